//! Measures the table in docs/chips.md that says how well networks agree on the chips with what they were in training.

use crate::common::{cargo, output, paths};
use crate::figures::markdown;
use anyhow::{Context, Result};
use std::fs;
use std::process::Command;

const PAGE: &str = "docs/chips.md";
const MARKER: &str = "agrees";

/// Networks that frameworks exported: the file, how it is read, the rule of its resets, and its layers in words.
const NETWORKS: [(&str, &str, &str, &str); 14] = [
    ("snntorch", "--as snntorch", "to-value", "snnTorch, `Leaky`"),
    ("snntorch", "--as snntorch", "subtract-late", "snnTorch, `Leaky`"),
    ("snntorch", "--as snntorch", "subtract-no-delay", "snnTorch, `Leaky`"),
    ("snntorch_one_to_one", "--as snntorch", "to-value", "snnTorch, `RLeaky`"),
    ("snntorch_one_to_one", "--as snntorch", "subtract-late", "snnTorch, `RLeaky`"),
    ("snntorch_one_to_one", "--as snntorch", "subtract-no-delay", "snnTorch, `RLeaky`"),
    ("spikingjelly", "--as spikingjelly", "to-value", "SpikingJelly, `IFNode` and `LIFNode`"),
    ("spikingjelly", "--as spikingjelly", "subtract", "SpikingJelly, `IFNode` and `LIFNode`"),
    (
        "spikingjelly_recurrent",
        "--as spikingjelly",
        "to-value",
        "SpikingJelly, recurrent `LIFNode`",
    ),
    (
        "spikingjelly_recurrent",
        "--as spikingjelly",
        "subtract",
        "SpikingJelly, recurrent `LIFNode`",
    ),
    ("norse", "--as norse --dt 0.001", "to-value", "Norse, `LIFBoxCell` and `LIBoxCell`"),
    ("norse", "--as norse --dt 0.001", "subtract", "Norse, `LIFBoxCell` and `LIBoxCell`"),
    ("norse_if", "--as norse --dt 0.001", "to-value", "Norse, `IAFCell` and `LIBoxCell`"),
    ("plain", "", "to-value", "6, 16 and 3 LIF, on the flight"),
];
const CHIPS: [&str; 2] = ["tinyodin --compare step", "reckon"];

/// Brings all networks onto the chips, and writes the table into docs/chips.md.
pub fn write() -> Result<()> {
    markdown::write(PAGE, MARKER, &table()?)
}

/// Brings all networks onto the chips, and fails if docs/chips.md has other figures.
pub fn verify() -> Result<()> {
    markdown::ensure_written(PAGE, MARKER, &table()?, "cargo xtask write chips")
}

fn table() -> Result<String> {
    output(&mut cargo("build --package spikewire-cli"))?;
    let mut rows = String::new();
    for (file, options, reset, words) in NETWORKS {
        let mut row = format!("| {words} | `{reset}` |");
        for chip in CHIPS {
            row += &format!(" {} |", agreement(file, options, reset, chip)?);
        }
        rows += &(row + "\n");
    }
    Ok(format!(
        "\n| network | reset | tinyODIN: steps, clocks | ReckOn: steps, clocks |\n|---|---|---|---|\n{rows}\n"
    ))
}

/// Returns the share of the held-out active steps in which a chip agrees, and its mean clocks a step; a dash if the
/// chip refuses the network.
fn agreement(file: &str, options: &str, reset: &str, chip: &str) -> Result<String> {
    let peers = paths::root().join("laptop/cli/tests/peers");
    let mut program = Command::new(paths::target().join("debug/spikewire"));
    program.args(["network", "--reset", reset, "--chip"]).args(chip.split(' '));
    program.args(options.split_whitespace());
    if file == "plain" {
        program.arg(peers.join("plain.json")).arg(paths::root().join("data/hexarotor.csv"));
        program.args("--scheme sf --threshold 0.05 --columns gyro_x,gyro_y,gyro_z".split(' '));
    } else {
        let recorded = fs::read_to_string(peers.join(format!("nir/{file}.{reset}.txt")))?;
        let column = |number: usize| -> String {
            let of = |line: &str| line.split(';').nth(number).unwrap_or("").to_owned() + "\n";
            recorded.lines().map(of).collect()
        };
        let [inputs, outputs] =
            ["inputs", "outputs"].map(|name| paths::target().join(format!("{name}.txt")));
        fs::write(&inputs, column(0))?;
        fs::write(&outputs, column(2))?;
        program.arg(peers.join(format!("nir/{file}.nir"))).arg(&inputs);
        // Norse's networks end in neurons that never fire.
        if !file.starts_with("norse") {
            program.arg("--trained-spikes").arg(&outputs);
        }
    }
    let ran = program.output()?;
    let report = String::from_utf8_lossy(&ran.stderr);
    if !ran.status.success() {
        return Ok("-".to_owned());
    }
    let held_out = report.split("held out:").nth(1).context("nothing is held out")?;
    let line = |start: &str| {
        held_out.lines().find_map(|line| line.strip_prefix(start)).context(start.to_owned())
    };
    let agrees = line("outputs agree in ")?;
    let (_, active) = agrees.split_once(", in ").context("no active steps")?;
    let (share, rest) = active.split_once(" of the ").context("no share")?;
    let count = rest.split(' ').next().unwrap_or("");
    let clocks = line("a step takes the chip ")?.split(' ').next().unwrap_or("");
    Ok(format!("{share} of {count}, {clocks}"))
}
