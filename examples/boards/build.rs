//! The linker scripts of cortex-m-rt and defmt, and the board's memory map.

use std::{env, fs, path::PathBuf};

/// Boards with a memory map of their own name, and those that share one.
const MAPS: [(&str, &str); 7] = [
    ("PICO", "rp2040"),
    ("PICO_8KHZ", "rp2040"),
    ("PICO2", "rp2350"),
    ("SPEEDYBEE_F405", "stm32f405"),
    ("CRAZYFLIE", "crazyflie"),
    ("MATEK_H743", "stm32h743"),
    ("NRF52840_DK", "nrf52840"),
];

fn main() {
    let has = |board: &str| env::var_os(format!("CARGO_FEATURE_{board}")).is_some();
    let chosen: Vec<_> = MAPS.iter().filter(|(board, _)| has(board)).collect();
    let [(_, map)] = chosen[..] else { panic!("one feature names one board: --features pico") };

    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap());
    fs::copy(format!("memory/{map}.x"), out.join("memory.x")).unwrap();
    println!("cargo:rerun-if-changed=memory");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    if *map == "rp2040" {
        println!("cargo:rustc-link-arg-bins=-Tlink-rp.x");
    }
}
