//! A compiler for Cortex-M from the Linux distribution, where rustup must fetch nothing.
//!
//! Debian ships rustc with the host's libraries only, but also the library source. So the core library is
//! built here, once for each target, and put where that rustc looks for it. Then rustup is told of the
//! distribution's toolchain under the name `thumb`, so that `cargo +thumb build --target …` just works.

use crate::{packages, paths, shell};
use anyhow::{Context, Result};
use std::{
    fs,
    path::{Path, PathBuf},
};

const PACKAGES: [&str; 6] = [
    "rustc-web",
    "cargo-web",
    "rust-web-src",    // the source of core
    "rust-web-clippy", // lints firmware
    "rust-web-llvm",   // rust-lld, which links firmware: a link to lld-22
    "lld-22",
];

const CARGO: &str = "/usr/bin/cargo";
const RUSTC: &str = "/usr/bin/rustc";

/// Says which compiler built the core library beside it.
const STAMP: &str = ".built-by";

/// Makes `cargo +thumb` build for these targets.
pub fn prepare(targets: &[&str]) -> Result<()> {
    packages::install(
        &PACKAGES,
        "a compiler whose core library can be built for Cortex-M; rustup must fetch nothing here",
    )?;
    if shell::has("rustup") && !shell::succeeds(shell::command("rustc").args(["+thumb", "-V"])) {
        println!("Telling rustup of the distribution's compiler, as toolchain `thumb`.");
        shell::run(shell::command("rustup").args(["toolchain", "link", "thumb", "/usr"]))?;
    }
    for target in targets {
        if !has_core(target)? {
            println!(
                "Building the core library for {target} and putting it into {}.",
                libraries(target).display()
            );
            build_core(target).with_context(|| format!("the core library for {target}"))?;
        }
    }
    Ok(())
}

/// Whether the distribution's compiler, at its present version, can build for the target.
pub fn has_core(target: &str) -> Result<bool> {
    if !Path::new(RUSTC).is_file() {
        return Ok(false);
    }
    let stamp = fs::read_to_string(libraries(target).join(STAMP)).unwrap_or_default();
    Ok(stamp.trim() == version()?)
}

fn libraries(target: &str) -> PathBuf {
    Path::new("/usr/lib/rustlib").join(target).join("lib")
}

fn version() -> Result<String> {
    let version = shell::output(shell::command(RUSTC).arg("-V"))?;
    Ok(version.trim().into())
}

/// Builds core and alloc as the dependencies of an empty crate, and keeps only them.
fn build_core(target: &str) -> Result<()> {
    let work = paths::target().join("core-library");
    fs::create_dir_all(work.join("src"))?;
    fs::write(work.join("src/lib.rs"), "#![no_std]\n")?;
    fs::write(
        work.join("Cargo.toml"),
        "[workspace]\n\
         [package]\nname = \"empty\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\
         [profile.release]\ncodegen-units = 1\n",
    )?;
    let mut cargo = shell::command(CARGO);
    cargo
        .current_dir(&work)
        .args(["build", "--quiet", "--release", "-Zbuild-std=core,alloc"])
        .args(["--target", target, "--target-dir", "target"])
        .env("RUSTC", RUSTC)
        .env("RUSTC_BOOTSTRAP", "1") // -Zbuild-std on a stable compiler
        .env("RUSTFLAGS", "-Cembed-bitcode=yes") // or `lto = true` fails
        .env_remove("CARGO_BUILD_TARGET");
    shell::output(&mut cargo)?;

    let stamp = work.join(STAMP);
    fs::write(&stamp, version()?)?;
    let built = work.join("target").join(target).join("release/deps");
    let kept = fs::read_dir(&built)?
        .map(|file| Ok(file?.path()))
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .filter(|path| is_wanted(path));

    let place = libraries(target);
    shell::output(packages::as_root("rm")?.arg("-rf").arg(&place))?;
    shell::output(packages::as_root("mkdir")?.arg("-p").arg(&place))?;
    // The stamp goes last: a copy that was cut short is done again.
    shell::output(packages::as_root("cp")?.args(kept).arg(&place))?;
    shell::output(packages::as_root("cp")?.arg(stamp).arg(&place))?;

    // Cargo knows the compiler by its version only, and would go on with what the old core library made.
    for stale in [work, paths::thumb_target()] {
        if stale.exists() {
            fs::remove_dir_all(stale)?;
        }
    }
    Ok(())
}

fn is_wanted(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let library = ["libcore-", "liballoc-", "libcompiler_builtins-"]
        .iter()
        .any(|start| name.starts_with(start));
    library && name.ends_with(".rlib")
}
