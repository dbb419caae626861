//! Receiver: the decoders of several channels at the end of a link, which know whether their values are exact.

use core::fmt;
use core::num::{NonZeroU32, NonZeroU64};

use super::time::Time;
use super::{Received, Withheld};
use crate::event::{
    Addresses, CodeOf, DecoderStateOf, Event, Keyframe, SampleOf, Schemes, States, Tick,
};
use crate::{Code, ConfigError, NeuronSpike, Recovery, Scheme, error};

/// The decoders of `N` channels at the end of a link, for any code.
///
/// A value is *exact* if it has the bits of a decoder on the sender's side, which loses no event and takes the
/// keyframes that arrive here. (How close that is to the signal depends on the scheme.) After a loss no channel is
/// exact; each becomes exact again as its [`RECOVERY`](Scheme::RECOVERY) says. Until then events are still decoded,
/// and give an [`estimate`](Self::estimate); [`withheld`](Self::withheld) says what is missing.
///
/// - **Temporal codes** ([`Recovery::Keyframe`]) are exact from their next keyframe on. A value holds from its event
///   until the next one.
/// - **Temporal codes whose step adapts** ([`Recovery::TimedKeyframe`]) are exact from their next keyframe on too. The
///   sender must take its samples every period, as for rate codes.
/// - **Population codes** ([`Recovery::Spike`]) are exact from the next whole sample in which the channel fires. A
///   sample is over when an event of a later one or a heartbeat arrives, or at [`advance`](Self::advance).
/// - **Rate codes** ([`Recovery::Samples`]) are exact after as many whole samples as the filter has taps. The sender
///   must take a sample every [period](super::Coding::period) of the link, with a jitter of each tick below a quarter of
///   a period, since samples without events are decoded, too: after as many of them as the filter has taps the value no
///   longer changes, and the others are passed over.
/// - **Means** ([`Recovery::Fading`]) take their samples every period too. They are never exact: the error of an
///   estimate fades.
/// - **Codes with sub-timesteps** need the sender's [`with_slot_ticks`](Self::with_slot_ticks), and a
///   [heartbeat](crate::Item::Heartbeat) after each loss, which says when a sample was taken: no value is decoded before.
///   The sender must take a sample every period, as long as all sub-timesteps or longer, with a jitter of each tick
///   below a quarter of a sub-timestep.
///
/// **Time:** however long a link is down, or a sender at rest, a frame's time says how many samples have passed. The
/// sender must know it: see [`Transmitter::observe`](super::Transmitter::observe).
///
/// - **Memory:** on a 32-bit part about 64 bytes; per channel the decoder's state, a sample and 8 bytes; and 8 bytes
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
    /// How many sub-timesteps a sample has, in the channel with most; 1 where they do not matter.
    slots: u32,
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
    /// The time of the sample; `None` while it is not known.
    time: Option<Time>,
    /// The events, each at the tick of its sub-timestep from 0 on.
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
        let mut slots = 1;
        let channels = schemes.channels(|scheme| {
            if T::Scheme::RECOVERY != Recovery::Keyframe {
                slots = slots.max(scheme.slots() as u32);
            }
            let state = scheme.decoder_state();
            let value = scheme.held(&state).unwrap_or_default();
            Channel { state, value, is_exact: false, whole: 0 }
        });
        let addresses = Addresses { first: 0, slot_ticks: 0 };
        Self { channels, addresses, slots, sample: Sampled::NONE, outside: 0, misfits: 0 }
    }

    /// Sets the first address, 0 by default; events of addresses without a channel are counted as
    /// [outside](Self::outside).
    ///
    /// # Panics
    /// Panics if the last address is above 65 535.
    #[must_use]
    pub const fn with_first_address(mut self, first_address: u16) -> Self {
        error::unwrap(error::first_address(first_address, Self::ADDRESSES));
        self.addresses.first = first_address;
        self
    }

    /// Sets the first address, 0 by default.
    ///
    /// # Errors
    /// Returns an error if the last address is above 65 535.
    pub fn try_with_first_address(self, first_address: u16) -> Result<Self, ConfigError> {
        error::first_address(first_address, Self::ADDRESSES)?;
        Ok(Self { addresses: Addresses { first: first_address, ..self.addresses }, ..self })
    }

    /// Sets the length of a sub-timestep in microseconds, that of the sender's
    /// [bank](crate::Bank::with_slot_ticks). By default it is 0: a code with sub-timesteps is then not decoded.
    #[must_use]
    pub const fn with_slot_ticks(mut self, slot_ticks: u32) -> Self {
        self.addresses.slot_ticks = slot_ticks;
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
            self.begin_again(received.is_start, &mut on_value);
        }
        self.sample.period = frame.period().into();
        for keyframe in frame.keyframes() {
            self.keyframe(frame.time(), keyframe, &mut on_value);
        }
        for address in frame.heartbeats() {
            self.heartbeat(frame.time(), address, &mut on_value);
        }
        let mut events = frame.events();
        for event in &mut events {
            self.event(frame.time(), event, &mut on_value);
        }
        if !events.is_complete() {
            self.misfits = self.misfits.saturating_add(1);
            self.mark_stale();
        }
    }

    /// Tells the receiver that all events before this tick have arrived: samples that are over by then are decoded and
    /// passed to `on_value`. Otherwise a sample is decoded when an event of a later one arrives. `now` must lie less than
    /// 2³¹ µs (35.8 minutes) after the last event or call. Codes of [`Recovery::Keyframe`] do not need this.
    pub fn advance(&mut self, now: Tick, mut on_value: impl FnMut(u16, Tick, SampleOf<T, N>)) {
        if let Some(time) = self.sample.time {
            self.finish_samples(time.nearest(now), &mut on_value);
        }
    }

    /// Marks every channel as not exact, after a loss that the link cannot see.
    pub fn mark_stale(&mut self) {
        T::each_mut(&mut self.channels).for_each(|(_, channel)| channel.mark_stale());
        self.sample.is_whole = false;
        self.sample.is_next_whole = false;
    }

    /// Marks every channel as not exact after a loss, and forgets when samples are taken where that may have changed.
    fn begin_again(
        &mut self,
        is_start: bool,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        self.mark_stale();
        if (is_start || self.has_slots())
            && let Some(time) = self.sample.time.take()
            && self.sample.count > 0
        {
            self.decode(time, on_value);
            self.sample.count = 0;
        }
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

    /// Why a channel has no exact value; `None` if it has one, or does not exist.
    pub fn withheld(&self, channel: u16) -> Option<Withheld> {
        let (scheme, channel) = T::each(&self.channels).nth(channel.into())?;
        let Sampled { time, period, .. } = self.sample;
        let slot_ticks = self.addresses.slot_ticks;
        Some(match scheme.recovery() {
            _ if channel.is_exact => return None,
            Recovery::Keyframe | Recovery::TimedKeyframe(_) => Withheld::Keyframe,
            Recovery::Fading(_) => Withheld::Always,
            _ if self.has_slots() && slot_ticks == 0 => Withheld::SlotTicks,
            _ if self.is_blind() && period > NonZeroU32::MIN => {
                Withheld::Slots { slots: self.slots, slot_ticks, period: period.get() }
            }
            _ if self.has_slots() && time.is_none() => Withheld::Heartbeat,
            Recovery::Samples(needed) => Withheld::Samples(needed.saturating_sub(channel.whole)),
            Recovery::Spike => Withheld::Spike,
        })
    }

    /// Number of events and keyframes whose address belongs to no channel.
    pub const fn outside(&self) -> u32 {
        self.outside
    }

    /// Number of things that do not fit the schemes: keyframes of another sample type or for a code without keyframes;
    /// frames with bits that code no event; events beyond the `EVENTS` of a sample, after their sample was over, or in
    /// none of its sub-timesteps.
    pub const fn misfits(&self) -> u32 {
        self.misfits
    }

    /// How many neurons a channel has.
    #[inline]
    fn neurons(&self) -> usize {
        T::each(&self.channels).next().map_or(1, |(scheme, _)| scheme.neurons()).max(1)
    }

    /// Whether the code tells values by sub-timesteps.
    #[inline]
    fn has_slots(&self) -> bool {
        CodeOf::<T, N>::SLOTS > 1 && self.slots > 1
    }

    /// Whether all sub-timesteps of a sample are over when the next begins.
    fn slots_fit(&self) -> bool {
        let length = u64::from(self.slots).wrapping_mul(self.addresses.slot_ticks.into());
        length <= u64::from(self.sample.period.get())
    }

    /// Whether the code tells values by sub-timesteps that are not known.
    fn is_blind(&self) -> bool {
        self.has_slots() && (self.addresses.slot_ticks == 0 || !self.slots_fit())
    }

    fn keyframe(
        &mut self,
        time: Time,
        keyframe: Keyframe,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        let address = usize::from(keyframe.address.wrapping_sub(self.addresses.first));
        let channel = address / self.neurons();
        if channel < N && matches!(T::Scheme::RECOVERY, Recovery::TimedKeyframe(_)) {
            self.sample_behind(time, on_value);
        }
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

    fn heartbeat(
        &mut self,
        time: Time,
        address: u16,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        let address = usize::from(address.wrapping_sub(self.addresses.first));
        if address >= N * self.neurons() {
            self.outside = self.outside.saturating_add(1);
        } else if T::Scheme::RECOVERY != Recovery::Keyframe {
            self.sample_behind(time, on_value);
        }
    }

    /// Takes an event of a frame of this time.
    #[inline]
    fn event(
        &mut self,
        frame: Time,
        event: Event,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
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
            self.sampled_event(frame.nearest(event.tick), event, on_value);
        }
    }

    /// Takes an event of a code that takes all events of a sample at once.
    fn sampled_event(
        &mut self,
        time: Time,
        event: Event,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        if self.is_blind() || self.has_slots() && self.sample.time.is_none() {
            return;
        }
        self.finish_samples(time, on_value);
        let Some(slot) = self.slot(time) else {
            self.misfits = self.misfits.saturating_add(1);
            return self.begin_again(true, on_value);
        };
        // Events that were lost before this one belong to its sample or to an earlier one.
        self.sample.is_next_whole = true;
        let after = slot.wrapping_mul(self.addresses.slot_ticks);
        // The event's own time instead of a whole number of periods: samples are counted from here on, whatever the
        // jitter, and where the sender's period is not quite that of the link.
        self.sample.time = Some(time.after(u64::from(after).wrapping_neg()));
        if let Some(place) = self.sample.events.get_mut(self.sample.count) {
            *place = Event { tick: after.into(), ..event };
            self.sample.count = self.sample.count.wrapping_add(1);
        } else {
            self.misfits = self.misfits.saturating_add(1);
            self.sample.is_whole = false;
            let address = usize::from(event.address.wrapping_sub(self.addresses.first));
            let channel = address.checked_div(self.neurons()).unwrap_or(0);
            if let Some((_, known)) = T::each_mut(&mut self.channels).nth(channel) {
                known.mark_stale();
            }
        }
    }

    /// How far an event may lie before its sample's time or sub-timestep: half a period, or half a sub-timestep.
    fn half(&self) -> u32 {
        let length =
            if self.has_slots() { self.addresses.slot_ticks } else { self.sample.period.get() };
        length / 2
    }

    /// The sub-timestep of the present sample at this time; `None` if the time lies in none.
    fn slot(&self, time: Time) -> Option<u32> {
        let Some(sample) = self.sample.time else { return Some(0) };
        let since = time.since(sample).saturating_add(self.half().into());
        let since = u32::try_from(since).ok()?;
        if !self.has_slots() {
            return Some(0);
        }
        let slot = since.checked_div(self.addresses.slot_ticks)?;
        (slot < self.slots).then_some(slot)
    }

    /// Goes on to the sample after the one taken at this time, which is over.
    fn sample_behind(&mut self, time: Time, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        if self.is_blind() {
            return;
        }
        let next = time.after(self.sample.period.get().into());
        self.finish_samples(next, on_value);
        // Events that come from here on belong to the next sample or to a later one.
        self.sample.is_whole |= self.sample.count == 0;
        self.sample.is_next_whole = true;
        self.sample.time = Some(next);
    }

    /// Decodes the sample that is over at this time, and the samples without events after it.
    fn finish_samples(&mut self, now: Time, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let Some(time) = self.sample.time else { return };
        let Sampled { period, is_next_whole, .. } = self.sample;
        // With sub-timesteps an event lies in the period after its sample, otherwise near its sample.
        let half = self.half();
        let since = now.since(time).saturating_add(half.into()).max(0).cast_unsigned();
        let samples = match u32::try_from(since) {
            Ok(since) => (since / period).into(),
            Err(_) => since / NonZeroU64::from(period),
        };
        if samples == 0 {
            return;
        }
        let period = u64::from(period.get());
        self.sample.time = Some(time.after(samples.wrapping_mul(period)));
        self.decode(time, on_value);
        self.sample.is_whole = is_next_whole;
        self.sample.count = 0;
        if samples == 1 {
            return;
        }
        // From the longest recovery on, samples without events change no channel.
        let silent = T::each(&self.channels).map(|(scheme, _)| match scheme.recovery() {
            Recovery::Samples(samples)
            | Recovery::TimedKeyframe(samples)
            | Recovery::Fading(samples) => samples,
            Recovery::Keyframe | Recovery::Spike => 0,
        });
        let silent = silent.max().unwrap_or_default();
        for sample in (1..samples).take(silent) {
            self.decode(time.after(sample.wrapping_mul(period)), on_value);
        }
    }

    /// Decodes a sample that is over, in every channel.
    fn decode(&mut self, time: Time, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let events = self.sample.events.get(..self.sample.count).unwrap_or_default();
        let tick = time.tick();
        for (channel, (scheme, known)) in (0..N).zip(T::each_mut(&mut self.channels)) {
            let code: CodeOf<T, N> =
                self.addresses.code(channel, scheme.neurons(), 0.into(), events);
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
        time: None,
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
