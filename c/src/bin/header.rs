//! Writes the header and the sizes that go with it: `header DIRECTORY-OF-HEADERS SIZES.rs`.

use std::collections::BTreeMap;
use std::path::Path;
use std::{env, fs, io, process};

use spikewire_c::{CODECS, Description, header};

fn main() -> io::Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [headers, sizes] = &arguments[..] else {
        eprintln!("header DIRECTORY SIZES.rs");
        process::exit(2);
    };
    let codecs: Vec<Description> = CODECS.iter().map(|describe| describe()).collect();
    // A file for each codec and shape, with all its sample types.
    let mut files: BTreeMap<&str, Vec<Description>> = BTreeMap::new();
    for codec in &codecs {
        let end = ["_f32", "_i16", "_q8_8", "_q16_16"];
        let name = end.iter().find_map(|end| codec.name.strip_suffix(end)).unwrap_or(codec.name);
        files.entry(name).or_default().push(*codec);
    }
    let headers = Path::new(headers);
    let each = headers.join("spikewire");
    fs::create_dir_all(&each)?;
    fs::write(headers.join("spikewire.h"), header::core())?;
    fs::write(each.join("all.h"), header::all(files.keys().copied()))?;
    for (name, codecs) in &files {
        fs::write(each.join(name).with_extension("h"), header::file(name, codecs))?;
    }
    fs::write(sizes, header::sizes("crate", &codecs))
}
