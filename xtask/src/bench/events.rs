//! What an event costs on its way, and six channels in all.

use super::figures::{self, mean};
use crate::boards::Board;
use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

/// What one direction of a link, format or chip costs; instructions are those of an event, or of a
/// set of samples.
#[derive(Serialize)]
pub struct Event {
    kind: &'static str,
    subject: String,
    direction: String,
    /// `event`, `sample set` or `pixel`.
    per: String,
    /// Where one has a part in it.
    sample: Option<String>,
    core: &'static str,
    count: u32,
    pub instructions_mean: f64,
    /// Of the worst; where many go together, of the worst batch's mean.
    instructions_max: u32,
    /// Null where nothing is written.
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
    max: u32,
    bytes: u32,
}

/// The sample type of each of the tables' cores.
const SAMPLES: [&str; 2] = ["f32", "q16.16"];

/// Six channels a second, and the core and clock that they are promised for.
const RATE: f64 = 8_000.0;
pub const PROMISED: (&str, &str) = ("M4F", "f32");
const CLOCK: f64 = 168e6;
const SHARE: f64 = 0.02;

impl Event {
    pub fn read(board: &Board, line: &str) -> Result<Self> {
        let printed: Printed = serde_json::from_str(line).with_context(|| line.to_owned())?;
        Ok(Self {
            kind: "event",
            core: board.core,
            instructions_mean: mean(printed.total, printed.count),
            instructions_max: printed.max,
            bytes_mean: (printed.bytes > 0).then(|| mean(printed.bytes, printed.count)),
            subject: printed.subject,
            direction: printed.direction,
            per: printed.per,
            sample: printed.sample,
            count: printed.count,
        })
    }

    /// What tells it from others.
    pub fn key(&self) -> String {
        let Self { core, subject, direction, sample, .. } = self;
        let sample = sample.as_ref().map(|sample| format!(" {sample}")).unwrap_or_default();
        format!("{core} {subject}{sample} {direction}")
    }

    fn bytes(&self) -> String {
        self.bytes_mean.map_or("–".into(), |bytes| format!("{bytes:.2}"))
    }
}

/// Every figure.
pub fn text(events: &[Event]) -> String {
    let mut text = String::new();
    let mut table = None;
    for event in events {
        if table != Some((event.core, &event.per)) {
            let title = format!("{}, each {}", event.core, event.per);
            text += &format!("\n{title:46} {:>8} {:>8} {:>6}\n", "mean", "worst", "bytes");
            table = Some((event.core, &event.per));
        }
        text += &format!(
            "{:20} {:12} {:12} {:>8.1} {:>8} {:>6}\n",
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

/// Those of docs/costs.md.
pub fn markdown(events: &[Event]) -> Result<String> {
    let tables = [each_event(events), frames(events), banks(events)?, six_channels(events)?];
    Ok(format!("\n{}\n", tables.join("\n")))
}

/// A line for each subject, with both directions and both cores.
fn each_event(events: &[Event]) -> String {
    let [first, second] = figures::CORES;
    let mut text = format!(
        "| an event | bytes | {first} write | worst | read | worst | {second} write | worst | read | worst |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    for (subject, name) in NAMES {
        let of = |core, directions: &[&str]| {
            events.iter().find(|event| {
                (event.core, event.subject.as_str()) == (core, subject)
                    && directions.contains(&event.direction.as_str())
            })
        };
        let cell = |event: Option<&Event>| match event {
            Some(Event { instructions_mean, instructions_max, .. }) => {
                format!("{instructions_mean:.1} | {instructions_max}")
            }
            None => "– | –".into(),
        };
        let Some(write) = of(first, &["encode", "push"]) else { continue };
        let cells = figures::CORES.map(|core| {
            let [write, read] = [of(core, &["encode", "push"]), of(core, &["decode", "pop"])];
            format!("{} | {}", cell(write), cell(read))
        });
        text += &format!("| {name} | {} | {} |\n", write.bytes(), cells.join(" | "));
    }
    text
}

/// The subjects as a reader of the tables knows them.
const NAMES: [(&str, &str); 19] = [
    ("queue", "queue: push, pop"),
    ("queue-lock-free", "queue, lock-free: push, pop"),
    ("raw", "raw: tick, address, sign"),
    ("link-full", "link, full frames"),
    ("link-100ms", "link, a frame every 100 ms"),
    ("edvs-e0", "eDVS E0, without time"),
    ("edvs-e1", "eDVS E1"),
    ("edvs-e2", "eDVS E2"),
    ("edvs-e3", "eDVS E3"),
    ("edvs-e4", "eDVS E4"),
    ("event-stream", "Event Stream"),
    ("evt2", "EVT2"),
    ("eieio", "EIEIO, a datagram a sample"),
    ("tinyodin-word", "tinyODIN, the word of 10 bits"),
    ("tinyodin", "tinyODIN, word and handshake"),
    ("odin-word", "ODIN, the word of 17 bits"),
    ("akd1500-convolution", "AKD1500, convolutional layer"),
    ("akd1500-dense", "AKD1500, dense layer"),
    ("xylo", "Xylo, counts of 10 ms"),
];

/// A pixel of a camera's row, on both cores.
fn frames(events: &[Event]) -> String {
    let [first, second] = figures::CORES;
    let mut text = format!(
        "| a pixel of a camera's row | RAM, bytes | {first}: nothing changes | an edge passes | all change | {second}: nothing changes | an edge passes | all change |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    for (subject, name, bytes) in PIXELS {
        text += &format!("| {name} | {bytes} |");
        for core in figures::CORES {
            for scene in ["rest", "edge", "all"] {
                let mean = events.iter().find(|event| {
                    (event.core, event.subject.as_str(), event.direction.as_str())
                        == (core, subject, scene)
                });
                let mean =
                    mean.map_or("–".into(), |event| format!("{:.1}", event.instructions_mean));
                text += &format!(" {mean} |");
            }
        }
        text += "\n";
    }
    text
}

/// The codes of pixels: the subject, its name, and the bytes that a pixel takes.
const PIXELS: [(&str, &str, u32); 4] = [
    ("frame-intensity", "`Intensity`, threshold 10", 1),
    ("frame-log-u8", "`LogIntensity<u8>`, 0.2", 1),
    ("frame-log-u16", "`LogIntensity<u16>`, 0.2", 2),
    ("frame-refractory", "`Refractory<Intensity>`, 1 frame", 2),
];

/// Six samples into a bank, on both cores.
fn banks(events: &[Event]) -> Result<String> {
    let mut text = String::from(
        "| the bank alone | SF | worst | HSA, 15 taps | worst | T-HSA, 15 taps | worst |\n\
         |---|---:|---:|---:|---:|---:|---:|\n",
    );
    for (core, sample) in figures::CORES.into_iter().zip(SAMPLES) {
        text += &format!("| {core}, `{sample}` |");
        for bank in ["bank-sf-6", "bank-hsa-6", "bank-t-hsa-6"] {
            let bank = find(events, core, bank, "encode", sample)?;
            text += &format!(" {:.1} | {} |", bank.instructions_mean, bank.instructions_max);
        }
        text += "\n";
    }
    Ok(text)
}

/// From six samples to frames, at both rates and on both cores.
fn six_channels(events: &[Event]) -> Result<String> {
    let mut text = String::from(
        "| SF, queue and frames | interrupt: bank, queue | worst | main: frames | all | worst 100 ms |\n\
         |---|---:|---:|---:|---:|---:|\n",
    );
    for (core, sample) in figures::CORES.into_iter().zip(SAMPLES) {
        for (path, rate) in [("path-8khz", "8 kHz"), ("path-200hz", "200 Hz")] {
            let of = |direction| find(events, core, path, direction, sample);
            let (interrupt, main, all) = (of("interrupt")?, of("main")?, of("all")?);
            text += &format!(
                "| {core}, `{sample}`, {rate} | {:.1} | {} | {:.1} | {:.1} | {} |\n",
                interrupt.instructions_mean,
                interrupt.instructions_max,
                main.instructions_mean,
                all.instructions_mean,
                all.instructions_max,
            );
        }
    }
    Ok(format!("{text}\n{}", in_a_sentence(events)?))
}

/// What six channels take of the core.
pub fn in_a_sentence(events: &[Event]) -> Result<String> {
    let set = set(events)?;
    let (second, share) = (set * RATE / 1e6, 100.0 * set * RATE / CLOCK);
    Ok(format!(
        "Six channels at 8 kHz, from samples to frames, are {set:.1} × 8000 = {second:.2} million instructions\n\
         a second: {share:.2} % of a Cortex-M4F at 168 MHz and one instruction a cycle.\n"
    ))
}

/// Of the promised core, from six samples to frames.
fn set(events: &[Event]) -> Result<f64> {
    let (core, sample) = PROMISED;
    Ok(find(events, core, "path-8khz", "all", sample)?.instructions_mean)
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

/// Fails if six channels at 8 kHz take more of the core than is promised.
pub fn ensure_six_channels_fit(events: &[Event]) -> Result<()> {
    let set = set(events)?;
    let most = SHARE * CLOCK / RATE;
    ensure!(set < most, "six channels take {set:.1} instructions a set, and may take {most:.0}");
    println!(
        "Six channels at 8 kHz: {set:.1} instructions a set, under {most:.0}, 2 % of 168 MHz."
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_per_cent_are_the_bound() {
        let path = |instructions_mean| Event {
            kind: "event",
            subject: "path-8khz".into(),
            direction: "all".into(),
            per: "sample set".into(),
            sample: Some("f32".into()),
            core: "M4F",
            count: 1,
            instructions_mean,
            instructions_max: 0,
            bytes_mean: None,
        };
        assert!(ensure_six_channels_fit(&[path(419.9)]).is_ok());
        assert!(ensure_six_channels_fit(&[path(420.0)]).is_err());
        assert!(ensure_six_channels_fit(&[]).is_err());
    }
}
