//! The crates as they would be published, for programs that use them as a user would.

use crate::common::{cargo, command, paths, run};
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// A crate that is published.
pub struct Crate {
    pub name: &'static str,
    /// Directory, from the repository's top.
    pub directory: &'static str,
    /// Whether the crate runs on a microcontroller.
    pub flies: bool,
}

impl Crate {
    /// Returns the names in its manifest's `[features]`, so that new features are checked without a change here.
    pub fn features(&self) -> Result<Vec<String>> {
        let manifest = paths::root().join(self.directory).join("Cargo.toml");
        let text = fs::read_to_string(manifest)?;
        let Some((_, rest)) = text.split_once("[features]\n") else { return Ok(Vec::new()) };
        let names = rest
            .lines()
            .take_while(|line| !line.starts_with('['))
            .filter(|line| !line.starts_with('#'))
            .filter_map(|line| line.split_once(" = "))
            .map(|(name, _)| name.to_owned())
            .collect();
        Ok(names)
    }
}

/// The published crates, each after those on which it depends.
pub const CRATES: [Crate; 5] = [
    Crate { name: "spikewire", directory: "", flies: true },
    Crate { name: "spikewire-cameras", directory: "cameras", flies: true },
    Crate { name: "spikewire-chips", directory: "chips", flies: true },
    Crate { name: "spikewire-network", directory: "network", flies: true },
    Crate { name: "flight-logs", directory: "flight-logs", flies: false },
];

/// Returns cargo arguments that select the crate as it would be published.
pub fn patch() -> Result<String> {
    Ok(format!("patch.crates-io.spikewire.path={:?}", unpacked()?.display().to_string()))
}

/// Packs the crate as it would be published; returns the directory into which it is unpacked.
fn unpacked() -> Result<PathBuf> {
    run(&mut cargo("package --package spikewire --no-verify --allow-dirty --quiet"))?;
    let packed = paths::target().join("package");
    let version = version()?;
    let archive = packed.join(format!("spikewire-{version}.crate"));
    // With the time of now: those in the archive never change, and cargo would take the last version's build for this one's.
    run(command("tar").arg("-xzmf").arg(&archive).arg("-C").arg(&packed))?;
    Ok(packed.join(format!("spikewire-{version}")))
}

pub fn version() -> Result<String> {
    let manifest = fs::read_to_string(paths::root().join("Cargo.toml"))?;
    let line = manifest.lines().find_map(|line| line.strip_prefix("version = \""));
    Ok(line.context("Cargo.toml has no version")?.trim_end_matches('"').into())
}

/// Copies an example and its shared files; returns the copy, and cargo arguments that select the crate as it would be
/// published.
pub fn copied(name: &str, shared: &[&str]) -> Result<(TempDir, String)> {
    const PATCH: &str = "[patch.crates-io]\nspikewire = { path = \"../..\" }\n";

    let elsewhere = tempfile::tempdir()?;
    for name in shared.iter().chain([&name]) {
        copy(&paths::examples().join(name), &elsewhere.path().join(name))?;
    }
    let manifest = elsewhere.path().join(name).join("Cargo.toml");
    let text = fs::read_to_string(&manifest)?;
    ensure!(text.contains(PATCH), "{} does not patch the crate", manifest.display());
    fs::write(manifest, text.replace(PATCH, ""))?;
    Ok((elsewhere, patch()?))
}

/// Copies a directory's files, without cargo's output.
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
