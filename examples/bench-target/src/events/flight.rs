//! The recorded flight as events, and as the samples of a faster sensor.

use spikewire::{
    Bank, Event, Polarity, Sample,
    temporal::{StepForward, StepForwardEncoder},
};

use crate::signal::Measured;

/// Gyroscope x, y, z, then accelerometer x, y, z.
pub const CHANNELS: usize = 6;
/// The recording's time from sample to sample, in µs.
pub const PERIOD: u16 = 5_038;

/// A time stamp in µs, then the channels, four bytes each.
const RECORD: usize = 4 + 4 * CHANNELS;

static RECORDS: &[u8] = flight_data::HEXAROTOR;

pub type Six<S> = Bank<StepForwardEncoder<S>, CHANNELS>;

/// The channels' schemes: a spike for every 0.1 rad/s and every 0.5 m/s².
pub fn schemes<S: Sample>() -> Option<[StepForward<S>; CHANNELS]> {
    let [rate, acceleration] =
        [0.1, 0.5].map(|threshold| StepForward::new(S::from_f64(threshold)).ok());
    let (rate, acceleration) = (rate?, acceleration?);
    Some([rate, rate, rate, acceleration, acceleration, acceleration])
}

pub fn bank<S: Sample>() -> Option<Six<S>> {
    Some(Bank::from_schemes(schemes()?))
}

/// The recording: times in µs, and six channels in rad/s and m/s².
pub fn samples() -> impl Iterator<Item = (u32, [f32; CHANNELS])> {
    let (records, _) = RECORDS.as_chunks::<RECORD>();
    records.iter().map(|record| {
        let (words, _) = record.as_chunks::<4>();
        let value = |at: usize| f32::from_le_bytes(words[at]);
        (u32::from_le_bytes(words[0]), core::array::from_fn(|channel| value(channel + 1)))
    })
}

/// The same in the sample type.
pub fn typed<S: Measured>((tick, set): (u32, [f32; CHANNELS])) -> (u32, [S; CHANNELS]) {
    (tick, set.map(|value| S::from_f64(value.into())))
}

/// The same as a sensor at another rate would have seen it, on straight lines between the samples.
pub fn samples_every(period: u32) -> impl Iterator<Item = (u32, [f32; CHANNELS])> {
    let pairs = samples().zip(samples().skip(1));
    let mut next = 0;
    pairs.flat_map(move |((start, from), (end, to))| {
        let first = next;
        next = end.next_multiple_of(period);
        (first..end).step_by(period as usize).map(move |tick| {
            let part = (tick - start) as f32 / (end - start) as f32;
            (
                tick,
                core::array::from_fn(|channel| {
                    from[channel] + part * (to[channel] - from[channel])
                }),
            )
        })
    })
}

/// Hands every event of the flight to `each`.
pub fn events(mut each: impl FnMut(Event)) {
    let Some(mut bank) = bank::<f32>() else { return };
    for (tick, sample) in samples() {
        bank.encode(tick, sample, &mut each);
    }
}

/// Hands the events of every `ticks` µs to `each`, up to `N` together.
pub fn batches<const N: usize>(ticks: u32, mut each: impl FnMut(&[Event])) {
    let mut batch = [Event { tick: 0, address: 0, polarity: Polarity::Up }; N];
    let mut length = 0;
    events(|event| {
        if length == N || length > 0 && batch[0].tick / ticks != event.tick / ticks {
            each(&batch[..length]);
            length = 0;
        }
        batch[length] = event;
        length += 1;
    });
    each(&batch[..length]);
}

/// Events in their order, as one number.
#[derive(Clone, Copy, PartialEq)]
pub struct Digest(u64);

impl Digest {
    pub const fn new() -> Self {
        Self(0)
    }

    pub fn add(&mut self, event: Event) {
        let Event { tick, address, polarity } = event;
        let up = u64::from(polarity == Polarity::Up);
        let event = u64::from(tick) << 17 | u64::from(address) << 1 | up;
        self.0 = (self.0 ^ event).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
    }
}
