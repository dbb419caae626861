//! Checks the firmware for real boards, each built in a project of its own, as a user would.

use crate::checks::emulator;
use crate::common::{cargo, command, lint, output, paths, run};
use crate::products::parts::{BOARDS, Part};
use crate::products::{new_firmware, new_firmware::Origin};
use crate::programs::published;
use crate::setup::toolchain::cargo_for;
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Maximum number of lines in a board's file.
const MOST_LINES: usize = 150;

/// Board that is checked every day; the others take too long.
const EVERY_DAY: &str = "pico";

/// Tests the sensors' drivers on the host; builds a Pico's image as it is flashed, and flies it in an emulator.
pub fn boards() -> Result<()> {
    let bodies =
        "test --quiet --manifest-path examples/Cargo.toml --package flight --package icm42688p";
    run(cargo(&format!("{bodies} --features flight/bmi323"))
        .env("CARGO_TARGET_DIR", paths::target()))?;
    run(cargo("fmt --check").current_dir(paths::examples().join("boards")))?;
    BOARDS.iter().filter(|part| part.name == EVERY_DAY).try_for_each(fly)
}

/// Flies the other images for which there is an emulator; compiles, links and inspects the rest. `BOARD` in the
/// environment selects a single one.
pub fn more() -> Result<()> {
    let asked = std::env::var("BOARD").ok();
    let is_asked = |part: &Part| match &asked {
        Some(name) => part.name == name,
        None => part.name != EVERY_DAY,
    };
    emulator::small_images()?;
    BOARDS.iter().filter(|part| is_asked(part)).try_for_each(|part| {
        if emulator::has(part) { fly(part) } else { build(part, true).map(drop) }
    })
}

fn fly(part: &Part) -> Result<()> {
    emulator::fly(part, &build(part, false)?)
}

/// Builds a board's image in a project that `new-firmware` writes, with the crate as it would be published. `quickly`
/// builds without optimisation, for images that are not run.
fn build(part: &Part, quickly: bool) -> Result<PathBuf> {
    let file = paths::examples().join(format!("boards/src/board/{}.rs", part.board));
    let lines = fs::read_to_string(&file)?.lines().count();
    println!("{}: {lines} lines of its own", part.name);
    ensure!(lines <= MOST_LINES, "{}: a board's file has {MOST_LINES} lines at most", part.name);

    let elsewhere = tempfile::tempdir()?;
    let project = elsewhere.path().join(part.name);
    new_firmware::write(&project, part, &Origin::Path(paths::root()))?;
    let patch = published::patch()?;
    let target = paths::thumb_target().join(if quickly { "parts" } else { "boards" });
    let mut cargo = cargo_for(part.target, "build --release")?;
    cargo.current_dir(&project).args(["--config", &patch]).env("CARGO_TARGET_DIR", &target);
    if quickly {
        cargo.env("CARGO_PROFILE_RELEASE_LTO", "off");
        cargo.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1");
        cargo.env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16");
    }
    run(lint(&mut cargo))?;
    let image = target.join(part.target).join("release").join(part.name);
    stack_ends_the_memory(&image)?;
    match part.memory {
        "stm32h743" => dma_has_its_memory(&image)?,
        "crazyflie" => the_bootloader_stays(&image)?,
        _ => {}
    }
    if part.memory.starts_with("stm32") || part.memory == "crazyflie" {
        a_binary_begins_with_the_vectors(&image)?;
    }
    Ok(image)
}

/// Returns the lowest address and the length of a section.
fn section(image: &Path, name: &str) -> Result<(u32, u32)> {
    let sections = output(command("arm-none-eabi-objdump").arg("-h").arg(image))?;
    let mut lines = sections.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let line = lines.find(|words| words.get(1) == Some(&name));
    let line = line.with_context(|| format!("no section `{name}`"))?;
    let number = |at: usize| u32::from_str_radix(line.get(at).unwrap_or(&""), 16);
    Ok((number(3)?, number(2)?))
}

/// Checks that buffers for DMA lie where DMA reaches, and where `part.rs` keeps the cache out.
fn dma_has_its_memory(image: &Path) -> Result<()> {
    let (start, length) = section(image, ".dma")?;
    println!("DMA: {length} bytes from {start:#x} on");
    ensure!(start == 0x3000_0000 && length >= 132, "the buffer is not in SRAM1");
    Ok(())
}

/// Checks that the first 16 KiB are left to the Crazyflie's radio bootloader.
fn the_bootloader_stays(image: &Path) -> Result<()> {
    let (start, _) = section(image, ".vector_table")?;
    ensure!(start == 0x0800_4000, "the image begins at {start:#x}, over the bootloader");
    Ok(())
}

/// Checks that the binary which `objcopy` makes for DFU and the radio begins with the stack's address, and has no gap
/// up to another memory.
fn a_binary_begins_with_the_vectors(image: &Path) -> Result<()> {
    let binary = image.with_extension("bin");
    run(command("arm-none-eabi-objcopy").args(["-O", "binary"]).arg(image).arg(&binary))?;
    let bytes = fs::read(&binary)?;
    println!("for DFU: {} bytes", bytes.len());
    ensure!(bytes.first_chunk() == Some(&0x2000_4000_u32.to_le_bytes()), "no stack's address");
    ensure!(bytes.len() < 256 * 1024, "{} bytes of a firmware of some 60 kB", bytes.len());
    Ok(())
}

/// Checks that the stack ends where the memory does: if it overflows it causes a fault, and does not overwrite statics.
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

    #[test]
    fn the_page_has_each_boards_port_and_code() {
        let page = fs::read_to_string(paths::root().join("docs/firmware.md")).unwrap();
        let (page, _) = page.split_once("\n## ").unwrap(); // the table of HALs comes later
        let rows = page.lines().filter(|line| line.starts_with("| `"));
        let rows: Vec<_> = rows.skip(1).collect();
        assert_eq!(rows.len(), BOARDS.len());
        let mut listen = "";
        for row in rows {
            let of_row = |part: &&Part| row.starts_with(&format!("| `{}` |", part.name));
            let part = BOARDS.iter().find(of_row).unwrap_or_else(|| panic!("{row}"));
            assert!(row.replace(' ', "").contains(&format!(",{}|", part.baud)), "{row}");
            if !row.ends_with("| the same |") {
                listen = part.listen;
                assert!(row.ends_with(&format!("| `{listen}` |")), "{row}");
            }
            assert_eq!(part.listen, listen, "{row}");
        }
    }

    /// A log that waits for a debug probe would stop the firmware once the probe is unplugged.
    #[test]
    fn no_log_waits_for_a_probe() {
        let text = fs::read_to_string(paths::examples().join("boards/Cargo.toml")).unwrap();
        let log = text.lines().find(|line| line.starts_with("defmt-rtt = ")).unwrap();
        assert!(log.contains("\"disable-blocking-mode\""), "{log}");
    }
}
