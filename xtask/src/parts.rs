//! The examples for real parts: workspaces of their own, built as their readers would build them.

use crate::{
    paths,
    shell::{cargo, run},
    toolchain::cargo_for,
};
use anyhow::Result;

/// An example and its part's target.
const PARTS: [(&str, &str); 3] = [
    ("rp2040", "thumbv6m-none-eabi"),
    ("stm32f405-rtic", "thumbv7em-none-eabihf"),
    ("stm32f4-embassy", "thumbv7em-none-eabihf"),
];

/// Warnings are errors, in the form in which cargo hands arguments to clippy.
const CLIPPY_ARGS: &str = "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__";

/// Builds each for its part. The linker tells if it does not fit.
pub fn parts() -> Result<()> {
    for (example, target) in PARTS {
        let directory = paths::examples().join(example);
        println!("in examples/{example}:");
        run(cargo("fmt --check").current_dir(&directory))?;
        let mut build = cargo_for(target, "build --release")?;
        // What a debugger needs is a fifth of the building time.
        build.env("CARGO_PROFILE_RELEASE_DEBUG", "false");
        // Clippy in the compiler's place, for the example alone: it lints and builds at once.
        build.env("RUSTC_WORKSPACE_WRAPPER", "clippy-driver").env("CLIPPY_ARGS", CLIPPY_ARGS);
        run(build.current_dir(&directory))?;
    }
    Ok(())
}
