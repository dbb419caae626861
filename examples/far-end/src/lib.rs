//! The other end of a link, on any machine: bytes in, values, and a command for each frame.
//!
//! The command damps the vehicle's rotation, and stands for whatever you do with the values. What matters is when it is
//! neutral: before the first keyframe, after a loss or a break until the next one, when the sender starts again, and when
//! no frame was accepted for [`SILENCE_MS`]. Bytes that are no frame are silence too.

#![no_std]

use spikewire::{
    Tick,
    link::{MAX_FRAME, Reader, Receiver},
    temporal::StepForward,
};

/// Gyroscope x, y, z in rad/s, then accelerometer x, y, z in m/s².
pub const CHANNELS: usize = 6;
static RATE: StepForward<f32> = StepForward::new(0.1);
static ACCELERATION: StepForward<f32> = StepForward::new(0.5);
/// Those of the sender, which is `link-uart`.
pub const SCHEMES: Schemes = [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];
/// One for each channel.
pub type Schemes = [&'static StepForward<f32>; CHANNELS];

/// From one keyframe of the sender to the next. A signal at rest has no events, so that keyframes alone say that the link
/// lives; of six channels in `f32` they are 56 bytes, 1.1 kB a second.
pub const KEYFRAME_MS: u32 = 50;

/// How long the last command may stand without a frame: two keyframes' time, so that one may be lost, and 20 ms for the
/// gathering, the line and the tasks on both ends.
///
/// A multirotor that turns with 100 rad/s² under an old torque, as a nimble one can, turns by half of that times the time
/// squared: 0.72 rad or 41° in 120 ms, from which it can right itself, and more than a whole turn in 0.4 s.
pub const SILENCE_MS: u32 = 2 * KEYFRAME_MS + 20;

/// Thousandths of the greatest torque for 1 rad/s.
const DAMPING: f32 = 120.0;
const GREATEST: f32 = 1_000.0;

/// What is done about the values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Nothing is known: no torque.
    Neutral,
    /// Torques about x, y and z against the rotation, in thousandths of the greatest.
    Damp([i16; 3]),
}

impl Command {
    /// For a line to the actuators: a mark, whether it is neutral, and three little endian numbers.
    pub fn bytes(self) -> [u8; 8] {
        let (is_known, [x, y, z]) = match self {
            Self::Neutral => (0, [0; 3]),
            Self::Damp(torques) => (1, torques),
        };
        let ([x0, x1], [y0, y1], [z0, z1]) = (x.to_le_bytes(), y.to_le_bytes(), z.to_le_bytes());
        [0x5C, is_known, x0, x1, y0, y1, z0, z1]
    }
}

/// The far end's state. Times are milliseconds of any clock that goes on, and may wrap.
pub struct FarEnd {
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<Schemes, CHANNELS>,
    silence: u32,
    /// When the last frame was accepted, or the last silence told.
    heard: Option<u32>,
}

impl Default for FarEnd {
    fn default() -> Self {
        Self::with_silence(SILENCE_MS)
    }
}

impl FarEnd {
    /// A far end whose last command stands for this many milliseconds without a frame.
    pub fn with_silence(silence: u32) -> Self {
        let receiver = Receiver::per_channel(SCHEMES);
        Self { reader: Reader::new(), receiver, silence, heard: None }
    }

    /// Takes bytes as they come, cut anywhere: each value, with its channel and tick, and a command after each frame.
    pub fn take(
        &mut self,
        now: u32,
        mut bytes: &[u8],
        mut on_value: impl FnMut(u16, Tick, f32),
        mut on_command: impl FnMut(Command),
    ) {
        while let Some(received) = self.reader.next_frame(&mut bytes) {
            // Bytes of which no frame can be read are no sign of life.
            if !received.is_unread {
                self.heard = Some(now);
            }
            self.receiver.apply(&received, &mut on_value);
            on_command(self.command());
        }
    }

    /// Returns the neutral command if there was no frame for too long: what is known is old, until the next keyframe. To be
    /// asked all the time, with or without bytes; it answers again after each further silence.
    pub fn silence(&mut self, now: u32) -> Option<Command> {
        let heard = *self.heard.get_or_insert(now);
        if now.wrapping_sub(heard) < self.silence {
            return None;
        }
        self.heard = Some(now);
        // What waits behind a frame without an end is too old to be exact, and must not hold up what comes.
        while let Some(received) = self.reader.next_after_silence() {
            self.receiver.apply(&received, |_, _, _| ());
        }
        self.receiver.mark_stale();
        Some(Command::Neutral)
    }

    /// Frames that were lost on the way, so far.
    pub fn lost_frames(&self) -> u32 {
        self.reader.lost_frames()
    }

    fn command(&self) -> Command {
        let torque = |channel| {
            let rate = self.receiver.exact(channel)?;
            Some((-DAMPING * rate).clamp(-GREATEST, GREATEST) as i16)
        };
        match [0, 1, 2].map(torque) {
            [Some(x), Some(y), Some(z)] => Command::Damp([x, y, z]),
            _ => Command::Neutral,
        }
    }
}
