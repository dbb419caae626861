//! Writes source code for firmware: a constant in Rust, a TOML file of parameters, or a crate that builds the C
//! library.

use crate::coding::Coding;
use crate::error::At;
use crate::flight::{self, Flight};
use crate::output::OutputKind;
use crate::scheme::Scheme;
use crate::tune::RequestKind;
use crate::tune::emit;
use crate::{Place, Result, Spot};
use catalogue::run::{Constant, ErrorKind, Known, Settings};
use std::path::Path;
use std::{fs, io};

/// Writes a coding as a Rust constant called `name`, with `comments` before it.
///
/// # Errors
/// Returns an error if a parameter is missing or invalid, or if the scheme cannot be written as a constant.
pub fn rust(coding: &Coding, name: &str, comments: &[String]) -> Result<String> {
    emit::rust(comments, name, coding.scheme, &settings(coding)?)
}

/// Writes a coding as a TOML file of parameters, with `comments` at its start.
///
/// # Errors
/// Returns an error if a parameter is missing or invalid.
pub fn toml(coding: &Coding, comments: &[String]) -> Result<String> {
    Ok(emit::toml(comments, coding.scheme, &settings(coding)?))
}

/// Completes a coding's parameters with defaults. Returns an error if a parameter can only be derived from a signal.
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

/// A codec to build into a C library.
#[derive(Clone, Debug)]
pub struct Codec {
    /// The codec's name in C: `roll` gives `sw_roll_encode`.
    pub name: String,
    /// The scheme, the sample type and the parameters.
    pub coding: Coding,
}

/// Writes a crate into the new directory `directory`. The crate builds a C library of these codecs, with their
/// parameters in flash. If `spikewire` is the path of a checkout, the crate depends on this checkout. If `spikewire` is
/// `None`, the crate depends on the published crates.
///
/// # Errors
/// Returns an error if a parameter is missing or invalid, if the C library does not offer a scheme, if two codecs share
/// a name, or if the directory exists.
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
    let files = [
        ("src/codecs.rs".to_owned(), CODECS.replace("@CODECS@", &all.concat())),
        ("src/bin/header.rs".to_owned(), HEADER.to_owned()),
    ];
    write(directory, "codecs", &files, spikewire).map_err(unwritten)
}

/// Writes a crate into the new directory `directory`. The crate builds a C library with a sender and a receiver for
/// each flight (scheme and channels of a drone). `flights` pairs a name in C with each flight. If `spikewire` is the
/// path of a checkout, the crate depends on this checkout. If `spikewire` is `None`, the crate depends on the published
/// crates.
///
/// # Errors
/// Returns an error if a scheme cannot be written as a constant in Rust, if two flights share a name, or if the
/// directory exists.
pub fn c_flights(
    flights: &[(String, Flight)],
    directory: &Path,
    spikewire: Option<&Path>,
) -> Result<()> {
    let mut files = Vec::new();
    for (place, (name, flight)) in flights.iter().enumerate() {
        if flights[..place].iter().any(|(other, _)| other == name) {
            return Err(RequestKind::TwoCodecs { name: name.clone() }.into());
        }
        let module = flight::rust(flight)?;
        let text = format!("{module}\nspikewire_c::flight!({name}, flight);\n");
        files.push((format!("src/flights/{name}.rs"), text));
    }
    let names = || flights.iter().map(|(name, _)| name.as_str());
    let modules: Vec<String> = names().map(|name| format!("pub mod {name};\n")).collect();
    let described: Vec<String> = names().map(|name| format!("{name}::description")).collect();
    let all =
        FLIGHTS.replace("@MODULES@", &modules.concat()).replace("@ALL@", &described.join(", "));
    files.push(("src/flights/mod.rs".to_owned(), all));
    files.push(("src/bin/header.rs".to_owned(), FLIGHT_HEADER.to_owned()));
    let unwritten = |error| OutputKind::Unwritten { error }.at(directory);
    write(directory, "flights", &files, spikewire).map_err(unwritten)
}

/// Checks that a codec can be built, and returns its declaration for `spikewire_c::codecs!`.
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
    scheme.codec(&settings)?; // invalid settings are an error here, before a compiler sees them
    Ok(declaration(name, *scheme, &settings, &scheme.constant(&settings)?))
}

/// Returns the lines that declare a codec in the macro `spikewire_c::codecs!`. `name` is the codec's name, and
/// `constant` gives its type and value.
fn declaration(name: &str, scheme: Scheme, settings: &Settings, constant: &Constant) -> String {
    let Constant { scheme: kind, value } = constant;
    let text = Coding::of_settings(scheme, settings).to_toml(&[]);
    let lines: Vec<String> = text.lines().map(|line| format!("    /// {line}\n")).collect();
    let (text, words, sample) = (lines.concat(), scheme.info().words, settings.sample);
    format!(
        "    /// {words}, in {sample}.\n    ///\n{text}    {name}: {kind} {{\n        constant {value};\n    }}\n"
    )
}

/// Writes a crate into a new directory: its manifest, a library with the module `module`, and `files`. Each file is
/// given by its path and its text.
fn write(
    directory: &Path,
    module: &str,
    files: &[(String, String)],
    spikewire: Option<&Path>,
) -> io::Result<()> {
    fs::create_dir(directory)?;
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
    let library = LIBRARY.replace("@MODULE@", module);
    let own = [
        ("Cargo.toml", manifest.as_str()),
        ("src/lib.rs", &library),
        ("src/sizes.rs", "// Written by the program `header`.\n"),
    ];
    let files = files.iter().map(|(path, text)| (path.as_str(), text.as_str()));
    for (path, text) in own.into_iter().chain(files) {
        let path = directory.join(path);
        fs::create_dir_all(path.parent().unwrap_or(directory))?;
        fs::write(path, text)?;
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
spikewire = { @SPIKEWIRE@, features = [\"fixed\", \"link\"] }
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
//! A C library of spike codecs for firmware.

#![cfg_attr(target_os = \"none\", no_std)]
#![allow(improper_ctypes_definitions)] // C sees storage of a size

mod @MODULE@;
#[cfg(target_os = \"none\")]
mod sizes;
";

const CODECS: &str = "\
spikewire_c::codecs! {
@CODECS@}
";

const HEADER: &str = "\
//! Writes the library's C headers: `cargo run --features header --bin header DIRECTORY`.

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

const FLIGHTS: &str = "\
@MODULES@
/// Functions that describe the flights, one for each flight. A flight is the scheme and the channels of a sender. The
/// program `header` writes the C headers from the descriptions.
#[allow(dead_code)] // the library itself does not ask
pub static FLIGHTS: &[fn() -> spikewire_c::Flight] = &[@ALL@];
";

const FLIGHT_HEADER: &str = "\
//! Writes the library's C headers: `cargo run --features header --bin header DIRECTORY`.

#[allow(improper_ctypes_definitions)]
#[path = \"../flights/mod.rs\"]
mod flights;

use spikewire_c::header;

fn main() -> std::io::Result<()> {
    let directory = std::env::args().nth(1).unwrap_or_else(|| \"include\".to_owned());
    let flights: Vec<_> = flights::FLIGHTS.iter().map(|own| own()).collect();
    std::fs::create_dir_all(&directory)?;
    std::fs::write(\"src/sizes.rs\", header::flight_sizes(&flights))?;
    std::fs::write(format!(\"{directory}/spikewire.h\"), header::core())?;
    for flight in &flights {
        std::fs::write(format!(\"{directory}/{}.h\", flight.name), header::flight(flight))?;
    }
    Ok(())
}
";
