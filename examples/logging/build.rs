//! The linker scripts of cortex-m-rt and defmt, said once and here: a second `-Tlink.x` fails to link. And what is
//! logged: without this, errors only.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").unwrap() == "none" {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
        println!("cargo:rustc-env=DEFMT_LOG=info");
    }
}
