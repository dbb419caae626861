//! `cargo demo`: runs real flight data through encoder, emulated flight controller and decoder.

use crate::common::{paths, usage};
use crate::figures::{drawing, flown, flown::Flown, names::full_name, picture, signal::Signal};
use crate::programs::{boards::Board, host, image, qemu};
use crate::setup::{self, needs};
use anyhow::{Result, bail};
use std::path::PathBuf;

/// The firmware program.
const PROGRAM: &str = "demo";

pub fn demo(args: &[String]) -> Result<()> {
    if !args.is_empty() {
        return Err(usage("`cargo demo` takes no arguments".into()));
    }
    println!("=== What this needs");
    setup::provide(&needs::DEMO)?;
    fly().map(drop)
}

/// Draws the flight into the documentation.
pub fn write() -> Result<()> {
    drawing::keep(&fly()?, "docs/flight.svg")
}

/// Flies, and draws the flight below the target directory.
pub fn fly() -> Result<PathBuf> {
    println!("\n=== The flight, in the firmware of an emulated flight controller");
    let board = Board::with("M4F")?;
    let image = image::build(PROGRAM, board)?;
    let flown = flown::parse(&qemu::run(board, &image)?)?;
    let here = flown::parse(&host::on_host(PROGRAM)?)?;
    let signal = Signal::read();

    print_table(&signal, &flown, &here);

    let path = paths::target().join("demo.svg");
    picture::draw(&path, &signal, &flown)?;
    println!("The signal, its spikes and its reconstruction: {}", path.display());
    println!(
        "Every sample type on every core: cargo verify all-cores; the everyday checks: cargo verify"
    );

    if flown != here {
        bail!("the board and this computer differ");
    }
    Ok(path)
}

fn print_table(signal: &Signal, flown: &[Flown], here: &[Flown]) {
    let (samples, seconds) = (signal.rates.len(), signal.duration());
    println!(
        "\nThe yaw rate of a hexarotor that takes off, flies and lands hard: {seconds:.1} s, {samples} samples.\n\
         Encoded and decoded on an STM32F405 (Cortex-M4F), and once more on this computer.\n"
    );
    println!(
        "{:37} {:>6} {:>8} {:>10} {:>11} {:>17}  every bit",
        "scheme", "spikes", "spikes/s", "efficiency", "RMSE, rad/s", "latency"
    );
    for (flown, here) in flown.iter().zip(here) {
        let spikes = flown.spikes();
        let latency = match flown.latency {
            0 => "none".into(),
            late => format!("{late} = {:.0} ms", late as f64 * signal.interval() * 1e3),
        };
        println!(
            "{:37} {spikes:>6} {:>8.1} {:>8.1} % {:>11.3} {latency:>17}  {}",
            full_name(&flown.scheme),
            spikes as f64 / seconds,
            100.0 - 100.0 * spikes as f64 / samples as f64,
            flown.rmse(&signal.rates),
            if flown == here { "agrees" } else { "DIFFERS" },
        );
    }
    println!(
        "\nEfficiency: 100 % without a spike, 0 % with one a sample, negative beyond. Latency: samples of look-ahead.\n"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use needs::{CHECKS, DEMO};

    /// More would cost time: each core library takes half a minute on two cores, and the C compiler half a gigabyte.
    #[test]
    fn it_asks_for_the_core_that_it_flies_on_and_the_emulator_alone() {
        assert_eq!(DEMO.targets, [Board::with("M4F").unwrap().target]);
        let programs: Vec<&str> = DEMO.tools.iter().map(|tool| tool.program).collect();
        assert_eq!(programs, ["qemu-system-arm"]);
        assert!(DEMO.targets.iter().all(|target| CHECKS.targets.contains(target)));
        assert_eq!(CHECKS.targets.len(), 6);
    }
}
