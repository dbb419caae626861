//! The C library's tests: programs in C on the host and on emulated boards, compared with the crate.

use super::{archive, compiler, ensure_written, flights, guides, host_archive, watched_archive};
use crate::common::shell;
use crate::programs::boards::{BOARDS, Board};
use crate::programs::{host, qemu};
use anyhow::{Result, ensure};
use std::process::Command;

/// The sample types of `flight.c`.
pub const SAMPLES: [&str; 4] = ["FLY_f32", "FLY_i16", "FLY_q8_8", "FLY_q16_16"];

/// Checks that generated files agree with the catalogue, and that C on the host under sanitizers, and on one core,
/// equals the crate.
pub fn verify() -> Result<()> {
    in_headers()?;
    let archive = host_archive()?;
    ensure_written()?;
    compiler::record()?;
    for language in ["c99", "c++11"] {
        let misuse = compiler::on_host("misuse", language, &archive, &[])?;
        print!("{}", shell::output(&mut Command::new(misuse))?);
    }
    let ends = guides::ends()?;
    compiler::guides(&ends)?;
    compiler::guides_run(&ends)?;
    let rust = in_rust()?;
    let flight = compiler::on_host("flight", "c99", &archive, &SAMPLES)?;
    compare("host", &shell::output(&mut Command::new(flight))?, &rust)?;
    fly("M4F", &rust)?;
    flights::verify()
}

/// Runs the library's own tests, which compile headers with odd names.
fn in_headers() -> Result<()> {
    let mut tests = shell::cargo("test --quiet --no-default-features --features header --lib");
    shell::run(tests.current_dir(super::room()).env("CARGO_TARGET_DIR", super::work()))
}

/// Runs the tests on the host with the library, too, under the address sanitizer.
pub fn watched() -> Result<()> {
    let archive = watched_archive()?;
    compiler::record()?;
    let misuse = compiler::on_host("misuse", "c99", &archive, &[])?;
    print!("{}", shell::output(&mut Command::new(misuse))?);
    let flight = compiler::on_host("flight", "c99", &archive, &SAMPLES)?;
    compare("watched host", &shell::output(&mut Command::new(flight))?, &in_rust()?)
}

/// Tests the other cores, and the host's package in a CMake project: a program with one codec must not contain all.
pub fn cores() -> Result<()> {
    compiler::with_cmake(&super::host()?)?;
    compiler::record()?;
    let rust = in_rust()?;
    BOARDS.iter().filter(|board| board.core != "M4F").try_for_each(|board| fly(board.core, &rust))
}

/// The flight on an emulated board.
fn fly(core: &str, rust: &[String]) -> Result<()> {
    let board = Board::with(core)?;
    let archive = archive(board)?;
    let misuse = compiler::for_board("misuse", board, &archive, &[])?;
    print!("{core}: {}", qemu::run(board, &misuse)?);
    let mut flown = String::new();
    // Half of a sample type's codecs at a time, as the smallest flash has no room for more.
    for (sample, half) in
        SAMPLES.into_iter().flat_map(|sample| [(sample, "HALF=0"), (sample, "HALF=1")])
    {
        let program = compiler::for_board("flight", board, &archive, &[sample, half])?;
        flown += &qemu::run(board, &program)?;
    }
    compare(core, &flown, rust)
}

/// Returns the crate's results for the flight on the host, as C prints them: `sf f32 spikes=2074 hash=…`.
fn in_rust() -> Result<Vec<String>> {
    let printed = host::flight_log()?;
    let lines = printed.lines().map(|line| {
        let is_kept = |word: &&str| !word.starts_with("efficiency=") && !word.starts_with("rmse=");
        line.split(' ').filter(is_kept).collect::<Vec<_>>().join(" ")
    });
    // What draws from a generator is not in C.
    let is_drawn = |line: &String| line.starts_with("bernoulli ") || line.starts_with("grf-prob ");
    Ok(lines.filter(|line| !is_drawn(line)).collect())
}

/// Fails unless both have the same lines, in any order.
fn compare(place: &str, flown: &str, rust: &[String]) -> Result<()> {
    let flown: Vec<&str> = flown.lines().collect();
    let differing: Vec<String> = rust
        .iter()
        .filter(|line| !flown.contains(&line.as_str()))
        .map(|line| {
            let label = line.split(" spikes=").next().unwrap_or(line);
            let own = flown.iter().find(|own| own.starts_with(&format!("{label} ")));
            format!("Rust: {line}\n  C: {}", own.unwrap_or(&"nothing"))
        })
        .collect();
    ensure!(differing.is_empty(), "{place}: C differs from Rust\n{}", differing.join("\n"));
    ensure!(
        flown.len() == rust.len(),
        "{place}: C flies {} codecs, Rust {}",
        flown.len(),
        rust.len()
    );
    println!("{place}: C and Rust agree on every bit of {} codecs", rust.len());
    Ok(())
}
