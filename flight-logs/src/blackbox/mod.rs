//! Reads blackbox logs of Betaflight and related firmware. A log contains full frames (I-frames), with difference
//! frames (P-frames) between them.
//!
//! The frames of the main loop are on the topic `main`, frames of values that change rarely on `slow`, and frames of
//! the GPS on `gps`. In a file with several logs, the topics of the second log are `main:1` and so on. Numbers have the
//! units in which the flight controller logs them.

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
use header::{Counts, Fields, Header};
use std::collections::VecDeque;
use std::path::Path;

/// First bytes of a blackbox log.
pub(crate) const START: &[u8] = b"H Product:Blackbox";

/// Returns the offset of the first log within the first bytes of a file. Programs that fetch logs from a controller may
/// write other bytes before it.
pub(crate) fn start(bytes: &[u8]) -> Option<usize> {
    bytes.windows(START.len()).position(|window| window == START)
}

/// Name of the topic with the frames of the main loop.
pub(crate) const MAIN: &str = "main";

/// Longest plausible step from one frame to the next, in µs and in loop iterations. A longer step counts as damage,
/// unless the following frames confirm it.
const LONGEST_JUMP: (i64, i64) = (10_000_000, 5000);

/// Reader of a file with one or several blackbox logs.
pub(crate) struct Blackbox {
    faults: Faults,
    window: Window,
    /// Number of logs found in the file so far. A flight controller appends one log for each flight.
    logs: usize,
    session: Option<Session>,
    topics: Vec<Topic>,
    /// The sensors' counts of the log that each topic is of.
    counts: Vec<Counts>,
    message: Vec<u8>,
    /// Messages that are decoded, and are to be returned before any further frame is read.
    decoded: VecDeque<Message>,
    /// Offset of the first byte of the range that is being skipped as damaged.
    damaged: Option<u64>,
}

/// The numbers of a frame, and what its entry needs.
struct Message {
    topic: usize,
    /// Time in µs.
    time: i64,
    /// Offset of the frame in the file.
    at: u64,
    numbers: Vec<i64>,
}

/// State of decoding one of the logs in a file.
struct Session {
    header: Header,
    /// Index in [`Blackbox::topics`] of the topic with the frames of the flight controller's main loop: full frames and
    /// difference frames.
    main: usize,
    slow: Option<usize>,
    gps: Option<usize>,
    /// Values of the last two frames of the main loop, the latest first.
    previous: Option<[Vec<i32>; 2]>,
    home: Vec<i32>,
    /// Number of the loop iteration, and time in µs, of the last good frame.
    last: Option<(i64, i64)>,
    /// Time in µs from the good frame before to the last one.
    step: i64,
    /// Messages before the first frame of the main loop. They have no time yet, and get that of this frame.
    early: Vec<Message>,
    /// Full frames that are no frames for what follows them, as long as there is no good frame.
    odd: OddFrames,
    /// Number of the loop iteration, and time in µs, of a full frame that is too far from the last good frame. The next
    /// full frame confirms or refutes this iteration and time.
    doubted: Option<(i64, i64)>,
    /// Index of the field `loopIteration` in a frame of the main loop, if the log has this field.
    iteration: Option<usize>,
    /// Index of the field `time` in a frame of the main loop.
    time: usize,
}

/// A decoded frame.
enum Frame {
    /// A frame of the main loop.
    Main(MainFrame),
    /// A frame of another topic. It has no time if no frame of the main loop has been read.
    Message {
        topic: usize,
        time: Option<i64>,
        numbers: Vec<i64>,
    },
    Other,
    End,
}

/// A frame of the main loop that follows the frames before it.
struct MainFrame {
    is_full: bool,
    frame: Vec<i32>,
    numbers: Vec<i64>,
    iteration: i64,
    /// Time in µs.
    time: i64,
}

/// Full frames behind which no frame begins.
#[derive(Default)]
struct OddFrames {
    count: u64,
    /// Time in µs of the latest.
    time: Option<i64>,
    /// Number of these frames behind which a frame begins if they have 1, 2 and so on fields more than the header names.
    longer: [u64; MOST_LOST],
}

/// Largest number of fields whose loss from a header is recognised.
const MOST_LOST: usize = 4;

impl Blackbox {
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        Ok(Self {
            faults,
            window: Window::new(Bytes::open(path)?),
            logs: 0,
            session: None,
            topics: Vec::new(),
            counts: Vec::new(),
            message: Vec::new(),
            decoded: VecDeque::new(),
            damaged: None,
        })
    }

    /// Reads the header of a log, and adds the log's topics. An invalid header is counted as damage.
    fn head(&mut self) -> Result<()> {
        let offset = self.window.offset();
        if self.logs == 0 && offset > 0 {
            self.faults
                .note(format!("the log begins at byte {offset}; what is before it is not read"));
        }
        self.end_session();
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
        // Without a single line, the start is skipped, so that it is not found again.
        if lines.is_empty() {
            self.window.pass(START.len());
        }
        let header = match Header::parse(&lines) {
            Ok(header) => header,
            Err(why) => {
                let what = format!("the head of a log: {why}");
                return self.faults.skip(offset, what);
            }
        };
        let name = |name: &str| match self.logs {
            0 => name.to_owned(),
            log => format!("{name}:{log}"),
        };
        let mut add = |base: &str, fields: &Fields| {
            let definition = fields.definition();
            let topic = Topic::new(name(base), String::new(), Dialect::Ros1, &definition);
            self.topics.push(topic);
            self.counts.push(header.counts);
            self.topics.len() - 1
        };
        let main = add(MAIN, &header.full);
        let slow = (!header.slow.names.is_empty()).then(|| add("slow", &header.slow));
        let gps = (!header.gps.names.is_empty()).then(|| add("gps", &header.gps));
        let (iteration, time) = (header.full.index("loopIteration"), header.full.index("time"));
        self.logs += 1;
        let Some(time) = time else {
            return self.faults.skip(offset, "the head of a log: it has no field `time`");
        };
        self.session = Some(Session {
            header,
            main,
            slow,
            gps,
            previous: None,
            home: Vec::new(),
            last: None,
            step: 0,
            early: Vec::new(),
            odd: OddFrames::default(),
            doubted: None,
            iteration,
            time,
        });
        Ok(())
    }

    /// Ends the log that is being decoded, if there is one. Returns its messages that never got a time.
    fn end_session(&mut self) {
        let Some(mut session) = self.session.take() else { return };
        session.stamp(session.odd.time.unwrap_or_default(), &mut self.decoded);
        if let Some(note) = session.lost_field() {
            self.faults.note(note);
        }
    }

    /// Decodes the next frame. A byte that cannot begin a frame is skipped as damage.
    fn frame(&mut self) -> Result<()> {
        let offset = self.window.offset();
        let Some(session) = &mut self.session else {
            self.window.pass(1);
            return Ok(());
        };
        let left = self.window.left();
        let mut input = Input { bytes: left, at: 0 };
        let frame = session.frame(&mut input).and_then(|frame| {
            let is_last = self.window.blank(input.at).is_some();
            let is_good = matches!(frame, Frame::End)
                || is_last
                || begins(&left[input.at..])
                || session.is_before_damage(&frame, &left[..input.at], left);
            if is_good {
                return Ok(frame);
            }
            if let Frame::Main(frame) = frame {
                session.count_odd(&frame, &left[input.at..]);
            }
            Err(Fault::Odd)
        });
        let taken = input.at;
        if frame.is_ok()
            && let Some(damaged) = self.damaged.take()
        {
            self.faults.lose(damaged, format!("{} bytes are no frames", offset - damaged));
        }
        match frame {
            Ok(Frame::Main(frame)) => {
                self.window.pass(taken);
                session.stamp(frame.time, &mut self.decoded);
                let (topic, time) = (session.main, frame.time);
                let numbers = session.follow(frame);
                self.decoded.push_back(Message { topic, time, at: offset, numbers });
            }
            Ok(Frame::Message { topic, time, numbers }) => {
                self.window.pass(taken);
                let known = time.or(session.odd.time);
                let message = Message { topic, time: known.unwrap_or(0), at: offset, numbers };
                if known.is_some() {
                    self.decoded.push_back(message);
                } else {
                    session.early.push(message);
                }
            }
            Ok(Frame::Other) => self.window.pass(taken),
            Ok(Frame::End) => {
                self.window.pass(taken);
                self.end_session();
            }
            Err(Fault::End) if self.window.is_at_end() && self.damaged.is_none() => {
                self.window.pass(AHEAD);
                self.faults.end(offset, "the log ends within a frame")?;
            }
            Err(_) => {
                session.previous = None;
                self.damaged.get_or_insert(offset);
                self.window.pass(1);
            }
        }
        Ok(())
    }
}

/// Returns whether a frame can begin with these bytes, or there are none.
fn begins(bytes: &[u8]) -> bool {
    bytes.first().is_none_or(|first| KINDS.contains(first))
}

/// First bytes of frames, one for each kind of frame: full frame (`I`), difference frame (`P`), slowly changing values
/// (`S`), GPS data (`G`), GPS home position (`H`) and event (`E`).
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
                let time = self.last.map(|(_, time)| time);
                Ok(self.slow.map_or(Frame::Other, |topic| Frame::Message { topic, time, numbers }))
            }
            b'G' => {
                let frame = self.numbers(&self.header.gps, false, input)?;
                let numbers = self.header.gps.widened(&frame);
                let last = self.last.map(|(_, time)| time);
                // A time that is a difference from the last frame is known with this frame.
                let time = match self.header.gps.index("time") {
                    Some(index) if last.is_some() || !self.header.gps.is_relative(index) => {
                        numbers.get(index).copied().or(last)
                    }
                    _ => last,
                };
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

    /// Turns a frame of the main loop into a message.
    ///
    /// A frame continues another frame if its time and its loop iteration are not lower, and are higher by less than
    /// [`LONGEST_JUMP`]. A frame is good if it continues the last good frame, or if there is none yet. A full frame that
    /// does not continue the last good frame is kept in `doubted`. The next full frame is good if it continues the
    /// doubted frame.
    ///
    /// # Errors
    /// Returns [`Fault::Odd`] if the frame is not good.
    fn main(&mut self, frame: Vec<i32>, is_full: bool) -> Result<Frame, Fault> {
        let mut numbers = self.header.full.widened(&frame);
        let mut time = numbers[self.time];
        let iteration =
            self.iteration.and_then(|index| numbers.get(index)).copied().unwrap_or_default();
        if let Some((before, last)) = self.last {
            // The time in µs has 32 bits, and starts again at 0.
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
        Ok(Frame::Main(MainFrame { is_full, frame, numbers, iteration, time }))
    }

    /// Takes a good frame of the main loop as the last one, and keeps it for the prediction of later frames. Returns its
    /// numbers.
    fn follow(
        &mut self,
        MainFrame { is_full, frame, numbers, iteration, time }: MainFrame,
    ) -> Vec<i64> {
        self.step = self.last.map_or(0, |(_, last)| time - last);
        self.last = Some((iteration, time));
        self.doubted = None;
        self.previous = Some(match self.previous.take() {
            Some([previous, _]) if !is_full => [frame, previous],
            _ => [frame.clone(), frame],
        });
        numbers
    }

    /// Gives the messages before the first frame of the main loop the time of this frame, and moves them to `decoded`.
    fn stamp(&mut self, time: i64, decoded: &mut VecDeque<Message>) {
        let relative =
            self.header.gps.index("time").filter(|time| self.header.gps.is_relative(*time));
        for mut message in self.early.drain(..) {
            message.time = time;
            if let Some(index) = relative.filter(|_| Some(message.topic) == self.gps) {
                message.numbers[index] = message.numbers[index].saturating_add(time);
                message.time = message.numbers[index];
            }
            decoded.push_back(message);
        }
    }

    /// Returns whether a frame of the main loop is good although no frame begins behind it: the damaged bytes are behind
    /// it if its time fits the last two frames, and if no frames begin within it. A frame of which bytes are missing
    /// extends into the next one. `taken` holds the bytes of the frame, `left` these and the bytes behind them.
    fn is_before_damage(&self, frame: &Frame, taken: &[u8], left: &[u8]) -> bool {
        const LATE: i64 = 4;
        const ENOUGH: usize = 2;
        let (Frame::Main(frame), Some((_, last))) = (frame, self.last) else { return false };
        let is_soon = (1..=self.step.saturating_mul(LATE)).contains(&(frame.time - last));
        let is_within = |start: usize| {
            let mut input = Input { bytes: left, at: start };
            (0..ENOUGH).all(|_| self.pass(&mut input).is_ok() && begins(&left[input.at..]))
        };
        is_soon && !(1..taken.len()).any(is_within)
    }

    /// Reads past a frame, whatever its values are.
    fn pass(&self, input: &mut Input<'_>) -> Result<(), Fault> {
        let fields = match input.byte()? {
            b'I' => &self.header.full,
            b'P' => &self.header.changes,
            b'S' => &self.header.slow,
            b'G' => &self.header.gps,
            b'H' => &self.header.home,
            // An event is too short to tell.
            _ => return Err(Fault::Odd),
        };
        fields.read(self.header.version, input).map(drop)
    }

    /// Counts a full frame behind which no frame begins, as long as there is no good frame; `behind` are the bytes
    /// behind it.
    fn count_odd(&mut self, frame: &MainFrame, behind: &[u8]) {
        if self.last.is_some() || !frame.is_full {
            return;
        }
        self.odd.count += 1;
        self.odd.time = Some(frame.time);
        let mut input = Input { bytes: behind, at: 0 };
        for longer in &mut self.odd.longer {
            if input.unsigned().is_err() {
                return;
            }
            if begins(&behind[input.at..]) {
                *longer += 1;
                return;
            }
        }
    }

    /// Returns a note if no frame is good, but most full frames would be if they had more fields than the header names.
    fn lost_field(&self) -> Option<String> {
        let most = self.odd.longer.iter().position(|count| count * 2 > self.odd.count)?;
        let last = self.header.full.names.last().filter(|_| self.last.is_none())?;
        let fields = if most == 0 { "1 field".to_owned() } else { format!("{} fields", most + 1) };
        Some(format!(
            "no frame of the main loop can be read: the frames have {fields} more than the header names, perhaps \
             behind `{last}`"
        ))
    }

    /// Decodes the values of a frame. Each field holds the difference between its value and a prediction. Set
    /// `is_change` for a difference frame, whose predictions use earlier frames.
    fn numbers(
        &self,
        fields: &Fields,
        is_change: bool,
        input: &mut Input<'_>,
    ) -> Result<Vec<i32>, Fault> {
        let none = [Vec::new(), Vec::new()];
        let before = match (&self.previous, is_change) {
            (Some(previous), true) => previous,
            // Differences cannot be decoded if the frame before them is missing.
            (None, true) => return Err(Fault::Odd),
            (_, false) => &none,
        };
        let mut frame: Vec<i32> = Vec::with_capacity(fields.encodings.len());
        for (number, &predictor) in
            fields.read(self.header.version, input)?.into_iter().zip(&fields.predictors)
        {
            let index = frame.len();
            let past = |frame: &Vec<i32>| frame.get(index).copied().unwrap_or_default();
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
                    .index("motor[0]")
                    .and_then(|motor| frame.get(motor).copied())
                    .unwrap_or_default(),
                6 => one.wrapping_add(1).wrapping_add(self.header.skipped(one.into()) as i32),
                7 => {
                    // Of two neighbouring fields with this predictor, the second is the longitude.
                    let is_second = index > 0 && fields.predictors[index - 1] == 7;
                    self.home.get(usize::from(is_second)).copied().unwrap_or_default()
                }
                8 => 1500,
                9 => self.header.battery,
                header::LAST_TIME => self.last.map_or(0, |(_, time)| time as i32),
                11 => self.header.min_motor,
                _ => return Err(Fault::Odd),
            };
            frame.push(number.wrapping_add(predicted));
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
            // Logging resumes at this iteration and time.
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
    /// Reads the numbers of a frame as they are stored, before any prediction is added.
    fn read(&self, version: i64, input: &mut Input<'_>) -> Result<Vec<i32>, Fault> {
        let mut numbers: Vec<i32> = Vec::with_capacity(self.encodings.len());
        while let Some(&encoding) = self.encodings.get(numbers.len()) {
            let same = self.encodings[numbers.len()..].iter().take_while(|next| **next == encoding);
            let count = encoding.group(same.count());
            let packed = input.numbers(encoding, count, version)?;
            // A group may be longer than the fields that are left.
            let count = count.min(self.encodings.len() - numbers.len());
            numbers.extend(&packed[..count]);
        }
        Ok(numbers)
    }

    /// Converts the values of a frame to 64 bits. The value of an unsigned field is converted by way of `u32`, and is
    /// therefore never negative.
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
            if let Some(Message { topic, time, at, numbers }) = self.decoded.pop_front() {
                self.message.clear();
                self.message.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
                let time = time.saturating_mul(1000);
                return Ok(Some(Entry { topic, time, at, sequence: None }));
            }
            self.window.fill(&mut self.faults)?;
            if self.window.pass_blank(0) {
                continue;
            }
            let blank = self.window.end_blank();
            if self.window.left().is_empty() {
                let end = self.window.offset();
                if let Some(blank) = blank {
                    self.faults.blank(blank, end - blank);
                }
                if let Some(damaged) = self.damaged.take() {
                    let what = format!("{} bytes are no frames", blank.unwrap_or(end) - damaged);
                    self.faults.lose(damaged, what);
                }
                if self.session.is_some() {
                    self.faults.note("the log has no end, as when power is cut".to_owned());
                    self.end_session();
                    continue;
                }
                if self.logs == 0 {
                    return Err(Error::not_a_log(
                        self.faults.file(),
                        "no log, where lines `H Product:Blackbox …` should stand",
                    ));
                }
                return Ok(None);
            }
            if let Some(session) = &mut self.session
                && let Some(blank) = blank
            {
                session.previous = None;
                self.damaged.get_or_insert(blank);
            }
            if self.window.left().starts_with(START) {
                self.head()?;
            } else {
                self.frame()?;
            }
        }
    }

    fn topics(&self) -> &[Topic] {
        &self.topics
    }

    fn message(&self) -> &[u8] {
        &self.message
    }

    fn unit(&self, topic: usize, field: &str) -> Option<String> {
        self.counts.get(topic)?.unit(field)
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }
}
