//! Costs of an event on its way, and of six channels in total.

use super::figures::{self, cycles_max, cycles_mean, mean};
use crate::programs::boards::Board;
use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

/// Costs of one direction of a link, format or chip; instructions are those of an event, or of a set of samples.
#[derive(Serialize)]
pub struct Event {
    kind: &'static str,
    subject: String,
    direction: String,
    /// What the costs are counted per: `event`, `sample set` or `pixel`.
    per: String,
    /// Sample type, if one matters.
    sample: Option<String>,
    core: &'static str,
    count: u32,
    pub instructions_mean: f64,
    /// Instructions of the most expensive one; for batches, the mean of the most expensive batch.
    instructions_max: u32,
    /// Lower and upper bound, as for a codec.
    cycles_mean: Option<[f64; 2]>,
    cycles_max: Option<[u32; 2]>,
    /// Mean number of bytes; null if nothing is written.
    bytes_mean: Option<f64>,
}

/// A line that the firmware prints.
#[derive(Deserialize)]
struct Printed {
    subject: String,
    direction: String,
    per: String,
    sample: Option<String>,
    count: u32,
    total: u32,
    total_cycles: [u32; 2],
    max: u32,
    max_cycles: [u32; 2],
    bytes: u32,
}

/// Sample rate of the six channels in Hz; the core and clock for which bounds are promised follow, and for two sample types
/// the share of the core that stays below.
const RATE: f64 = 8_000.0;
pub const PROMISED: &str = "M4F";
const CLOCK: f64 = 168e6;
const SHARES: [(&str, f64); 2] = [("f32", 0.0055), ("i16", 0.0042)];

impl Event {
    pub fn read(board: &Board, line: &str) -> Result<Self> {
        let printed: Printed = serde_json::from_str(line).with_context(|| line.to_owned())?;
        Ok(Self {
            kind: "event",
            core: board.core,
            instructions_mean: mean(printed.total, printed.count),
            instructions_max: printed.max,
            cycles_mean: cycles_mean(printed.total_cycles, printed.count),
            cycles_max: cycles_max(printed.max_cycles),
            bytes_mean: (printed.bytes > 0).then(|| mean(printed.bytes, printed.count)),
            subject: printed.subject,
            direction: printed.direction,
            per: printed.per,
            sample: printed.sample,
            count: printed.count,
        })
    }

    /// Returns a key that identifies the event.
    pub fn key(&self) -> String {
        let Self { core, subject, direction, sample, .. } = self;
        let sample = sample.as_ref().map(|sample| format!(" {sample}")).unwrap_or_default();
        format!("{core} {subject}{sample} {direction}")
    }

    fn bytes(&self) -> String {
        self.bytes_mean.map_or("–".into(), |bytes| format!("{bytes:.2}"))
    }

    /// Formats two cells: the mean cycles, and the instructions of the most expensive one.
    fn cycles_and_worst(&self) -> String {
        format!("{} | {}", figures::cell(self.cycles_mean), self.instructions_max)
    }
}

/// Formats all figures as text.
pub fn text(events: &[Event]) -> String {
    let mut text = String::new();
    let mut table = None;
    for event in events {
        if table != Some((event.core, &event.per)) {
            let title = format!("{}, each {}", event.core, event.per);
            text += &format!(
                "\n{title:46} {:>8} {:>8} {:>6} {:>15}\n",
                "mean", "worst", "bytes", "cycles"
            );
            table = Some((event.core, &event.per));
        }
        let cycles = figures::cell(event.cycles_mean);
        text += &format!(
            "{:20} {:12} {:12} {:>8.1} {:>8} {:>6} {cycles:>15}\n",
            event.subject,
            event.direction,
            event.sample.as_deref().unwrap_or_default(),
            event.instructions_mean,
            event.instructions_max,
            event.bytes(),
        );
    }
    text
}

/// Formats the tables of docs/costs.md.
pub fn markdown(events: &[Event]) -> Result<String> {
    let tables = [each_event(events), frames(events), six_channels(events)?];
    Ok(format!("\n{}\n", tables.join("\n")))
}

/// Formats a line for each subject: the cycles of both directions on the first core, and the worst instructions.
fn each_event(events: &[Event]) -> String {
    let [core, _] = figures::CORES;
    let mut text = format!(
        "| an event, {core} | bytes | write, cycles | worst | read, cycles | worst |\n\
         |---|---:|---:|---:|---:|---:|\n"
    );
    for (subject, name) in NAMES {
        let Some(write) = direction_of(events, core, subject, ["encode", "push"]) else { continue };
        let read = direction_of(events, core, subject, ["decode", "pop"]);
        let (bytes, write) = (write.bytes(), write.cycles_and_worst());
        let read = read.map_or("– | –".into(), Event::cycles_and_worst);
        text += &format!("| {name} | {bytes} | {write} | {read} |\n");
    }
    text
}

/// Returns the event of a subject whose direction has one of two names.
fn direction_of<'a>(
    events: &'a [Event],
    core: &str,
    subject: &str,
    names: [&str; 2],
) -> Option<&'a Event> {
    events.iter().find(|event| {
        (event.core, event.subject.as_str()) == (core, subject)
            && names.contains(&event.direction.as_str())
    })
}

/// Formats every figure on both cores as CSV.
pub fn csv(events: &[Event]) -> String {
    let mut text = String::from(
        "core,subject,direction,per,sample,bytes,instructions,cycles_least,cycles_most,worst_instructions\n",
    );
    for event in events.iter().filter(|event| figures::CORES.contains(&event.core)) {
        let cells = [
            event.core,
            &event.subject,
            &event.direction,
            &event.per,
            event.sample.as_deref().unwrap_or_default(),
            &event.bytes_mean.map(|bytes| format!("{bytes:.2}")).unwrap_or_default(),
            &figures::decimal(Some(event.instructions_mean)),
            &figures::bounds(event.cycles_mean),
            &event.instructions_max.to_string(),
        ];
        text += &format!("{}\n", cells.join(","));
    }
    text
}

/// The subjects on the page, with their names there; the file has all.
const NAMES: [(&str, &str); 10] = [
    ("queue", "queue: push, pop"),
    ("queue-lock-free", "queue, lock-free: push, pop"),
    ("raw", "raw: tick, address, sign"),
    ("link-full", "link, full frames"),
    ("link-100ms", "link, a frame every 100 ms"),
    ("edvs-e1", "eDVS E1"),
    ("event-stream", "Event Stream"),
    ("evt2", "EVT2"),
    ("tinyodin", "tinyODIN, word and handshake"),
    ("xylo", "Xylo, counts of 10 ms"),
];

/// Formats the costs of a pixel in a camera's row, on the first core.
fn frames(events: &[Event]) -> String {
    let [core, _] = figures::CORES;
    let mut text = format!(
        "| a pixel, {core} | RAM, bytes | nothing changes | an edge passes | all change |\n|---|---:|---:|---:|---:|\n"
    );
    for (subject, name, bytes) in PIXELS {
        text += &format!("| {name} | {bytes} |");
        for scene in ["rest", "edge", "all"] {
            let mean = events.iter().find(|event| {
                (event.core, event.subject.as_str(), event.direction.as_str())
                    == (core, subject, scene)
            });
            let mean = mean.map_or("–".into(), |event| format!("{:.1}", event.instructions_mean));
            text += &format!(" {mean} |");
        }
        text += "\n";
    }
    text
}

/// The codes of pixels: subject, name, and bytes for each pixel.
const PIXELS: [(&str, &str, u32); 4] = [
    ("frame-intensity", "`Intensity`, threshold 10", 1),
    ("frame-log-u8", "`LogIntensity<u8>`, 0.2", 1),
    ("frame-log-u16", "`LogIntensity<u16>`, 0.2", 2),
    ("frame-refractory", "`Refractory<Intensity>`, 1 frame", 2),
];

/// Formats the costs from six samples to frames, at both rates and on both cores.
fn six_channels(events: &[Event]) -> Result<String> {
    let mut text = String::from(
        "| six samples to frames | interrupt, cycles | worst | interrupt and main, cycles |\n|---|---:|---:|---:|\n",
    );
    let [first, second] = figures::CORES;
    for (core, sample) in [(first, "f32"), (first, "i16"), (second, "q16.16")] {
        for (path, code) in PATHS {
            let interrupt = find(events, core, path, "interrupt", sample)?;
            let all = find(events, core, path, "all", sample)?;
            text += &format!(
                "| {core}, `{sample}`, {code} | {} | {} | {} |\n",
                figures::cell(interrupt.cycles_mean),
                interrupt.instructions_max,
                figures::cell(all.cycles_mean),
            );
        }
    }
    Ok(format!("{text}\n{}", in_a_sentence(events)?))
}

/// The ways from six samples to frames that the page has.
const PATHS: [(&str, &str); 2] = [("path-8khz", "SF, 8 kHz"), ("path-200hz", "SF, 200 Hz")];

/// Describes in a few sentences how much of the core six channels take.
pub fn in_a_sentence(events: &[Event]) -> Result<String> {
    let [floats, counts] = SHARES.map(|(sample, _)| {
        let (set, [least, most]) = set(events, sample)?;
        let [low, high] = [least, most].map(|cycles| cycles * RATE / CLOCK * 100.0);
        let (mean, cycles) = (set.instructions_mean, figures::between([least, most]));
        anyhow::Ok(format!(
            "`{sample}` takes {mean:.1} instructions and {cycles} cycles, {low:.2} to {high:.2} %"
        ))
    });
    let (floats, counts) = (floats?, counts?);
    Ok(format!(
        "Six channels of SF at 8 kHz, from samples to frames, on a Cortex-M4F at 168 MHz: a sample set in\n\
         {floats}. {counts}.\n\
         Both are measured on the recorded flight, linearly interpolated to 8 kHz; 8 % of the sample sets produce a spike.\n"
    ))
}

/// Returns the event from six samples to frames on the promised core, and its cycles.
fn set<'a>(events: &'a [Event], sample: &str) -> Result<(&'a Event, [f64; 2])> {
    let set = find(events, PROMISED, "path-8khz", "all", sample)?;
    Ok((set, set.cycles_mean.context("no cycles are counted")?))
}

fn find<'a>(
    events: &'a [Event],
    core: &str,
    subject: &str,
    direction: &str,
    sample: &str,
) -> Result<&'a Event> {
    let is_it = |event: &&Event| {
        (event.core, event.subject.as_str(), event.direction.as_str(), event.sample.as_deref())
            == (core, subject, direction, Some(sample))
    };
    let found = events.iter().find(is_it);
    found.with_context(|| format!("no {subject} {direction} in {sample} on {core}"))
}

/// Fails if six channels at 8 kHz may take more of the core than promised.
pub fn ensure_six_channels_fit(events: &[Event]) -> Result<()> {
    for (sample, share) in SHARES {
        let (_, [_, set]) = set(events, sample)?;
        let (most, percent) = (share * CLOCK / RATE, share * 100.0);
        let said = format!("six channels in {sample} take up to {set:.1} cycles a set");
        ensure!(set < most, "{said}, and may take {most:.1}");
        println!("At 8 kHz {said}, under {most:.1}, {percent:.2} % of 168 MHz.");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_the_bounds() {
        let path = |sample: &str, most| Event {
            kind: "event",
            subject: "path-8khz".into(),
            direction: "all".into(),
            per: "sample set".into(),
            sample: Some(sample.into()),
            core: "M4F",
            count: 1,
            instructions_mean: 100.0,
            instructions_max: 0,
            cycles_mean: Some([100.0, most]),
            cycles_max: None,
            bytes_mean: None,
        };
        let fit = |floats, counts| {
            ensure_six_channels_fit(&[path("f32", floats), path("i16", counts)]).is_ok()
        };
        assert!(fit(115.4, 88.1));
        assert!(!fit(115.6, 88.1) && !fit(115.4, 88.3));
        assert!(ensure_six_channels_fit(&[]).is_err());
    }
}
