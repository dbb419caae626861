//! The linker script of cortex-m-rt, said once and here: a second `-Tlink.x` fails to link.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").unwrap() == "none" {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
