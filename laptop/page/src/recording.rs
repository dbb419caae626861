//! The recording that is looked at.

use crate::host::{Dropped, send};
use crate::words::label;
use anyhow::{Context, Result, bail};
use catalogue::run::Worded;
use flight_logs::Kind;
use flight_logs::files::{Bytes, lend, take_back};
use lab::bench::signal::{RATE, Waveform};
use lab::input::messages::overview;
use lab::input::{ChannelOptions, InputOptions};
use lab::trial::Recording;
use serde::Deserialize;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::io;
use std::path::{Path, PathBuf};

/// Steps in time above this many usual ones are gaps, as on the command line.
const GAP: f64 = 1.5;

/// The flight that the page brings.
const FLIGHT: &[u8] = include_bytes!("../../../data/hexarotor.csv");

/// Seconds of the paper's signal.
const SECONDS: usize = 15;

/// A channel of the file that is open, and how it is read.
#[derive(Clone, Deserialize)]
pub(crate) struct Channel {
    /// Topic of a log; none of a table.
    topic: Option<String>,
    /// Field of the topic, or column of the table.
    field: String,
    /// Samples a second, of a table without times.
    rate: Option<f64>,
    /// Whether values that are missing are passed over.
    skip_non_finite: bool,
    /// Whether the whole messages of a damaged log are taken.
    accept_cut: bool,
}

thread_local! {
    static FILE: RefCell<PathBuf> = RefCell::default();
    static OPEN: RefCell<Option<Open>> = const { RefCell::new(None) };
}

/// What was read, and how; samples from another worker were not read.
pub(crate) struct Open {
    pub recording: Recording,
    pub input: Option<InputOptions>,
}

/// Calls a function with the recording that is looked at.
///
/// # Errors
/// There is none, or the function's own.
pub(crate) fn with<T>(then: impl FnOnce(&Open) -> Result<T>) -> Result<T> {
    OPEN.with_borrow(|open| then(open.as_ref().context("no recording is open")?))
}

/// Bytes in memory.
struct Memory(std::borrow::Cow<'static, [u8]>);

impl Bytes for Memory {
    fn len(&self) -> u64 {
        self.0.len() as u64
    }

    fn read_at(&self, place: u64, into: &mut [u8]) -> io::Result<usize> {
        let own = self.0.get(place as usize..).unwrap_or_default();
        io::Read::read(&mut &*own, into)
    }
}

/// Takes files in the place of those before.
pub(crate) fn open(names: &[String], accept_cut: bool) -> Result<Value> {
    take_back();
    for (number, name) in (0..).zip(names) {
        lend(name, Dropped(number));
    }
    let first = names.iter().find(|name| *name == "metadata.yaml").or(names.first());
    list(Path::new(first.context("no file")?), accept_cut)
}

/// Opens a recording that the page brings.
pub(crate) fn example(name: &str) -> Result<Value> {
    take_back();
    let (file, bytes): (_, std::borrow::Cow<_>) = match name {
        "flight" => ("hexarotor.csv", FLIGHT.into()),
        "paper" => ("signal.csv", paper().into_bytes().into()),
        _ => bail!("there is no example `{name}`"),
    };
    lend(file, Memory(bytes));
    list(Path::new(file), false)
}

/// The paper's signal as `spikewire signal` writes it.
fn paper() -> String {
    let samples = (1..).zip(Waveform::new(SECONDS).with_noise(1, 0));
    let lines = samples.map(|(step, value)| format!("{},{value}\n", step * 1_000_000 / RATE));
    "time_us,signal\n".to_owned() + &lines.collect::<String>()
}

/// What a file holds: topics with fields, of which a table has one without a name.
fn list(path: &Path, accept_cut: bool) -> Result<Value> {
    FILE.set(path.to_owned());
    let topic = |name: &str, fields: Vec<String>, (count, about): (u64, String)| json!({ "name": name, "fields": fields, "count": count, "about": about });
    let (topics, notes) = match Kind::of(path)? {
        None => {
            let mut options = options(None);
            options.columns = vec!["all".to_owned()];
            let source = InputOptions { input: path.to_owned(), channel: options }.open()?;
            let names = source.names().into_iter().map(str::to_owned).collect();
            let notes = source.notes().iter().map(|note| note.spelled(label).to_string());
            (vec![topic("", names, (0, String::new()))], notes.collect())
        }
        Some(kind) => {
            let (topics, notes) = overview(path, kind, accept_cut, GAP)?;
            let topics =
                topics.into_iter().filter(|own| own.unread.is_none() && !own.fields.is_empty());
            let topics = topics.map(|own| {
                let fields = own.fields.iter().flat_map(|field| each(field)).collect();
                let about = format!("{} messages {}", own.count, own.kind);
                topic(&own.name, fields, (own.count, about.trim_end().to_owned()))
            });
            (topics.collect(), notes)
        }
    };
    if topics.is_empty() {
        bail!("{}: it holds no numbers that can be read", path.display());
    }
    Ok(json!({ "file": path, "topics": topics, "notes": notes }))
}

/// The fields that `name[0..3]` stands for.
fn each(field: &str) -> Vec<String> {
    /// An array that is longer has many fields to choose from already.
    const MOST: usize = 64;
    let array = field.split_once("[0..").and_then(|(name, rest)| {
        let (count, after) = rest.split_once(']')?;
        Some((name, count.parse::<usize>().ok()?, after))
    });
    match array {
        Some((name, count, after)) => {
            (0..count.min(MOST)).map(|own| format!("{name}[{own}]{after}")).collect()
        }
        None => vec![field.to_owned()],
    }
}

fn options(channel: Option<Channel>) -> ChannelOptions {
    let mut options = ChannelOptions { gap: GAP, ..ChannelOptions::default() };
    if let Some(Channel { topic, field, rate, skip_non_finite, accept_cut }) = channel {
        options.accept_cut = accept_cut && topic.is_some();
        options.skip_non_finite = skip_non_finite;
        options.rate = rate;
        match topic {
            Some(_) => options.field = vec![field],
            None => options.column = vec![field],
        }
        options.topic = topic;
    }
    options
}

/// Reads a channel: its samples and times go to the page.
pub(crate) fn load(channel: Channel) -> Result<Value> {
    OPEN.take();
    let input =
        InputOptions { input: FILE.with_borrow(Clone::clone), channel: options(Some(channel)) };
    let recording = Recording::read(&input)?;
    send("values", &recording.values);
    if let Some(first) = recording.times.first() {
        let seconds = |time: &i64| time.saturating_sub(*first) as f64 * 1e-6;
        send("times", &recording.times.iter().map(seconds).collect::<Vec<_>>());
    }
    let notes = recording.notes().into_iter().map(|note| note.spelled(label).to_string());
    let told = json!({
        "name": recording.name,
        "samples": recording.values.len(),
        "rate": recording.rate,
        "uneven": recording.uneven().is_some(),
        "seconds": recording.seconds(),
        "unit": recording.unit(),
        "notes": notes.collect::<Vec<_>>(),
        "segments": recording.segments.iter().map(|own| own.start).collect::<Vec<_>>(),
    });
    OPEN.set(Some(Open { recording, input: Some(input) }));
    Ok(told)
}

/// Takes samples as the bytes of numbers.
pub(crate) fn take(name: String, rate: Option<f64>, file: u32) -> Result<Value> {
    let file = Dropped(file);
    let mut bytes = vec![0; file.len() as usize];
    file.read_at(0, &mut bytes)?;
    let values: Vec<f64> = bytes.as_chunks().0.iter().map(|own| f64::from_le_bytes(*own)).collect();
    OPEN.set(Some(Open { recording: Recording::of(name, values, rate), input: None }));
    Ok(json!({}))
}
