//! `cargo xtask c-library` and `cargo verify c`: the C library, its header, and its tests.

mod bundle;
mod compiler;
mod cost;
mod declared;
mod flights;
mod guides;
mod package;
mod sizes;
mod tests;

use crate::common::{paths, shell, usage};
use crate::programs::boards::{BOARDS, Board};
use crate::programs::host::triple;
use crate::setup::toolchain;
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
};

pub use bundle::{bundle, verify as verify_bundle};
pub use cost::cost;
pub use flights::write_flights;
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

/// Builds the library for the host, for simulation in the loop and for unit tests.
fn host() -> Result<PathBuf> {
    let mut cargo = shell::cargo("rustc --release --lib --crate-type staticlib");
    shell::run(cargo.current_dir(room()).env("CARGO_TARGET_DIR", work()))?;
    let kept = apart(&work().join("release").join(ARCHIVE), "host", "objcopy")?;
    package::package("host", &kept, &["pthread", "dl", "m"])
}

/// Copies an archive and renames the critical section of its crate, as another Rust archive may contain one of another
/// type.
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
    paths::root().join("bindings/c")
}

/// Returns the directory of the tests' output.
fn work() -> PathBuf {
    paths::target().join("c")
}

/// Writes all committed files that are generated from the catalogue.
pub fn write() -> Result<()> {
    put(&room().join("src/codecs.rs"), &declared::codecs())?;
    include()?;
    put(&room().join("src/sizes.rs"), &fs::read_to_string(work().join("sizes.rs"))?)
}

/// Fails if a generated file does not agree with the catalogue.
fn ensure_written() -> Result<()> {
    let is = |path: &str, text: &str| {
        let kept = fs::read_to_string(room().join(path)).with_context(|| path.to_owned())?;
        ensure!(kept == text, "bindings/c/{path} is out of date: cargo xtask write c");
        Ok(())
    };
    is("src/codecs.rs", &declared::codecs())?;
    include()?;
    is("src/sizes.rs", &fs::read_to_string(work().join("sizes.rs"))?)
}

/// Returns the directory of the headers, which a program of the library writes from its declarations, once for all
/// users.
fn include() -> Result<&'static Path> {
    static WRITTEN: OnceLock<PathBuf> = OnceLock::new();
    if let Some(written) = WRITTEN.get() {
        return Ok(written);
    }
    let mut cargo = shell::cargo("build --features header --bin header");
    shell::run(cargo.current_dir(room()).env("CARGO_TARGET_DIR", work()))?;
    let into = work().join("include");
    let codecs = into.join("spikewire");
    fs::create_dir_all(&codecs)?;
    for stale in fs::read_dir(&codecs)? {
        fs::remove_file(stale?.path())?;
    }
    shell::run(Command::new(work().join("debug/header")).arg(&into).arg(work().join("sizes.rs")))?;
    Ok(WRITTEN.get_or_init(|| into))
}

/// Returns the library for the host, as linked by the program that writes the headers.
fn host_archive() -> Result<PathBuf> {
    let mut cargo = shell::cargo("rustc --lib --crate-type staticlib --features header");
    shell::run(cargo.current_dir(room()).env("CARGO_TARGET_DIR", work()))?;
    apart(&work().join("debug").join(ARCHIVE), "debug-host", "objcopy")
}

/// Returns the library for the host with the address sanitizer on each of its reads and writes, by a flag that a stable
/// compiler accepts only when told to. The sanitizer's runtime is that of the C compiler.
fn watched_archive() -> Result<PathBuf> {
    let host = triple()?;
    let mut cargo = shell::cargo("rustc --lib --crate-type staticlib --target");
    cargo.arg(&host).current_dir(room()).env("CARGO_TARGET_DIR", work());
    cargo.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address -Zexternal-clangrt");
    shell::run(&mut cargo)?;
    apart(&work().join(host).join("debug").join(ARCHIVE), "watched-host", "objcopy")
}

/// Returns the library for a board's core.
fn archive(board: &Board) -> Result<PathBuf> {
    let build = "rustc --release --lib --crate-type staticlib";
    let mut cargo = toolchain::cargo_for(board.target, build)?;
    cargo.current_dir(room()).env("RUSTFLAGS", format!("-C target-cpu={}", board.cpu));
    shell::run(&mut cargo).with_context(|| format!("the library for {}", board.core))?;
    // Two cores share a target.
    let built = paths::thumb_target().join(board.target).join("release").join(ARCHIVE);
    apart(&built, board.cpu, &format!("{}objcopy", board.tools()))
}

/// Writes a file if its content differs.
fn put(path: &Path, text: &str) -> Result<()> {
    if fs::read_to_string(path).is_ok_and(|own| own == text) {
        return Ok(());
    }
    fs::write(path, text).with_context(|| path.display().to_string())
}
