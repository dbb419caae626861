//! Channels side by side: samples in, addressed and time-stamped events out.

use crate::error;
#[cfg(feature = "queue")]
use crate::sink::EventQueue;
use crate::spike::{Code, Event, Firing};
use crate::{ConfigError, Encoder, Output, Scheme};
#[cfg(feature = "link")]
use crate::{Mark, Spike, link::Snapshot};

/// `N` encoders of one kind, such as the six channels of an inertial sensor.
///
/// Channel `c`, neuron `n` has the address `c * NEURONS + n`, where
/// [`NEURONS`](Code::NEURONS) counts the neurons of a channel. Events come out at the tick of the
/// sample that made them known, by rising address; a rate code's sample lies
/// [`LATENCY`](Scheme::LATENCY) samples before. Where sub-timesteps have ticks of their own, events
/// come out in the order of time: what chips, formats and [`Bins`](crate::Bins) want.
///
/// ```
/// use spikewire::{Bank, Event, Polarity, temporal::StepForward};
///
/// const GYRO: StepForward<f32> = StepForward::<f32>::checked(0.1);
/// let mut bank = Bank::<_, 3>::new(GYRO);
///
/// let mut events = Vec::new();
/// bank.encode(1_000, [0.0, 0.0, 0.0], |event| events.push(event));
/// bank.encode(2_000, [0.3, 0.0, -0.2], |event| events.push(event));
/// assert_eq!(events, [
///     Event { tick: 2_000, address: 0, polarity: Polarity::Up },
///     Event { tick: 2_000, address: 2, polarity: Polarity::Down },
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
    pub fn encode(&mut self, tick: u32, samples: [E::Sample; N], mut emit: impl FnMut(Event)) {
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
    fn encode_by_slot(&mut self, tick: u32, samples: [E::Sample; N], mut emit: impl FnMut(Event)) {
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
            tick = tick.wrapping_add(self.slot_ticks);
        }
    }

    /// The same into a queue, from the interrupt in which the samples come. Never blocks; what does not
    /// fit is counted in the queue, as lost under any policy, since nobody takes it back.
    #[cfg(feature = "queue")]
    #[inline]
    pub fn encode_into<const Q: usize>(
        &mut self,
        tick: u32,
        samples: [E::Sample; N],
        events: &EventQueue<Q>,
    ) {
        self.encode(tick, samples, |event| events.put(event));
    }

    /// What the encoders hold, for the keyframes of a link.
    ///
    /// `tick` is that of the last sample encoded, `mark` the queue's at the same moment: take it where
    /// the bank encodes, before the next sample.
    #[cfg(feature = "link")]
    pub fn snapshot(&self, tick: u32, mark: Mark) -> Snapshot<E::Sample, N>
    where
        E::Output: Output<Code = Spike>,
    {
        Snapshot { tick, mark, values: self.channels.each_ref().map(Encoder::keyframe) }
    }

    /// The encoders, for their keyframes and counters.
    pub fn channels(&self) -> &[E; N] {
        &self.channels
    }

    /// Resets every encoder. The far end of a link does not see this: tell it by
    /// [`Transmitter::mark_break`](crate::link::Transmitter::mark_break).
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
fn event(tick: u32, first_address: u16, firing: Firing) -> Event {
    let Firing { neuron, polarity, .. } = firing;
    Event { tick, address: first_address.wrapping_add(neuron), polarity }
}
