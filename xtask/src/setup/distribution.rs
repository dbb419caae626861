//! The Linux distribution's compiler, for machines where rustup must fetch nothing.
//!
//! Debian ships rustc with the host's libraries only, but also the source of the core library. `core_library.rs`
//! builds that once for each target, where this rustc looks for it.

use crate::common::shell;
use anyhow::Result;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Packages with the compiler and the source.
pub const PACKAGES: [&str; 6] = [
    "rustc-web",
    "cargo-web",
    "rust-web-src",    // the source of core
    "rust-web-clippy", // lints firmware
    "rust-web-llvm",   // rust-lld, which links firmware: a link to lld-22
    "lld-22",
];

pub const CARGO: &str = "/usr/bin/cargo";
pub const RUSTC: &str = "/usr/bin/rustc";
pub const CLIPPY: &str = "/usr/bin/clippy-driver";

/// File that names the compiler which built the core library beside it.
pub const STAMP: &str = ".built-by";

/// Returns whether the distribution's compiler, at its present version, can build for the target, and `cargo +thumb`
/// selects it.
pub fn has_core(target: &str) -> Result<bool> {
    if !Path::new(RUSTC).is_file() || !is_linked() {
        return Ok(false);
    }
    let stamp = fs::read_to_string(libraries(target).join(STAMP)).unwrap_or_default();
    Ok(stamp.trim() == version()?)
}

/// Returns whether rustup, if it is installed, knows this compiler as toolchain `thumb`.
pub fn is_linked() -> bool {
    !shell::has("rustup") || shell::succeeds(shell::command("rustc").args(["+thumb", "-V"]))
}

/// Returns the directory in which the compiler looks for the target's core library.
pub fn libraries(target: &str) -> PathBuf {
    Path::new("/usr/lib/rustlib").join(target).join("lib")
}

pub fn version() -> Result<String> {
    let version = shell::output(shell::command(RUSTC).arg("-V"))?;
    Ok(version.trim().into())
}
