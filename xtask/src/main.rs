//! Set-up and checks; `cargo xtask` lists the commands.
//!
//! Each module uses only those before it: `common`, `setup` (what a machine needs), `programs` (built for the host and
//! for emulated boards, and run), `figures` (tables and pictures of the documentation), `products` (what others use of
//! this repository) and `checks`. `verify` lists the checks, and `write` what is generated.

mod checks;
mod common;
mod figures;
#[cfg(test)]
mod habits;
mod mutants;
mod products;
mod programs;
mod release;
#[cfg(test)]
mod rooms;
mod setup;
mod verify;
mod write;

use anyhow::Result;
use checks::{emulate, firmware, network, simulated_drone};
use common::{Usage, progress, usage};
use figures::{bench, demo};
use products::{book, c_library, new_firmware, new_scheme, page};
use std::{env, process::ExitCode};

const USAGE: &str = "\
cargo xtask <command>

  setup                 compiler targets, QEMU and binutils for Cortex-M; does only what is missing
  firmware [PROGRAM]... runs the example programs on every emulated board and compares with the host
  write [PART]...       writes again what is generated: tables and pictures of the pages, declarations, stubs; all, or
                        the named parts; a name that there is not lists them
  c-library [--target]  the library for C: archive, header, CMake package and pkg-config file for each core and the host
  c-bundle              the same for people without Rust: one archive for make, CMake, Arduino, PlatformIO, Zephyr, ESP-IDF
  guides FIRMWARE DIR   builds the guide of bindings/c/guides for crazyflie, betaflight or px4 with a checkout of that firmware
  new-firmware DIR --board NAME
                        writes a firmware project for a board, which builds as it comes; without arguments, the boards
  new-firmware DIR --hal NAME --flight FLIGHT.toml
                        writes one with a HAL of yours, from a flight's file; without arguments, the HALs
  emulate IMAGE --part PART
                        runs an image with a sensor on its bus, and writes what its serial port says to standard output
  scheme NAME TYPE --like NAME
                        a scheme to begin from: a copy of one that there is under another name, and the lines that list it
  page [--serve]        a page to look at signals and their spikes, as one HTML file; serves it on this machine alone
  book                  the pages of this repository as a web site with search; installs MkDocs from PyPI
  network NETWORK.rs SPIKES.txt
                        a network that `spikewire network` wrote, on an emulated STM32F405 and RP2040 and on the host
  loop [CODE]           flies a simulated drone on spikes and draws it; installs RotorPy from PyPI, 1.2 GB
  demo                  real flight data through encoder, emulated flight controller and decoder
  release               checks and builds all that is uploaded, stops before that, and says what the owner fills in
  bench-target          what every codec costs on every emulated board, in instructions and bytes
  verify [STEP]...      every check, or the named ones; `cargo verify --help` lists them

`cargo demo`, `cargo bench-target` and `cargo verify` are short for the last three. Only `setup` acts as root or
removes directories; `demo` and `verify` begin with it. It says what it does.";

fn main() -> ExitCode {
    let mut args = env::args().skip(1);
    let command = args.next().unwrap_or_default();
    let rest: Vec<String> = args.collect();

    progress::watch();
    match run(&command, &rest) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            if error.is::<Usage>() { ExitCode::from(2) } else { ExitCode::FAILURE }
        }
    }
}

fn run(command: &str, args: &[String]) -> Result<()> {
    match command {
        "setup" => setup::setup(),
        "firmware" => firmware::firmware(args),
        "bench-target" => bench::bench(args),
        "write" => write::write(args),
        "c-library" => c_library::library(args),
        "c-bundle" => c_library::bundle().map(drop),
        "guides" => c_library::guides(args),
        "scheme" => new_scheme::new_scheme(args),
        "emulate" => emulate::emulate(args),
        "new-firmware" => new_firmware::new_firmware(args),
        "page" => page::page(args),
        "book" => book::build().map(drop),
        "demo" => demo::demo(args),
        "network" => network::network(args),
        "loop" => simulated_drone::fly(args),
        "release" => release::release(),
        "verify" => verify::verify(args),
        "" | "help" | "-h" | "--help" => {
            println!("{USAGE}");
            Ok(())
        }
        other => Err(usage(format!("no command `{other}`\n\n{USAGE}"))),
    }
}
