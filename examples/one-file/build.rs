//! The flight's module from its file; and the linker script of cortex-m-rt, said once and here.

fn main() {
    spikewire_flight::build("flight.toml").unwrap();
    if std::env::var("CARGO_CFG_TARGET_OS").unwrap() == "none" {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
