//! The examples for real parts: workspaces of their own, copied elsewhere and built there as their readers would build them.

use crate::{
    package, paths,
    shell::{cargo, command, lint, output, run},
    speed,
    toolchain::cargo_for,
};
use anyhow::{Context, Result, ensure};
use std::{fs, path::Path, process::Command};
use tempfile::TempDir;

/// An example, its part's target, and the boards that it knows beside the usual one.
struct Part {
    name: &'static str,
    target: &'static str,
    boards: &'static [&'static str],
}

const PARTS: [Part; 3] = [
    Part { name: "speedybee-f405", target: F4, boards: &[] },
    Part { name: "stm32f405-rtic", target: F4, boards: &[] },
    Part { name: "stm32f4-embassy", target: F4, boards: &["crazyflie"] },
];

/// Other parts, whose HALs take minutes: `cargo verify more-parts`.
const MORE: [Part; 4] = [
    Part { name: "nrf52840", target: F4, boards: &[] },
    Part { name: "rp2040", target: "thumbv6m-none-eabi", boards: &[] },
    Part { name: "rp2350", target: "thumbv8m.main-none-eabihf", boards: &[] },
    Part { name: "stm32h743", target: F4, boards: &[] },
];

const F4: &str = "thumbv7em-none-eabihf";

/// What is copied beside an example.
const SHARED: [&str; 2] = ["flight", "icm42688p"];

/// What every manifest says of the checkout, and a copy does without.
const PATCH: &str = "[patch.crates-io]\nspikewire = { path = \"../..\" }\n";

/// The STM32F405's, and what all of them share.
pub fn parts() -> Result<()> {
    bodies()?;
    build(&PARTS)
}

/// The other parts.
pub fn more() -> Result<()> {
    build(&MORE)
}

/// Builds each for its part, with the crate as it would be published. The linker tells if it does not fit.
fn build(parts: &[Part]) -> Result<()> {
    for part in parts {
        let Part { name, target, boards } = *part;
        println!("a copy of examples/{name}:");
        let original = paths::examples().join(name);
        run(cargo("fmt --check").current_dir(&original))?;
        let (elsewhere, patch) = copied(name, &SHARED)?;
        let project = elsewhere.path().join(name);

        // There, cargo does not see this repository's settings. All share what they can.
        let cargo = |args: &str| -> Result<Command> {
            let mut cargo = cargo_for(target, args)?;
            cargo.current_dir(&project).arg("--config").arg(&patch);
            cargo.env("CARGO_TARGET_DIR", paths::thumb_target().join("parts"));
            quickly(&mut cargo);
            lint(&mut cargo); // the example alone
            Ok(cargo)
        };
        let image = paths::thumb_target().join("parts").join(target).join("release").join(name);
        for board in boards {
            run(&mut cargo(&format!("build --release --features {board}"))?)?;
            stack_ends_the_memory(&image)?;
        }
        run(&mut cargo("build --release")?)?;
        stack_ends_the_memory(&image)?;
        if name == "stm32f405-rtic" {
            speed::spi_pins_are_fast(&image)?;
        }
        if name == "stm32h743" {
            dma_has_its_memory(&image)?;
        }
    }
    Ok(())
}

/// A copy of an example and of what is copied beside it, and what tells cargo of the crate as it would be published.
pub fn copied(name: &str, shared: &[&str]) -> Result<(TempDir, String)> {
    let elsewhere = tempfile::tempdir()?;
    for name in shared.iter().chain([&name]) {
        copy(&paths::examples().join(name), &elsewhere.path().join(name))?;
    }
    without_patch(&elsewhere.path().join(name).join("Cargo.toml"))?;
    let crate_ = package::unpacked()?;
    Ok((elsewhere, format!("patch.crates-io.spikewire.path={:?}", crate_.display().to_string())))
}

/// What the examples share, on the host: futures, and plain functions.
fn bodies() -> Result<()> {
    for features in ["simulated", "simulated,blocking"] {
        let test = "test --quiet --manifest-path examples/Cargo.toml --package flight --features";
        run(cargo(test).arg(features).env("CARGO_TARGET_DIR", paths::target()))?;
    }
    Ok(())
}

/// The vendors' descriptions of their registers are most of the work, and hardly any of the code: here it is about whether
/// all fits together, which needs no optimised code.
fn quickly(cargo: &mut Command) {
    cargo.env("CARGO_PROFILE_RELEASE_LTO", "off");
    cargo.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1");
    cargo.env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16");
}

/// Copies a directory's files, without what cargo has built there.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let (entry, target) = (entry?, to);
        let target = target.join(entry.file_name());
        match entry.file_type()? {
            kind if !kind.is_dir() => drop(fs::copy(entry.path(), target)?),
            _ if entry.file_name() == "target" => {}
            _ => copy(&entry.path(), &target)?,
        }
    }
    Ok(())
}

fn without_patch(manifest: &Path) -> Result<()> {
    let text = fs::read_to_string(manifest)?;
    ensure!(text.contains(PATCH), "{} does not patch the crate", manifest.display());
    Ok(fs::write(manifest, text.replace(PATCH, ""))?)
}

/// What DMA moves lies where DMA reaches, and where `memory.rs` of the example keeps the cache out.
fn dma_has_its_memory(image: &Path) -> Result<()> {
    let sections = output(command("arm-none-eabi-objdump").arg("-h").arg(image))?;
    let section = |name| {
        let mut lines = sections.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        let line = lines.find(|words| words.get(1) == Some(&name)).context("no such section")?;
        let number = |at: usize| u32::from_str_radix(line.get(at).unwrap_or(&""), 16);
        anyhow::Ok((number(3)?, number(2)?))
    };
    let (start, length) = section(".dma")?;
    println!("DMA: {length} bytes from {start:#x} on");
    ensure!(start == 0x3000_0000 && length >= 132, "the buffer is not in SRAM1");
    Ok(())
}

/// The stack ends where the memory does: one that overflows meets no static, but a fault.
fn stack_ends_the_memory(image: &Path) -> Result<()> {
    let symbols = output(command("arm-none-eabi-nm").arg(image))?;
    let [start, end, statics] = ["_stack_start", "_stack_end", "__sdata"].map(|name| {
        let line = symbols.lines().find(|line| line.ends_with(&format!(" {name}")))?;
        u32::from_str_radix(line.split(' ').next()?, 16).ok()
    });
    let (start, end) = (start.context("no stack")?, end.context("no stack's end")?);
    println!("stack: {} bytes from {end:#x} on", start - end);
    ensure!(end == 0x2000_0000, "below the stack is memory");
    ensure!(statics.context("no statics")? >= start, "statics lie in the stack's way");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A log that waits for a debug probe stops the firmware when somebody pulls the probe.
    #[test]
    fn no_log_waits_for_a_probe() {
        for part in PARTS.iter().chain(&MORE) {
            let manifest = paths::examples().join(part.name).join("Cargo.toml");
            let text = fs::read_to_string(manifest).unwrap();
            let log = text.lines().find(|line| line.starts_with("defmt-rtt = ")).unwrap();
            assert!(log.contains("\"disable-blocking-mode\""), "{}: {log}", part.name);
        }
    }
}
