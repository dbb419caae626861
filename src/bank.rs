//! Channels side by side: samples in, addressed and time-stamped events out.

#[cfg(feature = "queue")]
use crate::sink::EventQueue;
use crate::spike::{Code, Event};
use crate::{Encoder, Output, Scheme};
#[cfg(feature = "link")]
use crate::{Spike, link::Snapshot};

/// `N` encoders of one kind, such as the six channels of an inertial sensor.
///
/// Channel `c`, neuron `n` has the address `c * NEURONS + n`, where
/// [`NEURONS`](Code::NEURONS) counts the neurons of a channel. Events come out by rising address,
/// at the tick of the sample that made them known, plus the slot's time for codes with
/// sub-timesteps; a rate code's sample lies [`LATENCY`](Scheme::LATENCY) samples before.
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
    slot_ticks: u32,
}

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
            assert!(
                N * <<E::Output as Output>::Code as Code>::NEURONS <= 1 << 16,
                "addresses have 16 bits"
            );
        }
        Self { channels, slot_ticks: 0 }
    }

    /// The same with sub-timesteps of this many microseconds; 0 unless told.
    #[must_use]
    pub fn with_slot_ticks(self, slot_ticks: u32) -> Self {
        Self { slot_ticks, ..self }
    }

    /// Takes one sample of every channel and hands each event to `emit`.
    #[inline]
    pub fn encode(&mut self, tick: u32, samples: [E::Sample; N], mut emit: impl FnMut(Event)) {
        let mut first = 0_u16;
        for (channel, sample) in self.channels.iter_mut().zip(samples) {
            if let Some(code) = channel.encode(sample).code() {
                for firing in code.firings() {
                    emit(Event {
                        tick: tick.wrapping_add(self.slot_ticks.wrapping_mul(firing.slot.into())),
                        address: first.wrapping_add(firing.neuron),
                        polarity: firing.polarity,
                    });
                }
            }
            first = first.wrapping_add(<<E::Output as Output>::Code as Code>::NEURONS as u16);
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
    /// `tick` is that of the last sample encoded, `lost` the queue's count at the same moment: take it
    /// where the bank encodes, before the next sample.
    #[cfg(feature = "link")]
    pub fn snapshot(&self, tick: u32, lost: u32) -> Snapshot<E::Sample, N>
    where
        E::Output: Output<Code = Spike>,
    {
        Snapshot { tick, lost, values: self.channels.each_ref().map(Encoder::keyframe) }
    }

    /// The encoders, for their keyframes and counters.
    pub fn channels(&self) -> &[E; N] {
        &self.channels
    }

    /// Resets every encoder.
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
