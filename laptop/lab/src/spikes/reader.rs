//! Reads a file of spikes line by line.

use super::{Header, Spikes, SpikesKind};
use crate::error::At;
use crate::input::shown;
use crate::{Error, Place, Result};
use catalogue::run::Event;
use spikewire::Polarity;
use std::io::{BufRead, Read};

/// One item of a file of spikes, after the header.
#[derive(Debug, PartialEq)]
pub enum Item {
    /// A spike.
    Event {
        /// The spike. Its sample index counts all samples, including samples that are not finite.
        event: Event,
        /// The time of the event's sample in µs, if events have times.
        time: Option<i64>,
    },
    /// The time of a sample.
    Time {
        /// Index of the sample.
        sample: u64,
        /// Time of the sample, in µs.
        time: i64,
    },
    /// A run of samples that were not finite.
    Rejected {
        /// Index of the first sample that was not finite.
        first: u64,
        /// Number of consecutive samples that were not finite.
        count: u64,
    },
    /// The end of the file.
    End {
        /// Number of samples that were recorded.
        samples: u64,
    },
}

/// A reader of a file of spikes. It has already read the header, and reads the spikes below.
pub struct Reader<R> {
    input: R,
    file: String,
    line: Vec<u8>,
    number: u64,
    slots: u64,
    neurons: u64,
    is_signed: bool,
    columns: usize,
    /// Usual time between samples, in µs; 0 if unknown.
    period: u64,
    /// Sample index and time in µs in the latest `# time=` line.
    noted: Option<(u64, i64)>,
    previous: u64,
    events: u64,
    samples: Option<u64>,
    declared_events: Option<u64>,
}

impl<R: BufRead> Reader<R> {
    /// Reads the header. Returns a reader of the spikes, and the header.
    ///
    /// # Errors
    /// Returns an error if the header is incomplete or contradicts itself.
    pub fn open(input: R, file: &str) -> Result<(Self, Header)> {
        let mut reader = Self {
            input,
            file: file.to_owned(),
            line: Vec::new(),
            number: 0,
            slots: 1,
            neurons: 1,
            is_signed: false,
            columns: 3,
            period: 0,
            noted: None,
            previous: 0,
            events: 0,
            samples: None,
            declared_events: None,
        };
        let mut lines = Vec::new();
        loop {
            if !reader.next_line()? {
                let kind = match reader.number {
                    0 => SpikesKind::Empty,
                    _ => SpikesKind::NoEvents,
                };
                return Err(kind.at(file));
            }
            let text = reader.text();
            if let Some(note) = text.strip_prefix('#') {
                let Some((key, value)) = note.split_once('=') else {
                    return Err(SpikesKind::NoKey { text }.at(reader.place()));
                };
                lines.push((key.trim().to_owned(), value.trim().to_owned()));
                continue;
            }
            reader.columns = match text.as_str() {
                "index,address,polarity" => 3,
                "index,address,polarity,time_us" => 4,
                _ => return Err(SpikesKind::NoNames { text }.at(reader.place())),
            };
            break;
        }
        let header = Header::parse(lines).at(|| file)?;
        let mut neurons = 0;
        for settings in &header.channels {
            let shape = header.scheme.shape(settings).at(|| file)?;
            reader.slots = shape.slots as u64;
            neurons += shape.neurons as u64;
        }
        reader.neurons = neurons;
        reader.period = header.rate.map_or(0, |rate| (1e6 / rate).round() as u64);
        reader.is_signed = header.scheme.info().is_signed;
        Ok((reader, header))
    }

    /// Parses the text `SAMPLE,NUMBER`: the index of a sample, and a whole number.
    fn pair(&self, value: &str) -> Result<(u64, i64)> {
        let (sample, number) = value.split_once(',').unwrap_or((value, ""));
        let number = number.parse();
        Ok((
            self.count(sample)?,
            number.map_err(|_| self.refused(SpikesKind::NotAPair { text: value.to_owned() }))?,
        ))
    }

    fn event(&mut self) -> Result<Item> {
        let mut fields = self.line.split(|&byte| byte == b',');
        let (index, neuron, polarity) = (fields.next(), fields.next(), fields.next());
        let time = fields.clone().next();
        let (Some(index), Some(neuron), Some(polarity)) = (index, neuron, polarity) else {
            return Err(self.refused(SpikesKind::NotAnEvent { text: self.text() }));
        };
        if fields.count() + 3 != self.columns {
            let kind = SpikesKind::Columns { text: self.text(), columns: self.columns };
            return Err(self.refused(kind));
        }
        let (Some(index), Some(neuron)) = (digits(index), digits(neuron)) else {
            return Err(self.refused(SpikesKind::NotWhole { text: self.text() }));
        };
        let polarity = match polarity {
            b"1" => Polarity::Up,
            b"-1" if self.is_signed => Polarity::Down,
            _ => return Err(self.refused(SpikesKind::Polarity { text: shown(polarity) })),
        };
        if neuron >= self.neurons {
            let kind = SpikesKind::Address { address: neuron, neurons: self.neurons };
            return Err(self.refused(kind));
        }
        let (sample, slot) = (index / self.slots, (index % self.slots) as u16);
        self.rises(sample)?;
        self.previous = sample;
        self.events += 1;
        let within = self.period.saturating_mul(slot.into()) / self.slots;
        let time = match time {
            Some(time) => {
                let time: Option<i64> =
                    str::from_utf8(time).ok().and_then(|time| time.parse().ok());
                let Some(time) = time else {
                    return Err(self.refused(SpikesKind::NoTime { text: self.text() }));
                };
                Some(time.saturating_sub_unsigned(within))
            }
            None => None,
        };
        let event = Event { sample, neuron: neuron as u16, slot, polarity };
        Ok(Item::Event { event, time })
    }

    fn rises(&self, sample: u64) -> Result<()> {
        if sample < self.previous {
            return Err(self.refused(SpikesKind::Falls { sample, previous: self.previous }));
        }
        Ok(())
    }

    fn count(&self, value: &str) -> Result<u64> {
        let wrong = |_| self.refused(SpikesKind::NotACount { text: value.to_owned() });
        value.parse().map_err(wrong)
    }

    fn next_line(&mut self) -> Result<bool> {
        const LONGEST: u64 = 1 << 20;
        self.line.clear();
        let mut input = (&mut self.input).take(LONGEST);
        input.read_until(b'\n', &mut self.line).at(|| &self.file)?;
        if self.line.iter().any(|byte| matches!(byte, 0..=8 | 14..=31)) {
            return Err(SpikesKind::Binary.at(&self.file));
        }
        let is_some = !self.line.is_empty();
        self.number += u64::from(is_some);
        while self.line.last().is_some_and(u8::is_ascii_whitespace) {
            self.line.pop();
        }
        Ok(is_some)
    }

    /// Makes an error of the kind `kind`, with the current line as its place.
    fn refused(&self, kind: SpikesKind) -> Error {
        kind.at(Place::line(&self.file, self.number))
    }

    fn text(&self) -> String {
        String::from_utf8_lossy(&self.line).into_owned()
    }
}

impl<R: BufRead> Spikes for Reader<R> {
    fn is_timed(&self) -> bool {
        self.columns == 4
    }

    fn next(&mut self) -> Result<Item> {
        while self.next_line()? {
            if self.line.first() != Some(&b'#') {
                return self.event();
            }
            let text = self.text();
            let note = text.trim_start_matches('#').trim();
            let (key, value) = note.split_once('=').unwrap_or((note, ""));
            match key {
                "samples" => self.samples = Some(self.count(value)?),
                "events" => self.declared_events = Some(self.count(value)?),
                "time" => {
                    let (sample, time) = self.pair(value)?;
                    self.noted = Some((sample, time));
                    return Ok(Item::Time { sample, time });
                }
                "gap" | "backward" => {
                    let (after, step) = self.pair(value)?;
                    if let Some((_, time)) = self.noted.filter(|&(sample, _)| sample == after) {
                        let time = time.saturating_add(step);
                        return Ok(Item::Time { sample: after.saturating_add(1), time });
                    }
                }
                "rejected" => {
                    let (first, count) = value.split_once(',').unwrap_or((value, ""));
                    let (first, count) = (self.count(first)?, self.count(count)?);
                    self.rises(first)?;
                    self.previous = first.saturating_add(count);
                    return Ok(Item::Rejected { first, count });
                }
                _ => {
                    let key = key.to_owned();
                    return Err(self.refused(SpikesKind::NoMeaning { key }));
                }
            }
        }
        let (Some(samples), Some(events)) = (self.samples, self.declared_events) else {
            return Err(SpikesKind::NoEnd { line: self.number }.at(&self.file));
        };
        if events != self.events {
            let kind = SpikesKind::OtherCount { events: self.events, said: events };
            return Err(kind.at(&self.file));
        }
        if self.events > 0 && self.previous >= samples {
            let kind = SpikesKind::BehindEnd { sample: self.previous, samples };
            return Err(kind.at(&self.file));
        }
        Ok(Item::End { samples })
    }

    fn place(&self) -> Place {
        Place::line(&self.file, self.number)
    }
}

/// Parses a number of at most 18 digits. Returns `None` if the text is longer, or contains other characters.
fn digits(text: &[u8]) -> Option<u64> {
    if text.is_empty() || text.len() > 18 {
        return None;
    }
    text.iter().try_fold(0, |number, byte| {
        byte.is_ascii_digit().then(|| 10 * number + u64::from(byte - b'0'))
    })
}
