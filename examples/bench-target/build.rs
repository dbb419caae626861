//! The linker script, and the codecs in plain C for each sample type, by `arm-none-eabi-gcc`.

use std::{env, path::Path, process::Command};

/// Compilers' options for the cores of each target.
const CORES: [(&str, &str); 4] = [
    ("thumbv6m-none-eabi", "-mcpu=cortex-m0"),
    ("thumbv7m-none-eabi", "-mcpu=cortex-m3"),
    ("thumbv7em-none-eabihf", "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard"),
    ("thumbv8m.main-none-eabihf", "-mcpu=cortex-m33 -mfpu=fpv5-sp-d16 -mfloat-abi=hard"),
];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src/plain.c");
    let target = env::var("TARGET").unwrap();
    let Some((_, core)) = CORES.into_iter().find(|(name, _)| *name == target) else { return };
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    for (sample, wide) in [("float", "float"), ("int32_t", "int32_t"), ("int16_t", "int32_t")] {
        let object = Path::new(&env::var_os("OUT_DIR").unwrap()).join(format!("{sample}.o"));
        let mut gcc = Command::new("arm-none-eabi-gcc");
        gcc.args(["-O3", "-mthumb", "-ffreestanding", "-ffunction-sections", "-fwrapv"]);
        gcc.args(["-Wall", "-Wextra", "-Werror"]).args(core.split(' '));
        gcc.args([format!("-DTYPE={sample}"), format!("-DWIDE={wide}")]);
        gcc.args(["-c", "src/plain.c", "-o"]).arg(&object);
        assert!(gcc.status().expect("arm-none-eabi-gcc").success(), "src/plain.c fails to compile");
        println!("cargo:rustc-link-arg-bins={}", object.display());
    }
}
