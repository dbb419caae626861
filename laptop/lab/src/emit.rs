//! Sources for firmware: a constant in Rust, a file of parameters, a crate that makes the library for C.

use crate::coding::Coding;
use crate::tune::emit;
use anyhow::{Context, Result, bail};
use catalogue::run::{Constant, Known, Settings};
use std::fs;
use std::path::Path;

/// Writes a constant in Rust of this name, below these comments.
///
/// # Errors
/// A parameter is missing or makes no sense, or the scheme has no constant.
pub fn rust(coding: &Coding, name: &str, comments: &[String]) -> Result<String> {
    emit::rust(comments, name, coding.scheme, &settings(coding)?)
}

/// Writes a file of parameters, below these comments.
///
/// # Errors
/// A parameter is missing or makes no sense.
pub fn toml(coding: &Coding, comments: &[String]) -> Result<String> {
    Ok(emit::toml(comments, coding.scheme, &settings(coding)?))
}

/// Resolves a coding as it flies: where a signal begins is no parameter of it.
fn settings(coding: &Coding) -> Result<Settings> {
    let Coding { scheme, sample, asked } = coding;
    let past = vec![0.0; scheme.looks_back(asked)];
    let known = Known { calibrated: None, first: &past, can_calibrate: false };
    if let Some(what) = scheme.needs_signal(asked) {
        bail!("{} needs {what}", scheme.name());
    }
    scheme.resolve(*sample, asked, &known)
}

/// A codec of the library for C.
#[derive(Clone, Debug)]
pub struct Codec {
    /// The codec's name in C: `roll` gives `sw_roll_encode`.
    pub name: String,
    /// The scheme, the sample type and the parameters.
    pub coding: Coding,
}

/// Writes a crate that makes the library for C of exactly these codecs, their parameters in flash, into a new
/// directory. It is built with a checkout of spikewire, or with the published crates if there is none.
///
/// # Errors
/// A parameter is missing or makes no sense, the library has no such scheme, two codecs share a name, or the
/// directory is there.
pub fn c_crate(codecs: &[Codec], directory: &Path, spikewire: Option<&Path>) -> Result<()> {
    let mut all = Vec::new();
    for (place, codec) in codecs.iter().enumerate() {
        if codecs[..place].iter().any(|other| other.name == codec.name) {
            bail!("there are two codecs `{}`; a codec has the name of its file", codec.name);
        }
        all.push(declared(codec).with_context(|| format!("codec `{}`", codec.name))?);
    }
    write(directory, &all, spikewire)
        .with_context(|| format!("{}: cannot be written", directory.display()))
}

/// The declaration of a codec.
fn declared(Codec { name, coding }: &Codec) -> Result<String> {
    let Coding { scheme, sample, asked } = coding;
    let info = scheme.info();
    let is_in_c =
        catalogue::IN_C.iter().any(|(own, codecs)| own.name == info.name && !codecs.is_empty());
    if !is_in_c {
        bail!("{} draws from a generator, which the library for C has not", info.name);
    }
    if let Some(missing) = scheme.needs_signal(asked) {
        bail!("{} needs {missing}, which a signal tells; `tune` writes it", info.name);
    }
    let known = Known { calibrated: None, first: &[0.0], can_calibrate: false };
    let settings = scheme.resolve(*sample, asked, &known)?;
    scheme.codec(&settings)?; // what makes no sense is told here, not by the compiler
    let Constant { scheme: kind, value } = scheme.constant(&settings)?;
    let text = Coding::of_settings(*scheme, &settings).to_toml(&[]);
    let lines: Vec<String> = text.lines().map(|line| format!("    /// {line}\n")).collect();
    let text = lines.concat();
    Ok(format!(
        "    /// {}, in {sample}.\n    ///\n{text}    {name}: {kind} {{\n        constant {value};\n    }}\n",
        info.words
    ))
}

fn write(directory: &Path, declared: &[String], spikewire: Option<&Path>) -> Result<()> {
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
    let codecs: Vec<_> = codecs::CODECS.iter().map(|(_, codec)| codec[0]()).collect();
    std::fs::create_dir_all(&directory)?;
    let name = env!(\"CARGO_PKG_NAME\").replace('-', \"_\");
    std::fs::write(\"src/sizes.rs\", header::sizes(\"spikewire_c\", codecs.chunks(1)))?;
    std::fs::write(format!(\"{directory}/spikewire.h\"), header::core())?;
    std::fs::write(format!(\"{directory}/{name}.h\"), header::file(&name, &codecs))
}
";
