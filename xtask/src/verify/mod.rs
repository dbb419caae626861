//! `cargo verify`: runs every check in order, and reports the time of each. A failure does not stop the checks after
//! it.

pub(crate) mod modules;
mod opened;
mod packages;
mod passed;

use crate::checks::{
    everyday, fifo, firmware, fuzz, interface, link, logging, long, network, network_flies, nucleo,
    package, peers, rate_loop, real_boards, reckon, ros, ros2, simulated_drone, soak, storm,
    templates, tuned, video,
};
use crate::common::{cpu, usage};
use crate::figures::{bench, chips, demo, faults, flash};
use crate::mutants;
use crate::products::{book, c_library, new_scheme, page, python_package};
use crate::release;
use crate::setup::{self, needs};
use anyhow::{Result, bail, ensure};
use passed::Passed;
use std::time::Instant;

const USAGE: &str = "\
cargo verify [STEP]...     every check, or the named ones
cargo verify --list        the checks' names, the seconds of processor time that each took last, and which long ones are
                           stale: .ci/passed.toml has what each read when it last passed
cargo verify --long        the checks that need more time, by hand before a release
cargo verify --changed     of all, those that read something else than when they last passed; behind `--long` or names
                           likewise
cargo verify --help        this

A check that fails does not hide the next one. Exit status 0: all passed; 1: one failed; 2: no such check.
The summary gives each check's time on the clock, and its processor time over all cores.
Without names, `setup` comes first and installs what is missing: it says what, and what it does as root.";

/// A check that `cargo verify <name>` runs alone.
struct Step {
    name: &'static str,
    what: &'static str,
    run: fn() -> Result<()>,
    /// Text of `run`: the modules that it names are part of what the check reads.
    code: &'static str,
}

macro_rules! step {
    ($name:expr, $what:expr, $run:expr $(,)?) => {
        Step { name: $name, what: $what, run: $run, code: stringify!($run) }
    };
}

/// The everyday checks. To add one, write a function in a module of `checks`, and a line here.
const STEPS: &[Step] = &[
    step!(SETUP, "compiler targets, QEMU, binutils", setup::setup),
    step!("fmt", "rustfmt", everyday::fmt),
    step!(
        "clippy",
        "clippy on host code, which builds the tests, and on firmware",
        everyday::clippy,
    ),
    step!("test", "host tests and doctests", everyday::test),
    step!(
        "fuzz",
        "hostile bytes for every reader, link, chip and codec: corpora and mutants",
        fuzz::replay,
    ),
    step!("peers", "event formats against other programs", peers::peers),
    step!("readme", "the code of README and docs runs", everyday::readme),
    step!("book", "the pages as a web site: each has its place, and no link is broken", || {
        book::build().map(drop)
    }),
    step!("doc", "documentation without warnings", everyday::doc),
    step!("interface", "what each crate offers is what its interface.txt says", interface::verify),
    step!("package", "what is published has all that its pages show", package::package),
    step!("features", "every feature of what flies alone, on the host", everyday::each_feature),
    step!(
        "targets",
        "the crates that fly, alone and with all their features, for the least Cortex-M",
        everyday::targets,
    ),
    step!("no-panic", "every codec links without a panic handler", everyday::no_panic),
    step!("c", "the library for C, on the host and on a Cortex-M4F", c_library::verify),
    step!(
        "boards",
        "a Pico's firmware as it is flashed, in an emulator, and all that breaks",
        real_boards::boards,
    ),
    step!("fifo", "a sensor at 8 kHz: driver, and instructions", fifo::fifo),
    step!("demo", "the demo's table and picture", || demo::fly().map(drop)),
    step!("firmware", "an emulated M0 and M4F against the host", firmware::every_day),
    step!("storm", "more events than main takes, on emulated M0 and M4F and host", storm::storm),
    step!("link", "a flight over a serial line, board against host", link::link),
    step!("loop", "a flight through a chip's model, board against host", rate_loop::rate_loop),
    step!("tuned", "a constant from `spikewire tune`, in QEMU, spike by spike", tuned::tuned),
    step!(
        "network",
        "a published network from its NIR file to spikes on an emulated M0, STM32F405 and RP2040",
        network::verify,
    ),
    step!("laptop", "the laptop program on a flight, and the paper's tables", everyday::laptop),
    step!("python", "the Python package: tests, hashes, README, example", python_package::python),
    step!("video", "the paper's figure of a video, from a packaged clip", video::video),
    step!("bench", "instruction counts of a Cortex-M4F against the baseline", || {
        bench::verify("M4F")
    }),
];

/// Checks that take too long for every change, the longest last.
const LONG: &[Step] = &[
    step!("recordings", "the flights come out of the published logs again", long::recordings),
    step!("deny", "licences and sources of every crate, in every workspace", release::deny),
    step!("loom", "the queue without locks in every order of its loads and stores", long::loom),
    step!(
        "faults",
        "hours of flight in which all goes wrong, and the table of it in SAFETY.md",
        faults::verify,
    ),
    step!("soak", "hours of flight in which much goes wrong, in two emulated cores", soak::soak),
    step!(
        "stack",
        "no codec's stack is deeper than the bound of its code, nor that above 1 KiB, on two cores",
        bench::verify_stack,
    ),
    step!("flash", "the flash of one codec as linked, with two bounds", flash::verify),
    step!(
        "templates",
        "firmware from flight.toml with each HAL: built, and flown in its part's emulator",
        templates::templates,
    ),
    step!(
        "nucleo",
        "the whole program that the page of boards names, compiled and linked with its HAL",
        nucleo::nucleo,
    ),
    step!("logging", "defmt out of an emulated Cortex-M4F, decoded on the host", logging::logging),
    step!("pairs", "every two features of the crate, on the host", everyday::pairs),
    step!("beside", "slices on this machine beside another crate's", long::beside),
    step!("bench-m0", "instruction counts of a Cortex-M0 against the baseline", || {
        bench::verify("M0")
    }),
    step!(
        "panic-free",
        "every codec without a panic handler, on two cores",
        everyday::no_panic_all
    ),
    step!("scalar", "codes and networks with the loops of a core without vectors", long::scalar),
    step!(
        "lints",
        "clippy on all at once, and the crates that fly alone and with all their features on every core",
        long::lints,
    ),
    step!("capture", "the laptop program with a debug probe's driver", long::capture),
    step!("new-scheme", "what `cargo xtask scheme` writes compiles", new_scheme::verify),
    step!("logs", "logs of every kind, read as independent readers do", peers::logs),
    step!(
        "c-cores",
        "the library for C on the other four cores, and as the host has it",
        c_library::cores,
    ),
    step!(
        "c-asan",
        "the library for C on the host, under the address sanitizer as the programs in C are",
        c_library::watched,
    ),
    step!(
        "c-bundle",
        "the C library's archive for people without Rust: unpacked, compiled and run on six cores",
        c_library::verify_bundle,
    ),
    step!("c-cost", "what the calls of C take beside the crate's", c_library::cost),
    step!("page", "the page in a browser, against the laptop program", page::verify),
    step!(
        "ros2",
        "a clone built by colcon; its nodes with ROS 2's rclpy and with Cyclone DDS",
        ros2::ros2,
    ),
    step!("ros", "ROS nodes in the distribution's ROS, a flight through every scheme", ros::ros),
    step!(
        "py-speed",
        "the Python package from its source package, and its speed",
        python_package::speed,
    ),
    step!(
        "py-torch",
        "the layer of PyTorch, notebooks and a fleet's logs that train with it, and the package's pages",
        python_package::torch,
    ),
    step!(
        "fleet",
        "a thousand logs by the program and by Dask, and a few by Ray, killed on the way",
        python_package::fleet,
    ),
    step!(
        "all-boards",
        "the other boards' firmware: five flown in emulators, the Pico 2's linked",
        real_boards::more,
    ),
    step!(
        "flies",
        "a simulated drone on spikes: the picture and a row again",
        simulated_drone::verify,
    ),
    step!("flown", "the same, on an emulated board: bit for bit", simulated_drone::board),
    step!("chip-flies", "the same, on a network on tinyODIN's model", simulated_drone::chip),
    step!("net-flies", "the same, on a network in place of the cascade", network_flies::verify),
    step!("agrees", "networks on the chips agree as docs/chips.md says", chips::verify),
    step!("reckon", "the model of ReckOn against the chip's own code", reckon::reckon),
    step!(
        "tinyodin",
        "steps of networks on tinyODIN's own code, against its model",
        reckon::tiny_odin,
    ),
    step!(
        "all-cores",
        "firmware, storm and network on all emulated cores, seven for the recorded flight",
        || {
            let parts = [firmware::firmware(&[]), storm::on_all(), network::on_all()];
            let failed = parts.into_iter().filter_map(Result::err);
            let failed: Vec<_> = failed.map(|error| format!("{error:#}")).collect();
            ensure!(failed.is_empty(), "{}", failed.join("\n"));
            Ok(())
        },
    ),
    step!(
        "cores",
        "instruction counts on all five cores, and the log of the smallest",
        long::cores
    ),
    step!(
        "tuner",
        "`spikewire tune` beside differential evolution at 100, 300 and 1000 settings, and TPE at up to 300",
        peers::tuner,
    ),
    step!(
        "fuzz-long",
        "the same under libFuzzer, a minute a target (FUZZ_SECONDS), going on from the last run",
        fuzz::long,
    ),
    step!(
        "sweeps",
        "all tests, optimised, with twenty times as many cases, from a fresh seed",
        long::sweeps,
    ),
    step!(
        "mutants",
        "thousands of changes of what flies or writes it, one after the other; a test has to notice each",
        mutants::mutants,
    ),
];

const SETUP: &str = "setup";

/// The outcome of a check.
struct Outcome {
    step: &'static Step,
    good: bool,
    /// Elapsed time, in seconds.
    seconds: f64,
    /// Processor time over all cores, in seconds.
    processor: f64,
}

/// Runs the named checks, or all except the long ones, in the order of the list.
pub fn verify(args: &[String]) -> Result<()> {
    let mut args: Vec<&str> = args.iter().map(String::as_str).collect();
    let is_changed = args.pop_if(|last| *last == "--changed").is_some();
    let mut passed = Passed::read(is_changed)?;
    let mut chosen: Vec<&Step> = match args[..] {
        ["--help" | "-h"] => {
            println!("{USAGE}\n");
            list(&passed);
            return Ok(());
        }
        ["--list"] => {
            list(&passed);
            return Ok(());
        }
        [] => STEPS.iter().collect(),
        ["--long"] => LONG.iter().collect(),
        _ => named(&args)?,
    };
    if is_changed {
        let is_fresh = |step: &mut &Step| passed.is_fresh(step.name, step.code) == Some(true);
        let fresh: Vec<_> = chosen.extract_if(.., is_fresh).map(|step| step.name).collect();
        println!("Passed with what they read now, and left out: {}", fresh.join(" "));
    }
    if !chosen.iter().any(|step| step.name == SETUP) {
        needs::ensure_met()?;
    }
    let outcomes = run(&chosen, &mut passed);
    let is_good = summary(&outcomes);
    let stale: Vec<_> =
        LONG.iter().filter(|step| is_stale(step, &passed)).map(|step| step.name).collect();
    if !stale.is_empty() {
        println!("Long checks that read something else when they last passed: {}", stale.join(" "));
        println!("`cargo verify --long --changed` runs them.");
    }
    is_good
}

fn is_stale(step: &Step, passed: &Passed) -> bool {
    passed.is_fresh(step.name, step.code) == Some(false)
}

fn list(passed: &Passed) {
    let print = |step: &Step, mark: &str| {
        let took = passed.took(step.name).map(|seconds| format!("{seconds} s"));
        println!("  {:10} {:>6}  {mark}{}", step.name, took.unwrap_or_default(), step.what);
    };
    for step in STEPS {
        print(step, "");
    }
    println!("with --long; * marks those that read something else when they last passed:");
    for step in LONG {
        print(step, if is_stale(step, passed) { "* " } else { "  " });
    }
}

fn named(names: &[&str]) -> Result<Vec<&'static Step>> {
    let all = || STEPS.iter().chain(LONG);
    if let Some(name) = names.iter().find(|name| all().all(|step| step.name != **name)) {
        return Err(usage(format!("no check `{name}`; `cargo verify --help` lists them")));
    }
    Ok(all().filter(|step| names.contains(&step.name)).collect())
}

fn run(steps: &[&'static Step], passed: &mut Passed) -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    for &step in steps {
        println!("\n=== {}: {}", step.name, step.what);
        let is_long = LONG.iter().any(|long| long.name == step.name);
        let (start, before) = (Instant::now(), cpu::seconds());
        let (result, processor) = passed.run(step.name, step.code, is_long, || {
            let result = (step.run)();
            (result, cpu::seconds() - before)
        });
        if let Err(error) = &result {
            println!("FAILED: {error:#}");
        }
        let seconds = start.elapsed().as_secs_f64();
        println!("--- {}: {seconds:.0} s, {processor:.0} s of processor time", step.name);
        outcomes.push(Outcome { step, good: result.is_ok(), seconds, processor });
        if step.name == SETUP && result.is_err() {
            break; // nothing below can work
        }
    }
    outcomes
}

fn summary(outcomes: &[Outcome]) -> Result<()> {
    println!("\n=== summary: time, processor time");
    for Outcome { step, good, seconds, processor } in outcomes {
        let verdict = if *good { "ok" } else { "FAILED" };
        println!("{verdict:6} {seconds:6.1} s {processor:6.1} s  {:10} {}", step.name, step.what);
    }
    let total = |of: fn(&Outcome) -> f64| outcomes.iter().map(of).fold(0.0, |sum, one| sum + one);
    let (seconds, processor) = (total(|one| one.seconds), total(|one| one.processor));
    println!("{:6} {seconds:6.1} s {processor:6.1} s", "all");
    let failed: Vec<&str> =
        outcomes.iter().filter(|one| !one.good).map(|one| one.step.name).collect();
    if failed.is_empty() { Ok(()) } else { bail!("failed: {}", failed.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use modules::Modules;

    #[test]
    fn every_check_has_a_name_of_its_own() {
        let names: Vec<&str> = STEPS.iter().chain(LONG).map(|step| step.name).collect();
        for (index, name) in names.iter().enumerate() {
            assert!(!names[..index].contains(name), "two checks are called {name}");
            assert!(name.len() <= 10, "{name} does not fit its column");
        }
        let modules = Modules::read();
        for step in STEPS.iter().chain(LONG) {
            assert!(!modules.behind(step.code).is_empty(), "{}: {}", step.name, step.code);
        }
        assert!(named(&["fmt", "sweeps"]).is_ok_and(|steps| steps.len() == 2));
        assert!(named(&["fmt", "none"]).is_err());
    }
}
