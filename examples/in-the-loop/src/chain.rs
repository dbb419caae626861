//! Registers to spikes, frames, values and speeds, a sample at a time.

use core::fmt;

use spikewire::{
    Bank, FromItems, Item, Put, Tick,
    link::{MAX_FRAME, Reader, Receiver, Session, Transmitter},
    temporal::SendOnDelta,
};

use crate::control::Control;
use board::usart::Usart1;

const CHANNELS: usize = 6;
type Scheme = SendOnDelta<f32, 10>;
/// As `laptop/loop/codes.json` has them.
static RATE: Scheme = SendOnDelta::new(0.133_065);
static ASIDE: Scheme = SendOnDelta::new(0.320_045);
static UP: Scheme = SendOnDelta::new(0.755_087_44);
const SCHEMES: [&Scheme; CHANNELS] = [&RATE, &RATE, &RATE, &ASIDE, &ASIDE, &UP];

/// In µs.
const PERIOD: u16 = 2_000;
/// Samples from keyframe to keyframe.
const KEYFRAME_EVERY: u32 = 10;
/// What a count is: ±2000 °/s, and ±24 g.
const RATE_UNIT: f64 = 2000.0 / 32768.0 * (core::f64::consts::PI / 180.0);
const FORCE_UNIT: f64 = 24.0 / 32768.0 * 9.80665;

/// The board's first word.
const READY: u8 = b'!';
/// The world's last word.
const END: u8 = 0xFF;

/// Items of one sample: 60 events and 6 keyframes at most.
struct Items {
    all: [Option<Item>; 66],
    count: usize,
}

impl Put for &mut Items {
    fn put(&mut self, item: Item) {
        if let Some(place) = self.all.get_mut(self.count) {
            *place = Some(item);
            self.count += 1;
        }
    }
}

pub fn run(out: &mut impl fmt::Write) -> fmt::Result {
    let mut line = Usart1::new();
    let mut bank = Bank::<_, CHANNELS>::per_channel(SCHEMES);
    let mut transmitter = Transmitter::for_bank(&bank, PERIOD.into(), Session::counted(0));
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, CHANNELS, 0>::per_channel(SCHEMES);
    let mut control = Control::new(500.0);
    let mut samples = 0_u32;
    // A port that is not yet on hears nothing: the world waits for this.
    line.send(&[READY]);
    loop {
        // Which of the sample's frames are lost, a bit each.
        let [lost] = line.take();
        if lost == END {
            return writeln!(out, "{samples} samples, {} frames lost", reader.lost_frames());
        }
        let mut sample = [0.0; CHANNELS];
        for (channel, value) in sample.iter_mut().enumerate() {
            let count = f64::from(i16::from_le_bytes(line.take()));
            *value = (count * if channel < 3 { RATE_UNIT } else { FORCE_UNIT }) as f32;
        }
        let [attitude @ .., thrust, turn] = [(); 6].map(|()| f32::from_le_bytes(line.take()));

        let tick = Tick::from(samples.wrapping_mul(PERIOD.into()));
        let mut items = Items { all: [None; 66], count: 0 };
        bank.encode_into(tick, sample, &mut items);
        if samples.is_multiple_of(KEYFRAME_EVERY) {
            bank.keyframe_into(tick, &mut items);
        }
        samples = samples.wrapping_add(1);
        let mut source = FromItems(items.all.into_iter().flatten());
        let mut buffer = [0; MAX_FRAME];
        let mut number = 0;
        while let Some(frame) =
            transmitter.next_frame(&mut source, &mut buffer).map_err(|_| fmt::Error)?
        {
            line.send(&(frame.len() as u16).to_le_bytes());
            line.send(frame);
            let mut bytes = frame;
            while lost >> number & 1 == 0
                && let Some(received) = reader.next_frame(&mut bytes)
            {
                receiver.apply(&received, |_, _, _| ());
            }
            number += 1;
        }
        line.send(&[0; 2]);

        let heard: [f32; CHANNELS] =
            core::array::from_fn(|channel| receiver.estimate(channel as u16));
        let speeds = control.step(heard, attitude, thrust, [turn, 0.0, 0.0]);
        for value in heard.into_iter().chain(speeds) {
            line.send(&value.to_le_bytes());
        }
    }
}
