//! `cargo verify loop`: a flight around a whole loop, with tinyODIN's model in the firmware, board against host.

use crate::{boards::BOARDS, firmware, host, image, paths, qemu};
use anyhow::{Context, Result, bail, ensure};
use std::fs;

const PROGRAM: &str = "rate-loop";

/// The network of the firmware, from the file of its training: as `trained.rs` of the program encodes.
const NETWORK: &str = "network cli/tests/peers/roll.nir --scheme position --neurons 20 --min -2 --max 2 \
                       --column gyro_x data/hexarotor.csv";

/// All that the host prints the board must print too, bit for bit; and the trained network must fire on the board as
/// often as `spikewire network` says it will. The board is the one with an STM32F405: the chip's memories alone are
/// 36 KiB.
pub fn rate_loop() -> Result<()> {
    let on_host = firmware::on_host(PROGRAM)?;
    ensure!(on_host.contains(" hash="), "{PROGRAM} tells no hash on the host");
    println!("host:\n{on_host}");
    let board = BOARDS.iter().find(|board| board.machine == "netduinoplus2");
    let board = board.context("no board with an STM32F405")?;
    let printed = qemu::run_repeatably(board, &image::build(PROGRAM, board)?)?;
    println!("{}:\n{printed}", board.core);
    for line in on_host.lines() {
        ensure!(printed.lines().any(|printed| printed == line), "not so on the board: {line}");
    }

    let said = host::spikewire(NETWORK)?.output()?;
    let report = String::from_utf8_lossy(&said.stderr).into_owned();
    print!("{report}");
    ensure!(said.status.success(), "`spikewire network` refuses its own test's network");
    let constant = fs::read(paths::examples().join(PROGRAM).join("src/roll.rs"))?;
    ensure!(said.stdout == constant, "`spikewire network` makes another constant than src/roll.rs");
    let [foretold, counted] =
        [of_report(&report)?, on_host.lines().find_map(of_firmware).context("no spikes told")?];
    ensure!(foretold == counted, "{foretold} spikes foretold, {counted} counted");
    println!("Every bit agrees.");
    Ok(())
}

/// The spikes of the chip's last layer: `name: neurons, clipped; spikes, on the chip, distance`.
fn of_report(report: &str) -> Result<u32> {
    let last = report.lines().rfind(|line| line.starts_with("node `"));
    let Some((_, figures)) = last.and_then(|line| line.split_once("; ")) else {
        bail!("no layer in the report")
    };
    Ok(figures.split(", ").nth(1).context("no spikes on the chip")?.parse()?)
}

/// `roll: N spikes back, ...`
fn of_firmware(line: &str) -> Option<u32> {
    let (spikes, _) = line.strip_prefix("roll: ")?.split_once(" spikes back")?;
    spikes.parse().ok()
}
