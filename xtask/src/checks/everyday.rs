//! The steps of `cargo verify`, one function for each; `verify` lists them.

use crate::common::{cargo, lint, output, paths, run};
use crate::figures::{jumps, schemes};
use crate::products::templates::{TEMPLATES, Template};
use crate::programs::host::{spikewire, tests};
use crate::programs::{boards::Board, image, published::CRATES};
use crate::setup::toolchain::{TARGETS, cargo_for_each};
use anyhow::{Result, ensure};
use std::{fs, process::Command};

pub fn fmt() -> Result<()> {
    run(&mut cargo("fmt --all --check"))?;
    run(&mut cargo("fmt --all --check --manifest-path examples/Cargo.toml"))?;
    run(&mut cargo("fmt --check --manifest-path bindings/c/Cargo.toml"))?;
    run(&mut cargo("fmt --check --manifest-path laptop/page/Cargo.toml"))?;
    // Modules that a macro declares are unknown to `cargo fmt`.
    let mut schemes = Command::new("rustfmt");
    schemes.args(["--edition", "2024", "--check"]);
    for scheme in paths::root().join("laptop/catalogue/src/schemes").read_dir()? {
        schemes.arg(scheme?.path());
    }
    // Each becomes a project of its own, where its manifest finds the crates.
    schemes.arg(paths::examples().join("templates/build.rs"));
    schemes.arg(paths::examples().join("templates/nucleo/src/main.rs"));
    for Template { hal, .. } in &TEMPLATES {
        schemes.arg(paths::examples().join(format!("templates/{hal}/src/main.rs")));
    }
    run(&mut schemes)
}

/// Lints the host's code, which compiles everything that the tests need, and the firmware for one core as an example.
pub fn clippy() -> Result<()> {
    run(&mut tests("--no-run")?)?;
    image::lint_all(Board::with("M4F")?)
}

pub fn test() -> Result<()> {
    run(&mut tests("")?)
}

/// Tests the code on each page of documentation: `pages` of a crate includes each as the documentation of an item, which
/// exists only for this.
pub fn readme() -> Result<()> {
    let said = output(&mut tests("--doc -- pages")?)?;
    print!("{said}");
    for page in ["Readme", "Usage", "Frames", "Async", "TinyOdin"] {
        ensure!(
            said.contains(&format!(" - pages::{page} (line ")),
            "no doctest of `pages::{page}`: is the page included in a lib.rs?"
        );
    }
    Ok(())
}

pub fn doc() -> Result<()> {
    let mut doc = cargo("doc --no-deps --all-features");
    for own in CRATES {
        doc.args(["--package", own.name]);
    }
    run(doc.env("RUSTDOCFLAGS", "-D warnings"))
}

pub fn each_feature() -> Result<()> {
    for own in CRATES.iter().filter(|own| own.flies) {
        let check = format!("check --package {} --no-default-features", own.name);
        run(&mut cargo(&check))?;
        for feature in own.features()? {
            run(cargo(&check).args(["--features", &feature]))?;
        }
    }
    // That all public data can be logged.
    run(lint(&mut cargo("check --package host-tests --features defmt --test defmt")))
}

/// Tests every pair of features of each crate that flies. If one feature enables the other, the pair equals that one
/// alone and compiles at once.
pub fn pairs() -> Result<()> {
    for own in CRATES.iter().filter(|own| own.flies) {
        let features = own.features()?;
        let check =
            format!("check --quiet --package {} --no-default-features --features", own.name);
        for (place, one) in features.iter().enumerate() {
            for other in &features[place + 1..] {
                run(cargo(&check).arg(format!("{one},{other}")))?;
            }
        }
    }
    Ok(())
}

/// Checks the crates that fly, without and with all features, for the smallest core: no compare-and-swap and no FPU.
/// The firmware is compiled for all cores elsewhere; `cargo verify lints` does both for every core.
pub fn targets() -> Result<()> {
    check_for(&TARGETS[..1])
}

/// Checks the crates that fly without and with all features for Cortex-M targets.
pub fn check_for(targets: &[&str]) -> Result<()> {
    let packages: String = CRATES
        .iter()
        .filter(|own| own.flies)
        .map(|own| format!(" --package {}", own.name))
        .collect();
    for features in ["--no-default-features", "--all-features"] {
        let check = format!("check{packages} {features}");
        for mut cargo in cargo_for_each(targets, &check)? {
            run(&mut cargo)?;
        }
    }
    Ok(())
}

/// Links a program without a panic handler: it fails if there is a path to a panic that the compiler cannot rule out.
/// The program has overflow checks, so no arithmetic can wrap unnoticed in a release build, or panic in a debug build.
/// It is linked here for one core as an example; `cargo verify panic-free` links it for two, and without those checks,
/// which takes as long again.
pub fn no_panic() -> Result<()> {
    image::link_checked("no-panic", Board::with("M0")?)
}

pub fn no_panic_all() -> Result<()> {
    for core in ["M0", "M4F"] {
        image::build("no-panic", Board::with(core)?)?;
        image::link_checked("no-panic", Board::with(core)?)?;
    }
    Ok(())
}

/// Runs the laptop program on the recorded flight and on its hardest second, and reproduces the paper's tables in full.
pub fn laptop() -> Result<()> {
    let spikewire = |args: &str| output(&mut spikewire(args)?);
    let flight = "--column gyro_x data/hexarotor.csv";
    let target = paths::root().join("target");
    fs::create_dir_all(&target)?;
    let (spikes, picture) = (target.join("flight-spikes.csv"), target.join("flight.svg"));
    spikewire(&format!("encode --scheme sf --threshold 0.1 {flight} -o {}", spikes.display()))?;
    let decoded = spikewire(&format!("decode {}", spikes.display()))?;
    ensure!(decoded.lines().count() == 1 + 3627, "the flight decodes to another number of samples");
    let (stream, events) = (target.join("flight.es"), target.join("flight-events.csv"));
    spikewire(&format!("convert --from csv --to es {} -o {}", spikes.display(), stream.display()))?;
    spikewire(&format!(
        "convert --from csv --to csv {} -o {}",
        spikes.display(),
        events.display()
    ))?;
    ensure!(
        spikewire(&format!("listen --from es {}", stream.display()))?
            == fs::read_to_string(events)?,
        "the flight's events come out of an Event Stream otherwise"
    );
    print!("{}", spikewire(&format!("score {flight}"))?);
    schemes::ensure_written()?;
    jumps::jumps()?;
    spikewire(&format!("plot --all {flight} -o {}", picture.display()))?;
    let tables = spikewire("bench")?;
    print!("{tables}");
    ensure!(
        tables.ends_with("\n60 of 60 means within sampling error\n"),
        "the benchmark differs from the paper"
    );
    Ok(())
}
