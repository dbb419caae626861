//! `cargo xtask setup`: what a bare machine lacks. It says what it installs and why, and skips what is there.

use crate::{distribution, packages, shell, toolchain};
use anyhow::Result;
use std::env;

pub fn setup() -> Result<()> {
    compiler()?;
    packages::tool("qemu-system-arm", "qemu-system-arm", "emulates the boards")?;
    packages::tool(
        "binutils-arm-none-eabi",
        "arm-none-eabi-nm",
        "reads the firmware's size and symbols",
    )?;
    println!("Set up: Cortex-M compiler, QEMU, binutils.");
    Ok(())
}

/// A compiler with a core library for every Cortex-M target.
fn compiler() -> Result<()> {
    let mut missing = Vec::new();
    for target in toolchain::TARGETS {
        if !toolchain::has_core(target)? {
            missing.push(target);
        }
    }
    if missing.is_empty() {
        return Ok(());
    }

    // With RUSTUP_AUTO_INSTALL=0 a machine says that rustup must fetch nothing.
    let rustup_may_fetch = env::var("RUSTUP_AUTO_INSTALL").as_deref() != Ok("0");
    if shell::has("rustup") && rustup_may_fetch {
        println!(
            "Adding the core library for {missing:?} with rustup: the crate and its firmware run there."
        );
        let mut rustup = shell::command("rustup");
        rustup.args(["target", "add"]).args(missing);
        shell::run(&mut rustup)
    } else {
        distribution::prepare(&missing)
    }
}
