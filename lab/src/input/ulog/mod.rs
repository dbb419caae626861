//! PX4 flight logs.

mod format;
mod scan;

pub(crate) use scan::Findings;

use super::text::GZIP;
use super::{CHUNK, Chunk, InputOptions, Source, near};
use crate::files;
use anyhow::{Context, Result, anyhow, bail};
use flate2::read::MultiGzDecoder;
use format::{Field, Formats};
use scan::{HEADER, Scan};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;
use yule_log::builder::ULogParserBuilder;
use yule_log::model::inst::{FieldValue, Format};
use yule_log::model::msg::UlogMessage;

/// The messages of a flight log that can be read.
pub struct Log {
    bytes: Vec<u8>,
    formats: Formats,
    file: String,
    /// What was skipped, and what the logger missed.
    pub findings: Findings,
}

/// What a log holds of one instance of a topic.
#[derive(Debug, Default)]
pub struct Topic {
    /// Its fields of numbers.
    pub fields: Vec<String>,
    /// Its fields of text.
    pub texts: Vec<String>,
    /// When it was logged, in µs.
    pub times: Vec<i64>,
}

impl Log {
    /// Reads a log and sees to it that it is whole.
    ///
    /// # Errors
    /// It is not a flight log, or cut short and that was not accepted.
    pub fn read(path: &Path, accept_cut: bool) -> Result<Self> {
        let file = path.display().to_string();
        let mut bytes = files::read(path).with_context(|| format!("{file}: cannot be read"))?;
        if bytes.starts_with(&GZIP) {
            let mut unpacked = Vec::new();
            MultiGzDecoder::new(bytes.as_slice())
                .read_to_end(&mut unpacked)
                .with_context(|| format!("{file}: cannot be unpacked"))?;
            bytes = unpacked;
        }
        if bytes.is_empty() {
            bail!("{file}: empty");
        }
        if bytes.len() < HEADER || &bytes[..4] != b"ULog" {
            bail!("{file}: not a flight log; ULog files start with `ULog` and 12 bytes more");
        }
        let scanned = Scan::run(&bytes);
        let (findings, length) = (scanned.findings, bytes.len());
        if !accept_cut {
            if let Some(damage) = &findings.damage {
                bail!(
                    "{file}: damaged at byte {} of {length}; `accept_cut` goes on at byte {}",
                    damage.start,
                    damage.end
                );
            }
            if let Some(cut) = findings.cut {
                bail!(
                    "{file}: cut short within the message at byte {cut} of {length}; `accept_cut` takes what is before"
                );
            }
        }
        let mut bytes = scanned.bytes;
        silence_heartbeats(&mut bytes);
        Ok(Self { bytes, formats: scanned.formats, file, findings })
    }

    /// What the log holds, by topic; later instances as `topic:1`.
    ///
    /// # Errors
    /// A message that cannot be read.
    pub fn topics(&self) -> Result<BTreeMap<String, Topic>> {
        let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
        self.for_each(None, |name, time, data| {
            let topic = topics.entry(name).or_insert_with(|| Topic {
                fields: leaves(data).into_iter().map(|(name, _)| name).collect(),
                texts: self.texts(data).map(|field| field.name.clone()).collect(),
                times: Vec::new(),
            });
            topic.times.push(time);
        })?;
        Ok(topics)
    }

    /// The fields of text in a message.
    fn texts(&self, data: &Format) -> impl Iterator<Item = &Field> {
        let format = self.formats.get(&heard(&data.name));
        format.into_iter().flat_map(format::Format::texts)
    }

    fn for_each(
        &self,
        only: Option<&str>,
        mut visit: impl FnMut(String, i64, &Format),
    ) -> Result<()> {
        let mut parser = ULogParserBuilder::new(self.bytes.as_slice());
        if let Some(topic) = only {
            parser = parser.set_subscription_allow_list([topic]);
        }
        let parser = parser.build().map_err(|error| anyhow!("{}: {error}", self.file))?;
        for (number, message) in parser.enumerate() {
            let message =
                message.map_err(|error| anyhow!("{}: message {number}: {error}", self.file))?;
            if let UlogMessage::LoggedData(logged) = message {
                let name = match logged.data.multi_id_index.unwrap_or(0) {
                    0 => logged.data.name.to_string(),
                    instance => format!("{}:{instance}", logged.data.name),
                };
                visit(heard(&name), logged.timestamp as i64, &logged.data);
            }
        }
        Ok(())
    }
}

/// The parser prints every format whose name holds `heartbeat` on standard output, where our tables go.
/// So it gets to see another name of the same length, and only we the right one.
const HEARTBEAT: (&str, &str) = ("heartbeat", "HEARTBEAT");

fn silence_heartbeats(bytes: &mut [u8]) {
    let mut at = HEADER;
    while let Some(&[low, high, kind]) = bytes.get(at..at + 3) {
        let end = (at + 3 + usize::from(u16::from_le_bytes([low, high]))).min(bytes.len());
        // Definitions of formats and subscriptions to them.
        if matches!(kind, b'F' | b'A') {
            rename(&mut bytes[at + 3..end]);
        }
        at = end;
    }
}

fn rename(message: &mut [u8]) {
    let (from, to) = (HEARTBEAT.0.as_bytes(), HEARTBEAT.1.as_bytes());
    while let Some(place) = message.windows(from.len()).position(|window| window == from) {
        message[place..place + to.len()].copy_from_slice(to);
    }
}

fn heard(name: &str) -> String {
    name.replace(HEARTBEAT.1, HEARTBEAT.0)
}

/// Fields of one topic of a log.
pub(super) struct Channel {
    all: Chunk,
    taken: usize,
    origin: Vec<(&'static str, String)>,
    notes: Vec<String>,
}

impl Channel {
    pub(super) fn open(options: &InputOptions) -> Result<Self> {
        let log = Log::read(&options.input, options.accept_cut)?;
        let file = &log.file;
        let asked: Vec<&str> = options.fields().collect();
        let Some(topic) = options.topic.as_ref().filter(|_| !asked.is_empty()) else {
            bail!("{file}: a flight log needs `topic` and `field`; `spikewire info` lists them");
        };
        let name = topic.strip_suffix(":0").unwrap_or(topic);
        let mut all = Chunk::default();
        all.clear(asked.len());
        let mut places = Vec::new();
        let (mut fields, mut texts) = (Vec::new(), Vec::new());
        let parsed = name.split(':').next().unwrap_or(name).replace(HEARTBEAT.0, HEARTBEAT.1);
        log.for_each(Some(&parsed), |instance, time, data| {
            if instance != name {
                return;
            }
            let numbers = leaves(data);
            if fields.is_empty() {
                let place = |asked: &&str| numbers.iter().position(|(name, _)| name == asked);
                places = asked.iter().map(place).collect();
                fields = numbers.iter().map(|(name, _)| name.clone()).collect();
                texts = log.texts(data).map(|field| field.name.clone()).collect();
            }
            let value = |place: &Option<usize>| numbers.get((*place)?).map(|(_, value)| *value);
            let Some(values) = places.iter().map(value).collect::<Option<Vec<f64>>>() else {
                return;
            };
            for (column, value) in all.columns.iter_mut().zip(values) {
                column.push(value);
            }
            all.times.push(time);
        })?;
        if fields.is_empty() {
            let topics = log.topics()?;
            bail!("{file}: no topic `{topic}`; {}", near(topic, topics.keys().map(String::as_str)));
        }
        if let Some((field, _)) = asked.iter().zip(&places).find(|(_, place)| place.is_none()) {
            if texts.iter().any(|text| text == field.split('[').next().unwrap_or(field)) {
                bail!("{file}: topic {name}: field `{field}` is text, not a signal");
            }
            let near = near(field, fields.iter().map(String::as_str));
            bail!("{file}: topic {name} has no field `{field}`; {near}");
        }
        for (field, column) in asked.iter().zip(&all.columns) {
            let not_finite = column.iter().position(|value| !value.is_finite());
            if let Some(at) = not_finite.filter(|_| !options.skip_non_finite) {
                bail!(
                    "{file}: topic {name}, field {field}: {} at {} µs (sample {at}) is not finite; \
                     `skip_non_finite` goes on over such values",
                    column[at],
                    all.times[at]
                );
            }
        }
        let origin = vec![("topic", name.to_owned()), ("field", asked.join(","))];
        let notes = log.findings.to_string().lines().map(str::to_owned).collect();
        Ok(Self { all, taken: 0, origin, notes })
    }
}

impl Source for Channel {
    fn next(&mut self, chunk: &mut Chunk) -> Result<()> {
        let end = self.all.len().min(self.taken + CHUNK);
        chunk.clear(self.all.columns.len());
        for (column, all) in chunk.columns.iter_mut().zip(&self.all.columns) {
            column.extend_from_slice(&all[self.taken..end]);
        }
        chunk.times.extend_from_slice(&self.all.times[self.taken..end]);
        self.taken = end;
        Ok(())
    }

    fn origin(&self) -> &[(&'static str, String)] {
        &self.origin
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }
}

/// All numbers of a message by name: `field`, `array[0]`, `nested.field`.
fn leaves(data: &Format) -> Vec<(String, f64)> {
    let mut numbers = Vec::new();
    for field in &data.fields {
        add(&heard(&field.name), &field.value, &mut numbers);
    }
    numbers
}

fn add(name: &str, value: &FieldValue, numbers: &mut Vec<(String, f64)>) {
    let number = match value {
        FieldValue::ScalarU8(value) => f64::from(*value),
        FieldValue::ScalarU16(value) => f64::from(*value),
        FieldValue::ScalarU32(value) => f64::from(*value),
        FieldValue::ScalarU64(value) => *value as f64,
        FieldValue::ScalarI8(value) => f64::from(*value),
        FieldValue::ScalarI16(value) => f64::from(*value),
        FieldValue::ScalarI32(value) => f64::from(*value),
        FieldValue::ScalarI64(value) => *value as f64,
        FieldValue::ScalarF32(value) => f64::from(*value),
        FieldValue::ScalarF64(value) => *value,
        FieldValue::ScalarBool(value) => f64::from(u8::from(*value)),
        // Text is not a signal.
        FieldValue::ScalarChar(_) | FieldValue::ArrayChar(_) => return,
        FieldValue::ScalarOther(nested) => {
            for (inner, number) in leaves(nested) {
                numbers.push((format!("{name}.{inner}"), number));
            }
            return;
        }
        array => {
            for (index, value) in array.to_scalars().unwrap_or_default().iter().enumerate() {
                add(&format!("{name}[{index}]"), value, numbers);
            }
            return;
        }
    };
    numbers.push((name.to_owned(), number));
}
