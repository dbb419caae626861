//! Receiver: the decoders of several channels at the end of a link, which know whether their values are exact.

use core::fmt;
use core::num::NonZeroU32;

use super::Received;
use crate::event::{
    Addresses, CodeOf, DecoderStateOf, Event, Keyframe, SampleOf, Schemes, States, Tick,
};
use crate::{Code, ConfigError, NeuronSpike, Recovery, Scheme, error};

/// The decoders of `N` channels at the end of a link, for any code.
///
/// A value is *exact* if it has the bits of a decoder on the sender's side, which loses no event and takes the
/// keyframes that arrive here. (How close that is to the signal depends on the scheme.) After a loss no channel is
/// exact; each becomes exact again as its [`RECOVERY`](Scheme::RECOVERY) says. Until then events are still decoded,
/// and give an [`estimate`](Self::estimate).
///
/// - **Temporal codes** ([`Recovery::Keyframe`]) are exact from their next keyframe on. A value holds from its event
///   until the next one.
/// - **Temporal codes whose step adapts** ([`Recovery::TimedKeyframe`]) are exact from their next keyframe on too. The
///   sender must take its samples every period, as for rate codes.
/// - **Population codes** ([`Recovery::Spike`]) are exact from the next whole sample in which the channel fires. A
///   sample is over when an event of a later one arrives, or by [`advance`](Self::advance).
/// - **Rate codes** ([`Recovery::Samples`]) are exact after as many whole samples as the filter has taps. The sender
///   must take a sample every [period](super::Coding::period) of the link, with a jitter below half a period, since
///   samples without events are decoded, too: after as many of them as the filter has taps the value no longer
///   changes, and the others are passed over.
/// - **Means** ([`Recovery::Fading`]) take their samples every period too. They are never exact: the error of an
///   estimate fades.
///
/// - **Memory:** on a 32-bit part about 40 bytes; per channel the decoder's state, a sample and 8 bytes; and 8 bytes
///   for each of `EVENTS`, the most events that one sample has over all channels. Codes of [`Recovery::Keyframe`] need
///   none of these: 0.
/// - **Latency:** none for codes of [`Recovery::Keyframe`]; for others until the sample is over.
///
/// ```
/// use spikewire::{link::Receiver, temporal::StepForward};
///
/// static GYRO: StepForward<f32> = StepForward::new(0.1);
/// let receiver = Receiver::<_, 6>::new(&GYRO); // the sender's scheme
/// assert_eq!(receiver.exact(0), None); // until its first keyframe
/// ```
pub struct Receiver<T: Schemes<N>, const N: usize, const EVENTS: usize = 32> {
    channels: T::Channels<Channel<DecoderStateOf<T, N>, SampleOf<T, N>>>,
    addresses: Addresses,
    sample: Sampled<EVENTS>,
    outside: u32,
    misfits: u32,
}

#[derive(Clone, Copy, Debug)]
struct Channel<D, S> {
    state: D,
    value: S,
    is_exact: bool,
    /// How many samples were decoded since the last loss.
    whole: usize,
}

impl<D, S> Channel<D, S> {
    fn mark_stale(&mut self) {
        self.is_exact = false;
        self.whole = 0;
    }
}

/// The sample that is being received, of codes that take all events of a sample at once.
#[derive(Clone, Copy, Debug)]
struct Sampled<const EVENTS: usize> {
    /// The tick of the sample. Before the first one: `None`, or a tick from which samples lie whole periods away.
    tick: Option<Tick>,
    /// Whether an event has come.
    has_begun: bool,
    events: [Event; EVENTS],
    count: usize,
    /// Whether none of its events was lost.
    is_whole: bool,
    /// Whether none of the next sample's events was lost.
    is_next_whole: bool,
    period: NonZeroU32,
}

impl<'a, P: Scheme, const N: usize, const EVENTS: usize> Receiver<&'a P, N, EVENTS> {
    /// A receiver whose channels share one scheme, that of the sender.
    pub fn new(scheme: &'a P) -> Self {
        Self::with_schemes(scheme)
    }
}

impl<'a, P: Scheme, const N: usize, const EVENTS: usize> Receiver<[&'a P; N], N, EVENTS> {
    /// A receiver with a scheme for each channel, those of the sender.
    pub fn per_channel(schemes: [&'a P; N]) -> Self {
        Self::with_schemes(schemes)
    }
}

impl<T: Schemes<N>, const N: usize, const EVENTS: usize> Receiver<T, N, EVENTS> {
    const ADDRESSES: usize = N * CodeOf::<T, N>::NEURONS;
    const HAS_KEYFRAMES: bool =
        matches!(T::Scheme::RECOVERY, Recovery::Keyframe | Recovery::TimedKeyframe(_));

    fn with_schemes(schemes: T) -> Self {
        const {
            assert!(N >= 1, "a receiver has at least one channel");
            assert!(Self::ADDRESSES <= 1 << 16, "addresses have 16 bits");
        }
        let channels = schemes.channels(|scheme| {
            let state = scheme.decoder_state();
            let value = scheme.held(&state).unwrap_or_default();
            Channel { state, value, is_exact: false, whole: 0 }
        });
        let addresses = Addresses { first: 0, slot_ticks: 0 };
        Self { channels, addresses, sample: Sampled::NONE, outside: 0, misfits: 0 }
    }

    /// Sets the first address, 0 by default; events of addresses without a channel are counted as
    /// [outside](Self::outside).
    ///
    /// # Panics
    /// If the last address is above 65 535.
    #[must_use]
    pub const fn with_first_address(mut self, first_address: u16) -> Self {
        error::unwrap(error::first_address(first_address, Self::ADDRESSES));
        self.addresses.first = first_address;
        self
    }

    /// Sets the first address, 0 by default.
    ///
    /// # Errors
    /// The last address is above 65 535.
    pub fn try_with_first_address(self, first_address: u16) -> Result<Self, ConfigError> {
        error::first_address(first_address, Self::ADDRESSES)?;
        Ok(Self { addresses: Addresses { first: first_address, ..self.addresses }, ..self })
    }

    /// Sets the length of a sub-timestep in microseconds, 0 by default. `start` is the tick of one of the sender's
    /// samples; the others lie whole periods from it.
    #[must_use]
    pub const fn with_slot_ticks(mut self, slot_ticks: u32, start: Tick) -> Self {
        self.addresses.slot_ticks = slot_ticks;
        self.sample.tick = Some(start);
        self
    }

    /// Decodes a frame, and passes the channel, tick and new value of each keyframe, event or sample to `on_value`, in
    /// order.
    pub fn apply(
        &mut self,
        received: &Received<'_>,
        mut on_value: impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        let frame = &received.frame;
        if received.is_after_break() {
            self.mark_stale();
        }
        self.sample.period = frame.period().into();
        for keyframe in frame.keyframes() {
            self.keyframe(keyframe, &mut on_value);
        }
        let mut events = frame.events();
        for event in &mut events {
            self.event(event, &mut on_value);
        }
        if !events.is_complete() {
            self.misfits = self.misfits.saturating_add(1);
            self.mark_stale();
        }
    }

    /// Tells the receiver that all events before this tick have arrived: samples that are over by then are decoded and
    /// passed to `on_value`. Otherwise a sample is decoded when an event of a later one arrives. Codes of
    /// [`Recovery::Keyframe`] do not need this.
    pub fn advance(&mut self, now: Tick, mut on_value: impl FnMut(u16, Tick, SampleOf<T, N>)) {
        if T::Scheme::RECOVERY != Recovery::Keyframe {
            self.finish_samples(now, &mut on_value);
        }
    }

    /// Marks every channel as not exact, after a loss that the link cannot see.
    pub fn mark_stale(&mut self) {
        T::each_mut(&mut self.channels).for_each(|(_, channel)| channel.mark_stale());
        self.sample.is_whole = false;
        self.sample.is_next_whole = false;
    }

    /// The value of a channel if it is exact, else `None`. For a code of [`Recovery::Keyframe`] it is the value after
    /// the last event, for others that of the last sample that is over.
    pub fn exact(&self, channel: u16) -> Option<SampleOf<T, N>> {
        let (_, channel) = T::each(&self.channels).nth(channel.into())?;
        channel.is_exact.then_some(channel.value)
    }

    /// The value of a channel, exact or not; 0 for a channel that does not exist.
    pub fn estimate(&self, channel: u16) -> SampleOf<T, N> {
        let channel = T::each(&self.channels).nth(channel.into());
        channel.map(|(_, channel)| channel.value).unwrap_or_default()
    }

    /// How many events and keyframes had an address of no channel.
    pub const fn outside(&self) -> u32 {
        self.outside
    }

    /// How many keyframes had another sample type or came for a code without keyframes, plus how many frames had bits
    /// that code no event, plus how many events were more than the `EVENTS` of a sample.
    pub const fn misfits(&self) -> u32 {
        self.misfits
    }

    /// How many neurons a channel has.
    #[inline]
    fn neurons(&self) -> usize {
        T::each(&self.channels).next().map_or(1, |(scheme, _)| scheme.neurons()).max(1)
    }

    fn keyframe(
        &mut self,
        keyframe: Keyframe,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        if matches!(T::Scheme::RECOVERY, Recovery::TimedKeyframe(_)) {
            self.sample_behind(keyframe.tick, on_value);
        }
        let address = usize::from(keyframe.address.wrapping_sub(self.addresses.first));
        let channel = address / self.neurons();
        let Some((scheme, known)) = T::each_mut(&mut self.channels).nth(channel) else {
            self.outside = self.outside.saturating_add(1);
            return;
        };
        match keyframe.value() {
            Some(value) if Self::HAS_KEYFRAMES => {
                scheme.resync(&mut known.state, value);
                known.value = value;
                known.is_exact = true;
                on_value(channel as u16, keyframe.tick, value);
            }
            _ => self.misfits = self.misfits.saturating_add(1),
        }
    }

    #[inline]
    fn event(&mut self, event: Event, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let address = usize::from(event.address.wrapping_sub(self.addresses.first));
        let neurons = self.neurons();
        if address >= N * neurons {
            self.outside = self.outside.saturating_add(1);
        } else if T::Scheme::RECOVERY == Recovery::Keyframe {
            let channel = address / neurons;
            if let Some((scheme, known)) = T::each_mut(&mut self.channels).nth(channel) {
                let neuron = (address % neurons) as u16;
                let firing = NeuronSpike { neuron, slot: 0, polarity: event.polarity };
                let code = Code::assemble(core::iter::once(firing));
                known.value = scheme.decode(&mut known.state, code);
                on_value(channel as u16, event.tick, known.value);
            }
        } else {
            self.sample_at(event.tick, on_value);
            if let Some(place) = self.sample.events.get_mut(self.sample.count) {
                *place = event;
                self.sample.count = self.sample.count.wrapping_add(1);
            } else {
                self.misfits = self.misfits.saturating_add(1);
                self.sample.is_whole = false;
                let channel = address.checked_div(neurons).unwrap_or(0);
                if let Some((_, known)) = T::each_mut(&mut self.channels).nth(channel) {
                    known.mark_stale();
                }
            }
        }
    }

    /// Goes on to the sample of an event at this tick.
    fn sample_at(&mut self, tick: Tick, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        self.finish_samples(tick, on_value);
        // Events that were lost before this one belong to its sample or to an earlier one.
        self.sample.is_next_whole = true;
        self.sample.has_begun = true;
        if self.addresses.slot_ticks == 0 {
            // The event's own tick instead of a whole number of periods: samples are counted from here on, whatever
            // the jitter, and where the sender's period is not quite that of the link.
            self.sample.tick = Some(tick);
        }
    }

    /// Goes on to the sample after a keyframe of this tick, whose own sample is over.
    fn sample_behind(&mut self, tick: Tick, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let next = tick + u32::from(self.sample.period);
        self.finish_samples(next, on_value);
        self.sample.tick.get_or_insert(next);
        self.sample.has_begun = true;
    }

    /// Decodes the sample that is over at this tick, and the samples without events after it.
    fn finish_samples(&mut self, now: Tick, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let Some(tick) = self.sample.tick else { return };
        let Sampled { period, is_next_whole, .. } = self.sample;
        let since = now.since(tick).max(0) as u32;
        // With sub-timesteps an event lies in the period after its sample, otherwise near its sample.
        let has_slots = self.addresses.slot_ticks > 0;
        let half = if has_slots { 0 } else { period.get() / 2 };
        let samples = since.saturating_add(half) / period;
        if samples == 0 {
            return;
        }
        self.sample.tick = Some(tick + samples.wrapping_mul(period.get()));
        if self.sample.has_begun {
            self.decode(tick, on_value);
            self.sample.is_whole = is_next_whole;
            self.sample.count = 0;
            let recovery = T::each(&self.channels).next().map(|(scheme, _)| scheme.recovery());
            if let Some(
                Recovery::Samples(recovery)
                | Recovery::TimedKeyframe(recovery)
                | Recovery::Fading(recovery),
            ) = recovery
            {
                for sample in (1..samples).take(recovery) {
                    self.decode(tick + sample.wrapping_mul(period.get()), on_value);
                }
            }
        }
    }

    /// Decodes a sample that is over, in every channel.
    fn decode(&mut self, tick: Tick, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let events = self.sample.events.get(..self.sample.count).unwrap_or_default();
        for (channel, (scheme, known)) in (0..N).zip(T::each_mut(&mut self.channels)) {
            let code: CodeOf<T, N> = self.addresses.code(channel, scheme.neurons(), tick, events);
            known.value = scheme.decode(&mut known.state, code);
            if self.sample.is_whole {
                known.whole = known.whole.saturating_add(1);
                known.is_exact |= match scheme.recovery() {
                    Recovery::Samples(needed) => known.whole >= needed,
                    Recovery::Spike => code.firings().next().is_some(),
                    Recovery::Keyframe | Recovery::TimedKeyframe(_) | Recovery::Fading(_) => false,
                };
            }
            on_value(channel as u16, tick, known.value);
        }
    }
}

impl<const EVENTS: usize> Sampled<EVENTS> {
    const NONE: Self = Self {
        tick: None,
        has_begun: false,
        events: [Event::ZERO; EVENTS],
        count: 0,
        is_whole: false,
        is_next_whole: false,
        period: NonZeroU32::MIN,
    };
}

impl<T: Schemes<N>, const N: usize, const EVENTS: usize> Clone for Receiver<T, N, EVENTS>
where
    T::Channels<Channel<DecoderStateOf<T, N>, SampleOf<T, N>>>: Clone,
{
    fn clone(&self) -> Self {
        Self { channels: self.channels.clone(), ..*self }
    }
}

impl<T: Schemes<N>, const N: usize, const EVENTS: usize> fmt::Debug for Receiver<T, N, EVENTS> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut receiver = f.debug_struct("Receiver");
        receiver.field("channels", &States::<T, _, N>(&self.channels));
        receiver.field("addresses", &self.addresses);
        receiver.finish_non_exhaustive()
    }
}
