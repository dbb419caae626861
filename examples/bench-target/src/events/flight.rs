//! The recorded flight as events, and as the samples of a faster sensor.

use spikewire::{Bank, ConfigError, Event, Polarity, Start, Tick, temporal::StepForward};

use crate::signal::Measured;

/// Gyroscope x, y, z, then accelerometer x, y, z.
pub const CHANNELS: usize = 6;
/// The recording's time from sample to sample, in µs.
pub const PERIOD: u16 = 5_038;

/// A scheme for each channel.
pub type Six<'a, P> = [&'a P; CHANNELS];

/// The channels' schemes: a spike for every 0.1 rad/s and every 0.5 m/s².
pub struct Schemes<P> {
    rate: P,
    acceleration: P,
}

impl<P: Start<Sample: Measured>> Schemes<P> {
    /// Of what `scheme` makes of a threshold.
    pub fn new(scheme: impl Fn(P::Sample) -> Result<P, ConfigError>) -> Option<Self> {
        let [rate, acceleration] = [0.1, 0.5].map(|threshold| scheme(in_units(threshold)).ok());
        Some(Self { rate: rate?, acceleration: acceleration? })
    }

    pub fn each(&self) -> Six<'_, P> {
        let Self { rate, acceleration } = self;
        [rate, rate, rate, acceleration, acceleration, acceleration]
    }

    pub fn bank(&self) -> Bank<Six<'_, P>, CHANNELS> {
        Bank::per_channel(self.each())
    }
}

/// The recording: times in µs, and six channels in rad/s and m/s².
pub fn samples() -> impl Iterator<Item = (Tick, [f32; CHANNELS])> {
    let records = flight_data::records(flight_data::HEXAROTOR);
    records.map(|record| (record.micros.into(), record.channels))
}

/// A set of samples in the sample type.
pub fn typed<S: Measured>((tick, set): (Tick, [f32; CHANNELS])) -> (Tick, [S; CHANNELS]) {
    (tick, set.map(|value| in_units(value.into())))
}

fn in_units<S: Measured>(value: f64) -> S {
    S::from_f64(value * S::UNITS)
}

/// The recording as a sensor at another rate would have seen it, on straight lines between the samples.
pub fn samples_every(period: u32) -> impl Iterator<Item = (Tick, [f32; CHANNELS])> {
    let pairs = samples().zip(samples().skip(1));
    let mut next = 0;
    pairs.flat_map(move |((start, from), (end, to))| {
        let (start, end) = (start.micros(), end.micros());
        let first = next;
        next = end.next_multiple_of(period);
        (first..end).step_by(period as usize).map(move |tick| {
            let part = (tick - start) as f32 / (end - start) as f32;
            (
                Tick::from(tick),
                core::array::from_fn(|channel| {
                    from[channel] + part * (to[channel] - from[channel])
                }),
            )
        })
    })
}

/// Hands every event of the flight to `each`.
pub fn events(mut each: impl FnMut(Event)) {
    let Some(schemes) = Schemes::new(StepForward::<f32>::try_new) else { return };
    let mut bank = schemes.bank();
    for (tick, sample) in samples() {
        bank.encode(tick, sample, &mut each);
    }
}

/// For places that wait for an event.
pub const NO_EVENT: Event =
    Event { tick: Tick::from_micros(0), address: 0, polarity: Polarity::Up };

/// Hands the events of every `ticks` µs to `each`, up to `N` together.
pub fn batches<const N: usize>(ticks: u32, mut each: impl FnMut(&[Event])) {
    let mut batch = [NO_EVENT; N];
    let mut length = 0;
    let number = |event: Event| event.tick.micros() / ticks;
    events(|event| {
        if length == N || length > 0 && number(batch[0]) != number(event) {
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
        let event = u64::from(tick.micros()) << 17 | u64::from(address) << 1 | up;
        self.0 = (self.0 ^ event).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
    }
}
