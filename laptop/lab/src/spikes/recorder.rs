//! Records spikes as messages in a ROS 1 bag or an MCAP file. The topic `event` has one message for each sample. Its
//! messages are those of the toolbox that belongs to the paper *A toolbox for neuromorphic perception in robotics*.
//!
//! A single message on the topic `event_header` holds the header of a file of spikes as text. With this header, every
//! scheme can be decoded. The channels after the first are on the topics `event_1`, `event_2` and so on.

use super::bag::Bag;
use super::mcap::Mcap;
use super::spyke::{self, Kind, Spyke};
use super::{Header, Record, SpikesKind, Summary};
use crate::Result;
use crate::input::{Chunk, Step};
use crate::output::{Output, is_table};
use catalogue::run::Event;
use catalogue::toolbox::published;
use spikewire::Polarity;
use std::collections::VecDeque;
use std::path::Path;
use std::time::Duration;

/// A topic of a log that is being written.
pub(super) struct Topic {
    pub name: String,
    pub kind: Kind,
}

/// A log that is being written, in any format.
pub(super) trait Container {
    /// Appends a message on the topic of index `topic`, at a time in ns.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    fn add(&mut self, topic: usize, nanoseconds: u64, message: &[u8]) -> Result<()>;

    /// Writes the end of the log. Returns the output, which the caller must finish.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    fn finish(self: Box<Self>) -> Result<Output>;
}

/// The file format of recorded messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A ROS 1 bag.
    Bag,
    /// An MCAP file with messages of ROS 2.
    Mcap,
}

impl Format {
    /// Returns the format of a log, by the file's name. Returns `None` if the name is that of a table.
    ///
    /// # Errors
    /// Returns an error if the name has neither the ending of a log nor that of a table.
    pub fn of(path: &Path) -> Result<Option<Self>> {
        match path.extension().and_then(|own| own.to_str()) {
            Some("bag") => Ok(Some(Self::Bag)),
            Some("mcap") => Ok(Some(Self::Mcap)),
            _ => is_table(path, ", .bag (ROS 1) and .mcap (ROS 2)").map(|()| None),
        }
    }
}

/// A writer of spikes to a log of messages.
pub struct Recorder {
    container: Box<dyn Container>,
    format: Format,
    kind: Kind,
    /// For each channel, a template of its messages, with the content that does not change from sample to sample.
    empty: Vec<Spyke>,
    /// The header's lines, until they have been written.
    header: Option<String>,
    neurons: usize,
    /// Time between samples in µs, if the recording has no times.
    period: Option<f64>,
    /// Samples that are not written yet.
    pending: VecDeque<Pending>,
    /// Number of finite samples written so far. Encoders number samples by counting finite samples.
    finite: u64,
    /// Events that are not written yet, in the order of their samples.
    events: VecDeque<Event>,
    summary: Summary,
}

struct Pending {
    time: Duration,
    inputs: Vec<f64>,
    is_finite: bool,
}

/// Limit on the time of a message, in µs. All times must be below this limit, because a message stores the seconds in
/// 32 bits.
const LATEST: u64 = (1 << 32) * 1_000_000;
/// Topic of the first channel's spikes. The toolbox of the paper *A toolbox for neuromorphic perception in robotics*
/// uses the same name.
pub(super) const EVENT: &str = "event";
/// Topic of the header.
pub(super) const HEADER: &str = "event_header";

impl Recorder {
    /// Starts a log; `ranges` holds the smallest and largest sample of each channel.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written, or if the samples have neither times nor a rate.
    pub fn new(
        output: Output,
        format: Format,
        header: &Header,
        is_timed: bool,
        ranges: &[(f64, f64)],
    ) -> Result<Self> {
        let period =
            if is_timed { None } else { Some(1e6 / header.rate.ok_or(SpikesKind::Untimed)?) };
        let shape = header.scheme.shape(header.channels.first().ok_or(SpikesKind::NoChannel)?)?;
        let kind = if shape.neurons * shape.slots > 1 { Kind::SpykeArray } else { Kind::Spyke };
        let mut topics: Vec<Topic> = (0..header.channels.len())
            .map(|channel| Topic {
                name: if channel == 0 { EVENT.to_owned() } else { format!("{EVENT}_{channel}") },
                kind,
            })
            .collect();
        topics.push(Topic { name: HEADER.to_owned(), kind: Kind::String });
        let empty = header.channels.iter().zip(ranges).map(|(settings, &(min, max))| Spyke {
            spikes: vec![0; shape.neurons * shape.slots],
            start: settings.first_value().unwrap_or_default() as f32,
            range: (min as f32, max as f32),
            threshold: settings.number("threshold").unwrap_or_default() as f32,
            scheme: published(header.scheme.name()),
            ..Spyke::default()
        });
        let empty: Vec<Spyke> = empty.collect();
        let lines = header.lines().into_iter().map(|(key, value)| format!("{key}={value}\n"));
        Ok(Self {
            container: match format {
                Format::Bag => Box::new(Bag::new(output, topics)?),
                Format::Mcap => Box::new(Mcap::new(output, topics)?),
            },
            format,
            kind,
            empty,
            header: Some(lines.collect()),
            neurons: shape.neurons,
            period,
            pending: VecDeque::new(),
            finite: 0,
            events: VecDeque::new(),
            summary: Summary::default(),
        })
    }

    /// Writes the messages of a sample, one for each channel.
    fn sample(&mut self, pending: &Pending) -> Result<()> {
        let nanoseconds = pending.time.as_nanos() as u64;
        if let Some(header) = self.header.take() {
            let message = spyke::text(&header, self.format);
            self.container.add(self.empty.len(), nanoseconds, &message)?;
        }
        let mut messages = self.empty.clone();
        for (message, input) in messages.iter_mut().zip(&pending.inputs) {
            (message.input, message.time) = (*input as f32, pending.time);
        }
        while let Some(event) = self.events.front().copied()
            && pending.is_finite
            && event.sample == self.finite
        {
            self.events.pop_front();
            let (channel, neuron) = (
                usize::from(event.neuron) / self.neurons,
                usize::from(event.neuron) % self.neurons,
            );
            let place = usize::from(event.slot) * self.neurons + neuron;
            let spike = if event.polarity == Polarity::Up { 1 } else { -1 };
            if let Some(own) = messages.get_mut(channel).and_then(|own| own.spikes.get_mut(place)) {
                *own = own.saturating_add(spike);
            }
            self.summary.events += 1;
        }
        self.finite += u64::from(pending.is_finite);
        for (channel, message) in messages.iter().enumerate() {
            let bytes = message.bytes(self.kind, self.format);
            self.container.add(channel, nanoseconds, &bytes)?;
        }
        Ok(())
    }
}

impl Record for Recorder {
    fn observe(&mut self, chunk: &mut Chunk, _: &[Step]) -> Result<()> {
        let rows = chunk.finite_rows();
        for (row, &is_finite) in rows.iter().enumerate() {
            let microseconds = match self.period {
                Some(period) => (self.summary.samples as f64 * period).round() as i64,
                None => chunk.times[row],
            };
            let time = u64::try_from(microseconds).ok().filter(|time| *time < LATEST);
            let Some(time) = time else {
                return Err(SpikesKind::Time { microseconds }.into());
            };
            let inputs = chunk.columns.iter().map(|column| column[row]).collect();
            self.pending.push_back(Pending {
                time: Duration::from_micros(time),
                inputs,
                is_finite,
            });
            self.summary.samples += 1;
            self.summary.rejected += u64::from(!is_finite);
        }
        if rows.contains(&false) {
            chunk.columns = chunk.kept(&rows);
        }
        Ok(())
    }

    fn write(&mut self, events: &mut Vec<Event>, decided: u64) -> Result<()> {
        events.sort_by_key(|event| event.sample);
        self.events.extend(events.drain(..));
        while let Some(pending) = self.pending.pop_front() {
            if pending.is_finite && self.finite >= decided {
                self.pending.push_front(pending);
                break;
            }
            self.sample(&pending)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, events: &mut Vec<Event>) -> Result<(Output, Summary)> {
        self.write(events, u64::MAX)?;
        Ok((self.container.finish()?, self.summary))
    }
}
