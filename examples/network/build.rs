//! The linker script, and with `PLAIN_C` in the environment D in C, by `arm-none-eabi-gcc`.

use std::{env, path::Path, process::Command};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src/plain.c");
    if env::var("CARGO_CFG_TARGET_OS").unwrap() != "none" {
        return;
    }
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-env-changed=PLAIN_C");
    if env::var_os("PLAIN_C").is_none() {
        return;
    }
    println!("cargo:rustc-cfg=plain_c");
    let core = if env::var("TARGET").unwrap() == "thumbv6m-none-eabi" {
        "-mcpu=cortex-m0"
    } else {
        "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard"
    };
    let object = Path::new(&env::var_os("OUT_DIR").unwrap()).join("plain.o");
    let mut gcc = Command::new("arm-none-eabi-gcc");
    gcc.args(["-O3", "-mthumb", "-ffreestanding", "-Wall", "-Wextra", "-Werror"]);
    gcc.args(core.split(' ')).args(["-c", "src/plain.c", "-o"]).arg(&object);
    assert!(gcc.status().expect("arm-none-eabi-gcc").success(), "src/plain.c does not compile");
    println!("cargo:rustc-link-arg-bins={}", object.display());
}
