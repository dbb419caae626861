//! The other end of a link, on any machine: bytes in, values, and a command for each frame.
//!
//! The command damps the vehicle's rotation, and stands for whatever you do with the values. What matters is when it is
//! neutral: before the first keyframe, after a loss or a break until the next one, when the sender starts again, and when
//! nothing comes any more. A signal at rest has no events, so that only [`SILENCE_MS`], longer than from keyframe to
//! keyframe, is silence.

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

/// The sender has a keyframe every second.
pub const SILENCE_MS: u32 = 1_500;

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

/// The far end's state.
pub struct FarEnd {
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<Schemes, CHANNELS>,
}

impl Default for FarEnd {
    fn default() -> Self {
        Self { reader: Reader::new(), receiver: Receiver::per_channel(SCHEMES) }
    }
}

impl FarEnd {
    /// Takes bytes as they come, cut anywhere: each value, with its channel and tick, and a command after each frame.
    pub fn take(
        &mut self,
        mut bytes: &[u8],
        mut on_value: impl FnMut(u16, Tick, f32),
        mut on_command: impl FnMut(Command),
    ) {
        while let Some(received) = self.reader.next_frame(&mut bytes) {
            self.receiver.apply(&received, &mut on_value);
            on_command(self.command());
        }
    }

    /// Nothing came for [`SILENCE_MS`]: what is known is old, until the next keyframe.
    pub fn silence(&mut self) -> Command {
        self.receiver.mark_stale();
        Command::Neutral
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
