//! A small camera's frames to events and back. One line for each code of pixels:
//!
//! ```text
//! intensity-10 events=1234 over_budget=0 hash=0123456789abcdef
//! ```
//!
//! The hash is over all events and all decoded pixels, so two machines that print the same line did the same arithmetic.
//! The host's tests compare these lines with the reference's. Nothing here knows a board: the caller passes somewhere to
//! print to.

#![cfg_attr(target_os = "none", no_std)]

use core::fmt::{self, Write};

use spikewire::{ConfigError, Polarity, Tick};
use spikewire_cameras::frame::{
    FrameDecoder, FrameEncoder, Intensity, LogIntensity, PixelCode, PixelEvent, Refractory,
};

/// The pixels of a usual optical-flow sensor.
pub const SIZE: usize = 35;
/// How many frames there are.
pub const FRAMES: u32 = 60;
/// The time from one frame to the next, in µs.
pub const PERIOD: u32 = 8_333;

/// One frame.
pub type Frame = [[u8; SIZE]; SIZE];

/// A texture that drifts over the sensor, with noise, and a flash at last: all in whole numbers.
pub fn frame(index: u32) -> Frame {
    let mut noise = index.wrapping_mul(2_654_435_761) | 1;
    core::array::from_fn(|y| {
        core::array::from_fn(|x| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (x, y) = (x as u32 * 9 + index * 5, y as u32 * 13 + index * 2);
            let wave =
                |place: u32| if place & 128 == 0 { place & 127 } else { 127 - (place & 127) };
            let flash = if index == FRAMES - 2 { 90 } else { 0 };
            (wave(x) + wave(y) * 3 / 4 + (noise >> 29) + flash).min(255) as u8
        })
    })
}

/// What a code makes of the frames.
pub struct Line {
    /// Events that were sent.
    pub events: u32,
    /// Those that the budget kept back.
    pub over_budget: u32,
    /// FNV-1a over all events and decoded pixels.
    pub hash: u64,
}

impl Default for Line {
    fn default() -> Self {
        Self { events: 0, over_budget: 0, hash: 0xcbf2_9ce4_8422_2325 }
    }
}

impl Line {
    /// Takes an event.
    pub fn event(&mut self, micros: u32, x: u16, y: u16, up: bool) {
        self.events += 1;
        let ([a, b, c, d], [x, _], [y, _]) =
            (micros.to_le_bytes(), x.to_le_bytes(), y.to_le_bytes());
        self.bytes(&[a, b, c, d, x, y, up.into()]);
    }

    /// Takes decoded pixels.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Prints it.
    pub fn write(&self, out: &mut impl Write, name: &str) -> fmt::Result {
        let Self { events, over_budget, hash } = self;
        writeln!(out, "{name} events={events} over_budget={over_budget} hash={hash:016x}")
    }
}

/// All codes, one after the other.
pub fn run(out: &mut impl Write) -> fmt::Result {
    lines(out).unwrap_or_else(|error| {
        writeln!(out, "{error}")?;
        Err(fmt::Error)
    })
}

fn lines(out: &mut impl Write) -> Result<fmt::Result, ConfigError> {
    let most = |most| Intensity::new(10).try_with_most(most);
    let results = [
        line(out, "intensity-1", Intensity::try_new(1)?, u32::MAX, false),
        line(out, "intensity-10", most(1)?, u32::MAX, false),
        line(out, "intensity-10x4", most(4)?, u32::MAX, false),
        line(out, "intensity-10x4-slots", most(4)?, u32::MAX, true),
        line(out, "intensity-10x4-budget", most(4)?, 300, false),
        line(out, "intensity-10x4-refractory", Refractory::try_new(most(4)?, 2)?, u32::MAX, true),
        line(out, "log-u8-9", LogIntensity::<u8>::try_new(9, 9)?, u32::MAX, false),
        line(out, "log-u16-205", LogIntensity::<u16>::try_new(205, 205)?, u32::MAX, false),
        line(
            out,
            "log-u16-205-184x6-slots",
            LogIntensity::<u16>::try_new(205, 184)?.try_with_most(6)?,
            2000,
            true,
        ),
    ];
    Ok(results.into_iter().collect())
}

#[inline(never)] // leaves the stack before the next one comes
fn line<C: PixelCode>(
    out: &mut impl Write,
    name: &str,
    code: C,
    budget: u32,
    is_interpolated: bool,
) -> fmt::Result {
    let camera = FrameEncoder::<C, SIZE, SIZE>::new(code).try_with_budget(budget);
    let mut camera = camera.map_err(|_| fmt::Error)?;
    let mut picture = FrameDecoder::<C, SIZE, SIZE>::new(code);
    let mut line = Line::default();
    picture.start(&frame(0));
    for index in 0..FRAMES {
        let tick = Tick::from(index * PERIOD);
        let emit = |event: PixelEvent| {
            let PixelEvent { tick, x, y, polarity } = event;
            line.event(tick.micros(), x, y, polarity == Polarity::Up);
            picture.decode(event);
        };
        let frame = frame(index);
        if is_interpolated {
            camera.encode_interpolated(tick, &frame, emit);
        } else {
            camera.encode_frame(tick, &frame, emit);
        }
        picture.rows().for_each(|row| line.bytes(&row));
    }
    line.over_budget = camera.over_budget();
    line.write(out, name)
}
