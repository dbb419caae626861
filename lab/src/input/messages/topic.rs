//! Topics of a log: what their messages hold, and an overview of how they came.

use super::definition::{Definition, Dialect, Path, Stamp};
use super::wire::{self, Fault, Wire};
use super::{Kind, open};
use crate::input::{CHUNK, Clock, Rollover};
use anyhow::Result;

/// A topic, and how its messages are read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Topic {
    pub name: String,
    /// The type of its messages.
    pub kind: String,
    pub wire: Wire,
    /// The definition of its messages, or the reason that they cannot be read.
    pub definition: Result<Definition, String>,
}

impl Topic {
    /// A topic whose messages have a definition in this dialect.
    pub(super) fn new(name: String, kind: String, dialect: Dialect, text: &str) -> Self {
        let wire = match dialect {
            Dialect::Ros1 | Dialect::Px4 => Wire::Ros1,
            Dialect::Ros2 => Wire::Cdr,
        };
        let definition = Definition::parse(&kind, text, dialect);
        Self { name, kind, wire, definition }
    }

    /// A topic whose messages cannot be read, and why.
    pub(super) fn unread(name: String, kind: String, why: String) -> Self {
        Self { name, kind, wire: Wire::Ros1, definition: Err(why) }
    }

    /// The index of the topic among others, to which it is added if it is new.
    pub(super) fn place_in(self, topics: &mut Vec<Self>) -> usize {
        let known = topics.iter().position(|own| *own == self);
        known.unwrap_or_else(|| {
            topics.push(self);
            topics.len() - 1
        })
    }

    /// A number of a message; none where an array is shorter than that.
    ///
    /// # Errors
    /// The message is not as its definition says.
    pub(super) fn number(&self, path: &Path, message: &[u8]) -> Result<Option<f64>, Fault> {
        match &self.definition {
            Ok(definition) => wire::number(self.wire, definition, path, message),
            Err(_) => Ok(None),
        }
    }

    /// Whether a message goes on behind its definition.
    pub(super) fn is_longer(&self, message: &[u8]) -> bool {
        self.definition.as_ref().is_ok_and(|own| wire::is_longer(self.wire, own, message))
    }

    /// A text of a message.
    pub(super) fn text(&self, field: &str, message: &[u8]) -> Option<String> {
        let definition = self.definition.as_ref().ok()?;
        wire::text(self.wire, definition, &definition.text(field)?, message)
    }

    /// A time in a message, in ns.
    ///
    /// # Errors
    /// The message is not as its definition says.
    pub(super) fn stamp(&self, stamp: &Stamp, message: &[u8]) -> Result<Option<i64>, Fault> {
        let read = |path| self.number(path, message);
        let parts = read(&stamp.seconds)?.zip(read(&stamp.nanoseconds)?);
        Ok(parts.map(|(seconds, nanoseconds)| seconds as i64 * 1_000_000_000 + nanoseconds as i64))
    }
}

/// A summary of one topic of a log.
#[derive(Debug)]
pub struct Overview {
    /// Its name.
    pub name: String,
    /// The type of its messages, if they have one.
    pub kind: String,
    /// Its fields of numbers.
    pub fields: Vec<String>,
    /// Its fields of text.
    pub texts: Vec<String>,
    /// The reason that its fields cannot be read.
    pub unread: Option<String>,
    /// Number of messages.
    pub count: u64,
    /// Its length, rate and gaps.
    pub clock: Clock,
    /// The times that its clock ran over.
    pub rollover: Rollover,
    /// Number of messages missing, by the numbers that they have.
    pub missing: u64,
}

/// Summarises a log by topic, with notes on all else.
///
/// # Errors
/// Returns an error if the log cannot be read.
pub fn overview(
    path: &std::path::Path,
    kind: Kind,
    accept_cut: bool,
    gap: f64,
) -> Result<(Vec<Overview>, Vec<String>)> {
    let mut log = open(path, kind, accept_cut)?;
    let mut watched: Vec<Watched> = Vec::new();
    while let Some(entry) = log.next()? {
        for topic in log.topics().iter().skip(watched.len()) {
            watched.push(Watched::new(topic, gap));
        }
        let own = &mut watched[entry.topic];
        own.observe(microseconds(entry.time));
        let topic = &log.topics()[entry.topic];
        let counted = match &own.counter {
            Some(path) => topic.number(path, log.message()).ok().flatten().map(|own| own as u32),
            None => entry.sequence,
        };
        if let Some(sequence) = counted {
            own.count(sequence);
        }
        if topic.is_longer(log.message()) {
            log.faults().long(entry.at);
        }
    }
    let both = log.topics().iter().zip(watched).filter(|(_, own)| own.count > 0);
    let mut topics: Vec<Overview> = both.map(|(topic, own)| own.told(topic)).collect();
    topics.sort_by(|a, b| (&a.name, &a.kind).cmp(&(&b.name, &b.kind)));
    Ok((topics, log.faults().notes()))
}

/// The time in whole µs, as the times of all recordings are.
pub(super) fn microseconds(nanoseconds: i64) -> i64 {
    nanoseconds.saturating_add(500).div_euclid(1000)
}

/// The messages of one topic as they come.
struct Watched {
    gap: f64,
    /// The first times, which tell what is usual.
    first: Vec<i64>,
    clock: Option<Clock>,
    rollover: Rollover,
    count: u64,
    /// The place of the number with which messages count themselves.
    counter: Option<Path>,
    previous: Option<u32>,
    missing: u64,
}

impl Watched {
    fn new(topic: &Topic, gap: f64) -> Self {
        let definition = topic.definition.as_ref().ok();
        Self {
            gap,
            first: Vec::new(),
            clock: None,
            rollover: Rollover::default(),
            count: 0,
            counter: definition.and_then(|own| own.number("header.seq").ok()),
            previous: None,
            missing: 0,
        }
    }

    fn observe(&mut self, time: i64) {
        let time = self.rollover.take(time);
        self.count += 1;
        if let Some(clock) = &mut self.clock {
            clock.observe(&[time]);
            return;
        }
        self.first.push(time);
        if self.first.len() == CHUNK {
            self.clock = Some(self.started());
            self.first = Vec::new();
        }
    }

    fn started(&self) -> Clock {
        let mut clock = Clock::new(&self.first, None, self.gap);
        clock.observe(&self.first);
        clock
    }

    fn count(&mut self, sequence: u32) {
        let before = self.previous.replace(sequence);
        let step = before.map_or(1, |before| sequence.wrapping_sub(before));
        // A larger step is a counter that began anew.
        if (2..1 << 16).contains(&step) {
            self.missing += u64::from(step - 1);
        }
    }

    fn told(mut self, topic: &Topic) -> Overview {
        let clock = self.clock.take().unwrap_or_else(|| self.started());
        let ((fields, texts), unread) = match &topic.definition {
            Ok(definition) => (definition.names(), None),
            Err(error) => (Default::default(), Some(error.clone())),
        };
        Overview {
            name: topic.name.clone(),
            kind: topic.kind.clone(),
            fields,
            texts,
            unread,
            count: self.count,
            clock,
            rollover: self.rollover,
            missing: self.missing,
        }
    }
}
