//! Feeds hostile bytes to everything that reads bytes: `fuzz` replays the corpora, `fuzz-long` searches for new inputs
//! with libFuzzer.

use crate::common::{cargo, command, paths, run};
use crate::programs::host::{tests, triple};
use anyhow::{Context, Result, bail, ensure};
use std::{env, fs, path::PathBuf, process::Command};

/// Seconds for each target, unless `FUZZ_SECONDS` gives others.
const SECONDS: &str = "60";

/// Longest inputs, in bytes. NIR graphs are longer; they change only within their seeds.
const LONGEST: &str = "8192";

/// Flags of LLVM that let libFuzzer see which code an input reaches; a stable compiler passes them on.
const WATCHED: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=4 --cfg=fuzzing";

/// Replays every file of the corpora, and mutants of each from a fixed seed.
pub fn replay() -> Result<()> {
    run(&mut tests("--test replay -- --ignored --nocapture")?)
}

/// Runs every target, or the one that `FUZZ_TARGET` names, under libFuzzer. New inputs are kept below `target/fuzz`, so
/// that the next run continues from there.
pub fn long() -> Result<()> {
    let engine = build()?;
    let seconds = env::var("FUZZ_SECONDS").unwrap_or_else(|_| SECONDS.into());
    let wanted = env::var("FUZZ_TARGET").ok();
    let mut failed = Vec::new();
    let (mut all, mut lines) = (0, Vec::new());
    for target in targets()?.iter().filter(|name| wanted.as_ref().is_none_or(|own| own == *name)) {
        let found = paths::target().join("fuzz/corpus").join(target);
        let crashes = paths::target().join("fuzz/crashes");
        fs::create_dir_all(&found)?;
        fs::create_dir_all(&crashes)?;
        let mut fuzzer = command(&engine);
        fuzzer
            .env("FUZZ_TARGET", target)
            .arg(&found)
            .arg(paths::root().join("host-tests/fuzz/corpus").join(target))
            .arg(format!("-max_total_time={seconds}"))
            .arg(format!("-max_len={LONGEST}"))
            .arg(format!("-artifact_prefix={}/{target}-", crashes.display()))
            .args(["-timeout=20", "-rss_limit_mb=2048", "-print_final_stats=1"]);
        let told = told(&mut fuzzer)?;
        let number = |key: &str| {
            let line = told.lines().rev().find_map(|line| line.split_once(key))?;
            line.1.split_whitespace().next()?.parse::<u64>().ok()
        };
        let runs = number("number_of_executed_units:").unwrap_or(0);
        let (edges, of) =
            (number(" cov: ").unwrap_or(0), number("Loaded 1 PC tables (").unwrap_or(0));
        all += runs;
        lines.push(format!("{target:10} {runs:12} executions, {edges:6} of {of} edges"));
        println!("{}", lines[lines.len() - 1]);
        if told.contains("SUMMARY: libFuzzer:") {
            failed.push(format!(
                "{target}: {}",
                told.lines().rev().take(12).collect::<Vec<_>>().join("\n")
            ));
        }
        ensure!(runs > 0, "{target} was not run:\n{told}");
    }
    println!("\n{}\n{all} executions", lines.join("\n"));
    if failed.is_empty() {
        Ok(())
    } else {
        bail!("inputs that break a promise:\n{}", failed.join("\n"))
    }
}

/// Returns the output of libFuzzer, which exits with an error if it found something.
fn told(fuzzer: &mut Command) -> Result<String> {
    eprintln!("$ {fuzzer:?}");
    let output = fuzzer.output().context("the fuzzer does not start")?;
    Ok(String::from_utf8_lossy(&output.stderr).into_owned())
}

fn build() -> Result<PathBuf> {
    let target = paths::target().join("fuzz");
    let host = triple()?;
    // With a target, the flags are for it alone and not for what is run while building.
    let mut build = cargo("build --profile fuzz --package fuzz --features engine --bin engine");
    build.args(["--target", &host, "--target-dir"]).arg(&target).env("RUSTFLAGS", WATCHED);
    run(&mut build)?;
    Ok(target.join(host).join("fuzz/engine"))
}

/// Lists the targets, each of which has a corpus.
fn targets() -> Result<Vec<String>> {
    let mut names: Vec<String> = fs::read_dir(paths::root().join("host-tests/fuzz/corpus"))?
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<Result<_>>()?;
    names.sort();
    Ok(names)
}
