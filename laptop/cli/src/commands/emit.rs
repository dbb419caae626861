//! `spikewire emit`: writes source code for firmware, from a flight file (`flight.toml`) or from files of parameters.

use crate::inputs::read_flight;
use crate::options::check_ending;
use anyhow::{Result, bail};
use clap::{Args, Subcommand};
use lab::coding::Coding;
use lab::emit::{Codec, c_crate, c_flights};
use lab::flight::rust;
use lab::output::Output;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Write source code for firmware, from a flight file (`flight.toml`) or from files of parameters.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire emit rust --flight flight.toml -o src/flight.rs
  spikewire emit c roll.toml -o roll")]
pub(crate) struct Emit {
    #[command(subcommand)]
    language: Language,
}

#[derive(Subcommand, Debug)]
enum Language {
    Rust(Rust),
    C(C),
}

/// Write the sender and the receiver of a flight in Rust: a module `flight` to include with `include!`. A firmware's
/// build script can make the same module.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire advise flight.ulg --loop-bandwidth 4 -o flight.toml
  spikewire emit rust --flight flight.toml -o src/flight.rs")]
struct Rust {
    /// Flight file (`flight.toml`)
    #[arg(long, value_name = "FILE")]
    flight: PathBuf,
    /// File to write the module to; default: standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Write a crate that builds a C library. From files of parameters, the library contains the codecs, with their
/// parameters in flash. From flight files, it contains the senders and receivers of the flights.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire tune flight.csv --channels gyro_x --scheme sf --emit toml -o roll.toml
  spikewire emit c roll.toml --spikewire ../spikewire -o roll
  cd roll
  cargo run --features header --bin header include
  cargo build --release --target thumbv7em-none-eabihf

The codec has the name of its file: sw_roll_encode, of sw_roll_codec. So has a flight: sw_flight_bank_encode, in flight.h.")]
struct C {
    /// Files of parameters (TOML), as `tune --emit toml` writes them
    #[arg(required_unless_present = "flight", value_name = "FILE")]
    params: Vec<PathBuf>,
    /// Flight files (`flight.toml`), in place of files of parameters. The library then contains the bank of encoders,
    /// the frame writer and the receiver of each flight
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "params")]
    flight: Vec<PathBuf>,
    /// Directory to create for the crate; must not exist yet
    #[arg(short, long, value_name = "DIRECTORY")]
    output: PathBuf,
    /// Path of a checkout of spikewire to build against; default: the published crates
    #[arg(long, value_name = "DIRECTORY")]
    spikewire: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if an input file is invalid, or if the output cannot be written.
pub(crate) fn run(options: &Emit) -> Result<()> {
    let C { params, flight, output, spikewire } = match &options.language {
        Language::Rust(Rust { flight, output }) => {
            check_ending(output.as_deref(), "rs", "Rust")?;
            let text = rust(&read_flight(flight)?)?;
            let mut output = Output::open(output.as_deref(), flight)?;
            output.write_all(text.as_bytes())?;
            return Ok(output.finish()?);
        }
        Language::C(c) => c,
    };
    if !flight.is_empty() {
        let flights = flight.iter().map(|path| Ok((codec_name(path)?, read_flight(path)?)));
        let flights = flights.collect::<Result<Vec<_>>>()?;
        return Ok(c_flights(&flights, output, spikewire.as_deref())?);
    }
    let codecs = params.iter().map(|path| {
        Ok(Codec { name: codec_name(path)?, coding: Coding::read(&path.to_string_lossy())? })
    });
    Ok(c_crate(&codecs.collect::<Result<Vec<_>>>()?, output, spikewire.as_deref())?)
}

/// Returns the name of a codec in C: the file's name without its extension, in lower case, with `_` for other
/// characters. `Gyro-x.toml` gives `gyro_x`.
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
