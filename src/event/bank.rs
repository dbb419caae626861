//! Bank: the encoders of several channels, from samples to address events.

use core::fmt;

use super::address::addressed;
use super::schemes::{CodeOf, EncoderStateOf, SampleOf, States};
use super::{Event, Item, Keyframe, Put, Schemes, Tick};
#[cfg(feature = "link")]
use crate::Recovery;
use crate::num::{Bands, Quiet};
use crate::{Code, ConfigError, Fingerprint, NeuronSpike, Output, Sample, Scheme, Start};

/// The encoders of `N` channels, such as the six of an inertial sensor: one scheme for all channels or one for each,
/// and a state for each.
///
/// - **Addresses:** neuron `n` of channel `c` has the address `c * neurons + n`, where
///   [`neurons`](Scheme::neurons) is the number of neurons of a channel.
/// - **Order:** events come by rising address, with the tick of the sample just encoded. A rate code's spike belongs
///   to the sample [`LATENCY`](Scheme::LATENCY) samples earlier. With a tick for each
///   [sub-timestep](Self::with_slot_ticks), events come in the order of time, as chips, formats and
///   [`Bins`](crate::Bins) need them.
/// - **Work:** where all samples lie within their [quiet bands](Scheme::quiet_band), one test of all channels.
/// - **Memory:** the channels' states, 8 bytes for each channel, 4 in 16 bits, and 8 bytes; and 4 bytes for each reference to
///   a scheme on a 32-bit part.
///
/// ```
/// use spikewire::{Bank, Event, Polarity, Tick, temporal::StepForward};
///
/// static GYRO: StepForward<f32> = StepForward::new(0.1);
/// let mut bank = Bank::<_, 3>::new(&GYRO); // may be a static itself
///
/// let [first, second] = [1_000, 2_000].map(Tick::from_micros);
/// let mut events = Vec::new();
/// bank.encode(first, [0.0, 0.0, 0.0], |event| events.push(event));
/// bank.encode(second, [0.3, 0.0, -0.2], |event| events.push(event));
/// assert_eq!(events, [
///     Event { tick: second, address: 0, polarity: Polarity::Up },
///     Event { tick: second, address: 2, polarity: Polarity::Down },
/// ]);
/// ```
pub struct Bank<T: Schemes<N>, const N: usize> {
    channels: T::Channels<EncoderStateOf<T, N>>,
    /// Bands within which samples change nothing.
    quiet: Bands<SampleOf<T, N>, N>,
    first_address: u16,
    slot_ticks: u32,
}

impl<'a, P: Start, const N: usize> Bank<&'a P, N> {
    /// A bank whose channels share one scheme.
    pub const fn new(scheme: &'a P) -> Self {
        Self::with_states(scheme, [P::START; N])
    }
}

impl<'a, P: Scheme, const N: usize> Bank<&'a P, N> {
    /// A bank whose encoders go on from these states, as for a code that draws from a generator.
    pub const fn with_states(scheme: &'a P, states: [P::EncoderState; N]) -> Self {
        Self::with_channels((scheme, states))
    }
}

impl<'a, P: Start, const N: usize> Bank<[&'a P; N], N> {
    /// A bank with a scheme for each channel, such as one for rates and another for accelerations.
    #[expect(clippy::indexing_slicing, reason = "below N, and there is at least one")]
    pub const fn per_channel(schemes: [&'a P; N]) -> Self {
        let mut channels = [(schemes[0], P::START); N];
        let mut at = 1;
        while at < N {
            channels[at].0 = schemes[at];
            at += 1;
        }
        Self::per_channel_with_states(channels)
    }
}

impl<'a, P: Scheme, const N: usize> Bank<[&'a P; N], N> {
    /// A bank with a scheme for each channel, whose encoders go on from these states.
    pub const fn per_channel_with_states(channels: [(&'a P, P::EncoderState); N]) -> Self {
        Self::with_channels(channels)
    }
}

impl<T: Schemes<N>, const N: usize> Bank<T, N> {
    /// How many addresses it takes.
    const ADDRESSES: usize = N * CodeOf::<T, N>::NEURONS;

    const fn with_channels(channels: T::Channels<EncoderStateOf<T, N>>) -> Self {
        const {
            assert!(N >= 1, "a bank has at least one channel");
            assert!(Self::ADDRESSES <= 1 << 16, "addresses have 16 bits");
        }
        Self { channels, quiet: Bands::NONE, first_address: 0, slot_ticks: 0 }
    }

    addressed! {
        /// Sets the first address, 0 by default, so that several banks can share a queue. Banks that share a link are
        /// joined by `Transmitter::for_banks`, which sets it.
        first_address;
        /// Sets the length of a sub-timestep in microseconds. By default it is 0: all events of a sample have its tick.
        slot_ticks;
    }

    /// Encodes one sample of every channel and passes each event to `emit`.
    #[inline]
    pub fn encode(
        &mut self,
        tick: Tick,
        samples: [SampleOf<T, N>; N],
        mut emit: impl FnMut(Event),
    ) {
        self.encode_or_skip(tick, samples, |event| event.into_iter().for_each(&mut emit));
    }

    /// [`encode`](Self::encode), and passes `None` for each sample that its encoder leaves out: one that is not finite,
    /// for a rate code with a filter.
    #[inline]
    fn encode_or_skip(
        &mut self,
        tick: Tick,
        samples: [SampleOf<T, N>; N],
        emit: impl FnMut(Option<Event>),
    ) {
        if !T::Scheme::HAS_QUIET_BAND {
            self.encode_each(tick, &samples, emit);
        } else if !Quiet::are_within(&samples, &self.quiet) {
            self.encode_apart(tick, &samples, emit);
        }
    }

    /// Encodes those samples that lie outside their bands.
    #[cold]
    #[inline(never)]
    fn encode_apart(
        &mut self,
        tick: Tick,
        samples: &[SampleOf<T, N>; N],
        mut emit: impl FnMut(Option<Event>),
    ) {
        if CodeOf::<T, N>::SLOTS > 1 && self.slot_ticks > 0 {
            return self.encode_each(tick, samples, emit);
        }
        for (&sample, channel) in samples.iter().zip(0..N) {
            if !self.quiet.holds(channel, sample) {
                self.encode_one(tick, channel, sample, &mut emit);
            }
        }
    }

    /// Encodes the sample of one channel, and brings its band up to date.
    #[inline(never)]
    fn encode_one(
        &mut self,
        tick: Tick,
        channel: usize,
        sample: SampleOf<T, N>,
        emit: &mut impl FnMut(Option<Event>),
    ) {
        if let Some((scheme, state)) = T::each_mut(&mut self.channels).nth(channel) {
            let first = channel.wrapping_mul(scheme.neurons()) as u16;
            let first = self.first_address.wrapping_add(first);
            each_event(tick, first, scheme.encode(state, sample).code(), sample, emit);
            self.quiet.set(channel, scheme.quiet_band(state));
        }
    }

    /// Encodes all samples, channel by channel.
    #[inline]
    fn encode_each(
        &mut self,
        tick: Tick,
        samples: &[SampleOf<T, N>; N],
        mut emit: impl FnMut(Option<Event>),
    ) {
        if CodeOf::<T, N>::SLOTS > 1 && self.slot_ticks > 0 {
            return self.encode_by_slot(tick, samples, |event| emit(Some(event)));
        }
        let mut first = self.first_address;
        for ((scheme, state), &sample) in T::each_mut(&mut self.channels).zip(samples) {
            each_event(tick, first, scheme.encode(state, sample).code(), sample, &mut emit);
            first = first.wrapping_add(scheme.neurons() as u16);
        }
    }

    /// [`encode`](Self::encode) with a tick for each sub-timestep: a pass for each in which a neuron fires.
    fn encode_by_slot(
        &mut self,
        tick: Tick,
        samples: &[SampleOf<T, N>; N],
        mut emit: impl FnMut(Event),
    ) {
        let mut codes = [None; N];
        let channels = T::each_mut(&mut self.channels).zip(samples).zip(0..N);
        for (code, (((scheme, state), &sample), channel)) in codes.iter_mut().zip(channels) {
            *code = scheme.encode(state, sample).code();
            if T::Scheme::HAS_QUIET_BAND {
                self.quiet.set(channel, scheme.quiet_band(state));
            }
        }
        let mut slot = 0;
        while slot < CodeOf::<T, N>::SLOTS {
            let tick = tick + self.slot_ticks.wrapping_mul(slot as u32);
            let mut first = self.first_address;
            let mut next = usize::MAX;
            for (code, (scheme, _)) in codes.iter().zip(T::each(&self.channels)) {
                for firing in code.iter().flat_map(Code::firings) {
                    let own = usize::from(firing.slot);
                    if own == slot {
                        emit(event(tick, first, firing));
                    } else if own > slot {
                        next = next.min(own);
                    }
                }
                first = first.wrapping_add(scheme.neurons() as u16);
            }
            slot = next;
        }
    }

    /// Encodes one sample of every channel, in the interrupt that brings them, and puts the events into a queue.
    /// Never blocks; the queue counts events that do not fit as lost, under any policy.
    ///
    /// A rate code with a filter leaves out a sample that is not finite. So that a receiver, which counts samples,
    /// knows of it, this then puts a [break](Item::Break) too.
    #[inline]
    pub fn encode_into(&mut self, tick: Tick, samples: [SampleOf<T, N>; N], mut queue: impl Put) {
        let mut skips = false;
        self.encode_or_skip(tick, samples, |event| match event {
            Some(event) => queue.put(Item::Event(event)),
            None => skips = true,
        });
        if skips {
            queue.put(Item::Break(tick));
        }
    }

    /// Puts a keyframe of every channel that has one into a queue. If no channel has one, as with rate and population
    /// codes, puts a [heartbeat](Item::Heartbeat), which tells the far end when a sample was taken. Call it in the
    /// interrupt that encodes, after a sample, 1 to 20 times a second; `tick` is that of the sample.
    pub fn keyframe_into(&self, tick: Tick, mut queue: impl Put) {
        let mut address = self.first_address;
        let mut has_keyframe = false;
        for (scheme, state) in T::each(&self.channels) {
            if let Some(value) = scheme.keyframe(state) {
                queue.put(Item::Keyframe(Keyframe::new(tick, address, value)));
                has_keyframe = true;
            }
            address = address.wrapping_add(scheme.neurons() as u16);
        }
        if !has_keyframe {
            queue.put(Item::Heartbeat { tick, address: self.first_address });
        }
    }

    /// Resets every encoder and puts a [break](Item::Break) into a queue, which tells the receiver of a link.
    pub fn reset_into(&mut self, tick: Tick, mut queue: impl Put)
    where
        T::Scheme: Start,
    {
        self.reset();
        queue.put(Item::Break(tick));
    }

    /// Resets every encoder, without a break in a queue: where the events go to a link, use
    /// [`reset_into`](Self::reset_into), so that its receiver knows.
    pub fn reset(&mut self)
    where
        T::Scheme: Start,
    {
        T::each_mut(&mut self.channels).for_each(|(_, state)| *state = T::Scheme::START);
        self.quiet = Bands::NONE;
    }

    /// How many addresses the channels take.
    #[cfg(feature = "link")]
    pub(crate) fn addresses(&self) -> usize {
        T::each(&self.channels).map(|(scheme, _)| scheme.neurons()).fold(0, usize::saturating_add)
    }

    #[cfg(feature = "link")]
    pub(crate) fn first_address(&self) -> u16 {
        self.first_address
    }

    #[cfg(feature = "link")]
    pub(crate) fn set_first_address(&mut self, first_address: u16) {
        self.first_address = first_address;
    }

    /// Checks that a bank may be sampled every `period` µs: that its filters are made for this rate, and that a sample's
    /// sub-timesteps, where they matter, are over when the next is taken.
    #[cfg(feature = "link")]
    pub(crate) fn check_period(&self, period: u32) -> Result<(), ConfigError> {
        let period = period.max(1);
        for (scheme, _) in T::each(&self.channels) {
            scheme.check_period(period)?;
            if CodeOf::<T, N>::SLOTS > 1 && T::Scheme::RECOVERY != Recovery::Keyframe {
                let length = scheme.slots() as f64 * f64::from(self.slot_ticks);
                crate::error::within("time of all sub-timesteps", length, 0.0, period as f32)?;
            }
        }
        Ok(())
    }

    /// The fingerprint of the channels' schemes, the sample type, the addresses and the sub-timesteps, for
    /// [`Transmitter::for_bank`](crate::link::Transmitter::for_bank). For set-up.
    pub fn fingerprint(&self) -> Fingerprint {
        let schemes = T::each(&self.channels).map(|(scheme, _)| scheme);
        bank_fingerprint(schemes, self.first_address, self.slot_ticks)
    }

    /// The value that a channel's decoder should hold now; `None` before the first sample, for codes without
    /// keyframes, and for a channel that does not exist.
    pub fn keyframe(&self, channel: usize) -> Option<SampleOf<T, N>> {
        let (scheme, state) = T::each(&self.channels).nth(channel)?;
        scheme.keyframe(state)
    }

    /// Number of samples that were not finite, over all channels.
    pub fn rejected(&self) -> u32 {
        let each = T::each(&self.channels).map(|(_, state)| T::Scheme::rejected(state));
        each.fold(0, u32::saturating_add)
    }
}

impl<T: Schemes<N>, const N: usize> Clone for Bank<T, N>
where
    T::Channels<EncoderStateOf<T, N>>: Clone,
{
    fn clone(&self) -> Self {
        Self { channels: self.channels.clone(), ..*self }
    }
}

impl<T: Schemes<N>, const N: usize> fmt::Debug for Bank<T, N>
where
    EncoderStateOf<T, N>: fmt::Debug,
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut bank = f.debug_struct("Bank");
        bank.field("states", &States::<T, _, N>(&self.channels));
        bank.field("first_address", &self.first_address);
        bank.finish_non_exhaustive()
    }
}

/// Passes on the events of a sample's code, or `None` for a sample that is left out.
#[inline]
fn each_event<C: Code, S: Sample>(
    tick: Tick,
    first_address: u16,
    code: Option<C>,
    sample: S,
    emit: &mut impl FnMut(Option<Event>),
) {
    if let Some(code) = code {
        code.firings().for_each(|firing| emit(Some(event(tick, first_address, firing))));
    } else if !sample.is_finite() {
        emit(None);
    }
}

#[inline]
fn event(tick: Tick, first_address: u16, firing: NeuronSpike) -> Event {
    let NeuronSpike { neuron, polarity, .. } = firing;
    Event { tick, address: first_address.wrapping_add(neuron), polarity }
}

/// The fingerprint of a bank whose channels have these schemes.
pub(crate) fn bank_fingerprint<'s, P: Scheme + 's>(
    schemes: impl Iterator<Item = &'s P>,
    first_address: u16,
    slot_ticks: u32,
) -> Fingerprint {
    let mut bank = Fingerprint::bank(P::Sample::KIND, first_address, slot_ticks);
    let (mut count, mut last) = (0_u32, None);
    for scheme in schemes {
        // A scheme that channels share is described once.
        let described = match last {
            Some((same, described)) if core::ptr::eq(same, scheme) => described,
            _ => scheme.fingerprint(),
        };
        last = Some((scheme, described));
        bank = bank.and(described);
        count = count.wrapping_add(1);
    }
    bank.number(count)
}
