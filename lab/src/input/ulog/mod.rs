//! PX4 flight logs.

mod format;
mod scan;

pub(crate) use scan::Findings;

use super::text::GZIP;
use super::{CHUNK, Chunk, InputOptions, Source, near};
use crate::files;
use anyhow::{Context, Result, bail};
use flate2::read::MultiGzDecoder;
use scan::{HEADER, Scan, Scanned, Series};
use std::collections::BTreeMap;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

/// The messages of a flight log that can be read.
pub struct Log {
    bytes: Vec<u8>,
    series: Vec<Series>,
    messages: Vec<(usize, Range<usize>)>,
    file: String,
    /// Messages that were skipped, and what the logger missed.
    pub findings: Findings,
}

/// A summary of one instance of a topic.
#[derive(Debug, Default)]
pub struct Topic {
    /// Its fields of numbers.
    pub fields: Vec<String>,
    /// Its fields of text.
    pub texts: Vec<String>,
    /// The time at which it was logged, in µs.
    pub times: Vec<i64>,
}

impl Log {
    /// Reads a log and sees to it that it is whole.
    ///
    /// # Errors
    /// Returns an error if the file is no flight log, or is cut short and that is not accepted.
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
        let Scanned { series, messages, findings } = Scan::run(&bytes);
        let length = bytes.len();
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
        Ok(Self { bytes, series, messages, file, findings })
    }

    /// The log's topics by name; later instances as `topic:1`.
    pub fn topics(&self) -> BTreeMap<String, Topic> {
        let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
        self.for_each(None, |series, time, _| {
            let topic = topics.entry(series.name.clone()).or_insert_with(|| Topic {
                fields: series.numbers.iter().map(|(name, _)| name.clone()).collect(),
                texts: series.texts.clone(),
                times: Vec::new(),
            });
            topic.times.push(time);
        });
        topics
    }

    fn for_each<'a>(&'a self, only: Option<&str>, mut visit: impl FnMut(&'a Series, i64, &[u8])) {
        for (series, message) in &self.messages {
            let Some(series) = self.series.get(*series) else { continue };
            let message = &self.bytes[message.clone()];
            if only.is_none_or(|name| name == series.name)
                && let Some(time) = series.time.read_time(message)
            {
                visit(series, time, message);
            }
        }
    }
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
        let mut known: Option<&Series> = None;
        log.for_each(Some(name), |series, time, message| {
            let numbers = &series.numbers;
            // A topic may be registered again, in another format.
            if known.replace(series).is_none_or(|known| !std::ptr::eq(known, series)) {
                let place = |asked: &&str| numbers.iter().position(|(name, _)| name == asked);
                places = asked.iter().map(place).collect();
            }
            let value = |place: &Option<usize>| numbers.get((*place)?)?.1.read(message);
            let Some(values) = places.iter().map(value).collect::<Option<Vec<f64>>>() else {
                return;
            };
            for (column, value) in all.columns.iter_mut().zip(values) {
                column.push(value);
            }
            all.times.push(time);
        });
        let Some(Series { numbers, texts, .. }) = known else {
            let topics = log.topics();
            bail!("{file}: no topic `{topic}`; {}", near(topic, topics.keys().map(String::as_str)));
        };
        if let Some((field, _)) = asked.iter().zip(&places).find(|(_, place)| place.is_none()) {
            if texts.iter().any(|text| text == field.split('[').next().unwrap_or(field)) {
                bail!("{file}: topic {name}: field `{field}` is text, not a signal");
            }
            let near = near(field, numbers.iter().map(|(name, _)| name.as_str()));
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
