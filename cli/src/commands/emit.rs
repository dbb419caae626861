//! `spikewire emit`: sources for firmware, from files of parameters.

use anyhow::{Context, Result, bail};
use catalogue::run::{Constant, Known};
use clap::{Args, Subcommand};
use lab::coding::Coding;
use std::fs;
use std::path::{Path, PathBuf};

/// Write sources for firmware, from files of parameters.
#[derive(Args, Debug)]
pub(crate) struct Emit {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand, Debug)]
enum What {
    C(C),
}

/// Write a crate that makes the library for C of exactly these codecs, their parameters in flash.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  spikewire tune flight.csv --channel gyro_x --scheme sf --emit toml -o roll.toml
  spikewire emit c roll.toml --spikewire ../spikewire -o roll
  cd roll
  cargo run --features header --bin header include
  cargo build --release --target thumbv7em-none-eabihf

The codec has the name of its file: sw_roll_encode, of sw_roll_codec.")]
struct C {
    /// Files of parameters, TOML, as `tune --emit toml` writes them
    #[arg(required = true, value_name = "FILE")]
    params: Vec<PathBuf>,
    /// Directory of the crate, which must not be there
    #[arg(short, long, value_name = "DIRECTORY")]
    output: PathBuf,
    /// A checkout of spikewire; the published crates unless given
    #[arg(long, value_name = "DIRECTORY")]
    spikewire: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// A file is bad, or the crate cannot be written.
pub(crate) fn run(options: &Emit) -> Result<()> {
    let What::C(C { params, output, spikewire }) = &options.what;
    c(params, output, spikewire.as_deref())
}

/// Writes a crate that makes the library for C of the codecs in these files.
///
/// # Errors
/// A file is bad, or the crate cannot be written.
pub(crate) fn c(params: &[PathBuf], output: &Path, spikewire: Option<&Path>) -> Result<()> {
    let mut codecs: Vec<(String, String)> = Vec::new();
    for path in params {
        let name = codec_name(path)?;
        if codecs.iter().any(|(own, _)| *own == name) {
            bail!(
                "{}: there is another codec `{name}`; its file may have another name",
                path.display()
            );
        }
        let codec = codec(&name, path).with_context(|| path.display().to_string())?;
        codecs.push((name, codec));
    }
    write(output, &codecs, spikewire)
        .with_context(|| format!("{}: cannot be written", output.display()))
}

/// The file's name without its ending, as C takes it: `gyro-x.toml` gives `gyro_x`.
fn codec_name(path: &Path) -> Result<String> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let is_word = |letter: char| letter.is_ascii_alphanumeric();
    let words: Vec<&str> =
        stem.split(|letter| !is_word(letter)).filter(|word| !word.is_empty()).collect();
    match words.join("_") {
        name if name.starts_with(|first: char| first.is_ascii_alphabetic()) => Ok(name),
        _ => {
            bail!("{}: a codec has its file's name, which must begin with a letter", path.display())
        }
    }
}

/// The declaration of a codec.
fn codec(name: &str, path: &Path) -> Result<String> {
    let Coding { scheme, sample, asked } = Coding::read(&path.to_string_lossy())?;
    let info = scheme.info();
    let is_in_c =
        catalogue::IN_C.iter().any(|(own, codecs)| own.name == info.name && !codecs.is_empty());
    if !is_in_c {
        bail!("{} draws from a generator, which the library for C has not", info.name);
    }
    if let Some(missing) = scheme.needs_signal(&asked) {
        bail!("{} needs {missing}, which a signal tells; `tune` writes it", info.name);
    }
    let known = Known { calibrated: None, first: &[0.0], can_calibrate: false };
    let settings = scheme.resolve(sample, &asked, &known)?;
    scheme.codec(&settings)?; // what makes no sense is told here, not by the compiler
    let Constant { scheme: kind, value } = scheme.constant(&settings)?;
    let text = Coding::of_settings(scheme, &settings).to_toml(&[]);
    let lines: Vec<String> = text.lines().map(|line| format!("    /// {line}\n")).collect();
    let text = lines.concat();
    Ok(format!(
        "    /// {}, in {sample}.\n    ///\n{text}    {name}: {kind} {{\n        constant {value};\n    }}\n",
        info.words
    ))
}

fn write(directory: &Path, codecs: &[(String, String)], spikewire: Option<&Path>) -> Result<()> {
    fs::create_dir(directory)?;
    fs::create_dir_all(directory.join("src/bin"))?;
    let name = directory.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let name: String = name
        .chars()
        .map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' })
        .collect();
    let place = |part: &str| -> Result<String> {
        Ok(match spikewire {
            Some(path) => {
                let path = fs::canonicalize(path)?.join(part);
                format!("path = {:?}", path.display().to_string())
            }
            None => format!("version = \"{}\"", env!("CARGO_PKG_VERSION")),
        })
    };
    let manifest = MANIFEST
        .replace("@NAME@", &name)
        .replace("@SPIKEWIRE@", &place("")?)
        .replace("@C@", &place("c")?);
    let declared: Vec<&str> = codecs.iter().map(|(_, codec)| codec.as_str()).collect();
    let codecs = CODECS.replace("@CODECS@", &declared.concat());
    for (path, text) in [
        ("Cargo.toml", manifest.as_str()),
        ("src/lib.rs", LIBRARY),
        ("src/codecs.rs", &codecs),
        ("src/sizes.rs", "// The header brings it.\n"),
        ("src/bin/header.rs", HEADER),
    ] {
        fs::write(directory.join(path), text)?;
    }
    Ok(())
}

const MANIFEST: &str = "\
[workspace]

[package]
name = \"@NAME@\"
version = \"0.1.0\"
edition = \"2024\"
publish = false

[lib]
crate-type = [\"staticlib\"]

[[bin]]
name = \"header\"
required-features = [\"header\"]

[features]
header = [\"spikewire-c/header\"]

[dependencies]
spikewire = { @SPIKEWIRE@, features = [\"fixed\"] }
spikewire-c = { @C@, default-features = false }
fixed = { version = \"1.30\", default-features = false }

[profile.dev]
panic = \"abort\"

[profile.release]
codegen-units = 1
lto = true
opt-level = \"s\"
panic = \"abort\"
";

const LIBRARY: &str = "\
//! The codecs that fly, for firmware in C.

#![cfg_attr(target_os = \"none\", no_std)]
#![allow(improper_ctypes_definitions)] // C sees storage of a size

mod codecs;
#[cfg(target_os = \"none\")]
mod sizes;
";

const CODECS: &str = "\
spikewire_c::codecs! {
@CODECS@}
";

const HEADER: &str = "\
//! Writes the header: `cargo run --features header --bin header DIRECTORY`.

#[allow(improper_ctypes_definitions)]
#[path = \"../codecs.rs\"]
mod codecs;

use spikewire_c::header;

fn main() -> std::io::Result<()> {
    let directory = std::env::args().nth(1).unwrap_or_else(|| \"include\".to_owned());
    let codecs: Vec<_> = codecs::CODECS.iter().map(|describe| describe()).collect();
    std::fs::create_dir_all(&directory)?;
    let name = env!(\"CARGO_PKG_NAME\").replace('-', \"_\");
    std::fs::write(\"src/sizes.rs\", header::sizes(\"spikewire_c\", &codecs))?;
    std::fs::write(format!(\"{directory}/spikewire.h\"), header::core())?;
    std::fs::write(format!(\"{directory}/{name}.h\"), header::file(&name, &codecs))
}
";

#[cfg(test)]
mod tests {
    use super::codec_name;
    use std::path::Path;

    #[test]
    fn a_codec_has_its_files_name() {
        for (path, name) in
            [("a/Gyro-x.toml", Some("gyro_x")), ("roll", Some("roll")), ("2.toml", None)]
        {
            assert_eq!(codec_name(Path::new(path)).ok().as_deref(), name);
        }
    }
}
