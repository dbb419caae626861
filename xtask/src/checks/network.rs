//! `cargo xtask network`: runs a network that `spikewire network` wrote on five emulated cores and an RP2040, and
//! compares it with the host.

use super::emulator;
use crate::common::{cargo, command, output, paths, run, usage};
use crate::programs::boards::{BOARDS, Board};
use crate::programs::{host, image, qemu};
use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::path::Path;

const PROGRAM: &str = "trained";

/// The Cortex-M4F among the emulated boards.
const STM32: &str = "STM32F405";

/// The Cortex-M0+ of a Pico, in rp2040js.
const RP2040: Board = Board {
    core: "M0+",
    machine: "rp2040",
    target: "thumbv6m-none-eabi",
    cpu: "cortex-m0plus",
    clock: 1_000_000_000,
    icount: 0,
};

/// The page whose first commands bring a network whose spikes its authors published onto both boards.
const PAGE: &str = "docs/network.md";

/// Runs a network's module on a file of spikes, and prints the outcome.
pub fn network(args: &[String]) -> Result<()> {
    let [network, spikes] = args else {
        return Err(usage("cargo xtask network NETWORK.rs SPIKES.txt".to_owned()));
    };
    let there = |path: &String| fs::canonicalize(path).with_context(|| path.clone());
    print!("{}", everywhere(&there(network)?, &there(spikes)?, BOARDS.iter())?);
    Ok(())
}

/// Runs the networks of the page on the boards of every day, and counts the instructions of a step.
pub fn verify() -> Result<()> {
    of_page(Board::every_day())?;
    counts("M4F", &[("A,f32", 2426), ("A,i8", 2871), ("D,f32", 23_711), ("D,i8", 19_939)])?;
    counts("M0", &[("A,i8", 4663), ("D,i8", 31_551)])
}

/// Runs the networks of the page on all boards, as the page's own command does.
pub fn on_all() -> Result<()> {
    of_page(BOARDS.iter())
}

/// Runs the commands of the page as they stand there, and then those of integers.
fn of_page(boards: impl Iterator<Item = &'static Board> + Clone) -> Result<()> {
    let commands = commands()?;
    let [setup, install, export, steps] = &commands[..] else {
        bail!("{PAGE} begins with {} commands, where there were four", commands.len());
    };
    let is_known = setup == "cargo xtask setup" && install == "cargo install --path laptop/cli";
    ensure!(is_known, "the first two commands of {PAGE} are others");
    let export = export.strip_prefix("spikewire ").context("the third command is another")?;
    run(&mut host::spikewire(export)?)?;
    let steps = steps.strip_prefix("cargo xtask network ").and_then(|rest| rest.split_once(' '));
    let (module, spikes) = steps.context("the fourth is another")?;
    let at = |path: &str| paths::root().join(path);
    print!("{}", everywhere(&at(module), &at(spikes), boards.clone())?);

    let kept = "trained/src/braille.rs";
    let is_same = fs::read(at(module))? == fs::read(paths::examples().join(kept))?;
    ensure!(is_same, "`spikewire network` writes another examples/{kept}");
    let packed = module.replace(".rs", "_i8.rs");
    run(&mut host::spikewire(&format!("{} --numbers i8", export.replace(module, &packed)))?)?;
    println!("i8:\n{}", everywhere(&at(&packed), &at(spikes), boards)?);
    Ok(())
}

/// Returns the commands of the page's first block, without comments.
fn commands() -> Result<Vec<String>> {
    let page = fs::read_to_string(paths::root().join(PAGE))?;
    let block = page.split("```sh\n").nth(1).and_then(|rest| rest.split("```").next());
    let block = block.context("no commands")?.replace("\\\n", " ");
    let command = |line: &str| line.split('#').next().unwrap_or_default().trim().to_owned();
    Ok(block.lines().map(command).collect())
}

/// Builds the network as a C library, and compares its outputs and the bits of its potentials.
fn in_c(network: &Path, spikes: &Path, on_host: &str) -> Result<()> {
    let target = paths::target();
    let mut build = cargo("build --quiet --manifest-path examples/Cargo.toml --package network-c");
    run(build.env("CARGO_TARGET_DIR", &target).env("NETWORK", network))?;
    let place = target.join(PROGRAM);
    fs::create_dir_all(&place)?;
    let program = place.join("steps");
    let own = paths::examples().join("network-c/steps.c");
    let library = target.join("debug/libnetwork.a");
    run(command("cc")
        .args(["-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&program)
        .arg(own)
        .arg(library))?;
    let printed = output(command(program).stdin(fs::File::open(spikes)?))?;
    // The host's first line tells of the check; behind the steps are the potentials, and what was left out.
    let mut expected: Vec<String> =
        on_host.lines().skip(1).map(|line| line.trim_end().to_owned()).collect();
    let count = printed.lines().count();
    expected.truncate(count);
    let potentials = expected.pop().unwrap_or_default();
    let bits = |value: &str| -> Result<String> {
        let bits = value.parse::<i32>().map(i32::cast_unsigned);
        let bits = bits.or_else(|_| value.parse::<f32>().map(f32::to_bits))?;
        Ok(format!("{bits:08x}"))
    };
    let potentials = potentials.trim_matches(['[', ']']).split(", ").map(bits);
    expected.push(potentials.collect::<Result<Vec<_>>>()?.join(" "));
    let in_c: Vec<&str> = printed.lines().map(str::trim_end).collect();
    ensure!(count > 1 && in_c == expected, "C has other spikes or potentials than the host");
    Ok(())
}

/// Counts the instructions of the steps of `examples/network`. Fails if one takes 5 % more than it did with 10 % of the
/// neurons firing, or 10 % more than the equivalent C, then or with all firing.
fn counts(core: &str, known: &[(&str, u32)]) -> Result<()> {
    let board = Board::with(core)?;
    let image = image::build_with("network", board, &[("PLAIN_C", "1")])?;
    let printed = qemu::run_counting(board, &image)?;
    let count = |row: &str, percent: u32| -> Result<u32> {
        let start = format!("{row},{percent},");
        let rest = printed.lines().find_map(|line| line.strip_prefix(&start));
        let count = rest.and_then(|rest| rest.split(',').next()).with_context(|| start.clone())?;
        Ok(count.parse()?)
    };
    for &(row, before) in known {
        let now = count(row, 10)?;
        ensure!(
            now * 20 <= before * 21,
            "{row} on the {core}: {now} instructions, {before} before"
        );
        print!("{row} on the {core}: {now} instructions a step");
        for percent in [10, 100].into_iter().filter(|_| row.starts_with('D')) {
            let (now, plain) = (count(row, percent)?, count(&format!("{row} in C"), percent)?);
            print!("; with {percent} % firing {now}, in C {plain}");
            ensure!(now * 10 <= plain * 11, "{row} on the {core} takes a tenth more than in C");
        }
        println!();
    }
    Ok(())
}

/// Returns the output, which the host, the emulated boards and an RP2040 must have in common.
pub(super) fn everywhere(
    network: &Path,
    spikes: &Path,
    boards: impl Iterator<Item = &'static Board>,
) -> Result<String> {
    let variables = [("NETWORK", network), ("SPIKES", spikes)];
    let target = paths::target();
    let mut build = cargo("build --quiet --manifest-path examples/Cargo.toml --package");
    build.arg(PROGRAM).env("CARGO_TARGET_DIR", &target).envs(variables);
    run(&mut build)?;
    let on_host = output(&mut command(target.join("debug").join(PROGRAM)))?;
    let told = |printed: &str| -> String {
        printed
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(|line| line.to_owned() + "\n")
            .collect()
    };
    let mut all = told(&on_host);
    ensure!(all.starts_with("is intact: true\n"), "its own check fails on the host");

    in_c(network, spikes, &on_host)?;
    let mut compare = |name: &str, printed: &str| -> Result<()> {
        if told(printed) != told(&on_host) {
            bail!("{name} prints something else than the host:\n{printed}");
        }
        let costs = printed.lines().rfind(|line| line.starts_with('#')).unwrap_or_default();
        all += &match name {
            STM32 | "RP2040" => format!("{name}: the same, {}\n", costs.trim_start_matches("# ")),
            _ => format!("{name}: the same\n"),
        };
        Ok(())
    };
    for board in boards {
        let built = image::build_with(PROGRAM, board, &variables)?;
        let name = if board.core == "M4F" { STM32 } else { board.core };
        compare(name, &qemu::run_counting(board, &built)?)?;
    }
    let built = image::build_with(PROGRAM, &RP2040, &variables)?;
    let mut node = command("node");
    node.arg(emulator::installed()?.join("steps.mjs")).arg(built);
    compare("RP2040", &output(&mut node)?)?;
    Ok(all)
}
