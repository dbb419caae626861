//! `cargo verify mutants`: one change at a time in the crate, each of which the tests of `host-tests` have to notice.

use crate::{
    paths,
    shell::{cargo, command, run},
};
use anyhow::{Context, Result, ensure};
use std::{env, fs, path::Path};

/// Those that the tests can't tell from the crate stand in `.cargo/mutants.toml`, each with its reason.
///
/// All of them take days on one machine. `MUTANTS_SHARD=3/48` is the fourth of 48 parts, which are spread evenly over
/// the crate; each part goes on where its last run ended, and does not repeat what was noticed.
pub fn mutants() -> Result<()> {
    let tools = paths::target().join("tools");
    let program = tools.join("bin/cargo-mutants");
    if !program.is_file() {
        let mut install = cargo("install cargo-mutants --locked --root");
        run(install.arg(&tools).arg("--target-dir").arg(tools.join("build")))?;
    }
    let shard = env::var("MUTANTS_SHARD").unwrap_or("0/1".into());
    let told = paths::target().join("mutants").join(shard.replace('/', "-of-"));
    fs::create_dir_all(&told)?;
    let mut mutants = command(program);
    mutants
        .current_dir(paths::root())
        .args(["mutants", "--package", "spikewire", "--test-package", "host-tests"])
        .args(["--iterate", "--no-shuffle", "--sharding", "round-robin", "--shard", &shard])
        .args(["--colors", "never", "--output"])
        .arg(&told)
        .args(["--", "--test", "all"]);
    // Survivors are an exit status of their own; they are told below.
    mutants.status().context("cargo-mutants does not start")?;
    tell(&told.join("mutants.out"))
}

fn tell(told: &Path) -> Result<()> {
    let count = |name: &str| -> Result<Vec<String>> {
        let lines = fs::read_to_string(told.join(name)).unwrap_or_default();
        Ok(lines.lines().map(str::to_owned).collect())
    };
    let caught = count("caught.txt")?.len() + count("previously_caught.txt")?.len();
    let (missed, late, broken) =
        (count("missed.txt")?, count("timeout.txt")?, count("unviable.txt")?);
    println!(
        "{caught} noticed, {} end no test in time, {} do not compile, {} not noticed",
        late.len(),
        broken.len(),
        missed.len()
    );
    ensure!(caught > 0, "no mutant was tried");
    ensure!(missed.is_empty(), "no test notices:\n{}", missed.join("\n"));
    Ok(())
}
