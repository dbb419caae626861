//! Writes the header and the sizes that go with it: `header DIRECTORY-OF-HEADERS SIZES.rs`.

use std::path::Path;
use std::{env, fs, io, process};

use spikewire_c::{CODECS, Description, header};

fn main() -> io::Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [headers, sizes] = &arguments[..] else {
        eprintln!("header DIRECTORY SIZES.rs");
        process::exit(2);
    };
    // A file for each codec and shape, with all its sample types.
    let described = |codecs: &[fn() -> Description]| codecs.iter().map(|each| each()).collect();
    let files: Vec<(&str, Vec<Description>)> =
        CODECS.iter().map(|(name, codecs)| (*name, described(codecs))).collect();
    let headers = Path::new(headers);
    let each = headers.join("spikewire");
    fs::create_dir_all(&each)?;
    fs::write(headers.join("spikewire.h"), header::core())?;
    fs::write(each.join("all.h"), header::all(files.iter().map(|(name, _)| *name)))?;
    for (name, codecs) in &files {
        fs::write(each.join(name).with_extension("h"), header::file(name, codecs))?;
    }
    fs::write(sizes, header::sizes("crate", files.iter().map(|(_, codecs)| codecs.as_slice())))
}
