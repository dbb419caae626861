//! `cargo verify mutants`: one change at a time in the crate, each of which the tests of `host-tests` have to notice.

use crate::{
    paths,
    shell::{cargo, command, run},
};
use anyhow::{Context, Result, bail, ensure};
use std::{env, fs, path::Path};

/// The program of tests for each part of the crate.
const ROOMS: [(&str, &[&str]); 3] = [
    ("wire", &["src/wire/**", "src/event/**", "src/out/**", "src/serial.rs"]),
    ("chips", &["src/chip/**"]),
    ("codes", &["src/scheme/**", "src/num/**", "src/frame/**", "src/error/**"]),
];

/// Changes that no test can tell from the crate stand in `.cargo/mutants.toml`, each with its reason.
///
/// All of them take days on one machine. `MUTANTS_SHARD=3/48` is the fourth of 48 parts, which are spread evenly over a room,
/// and `MUTANTS_ROOM=wire` one room. Each part goes on where its last run ended, and does not repeat what was noticed.
pub fn mutants() -> Result<()> {
    let tools = paths::target().join("tools");
    let program = tools.join("bin/cargo-mutants");
    if !program.is_file() {
        let mut install = cargo("install cargo-mutants --locked --root");
        run(install.arg(&tools).arg("--target-dir").arg(tools.join("build")))?;
    }
    let shard = env::var("MUTANTS_SHARD").unwrap_or("0/1".into());
    let chosen = env::var("MUTANTS_ROOM").ok();
    let rooms = ROOMS.iter().filter(|(room, _)| chosen.as_deref().is_none_or(|name| name == *room));
    let mut missed = Vec::new();
    for (room, files) in rooms {
        // The unchanged tree passes: cargo-mutants would ask the crate's package for tests that are another's.
        run(cargo("test --quiet --package host-tests --test").arg(room))?;
        let told = paths::target().join("mutants").join(room).join(shard.replace('/', "-of-"));
        fs::create_dir_all(&told)?;
        let mut mutants = command(&program);
        mutants
            .args(["mutants", "--package", "spikewire", "--test-package", "host-tests"])
            .args(["--iterate", "--no-shuffle", "--sharding", "round-robin", "--shard", &shard])
            // Compiled anew for each change, and hardly run.
            .args(["--cargo-arg=--config", "--cargo-arg=profile.dev.package.catalogue.opt-level=0"])
            .args(["--baseline", "skip", "--timeout", "300", "--colors", "never", "--output"])
            .arg(&told)
            .args(files.iter().flat_map(|files| ["--file", files]))
            .args(["--", "--test", room]);
        // Survivors are an exit status of their own; they are told below.
        mutants.status().context("cargo-mutants does not start")?;
        missed.extend(survivors(room, &told.join("mutants.out"))?);
    }
    if missed.is_empty() { Ok(()) } else { bail!("no test notices:\n{}", missed.join("\n")) }
}

/// Those that no test noticed, once the counts are shown.
fn survivors(room: &str, told: &Path) -> Result<Vec<String>> {
    let lines = |name: &str| -> Vec<String> {
        let lines = fs::read_to_string(told.join(name)).unwrap_or_default();
        lines.lines().map(str::to_owned).collect()
    };
    let caught = lines("caught.txt").len() + lines("previously_caught.txt").len();
    let (missed, late, broken) = (lines("missed.txt"), lines("timeout.txt"), lines("unviable.txt"));
    println!(
        "{room}: {caught} noticed, {} without end, {} do not compile, {} not noticed",
        late.len(),
        broken.len(),
        missed.len()
    );
    ensure!(caught > 0, "{room}: no change was tried");
    Ok(missed)
}
