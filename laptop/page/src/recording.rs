//! The recording that is looked at.

use crate::host::{Dropped, send};
use crate::words::label;
use anyhow::{Context, Result, bail};
use catalogue::run::Worded;
use flight_logs::Kind;
use flight_logs::files::{Bytes, lend, take_back};
use lab::bench::signal::{RATE, Waveform};
use lab::input::messages::overview;
use lab::input::{CHUNK, ChannelOptions, Clock, InputOptions, inertial, items};
use lab::trial::Recording;
use lab::unit::unit_of_name;
use serde::Deserialize;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// Steps in time above this many usual ones are gaps, as on the command line.
const GAP: f64 = 1.5;

/// The flight that the page brings.
const FLIGHT: &[u8] = include_bytes!("../../../data/hexarotor.csv");

/// Most items of an array that are listed. A longer array has many fields to choose from already.
const MOST_ITEMS: usize = 64;

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
    /// How the rows of a table are read.
    #[serde(flatten)]
    table: TableOptions,
}

/// What the user says about a table that the table itself does not tell.
#[derive(Clone, Default, Deserialize)]
pub(crate) struct TableOptions {
    /// Unit of the time column.
    time_unit: Option<String>,
    /// Number of the line with the names of the columns, counted from 1.
    header: Option<u64>,
}

thread_local! {
    static FILE: RefCell<PathBuf> = RefCell::default();
    /// The recordings that are open, each at its place: the one that is looked at has place 0, the axes beside it follow.
    static OPEN: RefCell<BTreeMap<usize, Open>> = const { RefCell::new(BTreeMap::new()) };
}

/// A recording, and the options with which it was read.
pub(crate) struct Open {
    pub recording: Recording,
    pub input: InputOptions,
}

/// Calls a function with the recording that is looked at.
///
/// # Errors
/// Returns an error if no recording is open, or the function's own.
pub(crate) fn with<T>(then: impl FnOnce(&Open) -> Result<T>) -> Result<T> {
    with_place(0, then)
}

/// Calls a function with the recording at a place.
///
/// # Errors
/// Returns an error if no recording is open at `place`, or the function's own.
pub(crate) fn with_place<T>(place: usize, then: impl FnOnce(&Open) -> Result<T>) -> Result<T> {
    OPEN.with_borrow(|open| then(open.get(&place).context("no recording is open")?))
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
pub(crate) fn open(names: &[String], accept_cut: bool, table: &TableOptions) -> Result<Value> {
    take_back();
    OPEN.take();
    for (number, name) in (0..).zip(names) {
        lend(name, Dropped(number));
    }
    let first = names.iter().find(|name| *name == "metadata.yaml").or(names.first());
    list(Path::new(first.context("no file")?), accept_cut, table)
}

/// Opens a recording that the page brings.
pub(crate) fn example(name: &str) -> Result<Value> {
    take_back();
    OPEN.take();
    let (file, bytes): (_, std::borrow::Cow<_>) = match name {
        "flight" => ("hexarotor.csv", FLIGHT.into()),
        "paper" => ("signal.csv", paper().into_bytes().into()),
        _ => bail!("there is no example `{name}`"),
    };
    lend(file, Memory(bytes));
    list(Path::new(file), false, &TableOptions::default())
}

/// The paper's signal as `spikewire signal` writes it.
fn paper() -> String {
    let samples = (1..).zip(Waveform::new(SECONDS).with_noise(1, 0));
    let lines = samples.map(|(step, value)| format!("{},{value}\n", step * 1_000_000 / RATE));
    "time_us,signal\n".to_owned() + &lines.collect::<String>()
}

/// What a file holds: topics with fields, of which a table has one without a name.
fn list(path: &Path, accept_cut: bool, table: &TableOptions) -> Result<Value> {
    FILE.set(path.to_owned());
    let (topics, notes): (Vec<Topic>, Vec<String>) = match Kind::of(path)? {
        None => {
            let mut options = options(None)?;
            table.apply(&mut options)?;
            options.columns = vec!["all".to_owned()];
            let source = InputOptions { input: path.to_owned(), channel: options }.open()?;
            let fields: Vec<String> = source.names().into_iter().map(str::to_owned).collect();
            let notes = source.notes().iter().map(|note| note.spelled(label).to_string());
            (vec![Topic { fields, ..Topic::default() }], notes.collect())
        }
        Some(kind) => {
            let (topics, notes) = overview(path, kind, accept_cut, GAP)?;
            let topics =
                topics.into_iter().filter(|own| own.unread.is_none() && !own.fields.is_empty());
            let topics = topics.map(|own| Topic {
                fields: own.fields.iter().flat_map(|field| items(field, MOST_ITEMS)).collect(),
                count: own.count,
                about: format!("{} messages {}", own.count, own.kind).trim_end().to_owned(),
                name: own.name,
            });
            (topics.collect(), notes)
        }
    };
    let candidates: Vec<inertial::Topic> = topics.iter().map(Topic::candidate).collect();
    let found = inertial::find(&candidates).map(|sensor| sensor.topic);
    let Some(first) = found.or(topics.first().map(|topic| topic.name.clone())) else {
        bail!("{}: it holds no numbers that can be read", path.display());
    };
    let topics: Vec<Value> = topics.iter().map(Topic::to_json).collect();
    Ok(json!({ "file": path, "topics": topics, "notes": notes, "first": first }))
}

/// A topic of a log, or the columns of a table, which have no name.
#[derive(Default)]
struct Topic {
    name: String,
    fields: Vec<String>,
    count: u64,
    about: String,
}

impl Topic {
    fn candidate(&self) -> inertial::Topic<'_> {
        inertial::Topic { name: &self.name, fields: &self.fields, count: self.count }
    }

    /// Returns the topic as the page takes it. A field without a known unit has none, and one that is no axis of an
    /// inertial sensor has no group of a bank.
    fn to_json(&self) -> Value {
        let Self { name, fields, count, about } = self;
        let unit = |field: &String| match &**name {
            "" => unit_of_name(field),
            topic => unit_of_name(&format!("{topic}.{field}")),
        };
        let units: Vec<_> =
            fields.iter().map(|field| unit(field).map(crate::catalogue::unit)).collect();
        let groups: Vec<_> =
            fields.iter().map(|field| inertial::group(name, fields, field)).collect();
        json!({
            "name": name,
            "fields": fields,
            "units": units,
            "groups": groups,
            "axes": inertial::axes(name, fields),
            "first": inertial::first_field(name, fields),
            "count": count,
            "about": about,
        })
    }
}

impl TableOptions {
    /// Sets these options for reading.
    ///
    /// # Errors
    /// Returns an error if the unit of time is unknown.
    fn apply(&self, options: &mut ChannelOptions) -> Result<()> {
        options.header = self.header;
        options.time_unit = self.time_unit.as_deref().map(str::parse).transpose()?;
        Ok(())
    }
}

fn options(channel: Option<Channel>) -> Result<ChannelOptions> {
    let mut options = ChannelOptions { gap: GAP, ..ChannelOptions::default() };
    if let Some(Channel { topic, field, rate, skip_non_finite, accept_cut, table }) = channel {
        options.accept_cut = accept_cut && topic.is_some();
        options.skip_non_finite = skip_non_finite;
        options.rate = rate;
        if topic.as_deref().unwrap_or_default().is_empty() {
            table.apply(&mut options)?;
        }
        match topic {
            Some(_) => options.field = vec![field],
            None => options.column = vec![field],
        }
        options.topic = topic;
    }
    Ok(options)
}

/// Reads a channel to a place: its samples and times go to the page. If it cannot be read, the recording that was there
/// stays.
pub(crate) fn load(channel: Channel, place: usize) -> Result<Value> {
    let input =
        InputOptions { input: FILE.with_borrow(Clone::clone), channel: options(Some(channel))? };
    let recording = Recording::read(&input)?;
    send("values", &recording.values);
    if let Some(first) = recording.times.first() {
        let seconds = |time: &i64| time.saturating_sub(*first) as f64 * 1e-6;
        send("times", &recording.times.iter().map(seconds).collect::<Vec<_>>());
    }
    let notes = recording.notes().into_iter().map(|note| note.spelled(label).to_string());
    let uneven = recording.uneven().map(
        |uneven| json!({ "throughLength": uneven.through_length, "byMedian": uneven.by_median }),
    );
    let answer = json!({
        "name": recording.name,
        "samples": recording.values.len(),
        "rate": recording.rate,
        "uneven": uneven,
        "seconds": recording.seconds(),
        "unit": recording.unit().map(crate::catalogue::unit),
        "notes": notes.collect::<Vec<_>>(),
        "segments": recording.segments.iter().map(|own| own.start).collect::<Vec<_>>(),
        "gaps": gaps(&recording),
    });
    OPEN.with_borrow_mut(|open| open.insert(place, Open { recording, input }));
    Ok(answer)
}

/// Returns the samples after which a gap follows, as the clock of the recording counts gaps.
fn gaps(recording: &Recording) -> Vec<u64> {
    let first = recording.times.get(..CHUNK).unwrap_or(&recording.times);
    let mut clock = Clock::new(first, recording.rate, GAP);
    let steps = clock.observe(&recording.times).into_iter();
    steps.filter(|step| step.kind == lab::input::Kind::Gap).map(|step| step.after).collect()
}
