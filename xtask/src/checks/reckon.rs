//! Compares a chip's model with the chip's register-transfer code, which is not in this repository: it is cloned, or a
//! checkout is given.

use crate::common::{cargo, command, paths, run, shell::has};
use crate::setup;
use anyhow::{Result, ensure};
use std::{env, fs, path::PathBuf};

const REPOSITORY: &str = "https://github.com/ChFrenkel/ReckOn";
const COMMIT: &str = "5e5c0bea8fe1897876ba3b7bfdcecf76d3bf4505";
/// The code's files, besides those of the sources of random numbers.
const FILES: [&str; 4] = ["reckon.v", "spi_slave.v", "srnn.v", "fifo.v"];

/// Builds ReckOn's code with Verilator, and compares it with the model over a million clocks. The code is cloned unless
/// `RECKON_RTL` gives a checkout.
pub fn reckon() -> Result<()> {
    if !has("verilator") {
        setup::packages("what simulates the chip's code", &["verilator"])?;
    }
    let sources = checkout()?.join("src");
    let built = paths::target().join("rtl/reckon");
    let randoms = ["neur_stochround", "noise_neur", "oneur_stochround", "winp_wrec", "wout"];
    let randoms = randoms.map(|name| format!("lfsr/lfsr_{name}.v"));
    let files = FILES.into_iter().chain(randoms.iter().map(String::as_str));
    fs::create_dir_all(&built)?;
    let mut verilator = command("verilator");
    verilator
        .args(["--cc", "--exe", "--build", "-j", "2", "-O3", "--public-flat-rw"])
        .args(["-Wno-fatal", "-Wno-lint", "--x-assign", "0", "--x-initial", "0"])
        .args(["--top-module", "reckon", "-CFLAGS", "-O2", "-o", "simulation", "--Mdir"])
        .arg(&built)
        .args(files.map(|file| sources.join(file)))
        .arg(paths::root().join("chips/silicon/rtl/reckon.cpp"));
    run(&mut verilator)?;
    let program = "run --release --package silicon --example reckon_rtl --";
    run(cargo(program).arg(built.join("simulation")).arg("1000000"))
}

fn checkout() -> Result<PathBuf> {
    if let Some(named) = env::var_os("RECKON_RTL") {
        return Ok(named.into());
    }
    let cloned = paths::target().join("rtl/ReckOn");
    if !cloned.join("src").is_dir() {
        run(command("git").args(["clone", "--quiet", REPOSITORY]).arg(&cloned))?;
        run(command("git").arg("-C").arg(&cloned).args(["checkout", "--quiet", COMMIT]))?;
    }
    ensure!(cloned.join("src/srnn.v").is_file(), "{} holds no code", cloned.display());
    Ok(cloned)
}
