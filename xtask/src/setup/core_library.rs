//! Builds the core library for a microcontroller, and installs it where the distribution's compiler looks for it.

use crate::common::{paths, shell};
use crate::setup::distribution::{CARGO, RUSTC, STAMP, libraries, version};
use crate::setup::packages;
use anyhow::{Context, Result};
use std::{fs, path::Path};

/// Builds the library, copies it as root, and removes what was compiled with another one.
pub fn install(target: &str) -> Result<()> {
    let is_replaced = libraries(target).exists();
    build(target).with_context(|| format!("the core library for {target}"))?;
    remove(&work())?;
    // Cargo knows the compiler by its version only, and would go on with what the old core library made.
    if is_replaced { remove(&paths::thumb_target()) } else { Ok(()) }
}

fn remove(stale: &Path) -> Result<()> {
    if stale.exists() {
        fs::remove_dir_all(stale)?;
    }
    Ok(())
}

fn work() -> std::path::PathBuf {
    paths::target().join("core-library")
}

/// Builds core and alloc as dependencies of an empty crate, and keeps only them.
fn build(target: &str) -> Result<()> {
    let work = work();
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
        .args(["build", "--release", "-Zbuild-std=core,alloc"])
        .args(["--target", target, "--target-dir", "target"])
        .env("RUSTC", RUSTC)
        .env("RUSTC_BOOTSTRAP", "1") // -Zbuild-std on a stable compiler
        .env("RUSTFLAGS", "-Cembed-bitcode=yes") // or `lto = true` fails
        .env_remove("CARGO_BUILD_TARGET");
    shell::run(&mut cargo)?;

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
    Ok(())
}

fn is_wanted(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let library = ["libcore-", "liballoc-", "libcompiler_builtins-"]
        .iter()
        .any(|start| name.starts_with(start));
    library && name.ends_with(".rlib")
}
