//! PX4 flight logs.

use super::{CHUNK, Chunk, InputOptions, Source, near};
use anyhow::{Context, Result, anyhow, bail};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use yule_log::builder::ULogParserBuilder;
use yule_log::model::inst::{FieldValue, Format};
use yule_log::model::msg::UlogMessage;

/// The bytes of a flight log, whole messages only.
pub(crate) struct Log {
    bytes: Vec<u8>,
    file: String,
}

/// What a log holds of one instance of a topic.
#[derive(Debug, Default)]
pub(crate) struct Topic {
    /// Its fields of numbers.
    pub fields: Vec<String>,
    /// When it was logged, in µs.
    pub times: Vec<i64>,
}

impl Log {
    /// Reads a log and sees to it that it is whole.
    ///
    /// # Errors
    /// It is not a flight log, or cut short and that was not accepted.
    pub(crate) fn read(path: &Path, accept_cut: bool) -> Result<Self> {
        let file = path.display().to_string();
        let mut bytes = fs::read(path).with_context(|| format!("{file}: cannot be read"))?;
        if bytes.is_empty() {
            bail!("{file}: empty");
        }
        if bytes.len() < HEADER || &bytes[..4] != b"ULog" {
            bail!("{file}: not a flight log; ULog files start with `ULog` and 12 bytes more");
        }
        let whole = whole_messages(&bytes);
        if whole < bytes.len() {
            if !accept_cut {
                bail!(
                    "{file}: cut short within the message at byte {whole} of {}; --accept-cut takes what is before",
                    bytes.len()
                );
            }
            bytes.truncate(whole);
        }
        silence_heartbeats(&mut bytes);
        Ok(Self { bytes, file })
    }

    /// What the log holds, by topic; later instances as `topic:1`.
    ///
    /// # Errors
    /// A message that cannot be read.
    pub(crate) fn topics(&self) -> Result<BTreeMap<String, Topic>> {
        let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
        self.for_each(None, |name, time, data| {
            let topic = topics.entry(name).or_insert_with(|| Topic {
                fields: leaves(data).into_iter().map(|(name, _)| name).collect(),
                times: Vec::new(),
            });
            topic.times.push(time);
        })?;
        Ok(topics)
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

/// The length of the file's header.
const HEADER: usize = 16;

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

/// Where the last whole message ends. Each starts with its length in two bytes and its kind in one.
fn whole_messages(bytes: &[u8]) -> usize {
    let mut at = HEADER;
    while let Some(length) = bytes.get(at..at + 2) {
        let end = at + 3 + usize::from(u16::from_le_bytes([length[0], length[1]]));
        if end > bytes.len() {
            break;
        }
        at = end;
    }
    at
}

/// One field of one topic of a log.
pub(super) struct Channel {
    chunk: Chunk,
    taken: usize,
    origin: Vec<(&'static str, String)>,
}

impl Channel {
    pub(super) fn open(options: &InputOptions) -> Result<Self> {
        let log = Log::read(&options.input, options.accept_cut)?;
        let file = &log.file;
        let (Some(topic), Some(field)) = (&options.topic, &options.field) else {
            bail!("{file}: a flight log needs --topic and --field; `spikewire info` lists them");
        };
        let name = topic.strip_suffix(":0").unwrap_or(topic);
        let mut chunk = Chunk::default();
        let mut place = None;
        let mut fields = Vec::new();
        let parsed = name.split(':').next().unwrap_or(name).replace(HEARTBEAT.0, HEARTBEAT.1);
        log.for_each(Some(&parsed), |instance, time, data| {
            if instance != name {
                return;
            }
            let numbers = leaves(data);
            if fields.is_empty() {
                place = numbers.iter().position(|(name, _)| name == field);
                fields = numbers.iter().map(|(name, _)| name.clone()).collect();
            }
            if let Some((_, value)) = place.and_then(|place| numbers.get(place)) {
                chunk.times.push(time);
                chunk.values.push(*value);
            }
        })?;
        if fields.is_empty() {
            let topics = log.topics()?;
            bail!("{file}: no topic `{topic}`; {}", near(topic, topics.keys().map(String::as_str)));
        }
        if place.is_none() {
            let near = near(field, fields.iter().map(String::as_str));
            bail!("{file}: topic {name} has no field `{field}`; {near}");
        }
        let not_finite = chunk.values.iter().position(|value| !value.is_finite());
        if let Some(at) = not_finite.filter(|_| !options.skip_non_finite) {
            bail!(
                "{file}: topic {name}, field {field}: {} at {} µs (sample {at}) is not finite; \
                 --skip-non-finite goes on over such values",
                chunk.values[at],
                chunk.times[at]
            );
        }
        let origin = vec![("topic", name.to_owned()), ("field", field.clone())];
        Ok(Self { chunk, taken: 0, origin })
    }
}

impl Source for Channel {
    fn next(&mut self, chunk: &mut Chunk) -> Result<()> {
        let end = self.chunk.values.len().min(self.taken + CHUNK);
        chunk.values.clear();
        chunk.times.clear();
        chunk.values.extend_from_slice(&self.chunk.values[self.taken..end]);
        chunk.times.extend_from_slice(&self.chunk.times[self.taken..end]);
        self.taken = end;
        Ok(())
    }

    fn origin(&self) -> &[(&'static str, String)] {
        &self.origin
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
