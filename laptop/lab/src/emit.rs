//! Writes source code for firmware: a constant in Rust, a file of parameters, or a crate that builds the C library.

use crate::c_bank::CBank;
use crate::coding::Coding;
use crate::error::At;
use crate::flight::Flight;
use crate::output::OutputKind;
use crate::scheme::Scheme;
use crate::tune::RequestKind;
use crate::tune::emit;
use crate::{Place, Result, Spot};
use catalogue::run::{Constant, ErrorKind, Known, Settings};
use std::path::Path;
use std::{fs, io};

/// Writes a Rust constant of this name, with these comments before it.
///
/// # Errors
/// Returns an error if a parameter is missing or invalid, or if the scheme cannot be written as a constant.
pub fn rust(coding: &Coding, name: &str, comments: &[String]) -> Result<String> {
    emit::rust(comments, name, coding.scheme, &settings(coding)?)
}

/// Writes a file of parameters, with these comments at its start.
///
/// # Errors
/// Returns an error if a parameter is missing or invalid.
pub fn toml(coding: &Coding, comments: &[String]) -> Result<String> {
    Ok(emit::toml(comments, coding.scheme, &settings(coding)?))
}

/// Resolves a coding to settings for flight, without the first value of a signal.
fn settings(coding: &Coding) -> Result<Settings> {
    let Coding { scheme, sample, asked } = coding;
    let past = vec![0.0; scheme.looks_back(asked)];
    let known = Known { calibrated: None, first: &past, can_calibrate: false };
    if let Some(needs) = scheme.needs_signal(asked) {
        let kind = ErrorKind::NeedsSignal { scheme: scheme.info(), needs };
        return Err(catalogue::run::Error::from(kind).into());
    }
    Ok(scheme.resolve(*sample, asked, &known)?)
}

/// A codec of the C library.
#[derive(Clone, Debug)]
pub struct Codec {
    /// The codec's name in C: `roll` gives `sw_roll_encode`.
    pub name: String,
    /// The scheme, the sample type and the parameters.
    pub coding: Coding,
}

/// Writes a crate that builds a C library of exactly these codecs, with their parameters in flash, into a new
/// directory. It depends on the checkout at `spikewire`, or on the published crates if that is `None`.
///
/// # Errors
/// Returns an error if a parameter is missing or invalid, if the library has no such scheme, if two codecs share a
/// name, or if the directory exists.
pub fn c_crate(codecs: &[Codec], directory: &Path, spikewire: Option<&Path>) -> Result<()> {
    let mut all = Vec::new();
    for (place, codec) in codecs.iter().enumerate() {
        if codecs[..place].iter().any(|other| other.name == codec.name) {
            return Err(RequestKind::TwoCodecs { name: codec.name.clone() }.into());
        }
        let part = || Place::from(Spot::Part(format!("codec `{}`", codec.name)));
        all.push(declared(codec).at(part)?);
    }
    let unwritten = |error| OutputKind::Unwritten { error }.at(directory);
    write(directory, &all, spikewire).map_err(unwritten)
}

/// Writes a crate that builds a C library of a flight's codecs, as [`c_crate`] does, and `flight_bank.h` with its bank
/// and its writer.
///
/// # Errors
/// Returns an error if the library has no such scheme or sample type, or if the directory exists.
pub fn c_flight(flight: &Flight, directory: &Path, spikewire: Option<&Path>) -> Result<()> {
    let bank = CBank::new(flight)?;
    let scheme = Scheme::from(flight.run_time());
    let declared = bank.codecs().iter();
    let declared: Vec<String> =
        declared.map(|(name, own, constant)| declaration(name, scheme, own, constant)).collect();
    let written = write(directory, &declared, spikewire).and_then(|()| {
        fs::create_dir_all(directory.join("include"))?;
        fs::write(directory.join("include/flight_bank.h"), bank.header(directory))
    });
    written.map_err(|error| OutputKind::Unwritten { error }.at(directory))
}

/// Returns the declaration of a codec.
fn declared(Codec { name, coding }: &Codec) -> Result<String> {
    let Coding { scheme, sample, asked } = coding;
    let info = scheme.info();
    let is_in_c =
        catalogue::IN_C.iter().any(|(own, codecs)| own.name == info.name && !codecs.is_empty());
    if !is_in_c {
        return Err(RequestKind::Draws { scheme: info.name }.into());
    }
    if let Some(needs) = scheme.needs_signal(asked) {
        return Err(
            catalogue::run::Error::from(ErrorKind::NeedsSignal { scheme: info, needs }).into()
        );
    }
    let known = Known { calibrated: None, first: &[0.0], can_calibrate: false };
    let settings = scheme.resolve(*sample, asked, &known)?;
    scheme.codec(&settings)?; // what makes no sense is told here, not by the compiler
    Ok(declaration(name, *scheme, &settings, &scheme.constant(&settings)?))
}

/// Returns the declaration of a codec with this name and constant.
fn declaration(name: &str, scheme: Scheme, settings: &Settings, constant: &Constant) -> String {
    let Constant { scheme: kind, value } = constant;
    let text = Coding::of_settings(scheme, settings).to_toml(&[]);
    let lines: Vec<String> = text.lines().map(|line| format!("    /// {line}\n")).collect();
    let (text, words, sample) = (lines.concat(), scheme.info().words, settings.sample);
    format!(
        "    /// {words}, in {sample}.\n    ///\n{text}    {name}: {kind} {{\n        constant {value};\n    }}\n"
    )
}

fn write(directory: &Path, declared: &[String], spikewire: Option<&Path>) -> io::Result<()> {
    fs::create_dir(directory)?;
    fs::create_dir_all(directory.join("src/bin"))?;
    let name = directory.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let name: String = name
        .chars()
        .map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' })
        .collect();
    let place = |part: &str| -> io::Result<String> {
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
        .replace("@C@", &place("bindings/c")?);
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
