//! Checks the templates of `examples/templates`: each becomes a project, as a user would make it, is built, and runs in its
//! part's emulator, well and with every fault of its sensor.

use crate::checks::emulator::{self, Run};
use crate::checks::recording::{Recording, count_size};
use crate::common::{command, lint, output, paths, run};
use crate::products::new_firmware::{self, Origin};
use crate::products::templates::{TEMPLATES, Template};
use crate::programs::host;
use crate::setup::toolchain::cargo_for;
use anyhow::{Context, Result, ensure};
use spikewire_flight::Flight;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

/// Largest distance of a value from the filtered sample, in thresholds: the code may lag by one, and one is for the time of
/// the sample.
const MOST_DISTANCE: f64 = 2.0;
const PAGE: &str = "docs/firmware.md";
const HEADING: &str = "## From a log to exact values";
/// The repository's flight, as `spikewire advise` wrote it.
const FLIGHT: &str = "one-file/flight.toml";
/// The log of which it was written, and the time in s from which on it is flown here.
const LOG: &str = "data/hexarotor.csv";
const TAKE_OFF: f64 = 8.0;
/// How long each fault lasts, and from one to the next, in ms.
const LASTS: u64 = 300;
const EACH: u64 = 700;
/// The faults, with the words of the log and what ends them.
const FAULTS: [(&str, &str, &str); 7] = [
    ("miso-cut", "Identity(255)", "mend"),
    ("miso-low", "Identity(0)", "mend"),
    ("miso-noise", "Identity(", "mend"),
    ("clock-cut", "Identity(255)", "mend"),
    ("supply-gone", "Identity(255)", "supply-back"),
    ("another", "Identity(104)", "mend"),
    ("freeze", "Dead(Stuck)", "thaw"),
];

/// Builds and flies every template; `HAL` in the environment selects a single one.
pub fn templates() -> Result<()> {
    let asked = std::env::var("HAL").ok();
    if asked.is_none() {
        six_commands()?;
    }
    let is_asked = |own: &&Template| asked.as_ref().is_none_or(|hal| own.hal == hal);
    TEMPLATES.iter().filter(is_asked).try_for_each(|template| {
        let elsewhere = tempfile::tempdir()?;
        let project = elsewhere.path().join(format!("my-{}", template.hal)); // not the HAL's own name
        let image = build(template, &project)?;
        let Some(part) = template.emulated else {
            println!("{}: compiled and linked", template.hal);
            return Ok(());
        };
        let flight = project.join("flight.toml");
        let events = well(template, part, &image, &flight)?;
        let noticed = faults(template, part, &image, &flight)?;
        println!("{}: {events} exact values; {noticed}", template.hal);
        Ok(())
    })
}

/// Runs the six commands of docs/firmware.md as they stand there, except that the laptop program is the tests' build, and
/// that projects lie elsewhere.
fn six_commands() -> Result<()> {
    let page = fs::read_to_string(paths::root().join(PAGE))?;
    let (_, section) = page.split_once(HEADING).context(HEADING)?;
    let (_, rest) = section.split_once("```sh\n").context("no commands")?;
    let (commands, _) = rest.split_once("```").context("no end of the commands")?;
    let commands: Vec<&str> = commands.lines().collect();
    ensure!(commands.len() <= 6, "{} commands", commands.len());
    let elsewhere = tempfile::tempdir()?;
    let place = elsewhere.path().display();
    let program = host::spikewire("")?.get_program().display().to_string();
    let cargo = cargo_for("thumbv7em-none-eabihf", "build")?;
    let toolchain = cargo.get_args().next().filter(|arg| *arg == "+thumb");
    let xtask = std::env::current_exe()?.display().to_string();
    let mut heard = String::new();
    for line in commands.into_iter().filter(|line| !line.starts_with("cargo install")) {
        let line = line
            .replace("../mine", &format!("{place}/mine"))
            .replace(" flight.toml", &format!(" {place}/flight.toml"))
            // The whole log takes minutes: its first seconds have the take-off.
            .replace(" --log", " --seconds 10 --log")
            .replace("spikewire ", &format!("{program} "))
            .replace("cargo xtask", &xtask)
            .replace(
                "cargo build",
                if toolchain.is_some() { "cargo +thumb build" } else { "cargo build" },
            );
        heard = output(command("sh").args(["-c", &line]))?;
    }
    let (_, after_keyframe) = heard.split_once(",keyframe").context("no keyframe")?;
    let ends = |known: &str| after_keyframe.lines().filter(|line| line.ends_with(known)).count();
    let (exact, estimates) = (ends(",exact"), ends(",estimate"));
    ensure!(exact > 100 && estimates == 0, "{exact} exact values, {estimates} estimates");
    println!("the six commands of {PAGE}: {exact} values, all exact from the first keyframe on");
    Ok(())
}

/// Builds a template's image in a project of its own.
fn build(template: &Template, project: &Path) -> Result<PathBuf> {
    let flight = paths::examples().join(FLIGHT);
    new_firmware::write_template(project, template, &flight, &Origin::Path(paths::root()))?;
    let target = paths::thumb_target().join("templates");
    let mut cargo = cargo_for(template.target, "build --release")?;
    run(lint(cargo.current_dir(project).env("CARGO_TARGET_DIR", &target)))?;
    let name = project.file_name().context("a project has a name")?;
    Ok(target.join(template.target).join("release").join(name))
}

/// Checks two seconds of the recorded flight without faults: the sensor has the log's samples, in counts; and `spikewire
/// listen`, with the same file, says every value exactly, and each is one that the log has. Returns the number of values.
fn well(template: &Template, part: &str, image: &Path, flight: &Path) -> Result<usize> {
    let directory = paths::target().join("emulated").join(template.hal);
    let recording = Recording::read(flight, &paths::root().join(LOG))?.from(TAKE_OFF);
    let table = directory.join("recording.csv");
    recording.write(&table)?;
    let run = Run {
        part,
        image,
        sensor: "icm42688p",
        seconds: 2.0,
        directory: &directory,
        fates: &[],
        recording: Some(&table),
    };
    let seen = run.strictly()?;
    ensure!(seen.configured && seen.pulled_up, "the sensor is not configured, or its line floats");
    let log = emulator::log(image, &directory)?;
    ensure!(log.contains("Started") && !log.contains("Fault"), "the log says\n{log}");
    let values = listened(flight, &directory)?;
    ensure!(values.len() > 100, "{} values", values.len());
    // The first sample's spikes come before the first keyframe.
    let inexact =
        values.iter().skip_while(|value| !value.is_exact).filter(|value| !value.is_exact).count();
    ensure!(inexact == 0, "{inexact} of {} values are not exact", values.len());
    for sample in emulator::numbers(&directory, "samples")? {
        let (at, counts) = sample.split_first().context("a sample has a time")?;
        ensure!(counts == recording.counts(*at), "at {at} µs the sensor had {counts:?}");
    }
    let samples = Samples(recording.filtered(&Flight::read(flight)?)?);
    let distance = samples.distance(&last_of_samples(&values), &thresholds(flight)?);
    ensure!(distance <= MOST_DISTANCE, "a value is {distance:.2} thresholds from the log's");
    Ok(values.len())
}

/// Strikes the sensor with each fault; returns how soon each was noticed, in words.
fn faults(template: &Template, part: &str, image: &Path, flight: &Path) -> Result<String> {
    let directory = paths::target().join("emulated").join(format!("{}-faults", template.hal));
    let mut fates = Vec::new();
    for ((fault, _, end), at) in FAULTS.iter().zip((1..).map(|place| place * EACH)) {
        fates.extend([format!("{at}:{fault}"), format!("{}:{end}", at + LASTS)]);
    }
    let seconds = (FAULTS.len() as u64 + 1) * EACH;
    let run = Run {
        part,
        image,
        sensor: "icm42688p",
        seconds: seconds as f64 / 1e3,
        directory: &directory,
        fates: &fates,
        recording: None,
    };
    let seen = run.strictly()?;
    ensure!(seen.configured, "the sensor did not come back");
    let log = emulator::log(image, &directory)?;
    for (fault, words, _) in FAULTS {
        ensure!(log.contains(words), "{fault} is not `{words}` in the log:\n{log}");
    }
    let (deaths, starts) = (log.matches("Dead(").count(), log.matches("Started").count());
    ensure!(
        deaths >= FAULTS.len() && starts == deaths + 1,
        "{deaths} deaths, {starts} starts:\n{log}"
    );
    let values = listened(flight, &directory)?;
    let last = values.last().context("no values")?;
    ensure!(last.is_exact, "not exact again: {last:?}");
    let (samples, thresholds) = (samples(&directory)?, thresholds(flight)?);
    let threshold = |value: &Value| thresholds.get(value.channel).copied().unwrap_or_default();
    let is_wrong = |value: &&Value| value.is_exact && !samples.reach(value, threshold(value));
    let wrong = values.iter().filter(is_wrong).count();
    ensure!(wrong == 0, "{wrong} values are exact that no sensor had");
    Ok(format!("{deaths} deaths by {} faults, back from each", FAULTS.len()))
}

/// A value that `spikewire listen` prints.
#[derive(Debug)]
struct Value {
    /// Time in µs, of the flight's clock.
    tick: i64,
    channel: usize,
    value: f64,
    is_exact: bool,
}

/// Runs `spikewire listen` with the flight's file.
fn listened(flight: &Path, directory: &Path) -> Result<Vec<Value>> {
    let mut listen = host::spikewire("listen --flight")?;
    let table = output(listen.arg(flight).arg(directory.join("uart")))?;
    let value = |line: &str| {
        let words: Vec<&str> = line.split(',').collect();
        let [tick, channel, value, known] = words[..] else { anyhow::bail!("{line}") };
        let (tick, channel, value) = (tick.parse()?, channel.parse()?, value.parse()?);
        Ok(Value { tick, channel, value, is_exact: known != "estimate" })
    };
    table.lines().skip(1).filter(|line| !line.starts_with('#')).map(value).collect()
}

/// The last value of each sample of a channel. The spikes of one sample lead to it step by step.
fn last_of_samples(values: &[Value]) -> Vec<&Value> {
    let mut last = BTreeMap::new();
    for value in values {
        last.insert((value.tick, value.channel), value);
    }
    last.into_values().collect()
}

/// Samples in SI units, with their times in µs: rates, then accelerations.
struct Samples(Vec<(i64, [f64; 6])>);

fn samples(directory: &Path) -> Result<Samples> {
    let sample = |line: &str| {
        let counts = line.split(',').map(str::parse).collect::<Result<Vec<i64>, _>>()?;
        let [at, counts @ ..] = &counts[..] else { anyhow::bail!("{line}") };
        let value = |axis: usize| Some(*counts.get(axis)? as f64 * count_size(axis));
        let values = [0, 1, 2, 3, 4, 5].map(|axis| value(axis).unwrap_or_default());
        Ok((*at, values))
    };
    let text = fs::read_to_string(directory.join("samples"))?;
    Ok(Samples(text.lines().map(sample).collect::<Result<_>>()?))
}

impl Samples {
    /// Returns the largest distance of the values from the samples, in thresholds, at the best offset of the
    /// flight's clock from the sensor's: the part starts its clock when its crystals run.
    fn distance(&self, values: &[&Value], thresholds: &[f64]) -> f64 {
        let at_offset = |offset: i64| {
            let distance = |value: &&Value| self.distance_of(value, offset, thresholds);
            values.iter().map(distance).fold(0.0, f64::max)
        };
        (0..500).map(|ms| at_offset(1_000 * ms)).fold(f64::INFINITY, f64::min)
    }

    fn distance_of(&self, own: &Value, offset: i64, thresholds: &[f64]) -> f64 {
        let at = self.0.partition_point(|sample| sample.0 <= own.tick + offset);
        let near = at.checked_sub(1).and_then(|at| self.0[at].1.get(own.channel));
        let threshold = thresholds.get(own.channel).copied().unwrap_or(f64::NAN);
        near.map_or(f64::INFINITY, |near| (near - own.value).abs() / threshold)
    }

    /// Whether the code can have come to this value. A sensor that thaws jumps, as no vehicle does, by twice what it ever
    /// had at most, and the file's filter, with a corner near half of its rate, overshoots a jump by 19 %.
    fn reach(&self, own: &Value, threshold: f64) -> bool {
        let most = self.0.iter().map(|sample| sample.1[own.channel % 6].abs()).fold(0.0, f64::max);
        own.value.abs() <= most * (1.0 + 2.0 * 0.19) + threshold
    }
}

/// The threshold of each channel, in the file.
fn thresholds(flight: &Path) -> Result<Vec<f64>> {
    let file: toml::Table = fs::read_to_string(flight)?.parse()?;
    let channels = file.get("channel").and_then(toml::Value::as_array).context("no channels")?;
    let threshold = |channel: &toml::Value| channel.get("parameters")?.get("threshold")?.as_float();
    channels.iter().map(|channel| threshold(channel).context("no threshold")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Maximum number of lines that a person reads: without blank ones, comments and imports.
    const MOST_LINES: usize = 120;

    fn lines(text: &str) -> usize {
        let mut in_use = false;
        let is_read = |line: &&str| {
            let line = line.trim();
            let was_in_use = in_use;
            in_use = (in_use || line.starts_with("use ")) && !line.ends_with(';');
            !(was_in_use || line.is_empty() || line.starts_with("use ") || line.starts_with("//"))
        };
        text.lines().filter(is_read).count()
    }

    #[test]
    fn imports_comments_and_blank_lines_are_not_read() {
        assert_eq!(lines("//! a\nuse b;\nuse c::{\n    d,\n};\n\nfn e() {\n    // f\n}\n"), 2);
    }

    #[test]
    fn the_page_has_each_hal() {
        let page = fs::read_to_string(paths::root().join(PAGE)).unwrap();
        let (_, section) = page.split_once(HEADING).unwrap();
        let (section, _) = section.split_once("\n## ").unwrap();
        let rows: Vec<_> = section.lines().filter(|line| line.starts_with("| `")).collect();
        assert_eq!(rows.len(), TEMPLATES.len() + 1); // and the head
        for Template { hal, target, emulated, .. } in &TEMPLATES {
            let row = rows.iter().find(|row| row.starts_with(&format!("| `{hal}`"))).unwrap();
            assert!(row.contains(&format!("| `{target}` |")), "{row}");
            assert!(row.contains(&format!("| `{}`", emulated.unwrap_or("none"))), "{row}");
        }
    }

    #[test]
    fn a_template_stays_short() {
        for Template { hal, .. } in &TEMPLATES {
            let path = paths::examples().join(format!("templates/{hal}/src/main.rs"));
            let lines = lines(&fs::read_to_string(path).unwrap());
            assert!(lines <= MOST_LINES, "{hal}: {lines}");
        }
    }
}
