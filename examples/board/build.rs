//! Puts the board's memory map where the linker looks for `memory.x`.
//!
//! `BOARD` names the map. Without it the target's usual board is taken, the one that `cargo run` starts.

use std::{env, fs, path::Path};

fn main() {
    println!("cargo:rerun-if-env-changed=BOARD");
    println!("cargo:rerun-if-changed=build.rs");

    let target = env::var("TARGET").unwrap();
    let usual = match target.as_str() {
        "thumbv6m-none-eabi" => "microbit",
        "thumbv7m-none-eabi" => "lm3s6965evb",
        "thumbv7em-none-eabihf" => "netduinoplus2",
        "thumbv8m.main-none-eabihf" => "mps2-an505",
        "riscv32imc-unknown-none-elf" | "riscv32imafc-unknown-none-elf" => "virt",
        _ => return, // the host needs no map
    };
    let board = env::var("BOARD").unwrap_or_else(|_| usual.into());
    let map = match board.as_str() {
        "netduinoplus2" => "../../memory.x".into(), // the crate's default target
        other => format!("memory/{other}.x"),
    };
    println!("cargo:rerun-if-changed={map}");

    let out = env::var("OUT_DIR").unwrap();
    fs::copy(&map, Path::new(&out).join("memory.x"))
        .unwrap_or_else(|error| panic!("no memory map for board {board}: {map}: {error}"));
    println!("cargo:rustc-link-search={out}");
}
