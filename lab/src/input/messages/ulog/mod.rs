//! PX4 flight logs, which are read as a whole: a topic each for what is registered, later instances as `topic:1`.

mod scan;

use super::bytes::Bytes;
use super::faults::Faults;
use super::topic::Topic;
use super::{Entry, Log};
use anyhow::{Context, Result, bail};
use scan::{DATA, HEADER, Scan, Series};
use std::ops::Range;
use std::path::Path;

/// The first bytes of a log.
pub(super) const START: &[u8] = b"ULog";

/// A log, all in memory.
pub(super) struct Ulog {
    bytes: Vec<u8>,
    topics: Vec<Topic>,
    /// More about each of the topics.
    series: Vec<Series>,
    /// The good messages of data in their order: which topic, and where in the file.
    messages: std::vec::IntoIter<(usize, usize)>,
    /// The content of the present message.
    present: Range<usize>,
    faults: Faults,
}

impl Ulog {
    /// Reads a log and sees to it that it is whole.
    pub(super) fn open(path: &Path, mut faults: Faults) -> Result<Self> {
        let file = path.display();
        let mut bytes = Vec::new();
        Bytes::open(path)?
            .take(u64::MAX, &mut bytes)
            .with_context(|| format!("{file}: cannot be read"))?;
        if bytes.is_empty() {
            bail!("{file}: empty");
        }
        if bytes.len() < HEADER || !bytes.starts_with(START) {
            bail!("{file}: not a flight log; ULog files start with `ULog` and 12 bytes more");
        }
        let Scan { topics, series, messages, findings, .. } = Scan::run(&bytes);
        let length = bytes.len();
        if !faults.is_accepted() {
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
        findings.to_string().lines().for_each(|line| faults.note(line.to_owned()));
        Ok(Self { bytes, topics, series, messages: messages.into_iter(), present: 0..0, faults })
    }
}

impl Log for Ulog {
    fn next(&mut self) -> Result<Option<Entry>> {
        let Some((topic, at)) = self.messages.next() else { return Ok(None) };
        let series = &self.series[topic];
        self.present = at + DATA..at + DATA + series.lengths.0;
        let time = self.topics[topic].number(&series.time, self.message());
        let time = time.ok().flatten().unwrap_or_default() as i64;
        Ok(Some(Entry { topic, time: time.saturating_mul(1000), at: at as u64, sequence: None }))
    }

    fn topics(&self) -> &[Topic] {
        &self.topics
    }

    fn message(&self) -> &[u8] {
        &self.bytes[self.present.clone()]
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }
}
