//! The constant to fly, from the file that `TUNED` names or from `src/yaw.rs`; and the linker script of cortex-m-rt,
//! said once and here: a second `-Tlink.x` fails to link.

use std::{env, fs, path::Path};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=TUNED");
    let tuned = env::var("TUNED").unwrap_or_else(|_| "src/yaw.rs".to_owned());
    println!("cargo:rerun-if-changed={tuned}");
    let place = Path::new(&env::var("OUT_DIR").unwrap()).join("tuned.rs");
    fs::copy(&tuned, place).unwrap_or_else(|error| panic!("{tuned}: {error}"));
    if env::var("CARGO_CFG_TARGET_OS").unwrap() == "none" {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
