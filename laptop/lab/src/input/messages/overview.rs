//! Summarises a log: its topics, and the times of their messages.

use super::damage;
use crate::Result;
use crate::input::times::Times;
use crate::input::{Clock, Rollover};
use flight_logs::definition::Path as FieldPath;
use flight_logs::{Kind, Topic, microseconds, open};
use std::path::Path;

/// A summary of one topic of a log.
#[derive(Debug)]
pub struct Overview {
    /// Name of the topic.
    pub name: String,
    /// Type of the messages; empty if the log does not name the type.
    pub kind: String,
    /// Names of the fields that hold numbers.
    pub fields: Vec<String>,
    /// Names of the fields that hold text.
    pub texts: Vec<String>,
    /// Reason for which the topic's fields cannot be read. `None` if they can be read.
    pub unread: Option<String>,
    /// Number of messages of the topic.
    pub count: u64,
    /// The times of the messages: length, rate and gaps.
    pub clock: Clock,
    /// The wraps of the recorder's 32-bit clock: their number, and the sample before the first wrap.
    pub rollover: Rollover,
    /// Number of missing messages, according to the counter in the messages.
    pub missing: u64,
}

/// Summarises each topic of a log. Returns the summaries, sorted by name, and notes about the log.
///
/// # Errors
/// Returns an error if the log cannot be read.
pub fn overview(
    path: &Path,
    kind: Kind,
    accept_cut: bool,
    gap: f64,
) -> Result<(Vec<Overview>, Vec<String>)> {
    let mut log = open(path, kind, damage(accept_cut))?;
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
    let mut topics: Vec<Overview> = both.map(|(topic, own)| own.summary(topic)).collect();
    topics.sort_by(|a, b| (&a.name, &a.kind).cmp(&(&b.name, &b.kind)));
    Ok((topics, log.faults().notes()))
}

/// The state of one topic while its log is being summarised.
struct Watched {
    times: Times,
    count: u64,
    /// Position of the sequence number in the messages, if messages have a sequence number.
    counter: Option<FieldPath>,
    previous: Option<u32>,
    missing: u64,
}

impl Watched {
    fn new(topic: &Topic, gap: f64) -> Self {
        let definition = topic.definition.as_ref().ok();
        Self {
            times: Times::new(gap),
            count: 0,
            counter: definition.and_then(|own| own.number("header.seq").ok()),
            previous: None,
            missing: 0,
        }
    }

    fn observe(&mut self, time: i64) {
        self.times.observe(time);
        self.count += 1;
    }

    fn count(&mut self, sequence: u32) {
        let before = self.previous.replace(sequence);
        let step = before.map_or(1, |before| sequence.wrapping_sub(before));
        // A larger step means that the sequence began anew.
        if (2..1 << 16).contains(&step) {
            self.missing += u64::from(step - 1);
        }
    }

    fn summary(self, topic: &Topic) -> Overview {
        let (clock, rollover) = self.times.finish();
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
            rollover,
            missing: self.missing,
        }
    }
}
