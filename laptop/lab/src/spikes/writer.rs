//! Writes a file of spikes while the samples arrive.

use super::{Header, Record};
use crate::Result;
use crate::input::{Chunk, Kind, Step};
use crate::output::Output;
use catalogue::run::Event;
use spikewire::Polarity;
use std::collections::VecDeque;
use std::io::Write;

/// A file of spikes that is being written.
///
/// Encoders count only finite samples, while the file counts all samples. The comments of the file, such as notes on
/// gaps, stand between the events in the order of the samples. If an encoder looks ahead, its events come late. The
/// writer then holds back the notes on later samples until the events are written.
pub struct Writer {
    output: Output,
    slots: u64,
    /// Usual time between samples in µs; 0 if unknown.
    period: u64,
    is_timed: bool,
    /// Index and time of each finite sample that may still get events.
    pending: VecDeque<(u64, i64)>,
    /// Number of finite samples before the first one in `pending`.
    first_pending: u64,
    /// Notes that are not written yet, each with the index of its sample. A note must be written before the events of
    /// later samples.
    notes: VecDeque<(u64, String)>,
    /// First index and length of the current run of samples that were not finite.
    rejected_run: Option<(u64, u64)>,
    /// Time of the latest sample, in µs.
    last_time: i64,
    summary: Summary,
    line: Vec<u8>,
}

/// The numbers of samples and spikes in a file of spikes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Summary {
    /// Number of samples of each channel, including those that were not finite.
    pub samples: u64,
    /// Number of samples that were not finite.
    pub rejected: u64,
    /// Number of spikes.
    pub events: u64,
}

impl Writer {
    /// Writes the header, and returns a writer of the spikes after it.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub fn new(mut output: Output, header: &Header, is_timed: bool) -> Result<Self> {
        let slots = match header.channels.first() {
            Some(settings) => header.scheme.shape(settings)?.slots,
            None => 1,
        };
        for (key, value) in header.lines() {
            writeln!(output, "# {key}={value}")?;
        }
        writeln!(output, "index,address,polarity{}", if is_timed { ",time_us" } else { "" })?;
        Ok(Self {
            output,
            slots: slots as u64,
            period: header.rate.map_or(0, |rate| (1e6 / rate).round() as u64),
            is_timed,
            pending: VecDeque::new(),
            first_pending: 0,
            notes: VecDeque::new(),
            rejected_run: None,
            last_time: 0,
            summary: Summary::default(),
            line: Vec::new(),
        })
    }

    fn note(&mut self, sample: u64, note: String) {
        self.notes.push_back((sample, note));
    }

    fn note_time(&mut self, sample: u64, time: i64) {
        if self.is_timed {
            self.note(sample, format!("# time={sample},{time}"));
        }
    }

    fn end_run(&mut self) {
        if let Some((first, length)) = self.rejected_run.take() {
            let last = first + length - 1;
            self.note_time(last, self.last_time);
            self.note(last, format!("# rejected={first},{length}"));
        }
    }

    /// Writes the waiting notes that must come before the events of `sample`.
    fn write_notes(&mut self, sample: u64) {
        while self.notes.front().is_some_and(|&(at, _)| at < sample) {
            if let Some((_, note)) = self.notes.pop_front() {
                self.line.extend(note.as_bytes());
                self.line.push(b'\n');
            }
        }
    }
}

impl Record for Writer {
    fn observe(&mut self, chunk: &mut Chunk, steps: &[Step]) -> Result<()> {
        let rows = chunk.finite_rows();
        let mut steps = steps.iter().peekable();
        for (place, &is_finite) in rows.iter().enumerate() {
            let index = self.summary.samples;
            let time = chunk.times.get(place).copied().unwrap_or(0);
            while let Some(step) = steps.next_if(|step| step.after < index) {
                self.end_run();
                self.note_time(step.after, self.last_time);
                let key = match step.kind {
                    Kind::Gap => "gap",
                    Kind::Backward | Kind::Restart => "backward",
                };
                self.note(step.after, format!("# {key}={},{}", step.after, step.microseconds));
            }
            if index == 0 {
                self.note_time(0, time);
            }
            if is_finite {
                self.end_run();
                self.pending.push_back((index, time));
            } else {
                self.summary.rejected += 1;
                let (first, length) = self.rejected_run.unwrap_or_else(|| {
                    self.note_time(index, time);
                    (index, 0)
                });
                self.rejected_run = Some((first, length + 1));
            }
            self.summary.samples += 1;
            self.last_time = time;
        }
        if rows.contains(&false) {
            chunk.columns = chunk.kept(&rows);
        }
        Ok(())
    }

    fn write(&mut self, events: &mut Vec<Event>, decided: u64) -> Result<()> {
        if self.slots > 1 {
            events.sort_by_key(|event| (event.sample, event.slot));
        }
        self.line.clear();
        let mut digits = itoa::Buffer::new();
        for event in events.drain(..) {
            let (sample, time) = self.pending[(event.sample - self.first_pending) as usize];
            self.write_notes(sample);
            self.line.extend(digits.format(sample * self.slots + u64::from(event.slot)).as_bytes());
            self.line.push(b',');
            self.line.extend(digits.format(event.neuron).as_bytes());
            self.line.extend(if event.polarity == Polarity::Up {
                b",1".as_slice()
            } else {
                b",-1"
            });
            if self.is_timed {
                let within = self.period.saturating_mul(event.slot.into()) / self.slots;
                self.line.push(b',');
                self.line.extend(digits.format(time.saturating_add_unsigned(within)).as_bytes());
            }
            self.line.push(b'\n');
            self.summary.events += 1;
        }
        self.pending.drain(..(decided - self.first_pending) as usize);
        self.first_pending = decided;
        self.write_notes(self.pending.front().map_or(self.summary.samples, |&(sample, _)| sample));
        self.output.write_all(&self.line)?;
        Ok(())
    }

    fn finish(mut self: Box<Self>, events: &mut Vec<Event>) -> Result<(Output, Summary)> {
        self.end_run();
        let decided = self.first_pending + self.pending.len() as u64;
        if let Some(last) = self.summary.samples.checked_sub(1) {
            self.note_time(last, self.last_time);
        }
        self.write(events, decided)?;
        let Summary { samples, events, .. } = self.summary;
        writeln!(self.output, "# samples={samples}\n# events={events}")?;
        Ok((self.output, self.summary))
    }
}
