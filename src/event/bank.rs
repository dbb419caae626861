//! Channels side by side: samples in, addressed and time-stamped events out.

use super::{Event, Item, Keyframe, Put, Raw, Tick};
use crate::{Code, ConfigError, Encoder, Firing, Output, Scheme, error};

/// `N` encoders of one kind, such as the six channels of an inertial sensor.
///
/// Channel `c`, neuron `n` has the address `c * NEURONS + n`, where
/// [`NEURONS`](Code::NEURONS) counts the neurons of a channel. Events come out at the tick of the
/// sample that made them known, by rising address; a rate code's sample lies
/// [`LATENCY`](Scheme::LATENCY) samples before. Where sub-timesteps have ticks of their own, events
/// come out in the order of time: what chips, formats and [`Bins`](crate::Bins) want.
///
/// ```
/// use spikewire::{Bank, Event, Polarity, Tick, temporal::StepForward};
///
/// const GYRO: StepForward<f32> = StepForward::<f32>::checked(0.1);
/// let mut bank = Bank::<_, 3>::new(GYRO);
///
/// let mut events = Vec::new();
/// bank.encode(Tick::from_micros(1_000), [0.0, 0.0, 0.0], |event| events.push(event));
/// bank.encode(Tick::from_micros(2_000), [0.3, 0.0, -0.2], |event| events.push(event));
/// assert_eq!(events, [
///     Event { tick: Tick::from_micros(2_000), address: 0, polarity: Polarity::Up },
///     Event { tick: Tick::from_micros(2_000), address: 2, polarity: Polarity::Down },
/// ]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bank<E, const N: usize> {
    channels: [E; N],
    first_address: u16,
    slot_ticks: u32,
}

/// What one sample becomes.
type CodeOf<E> = <<E as Encoder>::Output as Output>::Code;

impl<E: Encoder, const N: usize> Bank<E, N> {
    /// The same scheme on every channel.
    pub fn new<P: Scheme<Encoder = E>>(scheme: P) -> Self {
        Self::from_schemes([scheme; N])
    }

    /// A scheme for each channel, such as one for rates and another for accelerations.
    pub fn from_schemes<P: Scheme<Encoder = E>>(schemes: [P; N]) -> Self {
        Self::from_encoders(schemes.map(Scheme::encoder))
    }

    /// Encoders of the caller's, each with parameters of its own.
    pub fn from_encoders(channels: [E; N]) -> Self {
        const {
            assert!(N >= 1, "a bank has at least one channel");
            assert!(N * CodeOf::<E>::NEURONS <= 1 << 16, "addresses have 16 bits");
        }
        Self { channels, first_address: 0, slot_ticks: 0 }
    }

    /// The same with addresses from this one on, 0 unless told, so that banks share a queue.
    ///
    /// Let the bank whose keyframes a link sends have those from 0 on: a
    /// [`Transmitter`](crate::link::Transmitter) and a [`Receiver`](crate::link::Receiver) number its
    /// channels so.
    ///
    /// # Errors
    /// The last address would be above 65 535.
    pub fn with_first_address(self, first_address: u16) -> Result<Self, ConfigError> {
        error::first_address(first_address, N * CodeOf::<E>::NEURONS)?;
        Ok(Self { first_address, ..self })
    }

    /// The same with sub-timesteps of this many microseconds; 0 unless told.
    #[must_use]
    pub fn with_slot_ticks(self, slot_ticks: u32) -> Self {
        Self { slot_ticks, ..self }
    }

    /// Takes one sample of every channel and hands each event to `emit`.
    #[inline]
    pub fn encode(&mut self, tick: Tick, samples: [E::Sample; N], mut emit: impl FnMut(Event)) {
        if CodeOf::<E>::SLOTS > 1 && self.slot_ticks > 0 {
            return self.encode_by_slot(tick, samples, emit);
        }
        let mut first = self.first_address;
        for (channel, sample) in self.channels.iter_mut().zip(samples) {
            if let Some(code) = channel.encode(sample).code() {
                for firing in code.firings() {
                    emit(event(tick, first, firing));
                }
            }
            first = first.wrapping_add(CodeOf::<E>::NEURONS as u16);
        }
    }

    /// The same where every sub-timestep has a tick of its own.
    fn encode_by_slot(&mut self, tick: Tick, samples: [E::Sample; N], mut emit: impl FnMut(Event)) {
        let mut samples = samples.into_iter();
        let codes = self.channels.each_mut().map(|channel| channel.encode(samples.next()?).code());
        let mut tick = tick;
        for slot in 0..CodeOf::<E>::SLOTS {
            let mut first = self.first_address;
            for code in &codes {
                let firings = code.iter().flat_map(Code::firings);
                for firing in firings.filter(|firing| usize::from(firing.slot) == slot) {
                    emit(event(tick, first, firing));
                }
                first = first.wrapping_add(CodeOf::<E>::NEURONS as u16);
            }
            tick += self.slot_ticks;
        }
    }

    /// Takes one sample of every channel, in the interrupt in which they come, and puts the events into a
    /// queue. Never blocks; what does not fit is counted by the queue as lost, under any policy.
    #[inline]
    pub fn encode_into(&mut self, tick: Tick, samples: [E::Sample; N], mut queue: impl Put) {
        self.encode(tick, samples, |event| queue.put(Item::Event(event)));
    }

    /// Puts a keyframe of every channel that has a value into a queue, behind the events of the samples so
    /// far: call it where the bank encodes. `tick` is that of the last sample.
    pub fn keyframe_into(&self, tick: Tick, mut queue: impl Put)
    where
        E::Sample: Raw,
    {
        let mut address = self.first_address;
        for channel in &self.channels {
            if let Some(value) = channel.keyframe() {
                queue.put(Item::Keyframe(Keyframe::new(tick, address, value)));
            }
            address = address.wrapping_add(CodeOf::<E>::NEURONS as u16);
        }
    }

    /// Resets every encoder, and puts a break into a queue, so that the far end of a link knows.
    pub fn reset_into(&mut self, tick: Tick, mut queue: impl Put) {
        self.reset();
        queue.put(Item::Break(tick));
    }

    /// The encoders, for their keyframes and counters.
    pub fn channels(&self) -> &[E; N] {
        &self.channels
    }

    /// Resets every encoder. The far end of a link does not see this: see [`reset_into`](Self::reset_into).
    pub fn reset(&mut self) {
        for channel in &mut self.channels {
            channel.reset();
        }
    }

    /// How many samples were not finite, over all channels.
    pub fn rejected(&self) -> u32 {
        self.channels.iter().fold(0, |sum, channel| sum.saturating_add(channel.rejected()))
    }
}

#[inline]
fn event(tick: Tick, first_address: u16, firing: Firing) -> Event {
    let Firing { neuron, polarity, .. } = firing;
    Event { tick, address: first_address.wrapping_add(neuron), polarity }
}
