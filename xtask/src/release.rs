//! `cargo xtask release`: does everything before an upload, which is left to the owner; also checks licences.

use crate::checks::package;
use crate::common::{cargo, command, output, paths, run};
use crate::products::{book, c_library, page};
use crate::programs::published::{self, CRATES};
use crate::programs::python;
use anyhow::{Context, Result, bail, ensure};
use serde_json::json;
use std::{fs, path::PathBuf};

/// Fields shown by crates.io and docs.rs that only an owner can fill in.
const OWNERS: [&str; 2] = ["repository", "authors"];

/// All workspaces, each with a lock file of its own.
const WORKSPACES: [&str; 5] = [".", "bindings/c", "bindings/ros/node", "examples", "laptop/page"];

/// Does everything except the upload, and lists what the owner still has to fill in.
pub fn release() -> Result<()> {
    let version = published::version()?;
    let changes = fs::read_to_string(paths::root().join("CHANGELOG.md"))?;
    let heading = changes.lines().find(|line| line.starts_with(&format!("## [{version}]")));
    let heading = heading.with_context(|| format!("CHANGELOG.md says nothing of {version}"))?;

    package::package()?;
    deny()?;
    for own in CRATES {
        run(cargo("publish --dry-run --allow-dirty --package").arg(own.name))?;
    }
    let materials = bill_of_materials(&version)?;
    println!("\n{} tells what the crate is built of.", materials.display());
    python_package()?;
    let attached = [c_library::bundle()?, page::build()?, book::pack()?, materials];

    let mut left = Vec::new();
    if !heading.contains(" - ") {
        left.push(format!("a date in CHANGELOG.md: `{heading} - YYYY-MM-DD`"));
    }
    let manifest = fs::read_to_string(paths::root().join("Cargo.toml"))?;
    for field in OWNERS.iter().filter(|field| !manifest.contains(&format!("\n{field} ="))) {
        left.push(format!("`{field}` in Cargo.toml"));
    }
    println!(
        "\nThe owner fills in: {}",
        if left.is_empty() { "nothing".into() } else { left.join("; ") }
    );
    let uploads = CRATES.map(|own| format!("cargo publish --package {}", own.name)).join("; ");
    println!("Then, by hand: git tag v{version}; {uploads}; twine upload target/release/packed/*");
    let attached = attached.map(|file| file.display().to_string()).join(", ");
    println!("Attached to the tag's release: {attached}. The tag makes the wheels.");
    Ok(())
}

/// Checks licences, sources and banned crates of every workspace, and known vulnerabilities if their list is available.
pub fn deny() -> Result<()> {
    let tools = paths::target().join("tools");
    let deny = tools.join("bin/cargo-deny");
    if !deny.is_file() {
        let mut install = cargo("install cargo-deny --locked --root");
        run(install.arg(&tools).arg("--target-dir").arg(tools.join("build")))?;
    }
    let checks = |workspace: &str, checks: &[&str]| {
        let manifest = paths::root().join(workspace).join("Cargo.toml");
        let mut deny = command(&deny);
        deny.arg("--manifest-path").arg(manifest).args([
            "--workspace",
            "--all-features",
            "--config",
        ]);
        deny.arg(paths::root().join("deny.toml"))
            .args(["check", "--hide-inclusion-graph"])
            .args(checks);
        deny
    };
    for workspace in WORKSPACES {
        run(&mut checks(workspace, &["licenses", "sources", "bans"]))?;
    }
    let advisories = checks(".", &["advisories"]).output()?;
    let said = String::from_utf8_lossy(&advisories.stderr).into_owned();
    if said.contains("failed to fetch") || said.contains("Could not resolve host") {
        println!("The list of vulnerabilities cannot be had here, and was not looked at.");
        return Ok(());
    }
    ensure!(advisories.status.success(), "known vulnerabilities:\n{said}");
    println!("No known vulnerability.");
    Ok(())
}

/// Writes what the published crate is built from, with all features, as `CycloneDX`.
fn bill_of_materials(version: &str) -> Result<PathBuf> {
    let mut tree = cargo(
        "tree --package spikewire --all-features --edges normal --prefix none --no-dedupe --format",
    );
    let tree = output(tree.arg("{p}|{l}"))?;
    let mut components = Vec::new();
    for line in tree.lines().skip(1) {
        let (package, license) =
            line.split_once('|').context("cargo tree prints something else")?;
        let mut words = package.split(' ');
        let (Some(name), Some(own)) = (words.next(), words.next()) else {
            bail!("no crate: {line}")
        };
        let own = own.trim_start_matches('v');
        let component = json!({
            "type": "library", "name": name, "version": own,
            "purl": format!("pkg:cargo/{name}@{own}"),
            "licenses": [{ "expression": license.replace('/', " OR ") }],
        });
        if !components.contains(&component) {
            components.push(component);
        }
    }
    ensure!(components.len() > 5, "cargo tree prints something else");
    let bill = json!({
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "metadata": { "component": { "type": "library", "name": "spikewire", "version": version } },
        "components": components,
    });
    let path = paths::target().join("spikewire.cdx.json");
    fs::write(&path, serde_json::to_string_pretty(&bill)? + "\n")?;
    Ok(path)
}

/// Packs the Python package's source, and lets twine check its metadata, which are also those of a wheel.
fn python_package() -> Result<()> {
    let packed = paths::target().join("release/packed");
    let python = python::environment("release")?;
    python::install(&python, &["maturin>=1.9,<2", "twine"])?;
    run(command(python.with_file_name("maturin"))
        .args(["sdist", "--manifest-path", "bindings/python/Cargo.toml", "--out"])
        .arg(&packed))?;
    for one in fs::read_dir(&packed)? {
        run(command(&python).args(["-m", "twine", "check", "--strict"]).arg(one?.path()))?;
    }
    Ok(())
}
