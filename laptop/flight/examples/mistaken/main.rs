//! Writes flight files into a directory, for checks in other languages: those of `tests/flights`, and many that are easily
//! mistaken for one another.
//!
//! `flights.txt` has a line for each file: its name, its scheme, the number that represents 1 in its samples, its
//! fingerprint, and its kinds. Two files with a common kind differ in one field only.

mod list;

use spikewire_flight::Flight;
use std::{env, error::Error, fmt::Write, fs, path::Path};

/// Flights whose bits `tests/both_ends.rs` compares.
const FLOWN: [&str; 10] = [
    "asf",
    "asf_q16_16",
    "first_order",
    "grf_slots",
    "healing",
    "notch",
    "sf",
    "sf_q2_14",
    "sod",
    "sod_i32",
];

fn main() -> Result<(), Box<dyn Error>> {
    let directory = env::args().nth(1).ok_or("no directory")?;
    let directory = Path::new(&directory);
    fs::create_dir_all(directory)?;
    let flown = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/flights");
    let mut flights = Vec::new();
    for name in FLOWN {
        let text = fs::read_to_string(flown.join(name).with_extension("toml"))?;
        flights.push((name.to_owned(), text, "flown".to_owned()));
    }
    for (place, (text, kinds)) in list::flights().into_iter().enumerate() {
        let kinds: Vec<_> = kinds.into_iter().collect();
        flights.push((format!("f{place}"), text, kinds.join(" ")));
    }
    let mut table = String::new();
    for (name, text, kinds) in flights {
        let flight = Flight::parse(&text)?;
        let (scheme, fingerprint) = (flight.scheme.name, flight.fingerprint());
        let step = flight.sample.step();
        let one = if step > 0.0 { 1.0 / step } else { 1.0 };
        writeln!(table, "{name} {scheme} {one} {} {kinds}", fingerprint.bits())?;
        fs::write(directory.join(name).with_extension("toml"), text)?;
    }
    Ok(fs::write(directory.join("flights.txt"), table)?)
}
