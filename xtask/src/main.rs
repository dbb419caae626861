//! Set-up and checks. `cargo xtask` lists the commands.

mod bench;
mod boards;
mod checks;
mod demo;
mod distribution;
mod firmware;
mod flown;
mod link;
mod logging;
mod markdown;
mod names;
mod packages;
mod parts;
mod paths;
mod peers;
mod picture;
mod qemu;
mod setup;
mod shell;
mod signal;
mod size;
mod storm;
mod toolchain;
mod verify;

use anyhow::{Result, bail};
use std::{env, process::ExitCode};

const USAGE: &str = "\
cargo xtask <command>

  setup                 compiler targets, QEMU and binutils for Cortex-M; does only what is missing
  firmware [PROGRAM]... runs the example programs on every emulated board and compares with the host
  firmware --markdown   the same for flight-log alone, as a table for the README
  demo                  real flight data through encoder, emulated flight controller and decoder
  bench-target          what every codec costs on every emulated board, in instructions and bytes
  verify [STEP]...      every check, or the named ones; `cargo verify --list` names them

`cargo demo`, `cargo bench-target` and `cargo verify` are short for the last three.";

fn main() -> ExitCode {
    let mut args = env::args().skip(1);
    let command = args.next().unwrap_or_default();
    let rest: Vec<String> = args.collect();

    match run(&command, &rest) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: &str, args: &[String]) -> Result<()> {
    match command {
        "setup" => setup::setup(),
        "firmware" => firmware::firmware(args),
        "bench-target" => bench::bench(args),
        "demo" => demo::demo(args),
        "verify" => verify::verify(args),
        "" | "help" | "-h" | "--help" => {
            println!("{USAGE}");
            Ok(())
        }
        other => bail!("no command `{other}`\n\n{USAGE}"),
    }
}
