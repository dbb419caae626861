//! Reads PX4's `ULog` files. The whole file is held in memory. Each message type that the log registers is a topic.
//! Further instances of a sensor have topics such as `sensor_accel:1`.

mod scan;

use super::bytes::Bytes;
use super::faults::Faults;
use super::topic::Topic;
use super::{Entry, Log};
use crate::{Damage, Error, ErrorKind, Result};
use scan::{DATA, HEADER, Scan, Series};
use std::ops::Range;
use std::path::Path;

/// First bytes of a `ULog` file.
pub(crate) const START: &[u8] = b"ULog";

/// Error text for a file with the extension `.ulg` that does not start as `ULog` files do.
pub(crate) const OTHER: &str = "not a flight log; ULog files start with `ULog` and 12 bytes more";

/// Error text for a log with a flag that this reader does not know, and that forbids to read the log without knowing it.
const INCOMPATIBLE: &str = "a ULog file with an incompatible flag that is not known: it cannot be read by programs that \
    know only the flag of appended data";

/// Reader of a `ULog` file, which is held in memory.
pub(crate) struct Ulog {
    bytes: Vec<u8>,
    topics: Vec<Topic>,
    /// Layouts of the topics' messages, in the same order as `topics`.
    series: Vec<Series>,
    /// Valid data messages that are still to be read: index of the topic, and offset in the file.
    messages: std::vec::IntoIter<(usize, usize)>,
    /// Range in `bytes` of the current message's content.
    present: Range<usize>,
    faults: Faults,
}

impl Ulog {
    /// Reads a whole log, and notes its faults.
    ///
    /// # Errors
    /// Returns an error if the file is not a `ULog` file, or if it is damaged and damage is refused.
    pub(crate) fn open(path: &Path, mut faults: Faults) -> Result<Self> {
        let refused = |kind| Err(Error::of(path, kind));
        let mut bytes = Vec::new();
        let read = Bytes::open(path)?.take(u64::MAX, &mut bytes);
        read.map_err(|error| Error::of(path, ErrorKind::Read(error)))?;
        if bytes.is_empty() {
            return refused(ErrorKind::Empty);
        }
        if bytes.len() < HEADER || !bytes.starts_with(START) {
            return refused(ErrorKind::NotALog(OTHER.to_owned()));
        }
        if Scan::is_incompatible(&bytes) {
            return refused(ErrorKind::Unsupported(INCOMPATIBLE.to_owned()));
        }
        let Scan { topics, series, messages, findings, .. } = Scan::run(&bytes);
        if faults.damage() == Damage::Refuse {
            let length = bytes.len() as u64;
            if let Some(Range { start, end }) = findings.damage {
                let (at, next) = (start as u64, end as u64);
                return refused(ErrorKind::Damaged { at, length, next });
            }
            if let Some(cut) = findings.cut {
                return refused(ErrorKind::Cut { at: cut as u64, length });
            }
        }
        if let Some(blank) = findings.blank {
            faults.blank(blank as u64, (bytes.len() - blank) as u64);
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
