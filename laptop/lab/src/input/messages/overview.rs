//! Summarises a log: its topics, and the times of their messages.

use super::damage;
use super::stamp::SensorStamp;
use crate::Result;
use crate::input::CHUNK;
use crate::input::clock::prefers_stamps;
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
    /// Name of the field with the sensor's own stamps, if the times are these. Otherwise, they are those of recording.
    pub stamp: Option<&'static str>,
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
        let topic = &log.topics()[entry.topic];
        own.observe(topic, log.message(), entry.time);
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
    stamp: Option<SensorStamp>,
    /// The times of recording and the sensor's own stamps of the first messages, until one of the two is chosen.
    first: Option<[Vec<i64>; 2]>,
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
            stamp: definition.and_then(SensorStamp::of),
            first: Some([Vec::new(), Vec::new()]),
            count: 0,
            counter: definition.and_then(|own| own.number("header.seq").ok()),
            previous: None,
            missing: 0,
        }
    }

    /// Takes the times of a message; `recorded` is that of recording, in ns.
    fn observe(&mut self, topic: &Topic, message: &[u8], recorded: i64) {
        let arrival = microseconds(recorded);
        let stamp = self.stamp.as_ref().map(|own| own.time.read(topic, message, recorded));
        let stamp = stamp.and_then(Result::ok);
        self.count += 1;
        let Some([arrivals, stamps]) = &mut self.first else {
            return self.times.observe(stamp.unwrap_or(arrival));
        };
        arrivals.push(arrival);
        stamps.extend(stamp);
        if arrivals.len() == CHUNK {
            self.choose_times();
        }
    }

    /// Decides by the first messages if the times are the sensor's own stamps, as for a channel that is read.
    fn choose_times(&mut self) {
        let Some([arrivals, stamps]) = self.first.take() else { return };
        let is_stamped = prefers_stamps(&stamps, &arrivals);
        if !is_stamped {
            self.stamp = None;
        }
        for time in if is_stamped { stamps } else { arrivals } {
            self.times.observe(time);
        }
    }

    fn count(&mut self, sequence: u32) {
        let before = self.previous.replace(sequence);
        let step = before.map_or(1, |before| sequence.wrapping_sub(before));
        // A larger step means that the sequence began anew.
        if (2..1 << 16).contains(&step) {
            self.missing += u64::from(step - 1);
        }
    }

    fn summary(mut self, topic: &Topic) -> Overview {
        self.choose_times();
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
            stamp: self.stamp.map(|stamp| stamp.name),
            clock,
            rollover,
            missing: self.missing,
        }
    }
}
