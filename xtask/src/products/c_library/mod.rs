//! `cargo xtask c-library` and `cargo verify c`: the library for C, its header, and its tests.

mod compiler;
mod cost;
mod declared;
mod guides;
mod package;
mod sizes;
mod tests;

use crate::{
    common::{paths, shell, usage::usage},
    programs::{
        boards::{BOARDS, Board},
        host::triple,
    },
    setup::toolchain,
};
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

pub use cost::cost;
pub use guides::guides;
pub use sizes::write as write_sizes;
pub use tests::{cores, verify, watched};

const ARCHIVE: &str = "libspikewire_c.a";

/// Builds the library for the named cores or targets, or for all.
pub fn library(args: &[String]) -> Result<()> {
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let boards: Vec<&Board> = match args[..] {
        ["--target", "host"] => return host().map(drop),
        [] => BOARDS.iter().collect(),
        ["--target", name] => BOARDS
            .iter()
            .filter(|board| [board.target, board.cpu, board.core].contains(&name))
            .collect(),
        _ => return Err(usage("cargo xtask c-library [--target TARGET, CORE or host]".into())),
    };
    if boards.is_empty() {
        let names: Vec<_> =
            BOARDS.iter().map(|board| format!("{} ({})", board.target, board.cpu)).collect();
        return Err(usage(format!("no such target; there are host, {}", names.join(", "))));
    }
    for board in boards {
        package::package(board.cpu, &archive(board)?, &[])?;
    }
    if args.is_empty() { host().map(drop) } else { Ok(()) }
}

/// Builds the library for the host: for a simulation in the loop, and for tests of units.
fn host() -> Result<PathBuf> {
    let mut cargo = shell::cargo("rustc --release --lib --crate-type staticlib");
    shell::run(cargo.current_dir(room()).env("CARGO_TARGET_DIR", work()))?;
    let kept = apart(&work().join("release").join(ARCHIVE), "host", "objcopy")?;
    package::package("host", &kept, &["pthread", "dl", "m"])
}

/// Copies an archive, in which the crate's critical section gets a name of its own: another archive from Rust has one,
/// too, of another type.
fn apart(built: &Path, name: &str, objcopy: &str) -> Result<PathBuf> {
    let kept = work().join(name).join("libspikewire.a");
    fs::create_dir_all(work().join(name))?;
    let mut command = shell::command(objcopy);
    for half in ["acquire", "release"] {
        let renamed = format!("_critical_section_1_0_{half}=_spikewire_critical_section_{half}");
        command.arg("--redefine-sym").arg(renamed);
    }
    shell::run(command.arg(built).arg(&kept))?;
    Ok(kept)
}

fn room() -> PathBuf {
    paths::root().join("c")
}

/// Everything that the tests make.
fn work() -> PathBuf {
    paths::target().join("c")
}

/// Writes all that is made from the catalogue.
pub fn write() -> Result<()> {
    put(&room().join("src/codecs.rs"), &declared::codecs())?;
    put(&room().join("tests/flown.h"), &declared::flown())?;
    host_archive()?;
    header(&room().join("include"), &room().join("src/sizes.rs"))
}

/// Fails if something that is made from the catalogue is not what the catalogue says now.
fn ensure_written() -> Result<()> {
    let is = |path: &str, text: &str| {
        let kept = fs::read_to_string(room().join(path)).with_context(|| path.to_owned())?;
        ensure!(kept == text, "c/{path} is out of date: cargo xtask write c");
        Ok(())
    };
    is("src/codecs.rs", &declared::codecs())?;
    is("tests/flown.h", &declared::flown())?;
    let fresh = work().join("fresh");
    header(&fresh, &fresh.join("sizes.rs"))?;
    is("src/sizes.rs", &fs::read_to_string(fresh.join("sizes.rs"))?)?;
    for name in ["spikewire.h".to_owned()].into_iter().chain(files(&fresh.join("spikewire"))?) {
        let path = if name == "spikewire.h" { name } else { format!("spikewire/{name}") };
        is(&format!("include/{path}"), &fs::read_to_string(fresh.join(&path))?)?;
    }
    let (kept, new) = (files(&room().join("include/spikewire"))?, files(&fresh.join("spikewire"))?);
    ensure!(kept == new, "c/include/spikewire has other files: {kept:?}, and not {new:?}");
    Ok(())
}

fn files(directory: &Path) -> Result<Vec<String>> {
    let entries = fs::read_dir(directory).with_context(|| directory.display().to_string())?;
    let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    let mut names = names.collect::<Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

/// The library for the host, with what writes its header.
fn host_archive() -> Result<PathBuf> {
    for args in [
        "rustc --lib --crate-type staticlib --features header",
        "build --features header --bin header",
    ] {
        let mut cargo = shell::cargo(args);
        shell::run(cargo.current_dir(room()).env("CARGO_TARGET_DIR", work()))?;
    }
    apart(&work().join("debug").join(ARCHIVE), "debug-host", "objcopy")
}

/// The library for the host, each of whose reads and writes the address sanitizer looks at: a flag that only a nightly
/// compiler takes without being asked to. The sanitizer's own code is that of the C compiler.
fn watched_archive() -> Result<PathBuf> {
    let host = triple()?;
    let mut cargo = shell::cargo("rustc --lib --crate-type staticlib --target");
    cargo.arg(&host).current_dir(room()).env("CARGO_TARGET_DIR", work());
    cargo.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address -Zexternal-clangrt");
    shell::run(&mut cargo)?;
    apart(&work().join(host).join("debug").join(ARCHIVE), "watched-host", "objcopy")
}

/// Writes the header with the program that [`host_archive`] built.
fn header(into: &Path, sizes: &Path) -> Result<()> {
    fs::create_dir_all(into)?;
    shell::run(Command::new(work().join("debug/header")).arg(into).arg(sizes))
}

/// The library for a board's core.
fn archive(board: &Board) -> Result<PathBuf> {
    let build = "rustc --release --lib --crate-type staticlib";
    let mut cargo = toolchain::cargo_for(board.target, build)?;
    cargo.current_dir(room()).env("RUSTFLAGS", format!("-C target-cpu={}", board.cpu));
    shell::run(&mut cargo).with_context(|| format!("the library for {}", board.core))?;
    // Two cores share a target.
    let built = paths::thumb_target().join(board.target).join("release").join(ARCHIVE);
    apart(&built, board.cpu, "arm-none-eabi-objcopy")
}

/// Writes a file if it says something else.
fn put(path: &Path, text: &str) -> Result<()> {
    if fs::read_to_string(path).is_ok_and(|own| own == text) {
        return Ok(());
    }
    fs::write(path, text).with_context(|| path.display().to_string())
}
