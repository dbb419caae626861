//! Reads blackbox logs of Betaflight and related firmware: full frames, and between them frames of differences.
//!
//! The frames of the main loop are on the topic `main`, values that change rarely on `slow`, and those of the GPS on
//! `gps`. Those of a second log in the file are on `main:1` and so on. Numbers are as logged, in the flight
//! controller's units.

mod encoding;
mod header;

use super::bytes::Bytes;
use super::definition::Dialect;
use super::faults::Faults;
use super::topic::Topic;
use super::window::{AHEAD, Window};
use super::{Entry, Log};
use crate::{Error, Result};
use encoding::{Fault, Input};
use header::{Fields, Header};
use std::path::Path;

/// The first bytes of a log.
pub(crate) const START: &[u8] = b"H Product:Blackbox";

/// The topic of the frames of the main loop.
pub(crate) const MAIN: &str = "main";

/// Longest plausible step between frames, in µs and in iterations. A longer one counts as damage unless the following
/// frames confirm it.
const LONGEST_JUMP: (i64, i64) = (10_000_000, 5000);

/// A log that is being read.
pub(crate) struct Blackbox {
    faults: Faults,
    window: Window,
    /// Number of logs in the file so far: a flight controller appends one for each flight.
    logs: usize,
    session: Option<Session>,
    topics: Vec<Topic>,
    message: Vec<u8>,
    /// Offset at which the present damage began.
    damaged: Option<u64>,
}

/// One of the logs in the file.
struct Session {
    header: Header,
    /// Index of its main topic; `slow` and `gps` are the indices of the other topics.
    main: usize,
    slow: Option<usize>,
    gps: Option<usize>,
    /// The last two frames, the latest first.
    previous: Option<[Vec<i32>; 2]>,
    home: Vec<i32>,
    /// Iteration and time of the last good frame.
    last: Option<(i64, i64)>,
    /// Iteration and time of a frame far from the last good one, until the next frame confirms or refutes it.
    doubted: Option<(i64, i64)>,
    /// Indices of the fields `loopIteration` and `time`.
    iteration: Option<usize>,
    time: usize,
}

/// The outcome of reading a frame.
enum Frame {
    Message { topic: usize, time: i64, numbers: Vec<i64> },
    Other,
    End,
}

impl Blackbox {
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        Ok(Self {
            faults,
            window: Window::new(Bytes::open(path)?),
            logs: 0,
            session: None,
            topics: Vec::new(),
            message: Vec::new(),
            damaged: None,
        })
    }

    /// Reads the header of a log.
    fn head(&mut self) -> Result<()> {
        let place = self.window.place();
        let mut lines = Vec::new();
        loop {
            self.window.fill(&mut self.faults)?;
            let left = self.window.left();
            let end = left.iter().take(AHEAD).position(|&byte| byte == b'\n');
            let Some(end) = end.filter(|_| left.starts_with(b"H ")) else { break };
            let line = String::from_utf8_lossy(&left[2..end.max(2)]).into_owned();
            if let Some((key, value)) = line.split_once(':') {
                lines.push((key.trim().to_owned(), value.trim().to_owned()));
            }
            self.window.pass(end + 1);
        }
        // Where there is not even a line, the start is passed over.
        if lines.is_empty() {
            self.window.pass(START.len());
        }
        let header = match Header::parse(&lines) {
            Ok(header) => header,
            Err(why) => {
                let what = format!("the head of a log: {why}");
                return self.faults.skip(place, what);
            }
        };
        let name = |name: &str| match self.logs {
            0 => name.to_owned(),
            log => format!("{name}:{log}"),
        };
        let mut add = |own: &str, fields: &Fields| {
            let definition = fields.definition();
            let topic = Topic::new(name(own), String::new(), Dialect::Ros1, &definition);
            self.topics.push(topic);
            self.topics.len() - 1
        };
        let main = add(MAIN, &header.full);
        let slow = (!header.slow.names.is_empty()).then(|| add("slow", &header.slow));
        let gps = (!header.gps.names.is_empty()).then(|| add("gps", &header.gps));
        let (iteration, time) = (header.full.place("loopIteration"), header.full.place("time"));
        self.logs += 1;
        let Some(time) = time else {
            return self.faults.skip(place, "the head of a log: it has no field `time`");
        };
        self.session = Some(Session {
            header,
            main,
            slow,
            gps,
            previous: None,
            home: Vec::new(),
            last: None,
            doubted: None,
            iteration,
            time,
        });
        Ok(())
    }

    /// Reads a frame, or skips a byte that cannot begin one.
    fn frame(&mut self) -> Result<Option<Entry>> {
        let place = self.window.place();
        let Some(session) = &mut self.session else {
            self.window.pass(1);
            return Ok(None);
        };
        let left = self.window.left();
        let mut input = Input { bytes: left, at: 0 };
        let frame = session.frame(&mut input).and_then(|frame| {
            // What follows tells whether it was one.
            let is_followed = left.get(input.at).is_none_or(|next| KINDS.contains(next));
            if is_followed || matches!(frame, Frame::End) { Ok(frame) } else { Err(Fault::Odd) }
        });
        let taken = input.at;
        if frame.is_ok()
            && let Some(damaged) = self.damaged.take()
        {
            self.faults.lose(damaged, format!("{} bytes are no frames", place - damaged));
        }
        match frame {
            Ok(Frame::Message { topic, time, numbers }) => {
                self.window.pass(taken);
                self.message.clear();
                self.message.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
                let time = time.saturating_mul(1000);
                return Ok(Some(Entry { topic, time, at: place, sequence: None }));
            }
            Ok(Frame::Other) => self.window.pass(taken),
            Ok(Frame::End) => {
                self.window.pass(taken);
                self.session = None;
            }
            Err(Fault::End) if self.window.is_at_end() && self.damaged.is_none() => {
                self.window.pass(AHEAD);
                self.faults.end(place, "the log ends within a frame")?;
            }
            Err(_) => {
                session.previous = None;
                self.damaged.get_or_insert(place);
                self.window.pass(1);
            }
        }
        Ok(None)
    }
}

/// The bytes with which frames begin.
const KINDS: &[u8] = b"IPSGHE";

impl Session {
    fn frame(&mut self, input: &mut Input<'_>) -> Result<Frame, Fault> {
        match input.byte()? {
            b'I' => {
                let frame = self.numbers(&self.header.full, false, input)?;
                self.main(frame, true)
            }
            b'P' => {
                let frame = self.numbers(&self.header.changes, true, input)?;
                self.main(frame, false)
            }
            b'S' => {
                let frame = self.numbers(&self.header.slow, false, input)?;
                let numbers = self.header.slow.widened(&frame);
                let time = self.last.map_or(0, |(_, time)| time);
                Ok(self.slow.map_or(Frame::Other, |topic| Frame::Message { topic, time, numbers }))
            }
            b'G' => {
                let frame = self.numbers(&self.header.gps, false, input)?;
                let numbers = self.header.gps.widened(&frame);
                let own = self.header.gps.place("time").and_then(|place| numbers.get(place));
                let time = own.copied().or(self.last.map(|(_, time)| time)).unwrap_or_default();
                Ok(self.gps.map_or(Frame::Other, |topic| Frame::Message { topic, time, numbers }))
            }
            b'H' => {
                self.home = self.numbers(&self.header.home, false, input)?;
                Ok(Frame::Other)
            }
            b'E' => self.event(input),
            _ => Err(Fault::Odd),
        }
    }

    /// Accepts a frame of the main loop if it follows from the frame before.
    fn main(&mut self, frame: Vec<i32>, is_full: bool) -> Result<Frame, Fault> {
        let mut numbers = self.header.full.widened(&frame);
        let mut time = numbers[self.time];
        let iteration =
            self.iteration.and_then(|place| numbers.get(place)).copied().unwrap_or_default();
        if let Some((before, last)) = self.last {
            // The count of µs starts anew at 32 bits.
            let wraps = (last - time + (1 << 31)).div_euclid(1 << 32).max(0);
            time += wraps << 32;
            let follows = |(before, last): (i64, i64)| {
                (0..LONGEST_JUMP.0).contains(&(time - last))
                    && (0..LONGEST_JUMP.1).contains(&(iteration - before))
            };
            let is_confirmed = is_full && self.doubted.is_some_and(follows);
            if !follows((before, last)) && !is_confirmed {
                self.doubted = is_full.then_some((iteration, time));
                return Err(Fault::Odd);
            }
        }
        numbers[self.time] = time;
        self.last = Some((iteration, time));
        self.doubted = None;
        self.previous = Some(match self.previous.take() {
            Some([previous, _]) if !is_full => [frame, previous],
            _ => [frame.clone(), frame],
        });
        Ok(Frame::Message { topic: self.main, time, numbers })
    }

    /// Decodes the numbers of a frame: for each field the packed difference plus the prediction.
    fn numbers(
        &self,
        fields: &Fields,
        is_change: bool,
        input: &mut Input<'_>,
    ) -> Result<Vec<i32>, Fault> {
        let none = [Vec::new(), Vec::new()];
        let before = match (&self.previous, is_change) {
            (Some(previous), true) => previous,
            // Changes of a frame that is missing mean nothing.
            (None, true) => return Err(Fault::Odd),
            (_, false) => &none,
        };
        let mut frame: Vec<i32> = Vec::with_capacity(fields.encodings.len());
        while let Some(&encoding) = fields.encodings.get(frame.len()) {
            let own = fields.encodings[frame.len()..].iter().take_while(|own| **own == encoding);
            let count = encoding.group(own.count());
            let packed = input.numbers(encoding, count, self.header.version)?;
            for number in packed.into_iter().take(count) {
                let place = frame.len();
                let Some(&predictor) = fields.predictors.get(place) else { break };
                let past = |frame: &Vec<i32>| frame.get(place).copied().unwrap_or_default();
                let (one, two) = (past(&before[0]), past(&before[1]));
                let predicted = match predictor {
                    0 => 0,
                    1 => one,
                    2 => one.wrapping_mul(2).wrapping_sub(two),
                    3 => i64::midpoint(one.into(), two.into()) as i32,
                    4 => self.header.min_throttle,
                    5 => self
                        .header
                        .full
                        .place("motor[0]")
                        .and_then(|motor| frame.get(motor).copied())
                        .unwrap_or_default(),
                    6 => one.wrapping_add(1).wrapping_add(self.header.skipped(one.into()) as i32),
                    7 => {
                        // The second of two is the longitude.
                        let is_second = place > 0 && fields.predictors[place - 1] == 7;
                        self.home.get(usize::from(is_second)).copied().unwrap_or_default()
                    }
                    8 => 1500,
                    9 => self.header.battery,
                    10 => self.last.map_or(0, |(_, time)| time as i32),
                    11 => self.header.min_motor,
                    _ => return Err(Fault::Odd),
                };
                frame.push(number.wrapping_add(predicted));
            }
        }
        Ok(frame)
    }

    fn event(&mut self, input: &mut Input<'_>) -> Result<Frame, Fault> {
        match input.byte()? {
            0 | 15 | 40 => drop(input.unsigned()?),
            13 => {
                if input.byte()? & 0x80 == 0 {
                    input.signed()?;
                } else {
                    for _ in 0..4 {
                        input.byte()?;
                    }
                }
            }
            // Logging goes on at an iteration and a time.
            14 => {
                let (iteration, time) = (input.unsigned()?, input.unsigned()?);
                self.last = Some((iteration.into(), time.into()));
            }
            30 => {
                input.unsigned()?;
                input.unsigned()?;
            }
            255 => {
                const WORDS: &[u8] = b"End of log";
                if !input.bytes[input.at..].starts_with(WORDS) {
                    return Err(Fault::Odd);
                }
                while input.byte()? != 0 {}
                return Ok(Frame::End);
            }
            _ => return Err(Fault::Odd),
        }
        Ok(Frame::Other)
    }
}

impl Fields {
    /// Converts the numbers of a frame, so that unsigned fields are not negative.
    fn widened(&self, frame: &[i32]) -> Vec<i64> {
        let numbers = frame.iter().zip(&self.signed);
        numbers
            .map(|(&number, &signed)| if signed { number.into() } else { (number as u32).into() })
            .collect()
    }
}

impl Log for Blackbox {
    fn next(&mut self) -> Result<Option<Entry>> {
        loop {
            self.window.fill(&mut self.faults)?;
            if self.window.left().is_empty() {
                if let Some(damaged) = self.damaged.take() {
                    let what = format!("{} bytes are no frames", self.window.place() - damaged);
                    self.faults.lose(damaged, what);
                }
                if self.session.take().is_some() {
                    self.faults.note("the log has no end, as when power is cut".to_owned());
                }
                if self.logs == 0 {
                    return Err(Error::not_a_log(
                        self.faults.file(),
                        "no log, where lines `H Product:Blackbox …` should stand",
                    ));
                }
                return Ok(None);
            }
            if self.window.left().starts_with(START) {
                self.head()?;
                continue;
            }
            let entry = self.frame()?;
            if entry.is_some() {
                return Ok(entry);
            }
        }
    }

    fn topics(&self) -> &[Topic] {
        &self.topics
    }

    fn message(&self) -> &[u8] {
        &self.message
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }
}
