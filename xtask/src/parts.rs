//! The examples for real parts: workspaces of their own, built as their readers would build them.

use crate::{
    paths,
    shell::{cargo, lint, run},
    toolchain::cargo_for,
};
use anyhow::Result;

/// An example and its part's target.
const PARTS: [(&str, &str); 3] = [
    ("rp2040", "thumbv6m-none-eabi"),
    ("stm32f405-rtic", "thumbv7em-none-eabihf"),
    ("stm32f4-embassy", "thumbv7em-none-eabihf"),
];

/// Builds each for its part. The linker tells if it does not fit.
pub fn parts() -> Result<()> {
    for (example, target) in PARTS {
        let directory = paths::examples().join(example);
        println!("in examples/{example}:");
        run(cargo("fmt --check").current_dir(&directory))?;
        let mut build = cargo_for(target, "build --release")?;
        lint(&mut build); // the example alone
        run(build.current_dir(&directory))?;
    }
    Ok(())
}
