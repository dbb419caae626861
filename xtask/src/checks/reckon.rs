//! Compares the chips' models with the chips' register-transfer code, which is not in this repository: it is cloned, or
//! a checkout is given.

use crate::common::{cargo, command, output, paths, run, shell::has};
use crate::setup;
use anyhow::{Result, ensure};
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Stdio,
};

/// The files of `ReckOn`'s code, besides those of the sources of random numbers.
const FILES: [&str; 4] = ["reckon.v", "spi_slave.v", "srnn.v", "fifo.v"];
/// The files of tinyODIN's code.
const TINY_ODIN_FILES: [&str; 9] = [
    "tinyODIN.v",
    "aer_out.v",
    "controller.v",
    "fifo.v",
    "lif_neuron.v",
    "neuron_core.v",
    "scheduler.v",
    "spi_slave.v",
    "synaptic_core.v",
];
/// Networks of six inputs that run on tinyODIN with neurons that compare once a step, and how their files are read.
const NETWORKS: [(&str, &str); 4] = [
    ("plain.json", "--reset zero"),
    ("on_chip.json", "--reset zero"),
    ("nir/snntorch_one_to_one.nir", "--as snntorch --reset to-value"),
    ("nir/spikingjelly.nir", "--as spikingjelly --reset subtract"),
];
/// A recording of six inputs: the first column has those that fire in each step.
const RECORDING: &str = "nir/snntorch.to-value.txt";

/// A repository with a chip's code.
struct Code {
    name: &'static str,
    repository: &'static str,
    commit: &'static str,
    /// Environment variable that gives a checkout.
    variable: &'static str,
}

const RECKON: Code = Code {
    name: "ReckOn",
    repository: "https://github.com/ChFrenkel/ReckOn",
    commit: "5e5c0bea8fe1897876ba3b7bfdcecf76d3bf4505",
    variable: "RECKON_RTL",
};
const TINY_ODIN: Code = Code {
    name: "tinyODIN",
    repository: "https://github.com/ChFrenkel/tinyODIN",
    commit: "18656534162a9de09b9954aea28fbfad7a7f8657",
    variable: "TINYODIN_RTL",
};

/// Builds ReckOn's code with Verilator, and compares it with the model over a million clocks. The code is cloned unless
/// `RECKON_RTL` gives a checkout.
pub fn reckon() -> Result<()> {
    let randoms = ["neur_stochround", "noise_neur", "oneur_stochround", "winp_wrec", "wout"];
    let randoms = randoms.map(|name| format!("lfsr/lfsr_{name}.v"));
    let files = FILES.into_iter().chain(randoms.iter().map(String::as_str));
    let sources = RECKON.checkout("src/srnn.v")?.join("src");
    let simulation = simulation("reckon", files.map(|file| sources.join(file)))?;
    let program = "run --release --package silicon --example reckon_rtl --";
    run(cargo(program).arg(simulation).arg("1000000"))
}

/// Builds tinyODIN's code with Verilator, and compares its answers with those of `spikewire network --live` byte by
/// byte, for networks whose neurons compare once a step. The code is cloned unless `TINYODIN_RTL` gives a checkout.
pub fn tiny_odin() -> Result<()> {
    let sources = TINY_ODIN.checkout("lif_neuron.v")?;
    let simulation = simulation("tinyODIN", TINY_ODIN_FILES.map(|file| sources.join(file)))?;
    let peers = paths::root().join("laptop/cli/tests/peers");
    let recording = fs::read_to_string(peers.join(RECORDING))?;
    let steps =
        recording.lines().map(|line| line.split(';').next().unwrap_or("").to_owned() + "\n");
    let steps: String = steps.collect();
    let place = paths::target().join("rtl");
    let [inputs, source, bytes] =
        ["steps.txt", "network.rs", "network.bytes"].map(|name| place.join(name));
    fs::write(&inputs, &steps)?;
    for (network, options) in NETWORKS {
        let mut live =
            cargo("run --quiet --package spikewire-cli -- network --compare step --live");
        live.args(options.split(' ')).arg(peers.join(network)).arg(&inputs);
        live.arg("-o").arg(&source).arg("--bytes").arg(&bytes);
        let on_model = answers(&mut live, &inputs)?;
        let mut program = cargo("run --quiet --package silicon --example tinyodin_rtl --");
        let on_chip = answers(program.arg(&simulation).arg(&source).arg(&bytes), &inputs)?;
        let (count, all) = (on_chip.lines().count(), steps.lines().count());
        ensure!(count == all, "{network}: {count} answers to {all} steps");
        ensure!(on_model == on_chip, "{network}: the chip's code answers otherwise than its model");
        let spikes: usize = on_chip.lines().map(|line| line.split(' ').count() - 1).sum();
        println!("{network}: {all} steps, {spikes} spikes of outputs, the same to the clock");
    }
    Ok(())
}

/// Runs a program on the steps in the file `inputs`, and returns what it prints.
fn answers(program: &mut std::process::Command, inputs: &Path) -> Result<String> {
    output(program.stdin(Stdio::from(fs::File::open(inputs)?)))
}

/// Builds a chip's code with Verilator; returns the program that simulates it.
fn simulation(top: &str, files: impl IntoIterator<Item = PathBuf>) -> Result<PathBuf> {
    if !has("verilator") {
        setup::packages("what simulates the chips' code", &["verilator"])?;
    }
    let name = top.to_lowercase();
    let built = paths::target().join("rtl").join(&name);
    fs::create_dir_all(&built)?;
    let mut verilator = command("verilator");
    verilator
        .args(["--cc", "--exe", "--build", "-j", "2", "-O3", "--public-flat-rw"])
        .args(["-Wno-fatal", "-Wno-lint", "--x-assign", "0", "--x-initial", "0"])
        .args(["--top-module", top, "-CFLAGS", "-O2", "-o", "simulation", "--Mdir"])
        .arg(&built)
        .args(files)
        .arg(paths::root().join(format!("chips/silicon/rtl/{name}.cpp")));
    run(&mut verilator)?;
    Ok(built.join("simulation"))
}

impl Code {
    /// Clones the code, unless the environment gives a checkout; `file` is one of its files.
    fn checkout(&self, file: &str) -> Result<PathBuf> {
        if let Some(named) = env::var_os(self.variable) {
            return Ok(named.into());
        }
        let cloned = paths::target().join("rtl").join(self.name);
        if !cloned.is_dir() {
            run(command("git").args(["clone", "--quiet", self.repository]).arg(&cloned))?;
            run(command("git").arg("-C").arg(&cloned).args(["checkout", "--quiet", self.commit]))?;
        }
        ensure!(cloned.join(file).is_file(), "{} holds no code", cloned.display());
        Ok(cloned)
    }
}
