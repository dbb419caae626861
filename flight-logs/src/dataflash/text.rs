//! Reads `ArduPilot`'s text logs, `.log`: each line is a message, which begins with the name of its type. Numbers are
//! written as values, not as fixed-point integers.

use super::format::{Format, Formats, Letter};
use crate::bytes::Bytes;
use crate::faults::Faults;
use crate::topic::Topic;
use crate::window::{AHEAD, Window};
use crate::{Entry, Log, Result};
use std::path::Path;

/// Reader of a text log.
pub(crate) struct Text {
    window: Window,
    faults: Faults,
    formats: Formats,
    /// Whether a definition has been read. Some loggers write other text before the first definition.
    is_begun: bool,
    message: Vec<u8>,
    /// Time of the last message that contained a time, in ns.
    time: i64,
}

/// Name of the messages that define formats.
const DEFINITION: &str = "FMT";

impl Text {
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        Ok(Self {
            window: Window::new(Bytes::open(path)?),
            faults,
            formats: Formats::new(),
            is_begun: false,
            message: Vec::new(),
            time: 0,
        })
    }

    /// Processes a line of the log; `at` is the offset of the line in the file. Returns the message's entry, or `None`
    /// if the line is no message.
    fn line(&mut self, at: u64, line: &str) -> Result<Option<Entry>> {
        let (name, rest) = line.split_once(',').unwrap_or((line, ""));
        let name = name.trim();
        self.is_begun |= name == DEFINITION;
        if !self.is_begun || line.trim().is_empty() {
            return Ok(None);
        }
        let Some(kind) = self.formats.named(name) else {
            self.faults.skip(at, "a line that no `FMT` defines")?;
            return Ok(None);
        };
        let topic = match self.read(kind, rest) {
            Ok(instance) => self.formats.topic(kind, instance, true),
            Err(what) => {
                self.faults.skip(at, what)?;
                return Ok(None);
            }
        };
        match name {
            DEFINITION if !self.define(rest) => {
                self.faults.skip(at, "a definition that cannot be read")?;
            }
            "FMTU" => {
                let mut words = rest.split(',').map(str::trim).skip(1);
                if let (Some(Ok(kind)), Some(units)) = (words.next().map(str::parse), words.next())
                {
                    self.formats.units(kind, units);
                }
            }
            _ => {}
        }
        Ok(topic.map(|topic| Entry { topic, time: self.time, at, sequence: None }))
    }

    /// Parses the columns of a message into `self.message`; returns the number of the message's instance.
    ///
    /// # Errors
    /// Returns the reason if columns are missing, or if one is not a number.
    fn read(&mut self, kind: u8, line: &str) -> std::result::Result<i64, String> {
        self.message.clear();
        let Some(format) = self.formats.get(kind) else { return Ok(0) };
        let Ok(columns) = &format.columns else { return Ok(0) };
        let mut instance = 0;
        // The last column, a text, may contain commas.
        let mut words = line.splitn(columns.len().max(1), ',').map(str::trim);
        for (index, column) in columns.iter().enumerate() {
            let Some(word) = words.next() else {
                return Err(format!(
                    "a message of {index} columns where {} are defined",
                    columns.len()
                ));
            };
            if matches!(column.letter, Letter::Text(_) | Letter::Mode | Letter::Array) {
                self.message.extend((word.len() as u32).to_le_bytes());
                self.message.extend(word.as_bytes());
                continue;
            }
            let number: f64 =
                word.parse().map_err(|_| format!("column {} is no number", column.name))?;
            self.message.extend(number.to_le_bytes());
            if format.instance == Some(index) {
                instance = number as i64;
            }
            if let Some((_, unit)) = format.time.filter(|(time, _)| *time == index) {
                self.time = (number as i64).saturating_mul(unit);
            }
        }
        Ok(instance)
    }

    /// Parses the columns of an `FMT` message, and stores the format; returns false if the columns are invalid.
    fn define(&mut self, line: &str) -> bool {
        let mut words = line.splitn(5, ',').map(str::trim);
        let mut word = || words.next().unwrap_or_default();
        let (kind, length) = (word().parse(), word().parse());
        let (name, letters, columns) = (word(), word(), word());
        let (Ok(kind), Ok(length)) = (kind, length) else { return false };
        // The `FMT` line for `FMT` itself lacks the name of the last column. Its format is fixed.
        if name != DEFINITION {
            self.formats.define(kind, Format::new(name, length, letters, columns));
        }
        !name.is_empty()
    }
}

impl Log for Text {
    fn next(&mut self) -> Result<Option<Entry>> {
        loop {
            self.window.fill(&mut self.faults)?;
            let left = self.window.left();
            if left.is_empty() {
                return Ok(None);
            }
            let end = left.iter().take(AHEAD).position(|&byte| byte == b'\n');
            let (bytes, passed) = match end {
                Some(end) => (&left[..end], end + 1),
                None => (left, left.len().min(AHEAD)),
            };
            let line = str::from_utf8(bytes).map(str::to_owned);
            let at = self.window.offset();
            let is_whole = end.is_some() || self.window.is_at_end();
            self.window.pass(passed);
            match line {
                Ok(line) if is_whole => {
                    let entry = self.line(at, &line)?;
                    if entry.is_some() {
                        return Ok(entry);
                    }
                }
                _ if self.is_begun => self.faults.skip(at, "a line that is no text of a log")?,
                _ => {}
            }
        }
    }

    fn topics(&self) -> &[Topic] {
        &self.formats.topics
    }

    fn message(&self) -> &[u8] {
        &self.message
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }
}
