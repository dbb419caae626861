//! Flies images from their reset vector, with a sensor that fails in every way that it can: a Pico's image in rp2040js,
//! those for a Cortex-M4F in Unicorn with peripherals from `examples/boards/emulator`.

use crate::common::{command, output, paths, run, shell};
use crate::figures::bench::{cycles, cycles::Cycles, cycles::Model, listing::Instruction};
use crate::products::parts::{BMI088, BMI323, Part};
use crate::programs::{host, python};
use crate::setup;
use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use spikewire::{
    Scheme,
    link::{MAX_FRAME, Reader, Receiver},
    temporal::{SendOnDelta, StepForward},
};
use std::{
    collections::BTreeMap,
    fs::{self, File},
    path::{Path, PathBuf},
};

/// Time of the first fault, and time from one fault to the next, in ms.
const FIRST: u64 = 600;
const EACH: u64 = 700;
/// Duration of a fault, in ms.
const LASTS: u64 = 250;
/// Time within which the far end must be exact on all channels again, with most sensors, in ms: the documentation says
/// 0.3 s.
const BACK: u64 = 300;
/// Time within which a code with one spike a sample follows a jump over the whole range of the signal, in µs.
const FOLLOWS: u64 = 20_000;
/// Largest difference between a sample's tick and its time, in µs.
const JITTER: u64 = 20;
/// Start-up time of an nRF52840's slow crystal, which a reset stops, in ms.
const SLOW_CRYSTAL: u64 = 250;

/// Python packages that the emulator needs.
const PYTHON: [&str; 2] = ["unicorn==2.1.3", "quickjs==1.19.4"];
const FILES: [&str; 13] = [
    "elf.mjs",
    "package.json",
    "pico.mjs",
    "sensors.mjs",
    "steps.mjs",
    "bench.py",
    "board.py",
    "cortex_m.py",
    "crazyflie.py",
    "nrf52840.py",
    "stm32f405.py",
    "stm32h743.py",
    "test_board.py",
];

/// Parts of which there is a model.
pub const PARTS: [&str; 5] = ["rp2040", "nrf52840", "stm32f405", "stm32h743", "crazyflie"];
/// Sensors of which there is a model.
pub const SENSORS: [&str; 3] = ["icm42688p", "bmi088", "bmi323"];

/// The faults, each with the event that ends it.
const BREAKS: [(&str, &str); 9] = [
    ("miso-cut", "mend"),
    ("miso-noise", "mend"),
    ("miso-low", "mend"),
    ("miso-high", "mend"),
    ("ready-cut", "mend"),
    ("clock-cut", "mend"),
    ("supply-gone", "supply-back"),
    ("freeze", "thaw"),
    ("freeze-accelerometer", "thaw"),
];

/// The emulator's observations.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Seen {
    starts: Vec<Start>,
    instructions: u64,
    cycles: u64,
    /// Shortest pause between transfers, in ns; `shortest_guard` is the shortest time before one.
    shortest_pause: f64,
    shortest_guard: f64,
    spi_hz: u32,
    baud: u32,
    clk_sys: u32,
    pub configured: bool,
    pub pulled_up: bool,
    /// Whether the watchdog pauses at a breakpoint.
    pauses_on_halt: bool,
    /// Place at which the firmware faulted, if it did.
    fault: Option<String>,
}

#[derive(Deserialize)]
struct Start {
    /// Time of the reset, in ms.
    at: f64,
    /// Reason of the reset: 1 is the watchdog.
    reason: u32,
    /// Time at which the clock of the ticks started, in µs; that of a Pico keeps running in rp2040js.
    ticks: Option<f64>,
}

/// What the far end received.
struct Heard {
    /// Times in ms at which all channels became exact (true), or were no longer exact (false).
    exact: Vec<(u64, bool)>,
    /// Time in ms of each start of the sender that a frame reported.
    starts: Vec<u64>,
    /// Number of frames that report items dropped by the queue.
    after_loss: u32,
    /// Values that were marked exact but differ from the sensor's sample by more than a threshold.
    wrong: Vec<(u32, u16, i16)>,
    values: u32,
}

/// Limits for a sensor: timing in ns and Hz, and the time within which a dead sensor must be reported, in ms.
struct Limits {
    sensor: &'static str,
    pause: f64,
    guard: f64,
    spi_hz: u32,
    noticed: u64,
    /// Time within which the far end must be exact again after a fault, in ms.
    back: u64,
    samples_a_second: usize,
}

/// Limits for a BMI323. A dead one is noticed after twenty samples at 800 Hz, 5 ms for gathering, and the time on the
/// line.
const BMI323_LIMITS: Limits = Limits {
    sensor: "bmi323",
    pause: 2_000.0,
    guard: 200.0,
    spi_hz: 10_000_000,
    noticed: 35,
    back: BACK,
    samples_a_second: 800,
};
/// Limits for a BMI088. On I2C there is no select line. A start that hangs because the bus is held low is given up
/// first, which takes longer.
const BMI088_LIMITS: Limits = Limits {
    sensor: "bmi088",
    pause: 0.0,
    guard: 0.0,
    spi_hz: 400_000,
    noticed: 35,
    back: BACK + 100,
    samples_a_second: 1_000,
};
const ICM42688P_LIMITS: Limits = Limits {
    sensor: "icm42688p",
    pause: 0.0,
    guard: 100.0,
    spi_hz: 24_000_000,
    noticed: 20,
    back: BACK,
    samples_a_second: 8_000,
};

/// Flies the image, and checks what it did.
pub fn fly(part: &Part, image: &Path) -> Result<()> {
    let limits = match part.listen {
        BMI323 => BMI323_LIMITS,
        BMI088 => BMI088_LIMITS,
        _ => ICM42688P_LIMITS,
    };
    whole(part, image, &limits)?;
    broken(part, image, &limits)?;
    without_a_crystal(part, image, &limits)
}

/// Checks a second and a half without faults: clocks, configuration, rate, values.
fn whole(part: &Part, image: &Path, limits: &Limits) -> Result<()> {
    let (seen, directory) = emulate(part, image, limits.sensor, 1.5, &[])?;
    ensure!(seen.clk_sys == core_hz(part)?, "the core runs at {} Hz", seen.clk_sys);
    ensure!(seen.configured && seen.pulled_up, "the sensor is not configured, or its line floats");
    ensure!(seen.pauses_on_halt, "the watchdog bites at a breakpoint");
    ensure!(seen.spi_hz <= limits.spi_hz, "SPI runs at {} Hz", seen.spi_hz);
    ensure!(seen.baud.abs_diff(part.baud) * 50 < part.baud, "{} baud", seen.baud);
    let (pause, guard) = (seen.shortest_pause, seen.shortest_guard);
    ensure!(pause >= limits.pause && guard >= limits.guard, "pause {pause} ns, guard {guard} ns");
    let heard = hear(part, &seen, &directory)?;
    ensure!(heard.wrong.is_empty(), "values that the sensor did not have: {:?}", heard.wrong);
    ensure!(heard.exact.len() == 2 && heard.after_loss == 0, "{:?}", heard.exact);
    let table = listened(part, &directory)?;
    let exact = table.lines().filter(|line| line.ends_with(",exact")).count();
    ensure!(exact > 100, "spikewire listen has {exact} exact values");
    let log = log(image, &directory)?;
    let counted = log.lines().filter_map(|line| number(line, "samples: ")).next_back().unwrap_or(0);
    ensure!(counted as usize >= limits.samples_a_second, "no second of samples in the log:\n{log}");
    let reason = if seen.starts.len() > 1 { "reset by Software" } else { "reset by PowerOrPin" };
    ensure!(log.contains(reason), "the log does not say why it started:\n{log}");
    let cycles = if is_pico(part) {
        cycles_agree(image, &directory)?;
        format!("{}", seen.cycles * 2 / 3)
    } else if part.part == "stm32h743" {
        "unknown".into() // no table of a Cortex-M7
    } else {
        let [least, most] = cycles(image, &directory)?.map(|cycles| cycles * 2 / 3);
        format!("{least} to {most}")
    };
    let pauses = if limits.guard > 0.0 {
        format!("pauses of {pause:.0} ns and more, ")
    } else {
        String::new()
    };
    println!(
        "{}: {} Hz, the sensor's bus {} Hz, {} baud, {pauses}{} values, {} instructions and {cycles} cycles a second",
        part.name,
        seen.clk_sys,
        seen.spi_hz,
        seen.baud,
        heard.values,
        seen.instructions * 2 / 3,
    );
    Ok(())
}

/// Returns the clock that the board's firmware configures.
fn core_hz(part: &Part) -> Result<u32> {
    match part.part {
        "rp" => Ok(125_000_000),
        "nrf52840" => Ok(64_000_000),
        "stm32f405" => Ok(168_000_000),
        "stm32h743" => Ok(400_000_000),
        other => bail!("no emulator of {other}"),
    }
}

/// Returns whether there is an emulator for the part.
pub fn has(part: &Part) -> bool {
    core_hz(part).is_ok() && part.memory != "rp2350"
}

fn is_pico(part: &Part) -> bool {
    part.part == "rp"
}

/// Returns bounds of the cycles that were executed, by the manual's table.
fn cycles(image: &Path, directory: &Path) -> Result<[i64; 2]> {
    let known = cycles_by_address(Model::M4, image)?;
    let mut all = [0, 0];
    for line in numbers(directory, "executed")? {
        let [address, count, taken] = line[..] else { bail!("a line of three numbers") };
        let Some((_, Cycles { once, taken: more })) = known.get(&address) else { continue };
        all = [0, 1].map(|bound| {
            all[bound] + count * i64::from(once[bound]) + taken * i64::from(more[bound])
        });
    }
    Ok(all)
}

fn cycles_by_address(model: Model, image: &Path) -> Result<BTreeMap<i64, (Instruction, Cycles)>> {
    let all = cycles::of_image(model, image)?.into_iter();
    Ok(all.map(|(one, cycles)| (i64::from(one.address), (one, cycles))).collect())
}

/// Compares the cycles that rp2040js counts with those of the manual's table, instruction by instruction. Both leave
/// out the waits of the buses.
fn cycles_agree(image: &Path, directory: &Path) -> Result<()> {
    let known = cycles_by_address(Model::M0, image)?;
    let (mut all, mut fewer) = ([0, 0], 0);
    for line in numbers(directory, "executed")? {
        let [address, count, taken, counted] = line[..] else { bail!("a line of four numbers") };
        let (one, Cycles { once, taken: more }) =
            known.get(&address).with_context(|| format!("{address:#x} is not in the image"))?;
        if one.name == "wfi" || one.name == "wfe" {
            continue;
        }
        let here = count * i64::from(once[0]) + taken * i64::from(more[0]);
        // The manual counts LR and PC among the registers of a list, rp2040js does not.
        let is_listed = matches!(one.name.as_str(), "push" | "pop") && one.has_link();
        let without = if is_listed { count } else { 0 };
        ensure!(
            counted == here - without,
            "{address:#x} `{}`, {count} times, {taken} branches: {here} cycles, and {counted} in rp2040js",
            one.text()
        );
        all = [all[0] + here, all[1] + counted];
        fewer += without;
    }
    println!(
        "  {} cycles by the manual's table, {} in rp2040js, which leaves LR and PC out of {fewer} lists",
        all[0], all[1]
    );
    Ok(())
}

/// Causes all faults one after the other; then a queue overflow, a hang and a second start.
fn broken(part: &Part, image: &Path, limits: &Limits) -> Result<()> {
    let mut fates = Vec::new();
    let mut at = FIRST;
    for (breaks, mends) in BREAKS {
        fates.extend([(at, breaks), (at + LASTS, mends)]);
        at += EACH;
    }
    let slow = at;
    let (mended, hang, reset, end) = (slow + 1_500, slow + 2_000, slow + 3_000, slow + 3_600);
    fates.extend([(slow, "uart-slow"), (mended, "mend"), (hang, "hang"), (reset, "reset")]);
    let (seen, directory) = emulate(part, image, limits.sensor, end as f64 / 1e3, &fates)?;
    let mut heard = hear(part, &seen, &directory)?;
    // A sensor that thaws jumps from one sample to the next, as no vehicle does; a code of one spike a sample follows.
    let thaws = fates.iter().filter(|fate| fate.1 == "thaw").map(|fate| fate.0 * 1_000);
    let jumps: Vec<_> = thaws.map(|at| at - JITTER..at + FOLLOWS).collect();
    heard.wrong.retain(|one| !jumps.iter().any(|jump| jump.contains(&u64::from(one.0))));
    ensure!(heard.wrong.is_empty(), "values that the sensor did not have: {:?}", heard.wrong);

    let is_exact = |at: u64| heard.exact.iter().rfind(|one| one.0 <= at).is_some_and(|one| one.1);
    let next = |from: u64, is: bool| {
        if is_exact(from) == is {
            return Some(0);
        }
        heard.exact.iter().find(|one| one.0 > from && one.1 == is).map(|one| one.0 - from)
    };
    for (index, (breaks, _)) in BREAKS.into_iter().enumerate() {
        let at = FIRST + EACH * index as u64;
        ensure!(is_exact(at), "before {breaks} the far end knew nothing: {:?}", heard.exact);
        let (noticed, back) = (next(at, false), next(at + LASTS, true));
        println!("  {breaks:20} noticed within {noticed:?} ms, recovered within {back:?} ms");
        ensure!(noticed.is_some_and(|ms| ms <= limits.noticed), "{breaks} was noticed too late");
        ensure!(back.is_some_and(|ms| ms <= limits.back), "{breaks}: not exact in time again");
    }
    let queue = next(mended, true);
    println!(
        "  {:20} {} frames tell of it, recovered within {queue:?} ms",
        "a queue full", heard.after_loss
    );
    ensure!(heard.after_loss > 0 && queue.is_some_and(|ms| ms <= BACK), "a queue that ran over");

    let mut starts: Vec<_> =
        seen.starts.iter().map(|start| (start.at as u64, start.reason)).collect();
    starts.dedup(); // an nRF52840 that was erased writes its settings, and starts anew at once
    let [(0, 0), (bitten, 1), (again, 0)] = starts[..] else {
        bail!("one hang, one reset: {starts:?}");
    };
    let [_, after_hang, after_reset] = heard.starts[..] else {
        bail!("the far end heard of these starts: {:?}", heard.starts);
    };
    // From each start on, until the far end has heard of it and knows all channels.
    let [back, second] = [(bitten, after_hang), (again, after_reset)]
        .map(|(from, heard_of)| next(heard_of, true).map(|ms| heard_of + ms - from));
    println!("  {:20} reset within {} ms, recovered within {back:?} ms", "a hang", bitten - hang);
    println!("  {:20} recovered within {second:?} ms", "a second start");
    ensure!((400..=510).contains(&(bitten - hang)), "the watchdog took {} ms", bitten - hang);
    let most = BACK + if part.part == "nrf52840" { SLOW_CRYSTAL } else { 0 };
    ensure!(back.is_some_and(|ms| ms <= most), "after a hang");
    ensure!(second.is_some_and(|ms| ms <= most), "after a second start");
    ensure!(log(image, &directory)?.contains("reset by Watchdog"), "the log knows of no watchdog");
    Ok(())
}

/// Checks that a crystal that does not start leads to resets until it does.
fn without_a_crystal(part: &Part, image: &Path, limits: &Limits) -> Result<()> {
    let fates = [(0, "crystal-dead"), (700, "mend")];
    let (seen, directory) = emulate(part, image, limits.sensor, 1.6, &fates)?;
    let bites = seen.starts.iter().filter(|start| start.reason == 1).count();
    println!("  {:20} {bites} resets by the watchdog", "a dead crystal");
    ensure!(bites >= 1, "a dead crystal hangs the board");
    let heard = hear(part, &seen, &directory)?;
    ensure!(heard.exact.last().is_some_and(|one| one.1), "it never recovered");
    Ok(())
}

/// Runs an image; returns the observations, and the directory with all other output.
fn emulate(
    part: &Part,
    image: &Path,
    sensor: &str,
    seconds: f64,
    fates: &[(u64, &str)],
) -> Result<(Seen, PathBuf)> {
    let directory = paths::target().join("emulated").join(part.name);
    let fates: Vec<String> = fates.iter().map(|(at, name)| format!("{at}:{name}")).collect();
    let run = Run {
        part: part.memory,
        image,
        sensor,
        seconds,
        directory: &directory,
        fates: &fates,
        recording: None,
    };
    let seen = run.on_emulator(false)?;
    Ok((seen, directory))
}

/// An image on a part, with a sensor on its bus.
pub struct Run<'a> {
    pub part: &'a str,
    pub image: &'a Path,
    pub sensor: &'a str,
    pub seconds: f64,
    /// Place for all that the run writes.
    pub directory: &'a Path,
    pub fates: &'a [String],
    /// Table of what the sensor measures, as `Recording::write` writes it; without one, sines with noise.
    pub recording: Option<&'a Path>,
}

impl Run<'_> {
    /// Runs the image, and ends where it uses what nothing models.
    pub fn strictly(&self) -> Result<Seen> {
        self.on_emulator(true)
    }

    fn on_emulator(&self, is_strict: bool) -> Result<Seen> {
        let Self { part, image, sensor, seconds, directory, fates, recording } = *self;
        let home = installed()?;
        fs::create_dir_all(directory)?;
        let mut emulator = if part == "rp2040" {
            let mut node = command("node");
            node.arg(home.join("pico.mjs")).env("STRICT", if is_strict { "1" } else { "0" });
            node
        } else {
            // Always strict.
            let mut python = command(unicorn()?);
            python.arg(home.join("board.py")).arg(part);
            python
        };
        match recording {
            Some(recording) => emulator.env("RECORDING", recording),
            None => emulator.env_remove("RECORDING"),
        };
        emulator
            .args([image, Path::new(sensor)])
            .arg(seconds.to_string())
            .arg(directory)
            .args(fates);
        let seen: Seen =
            serde_json::from_str(&output(&mut emulator)?).context("what the emulator says")?;
        if let Some(fault) = seen.fault {
            bail!("{fault}; the log says\n{}", log(image, directory)?);
        }
        Ok(seen)
    }
}

/// Runs small images on the emulated STM32F405: modelled peripherals must work, and access to any other must end the
/// run.
pub fn small_images() -> Result<()> {
    run(command(unicorn()?).arg(installed()?.join("test_board.py")))
}

/// Returns the Python with the emulator's packages.
fn unicorn() -> Result<PathBuf> {
    let python = python::environment("emulator-python")?;
    python::install(&python, &PYTHON)?;
    Ok(python)
}

/// Copies the emulators beside the package that the Pico's needs.
pub fn installed() -> Result<PathBuf> {
    let (from, home) =
        (paths::examples().join("boards/emulator"), paths::target().join("emulator"));
    fs::create_dir_all(&home)?;
    for file in FILES {
        fs::copy(from.join(file), home.join(file))?;
    }
    if !home.join("node_modules/rp2040js").is_dir() {
        if !shell::has("npm") {
            setup::packages("Node.js, which runs the emulated board", &["nodejs", "npm"])?;
        }
        let npm = "install --silent --no-audit --no-fund";
        run(command("npm").args(npm.split(' ')).current_dir(&home))
            .context("npm and Node.js 18 or newer are needed")?;
    }
    Ok(home)
}

/// Returns what `spikewire listen` decodes from the UART's bytes.
fn listened(part: &Part, directory: &Path) -> Result<String> {
    output(host::spikewire("listen")?.args(part.listen.split(' ')).arg(directory.join("uart")))
}

/// Returns the log, decoded; empty if the image has none by defmt.
pub fn log(image: &Path, directory: &Path) -> Result<String> {
    if fs::metadata(directory.join("log"))?.len() == 0 {
        return Ok(String::new());
    }
    let mut decode = command(host::example("logging")?);
    output(decode.arg(image).stdin(File::open(directory.join("log"))?))
}

fn number(line: &str, after: &str) -> Option<u32> {
    let (_, rest) = line.split_once(after)?;
    rest.split(|at: char| !at.is_ascii_digit()).next()?.parse().ok()
}

/// Decodes the bytes in the order of their arrival, and compares each exact value with the sensor's sample.
fn hear(part: &Part, seen: &Seen, directory: &Path) -> Result<Heard> {
    if let BMI323 | BMI088 = part.listen {
        let threshold = if part.listen == BMI323 { 205 } else { 137 };
        let rate = SendOnDelta::<i16, 16>::new(98);
        let acceleration = SendOnDelta::new(threshold);
        hear_with(part, seen, directory, [&rate, &acceleration], [98, threshold.unsigned_abs()])
    } else {
        let (rate, acceleration) = (StepForward::<i16>::new(98), StepForward::new(328));
        hear_with(part, seen, directory, [&rate, &acceleration], [98, 328])
    }
}

/// Longest silence during which a far end assumes that the sender is alive, in µs; the crate `far-end` derives it.
const SILENCE: u64 = 120_000;

fn hear_with<P: Scheme<Sample = i16>>(
    part: &Part,
    seen: &Seen,
    directory: &Path,
    [rate, acceleration]: [&P; 2],
    thresholds: [u16; 2],
) -> Result<Heard> {
    let bytes = fs::read(directory.join("uart"))?;
    let times = numbers(directory, "times")?;
    let samples = turned(part, numbers(directory, "samples")?);
    let schemes = [rate, rate, rate, acceleration, acceleration, acceleration];
    let mut receiver = Receiver::<_, 6>::per_channel(schemes);
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut heard = Heard {
        exact: vec![(0, false)],
        starts: Vec::new(),
        after_loss: 0,
        wrong: Vec::new(),
        values: 0,
    };
    let zeros: Vec<u32> =
        seen.starts.iter().filter_map(|start| Some(start.ticks? as u32)).collect();
    let mut last = 0;
    for (byte, time) in bytes.chunks(1).zip(&times) {
        let now = time.first().copied().unwrap_or_default() as u64;
        let mut byte = byte;
        while let Some(received) = reader.next_frame(&mut byte) {
            if now - last > SILENCE {
                receiver.mark_stale();
                note(&mut heard, (last + SILENCE) / 1_000, false);
            }
            last = now;
            if received.is_start {
                heard.starts.push(now / 1_000);
            }
            heard.after_loss += u32::from(received.frame.is_after_loss());
            let zero = heard.starts.len().checked_sub(1).and_then(|start| zeros.get(start));
            let zero = zero.copied().unwrap_or(0);
            let mut values = Vec::new();
            receiver.apply(&received, |channel, tick, value| {
                values.push((zero + tick.micros(), channel, value))
            });
            let is_exact = (0..6).all(|channel| receiver.exact(channel).is_some());
            note(&mut heard, now / 1_000, is_exact);
            heard.values += values.len() as u32;
            let wrong = values
                .into_iter()
                .filter(|&value| is_exact && !is_near(value, &samples, thresholds));
            heard.wrong.extend(wrong);
        }
    }
    Ok(heard)
}

/// Rotates the sensor's samples to the vehicle's axes: a SpeedyBee's sensor is turned by 90°, a Matek's is upside down
/// (`ALIGNMENT`).
fn turned(part: &Part, samples: Vec<Vec<i64>>) -> Vec<Vec<i64>> {
    let turn = |sample: Vec<i64>| match (part.name, &sample[..]) {
        ("speedybee-f405", &[at, rx, ry, rz, ax, ay, az]) => vec![at, ry, -rx, rz, ay, -ax, az],
        ("matek-h743", &[at, rx, ry, rz, ax, ay, az]) => vec![at, -rx, ry, -rz, -ax, ay, -az],
        _ => sample,
    };
    samples.into_iter().map(turn).collect()
}

fn note(heard: &mut Heard, at: u64, is_exact: bool) {
    if heard.exact.last().is_none_or(|last| last.1 != is_exact) {
        heard.exact.push((at, is_exact));
    }
}

/// Returns whether a value is within two thresholds of the sensor's at its tick: one by which the code may lag, and one
/// for noise and the time of the sample.
fn is_near(
    (tick, channel, value): (u32, u16, i16),
    samples: &[Vec<i64>],
    thresholds: [u16; 2],
) -> bool {
    let later = samples.partition_point(|sample| sample[0] <= i64::from(tick) + JITTER as i64);
    let threshold = thresholds[usize::from(channel >= 3)];
    let near = later.checked_sub(1).and_then(|at| samples[at].get(1 + usize::from(channel)));
    near.is_some_and(|&sample| sample.abs_diff(value.into()) <= 2 * u64::from(threshold))
}

/// Parses a file's lines of numbers, separated by commas.
pub fn numbers(directory: &Path, name: &str) -> Result<Vec<Vec<i64>>> {
    let text = fs::read_to_string(directory.join(name))?;
    let line = |line: &str| line.split(',').map(str::parse).collect::<Result<Vec<i64>, _>>();
    Ok(text.lines().map(line).collect::<Result<_, _>>()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> String {
        let path = paths::root().join("docs/before-you-fly.md");
        fs::read_to_string(path).unwrap().replace("\n   ", " ").replace('\n', " ")
    }

    fn says(page: &str, words: &str) {
        assert!(page.contains(words), "docs/before-you-fly.md does not say `{words}`");
    }

    #[test]
    fn before_you_fly_says_what_the_emulated_boards_are_held_to() {
        let (page, bmi, icm) = (page(), BMI323_LIMITS, ICM42688P_LIMITS);
        says(
            &page,
            &format!("{} ms (BMI323, BMI088) or {} ms (ICM-42688-P)", bmi.noticed, icm.noticed),
        );
        assert_eq!(bmi.noticed, BMI088_LIMITS.noticed);
        says(&page, &format!("{} ns (BMI323) or {} ns (ICM-42688-P)", bmi.guard, icm.guard));
        says(&page, &format!("{} µs or more high (BMI323)", bmi.pause / 1e3));
        let seconds = |ms: u64| format!("{} s", ms as f64 / 1e3);
        says(&page, &format!("within {} of the wire's return", seconds(BACK)));
        says(&page, &format!("(BMI088: {})", seconds(BMI088_LIMITS.back)));
        says(&page, &format!("{} later (an nRF52840", seconds(BACK)));
        says(&page, &format!("starts anew: {})", seconds(BACK + SLOW_CRYSTAL)));
        says(&page, &format!("within {} the far end is neutral", seconds(SILENCE / 1_000)));
        says(&page, &format!("as dead after {} ms", SILENCE / 1_000));
    }

    #[test]
    fn before_you_fly_says_what_the_firmware_has() {
        let main = paths::examples().join("boards/src/main.rs");
        let (page, main) = (page(), fs::read_to_string(main).unwrap());
        for (code, words) in [
            ("EventQueue<512>", "half of the queue, which is 512"),
            ("WATCHDOG: Duration = Duration::from_millis(500)", "resets it within half a second"),
        ] {
            assert!(main.contains(code), "{code}");
            says(&page, words);
        }
    }
}
