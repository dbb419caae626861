//! Reads spikes from logs of messages. The logs were written by this library, or by the toolbox that belongs to the
//! paper *A toolbox for neuromorphic perception in robotics*.

use super::recorder::{EVENT, HEADER};
use super::{Header, Item, Spikes, SpikesKind};
use crate::error::At;
use crate::input::messages::damage;
use crate::{Error, Place, Result};
use catalogue::run::Event;
use catalogue::toolbox::{GAUSSIAN_FIELDS, meant};
use flight_logs::{Kind, Reading};
use spikewire::Polarity;
use std::collections::VecDeque;
use std::path::Path;

/// A log of spikes that is read from its start to its end.
pub struct Messages {
    log: Reading,
    /// For each channel, its topic and the number of samples read so far.
    channels: Vec<(String, u64)>,
    /// Number of neurons of each channel.
    neurons: usize,
    /// Number of sub-timesteps (slots) of each sample.
    slots: usize,
    is_signed: bool,
    /// Whether the log has a header. Only logs that this library wrote have one. In such a log, the field `input` of a
    /// message is missing or NaN if the message's sample was not encoded.
    has_header: bool,
    items: VecDeque<Item>,
}

impl Messages {
    /// Opens a log, and returns a header with the scheme and settings of its spikes. If the log contains no header,
    /// makes one from the parameters in the messages.
    ///
    /// # Errors
    /// Returns an error if the log has no spikes, or if its messages lack a parameter that decoding needs.
    pub fn open(path: &Path, kind: Kind, accept_cut: bool) -> Result<(Self, Header)> {
        let file = path.display().to_string();
        let found = Found::read(Reading::open(path, kind, damage(accept_cut))?)?;
        let lines = found.lines().at(|| &file)?;
        let header = Header::parse(lines).at(|| &file)?;
        let settings = header.channels.first().ok_or(SpikesKind::NoChannel)?;
        let shape = header.scheme.shape(settings).at(|| &file)?;
        let topic = |channel: usize| match channel {
            0 => found.topic.clone(),
            _ => format!("{}_{channel}", found.topic),
        };
        let messages = Self {
            log: Reading::open(path, kind, damage(accept_cut))?,
            channels: (0..header.channels.len()).map(|channel| (topic(channel), 0)).collect(),
            neurons: shape.neurons,
            slots: shape.slots,
            is_signed: header.scheme.info().is_signed,
            has_header: found.header.is_some(),
            items: VecDeque::new(),
        };
        Ok((messages, header))
    }

    /// Converts the current message to items. The message belongs to the channel with the number `channel`.
    fn take(&mut self, channel: usize) -> Result<()> {
        let (neurons, slots) = (self.neurons, self.slots);
        let sample = self.channels[channel].1;
        self.channels[channel].1 += 1;
        if channel > 0 && self.channels[0].1 != sample + 1 {
            return Err(SpikesKind::OutOfOrder { sample }.at(self.place()));
        }
        let is_rejected = self.has_header && self.log.number("input")?.is_none_or(f64::is_nan);
        if is_rejected && channel == 0 {
            self.items.push_back(Item::Rejected { first: sample, count: 1 });
        }
        if is_rejected {
            return Ok(());
        }
        if channel == 0 {
            self.items.push_back(Item::Time { sample, time: self.log.time()? });
        }
        for place in 0..neurons * slots {
            let Some(spikes) = spike(&self.log, place, neurons * slots)? else {
                return Err(SpikesKind::Neurons { neurons: neurons * slots }.at(self.place()));
            };
            let polarity = if spikes > 0 { Polarity::Up } else { Polarity::Down };
            if spikes < 0 && !self.is_signed {
                return Err(SpikesKind::Negative { spikes }.at(self.place()));
            }
            let neuron = (channel * neurons + place % neurons) as u16;
            let event = Event { sample, neuron, slot: (place / neurons) as u16, polarity };
            let item = || Item::Event { event, time: None };
            self.items.extend((0..spikes.unsigned_abs()).map(|_| item()));
        }
        Ok(())
    }
}

impl Spikes for Messages {
    fn is_timed(&self) -> bool {
        true
    }

    fn next(&mut self) -> Result<Item> {
        loop {
            if let Some(item) = self.items.pop_front() {
                return Ok(item);
            }
            if !self.log.advance()? {
                let samples = self.channels.first().map_or(0, |(_, samples)| *samples);
                return Ok(Item::End { samples });
            }
            let own = self.channels.iter().position(|(topic, _)| *topic == self.log.topic());
            if let Some(channel) = own {
                self.take(channel)?;
            }
        }
    }

    fn place(&self) -> Place {
        Place::of(self.log.place())
    }

    fn notes(&mut self) -> Vec<String> {
        self.log.notes()
    }
}

/// Reads one spike of a message. `place` is the index of the spike, counted from 0. `of` is the number of spikes in the
/// message, or `usize::MAX` if unknown. If the message has one spike, the field `spike` is a number. If the message has
/// several spikes, the field `spike` is an array. Returns `None` if `place` is beyond the last spike.
///
/// # Errors
/// Returns an error if the message has no field `spike`.
fn spike(log: &Reading, place: usize, of: usize) -> Result<Option<i8>> {
    let number = match (log.has_number("spike"), place, of) {
        (true, 0, 1 | usize::MAX) => log.number("spike")?,
        (true, ..) => None,
        (false, ..) => log.number(&format!("spike[{place}]"))?,
    };
    Ok(number.map(|number| number as i8))
}

/// Facts about a log's spikes, collected in a first pass over the log.
#[derive(Default)]
struct Found {
    topic: String,
    /// Text of the header, in logs that this library wrote.
    header: Option<String>,
    scheme: String,
    /// Value from which decoding starts, as given in the topic's first message.
    start: f64,
    range: (f64, f64),
    neurons: usize,
    first: i64,
    /// Sum of the thresholds in all messages. As in the paper's toolbox, decoding uses the mean threshold.
    thresholds: f64,
    samples: u64,
    last: i64,
}

impl Found {
    fn read(mut log: Reading) -> Result<Self> {
        let mut found = Self::default();
        while log.advance()? {
            if log.topic() == HEADER {
                found.header = Some(text(&log, "data")?);
                EVENT.clone_into(&mut found.topic);
                return Ok(found);
            }
            // The toolbox publishes on the topic `event`; a renamed topic is known by its message type.
            let kind = log.kind().rsplit('/').next().unwrap_or_default().to_owned();
            let is_spyke = ["spyke", "spyke_array", "Spyke", "SpykeArray"].contains(&kind.as_str());
            if !is_spyke || (found.samples > 0 && found.topic != log.topic()) {
                continue;
            }
            let number = |name| log.number(name)?.ok_or_else(|| lacks(&log, name));
            if found.samples == 0 {
                log.topic().clone_into(&mut found.topic);
                found.scheme = text(&log, "scheme")?;
                found.start = number("start")?;
                found.range = (number("min_input")?, number("max_input")?);
                found.first = log.time()?;
                while spike(&log, found.neurons, usize::MAX)?.is_some() && found.neurons < MOST {
                    found.neurons += 1;
                }
            }
            found.thresholds += number("threshold")?;
            found.samples += 1;
            found.last = log.time()?;
        }
        if found.samples == 0 {
            return Err(SpikesKind::NoMessages { topic: EVENT }.at(log.file()));
        }
        Ok(found)
    }

    /// Returns the keys and values of a header for the spikes.
    fn lines(&self) -> Result<Vec<(String, String)>> {
        if let Some(header) = &self.header {
            let pairs = header.lines().filter_map(|line| line.split_once('='));
            return Ok(pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect());
        }
        let scheme = meant(&self.scheme);
        let threshold = self.thresholds / self.samples as f64;
        let line = |key: &str, value: String| (key.to_owned(), value);
        let own = match scheme {
            // The toolbox decodes from 0 on, and doubles the result.
            "tbr" => vec![
                line("threshold", threshold.to_string()),
                line("step", (2.0 * threshold).to_string()),
                line("first", "0".to_owned()),
            ],
            "sf" => vec![
                line("threshold", threshold.to_string()),
                line("first", self.start.to_string()),
            ],
            "mw" => vec![
                line("threshold", threshold.to_string()),
                line("window", "1".to_owned()),
                line("first", self.start.to_string()),
            ],
            "grf" => {
                let (min, max) = self.range;
                let field = (max - min) / (self.neurons.saturating_sub(2).max(1)) as f64;
                // The range in which this crate's neurons have the same centres as the toolbox's neurons.
                let lower = if self.scheme == GAUSSIAN_FIELDS { field } else { 0.0 };
                vec![
                    line("neurons", self.neurons.to_string()),
                    line("min", (min - lower).to_string()),
                    line("max", (max - lower).to_string()),
                ]
            }
            other => {
                let scheme = other.to_owned();
                return Err(SpikesKind::NotEnough { scheme, topic: HEADER }.into());
            }
        };
        let mut lines = vec![
            line("spikewire", "1".to_owned()),
            line("scheme", scheme.to_owned()),
            line("sample", "f32".to_owned()),
        ];
        lines.extend(own);
        let microseconds = self.last.saturating_sub(self.first) as f64;
        if microseconds > 0.0 {
            let rate = (self.samples - 1) as f64 * 1e6 / microseconds;
            lines.push(line("rate", rate.to_string()));
        }
        Ok(lines)
    }
}

/// Reads the text of the field `name`.
fn text(log: &Reading, name: &'static str) -> Result<String> {
    log.text(name).ok_or_else(|| lacks(log, name))
}

/// Makes the error for a message that lacks the field `name`.
fn lacks(log: &Reading, name: &'static str) -> Error {
    SpikesKind::NoField { name }.at(log.place())
}

/// Maximum number of neurons: the number of possible addresses.
const MOST: usize = 1 << 16;

#[cfg(test)]
mod tests {
    use super::Found;

    /// A log with the toolbox's scheme `gaussian_fields` is decoded as GRF over a lower range. The toolbox counts its
    /// neurons from 0 in the formula of the centres, and this crate from 1. Thus each centre of the toolbox is lower by
    /// the distance between two neighbouring fields. For a log with the scheme `grf`, the range stays.
    #[test]
    fn the_toolbox_numbers_its_fields_from_0() {
        for (scheme, min, max) in [("gaussian_fields", "-1.5", "7.5"), ("grf", "-1", "8")] {
            let found = Found {
                scheme: scheme.to_owned(),
                range: (-1.0, 8.0),
                neurons: 20,
                samples: 1,
                ..Found::default()
            };
            let lines = found.lines().unwrap();
            let value = |key| lines.iter().find(|line| line.0 == key).map(|line| line.1.as_str());
            assert_eq!((value("scheme"), value("neurons")), (Some("grf"), Some("20")));
            assert_eq!((value("min"), value("max")), (Some(min), Some(max)));
        }
    }
}
