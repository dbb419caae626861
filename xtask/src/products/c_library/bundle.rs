//! `cargo xtask c-bundle`: the C library for people without Rust, in one archive laid out for make, CMake, Arduino,
//! PlatformIO, Zephyr and ESP-IDF.

use super::{archive, include, room};
use crate::common::{paths, shell};
use crate::programs::boards::{Board, RISC_V};
use crate::setup;
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Cores, and the directory that holds the archive of each: Arduino's name of the core, then those of its
/// floating-point unit and calling convention.
const CORES: [(&str, &str); 6] = [
    ("M0", "cortex-m0plus"),
    ("M3", "cortex-m3"),
    ("M4F", "cortex-m4/fpv4-sp-d16-hard"),
    ("M7", "cortex-m7/fpv4-sp-d16-hard"),
    ("M33", "cortex-m33/fpv5-sp-d16-hard"),
    ("RV32", "esp32c3"),
];

/// Packages that compile the program in `bare` for RISC-V.
const PACKAGES: [&str; 2] = ["gcc-riscv64-unknown-elf", "make"];

/// Output of the program in `bare`, by the law of step forward: threshold 0.5, samples 0, 0.2, 0.6, 1.2, 1.3, 0.4.
const SPIKES: &str = ".\n.\n+\n+\n.\n-\n";

/// Writes the bundle; returns the path of the compressed archive.
pub fn bundle() -> Result<PathBuf> {
    setup::packages("what strips the archive for RISC-V", &["binutils-riscv64-unknown-elf"])?;
    let version = crate::programs::published::version()?;
    let name = format!("spikewire-c-{version}");
    let top = tempfile::tempdir()?;
    let place = top.path().join(&name);
    copy(&room().join("bundle"), &place)?;
    copy(include()?, &place.join("src"))?;
    for (core, directory) in CORES {
        let board = Board::with(core)?;
        let into = place.join("src").join(directory);
        fs::create_dir_all(&into)?;
        let from = archive(board)?;
        let mut strip = shell::command(format!("{}objcopy", board.tools()));
        // What names the build's directories is for a debugger only.
        strip.args(["--strip-debug", "--enable-deterministic-archives"]);
        shell::run(strip.arg(from).arg(into.join("libspikewire.a")))?;
    }
    for file in ["board.h", "cortex_m.c", "link.ld"] {
        fs::copy(room().join("tests").join(file), place.join("bare").join(file)).context(file)?;
    }
    for board in Board::all() {
        fs::copy(board.memory_map(), place.join(format!("bare/{}.x", board.machine)))?;
    }
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(paths::root().join(licence), place.join(licence))?;
    }
    let hashes = "find . -type f ! -name SHA256SUMS | LC_ALL=C sort | xargs sha256sum > SHA256SUMS";
    shell::run(shell::command("sh").args(["-c", hashes]).current_dir(&place))?;

    // The same bytes for the same files: no time, no owner, and always in one order.
    let packed = paths::target().join(format!("c-bundle/{name}.tar.gz"));
    fs::create_dir_all(paths::target().join("c-bundle"))?;
    let pack = format!(
        "LC_ALL=C tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=go=rX,u+rw \
         -cf - {name} | gzip -9n > {}",
        packed.display()
    );
    shell::run(shell::command("sh").args(["-c", &pack]).current_dir(&top))?;
    println!("{}", packed.display());
    Ok(packed)
}

/// Unpacks the bundle into a directory of its own, and runs its program on every emulated core with what a person without
/// Rust has: make, a C compiler and QEMU. Also checks that each manifest names the crate's version.
pub fn verify() -> Result<()> {
    setup::packages("what compiles C for RISC-V", &PACKAGES)?;
    let packed = bundle()?;
    let elsewhere = tempfile::tempdir()?;
    shell::run(shell::command("tar").arg("-xzf").arg(&packed).arg("-C").arg(elsewhere.path()))?;
    let name = packed.file_name().context("the archive has a name")?.to_string_lossy();
    let place = elsewhere.path().join(name.trim_end_matches(".tar.gz"));
    shell::output(shell::command("sha256sum").args(["-c", "SHA256SUMS"]).current_dir(&place))?;
    ensure_versions(&place)?;
    for (core, _) in CORES {
        let core = if core == RISC_V[0].core { "riscv".into() } else { core.to_lowercase() };
        let mut make = shell::command("make");
        make.args(["--silent", "run", &format!("CORE={core}")]).current_dir(place.join("bare"));
        let printed = shell::output(make.env_clear().env("PATH", "/usr/bin:/bin"))?;
        ensure!(printed == SPIKES, "{core}: {printed:?} in place of {SPIKES:?}");
    }
    println!("The program of the bundle gives the same spikes on {} cores.", CORES.len());
    Ok(())
}

fn ensure_versions(place: &Path) -> Result<()> {
    let version = crate::programs::published::version()?;
    for (file, line) in [
        ("library.properties", format!("version={version}")),
        ("library.json", format!("\"version\": \"{version}\"")),
        ("idf_component.yml", format!("version: \"{version}\"")),
    ] {
        let text = fs::read_to_string(place.join(file)).context(file)?;
        ensure!(
            text.contains(&line),
            "bindings/c/bundle/{file} has another version than {version}"
        );
    }
    Ok(())
}

fn copy(from: &Path, into: &Path) -> Result<()> {
    shell::run(shell::command("cp").arg("-r").arg(from).arg(into))
}
