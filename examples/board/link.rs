//! The build script of every program: the linker script of cortex-m-rt or riscv-rt, said once and here, as a second `-Tlink.x` fails to
//! link.

fn main() {
    println!("cargo:rerun-if-changed=../board/link.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").unwrap() == "none" {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
