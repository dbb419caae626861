//! Receiver: the decoders of several channels at the end of a link, which know whether their values are exact.

use core::fmt;

use super::delta::Numbered;
use super::pace::{CLOCK_TOLERANCE, Elapsed, Pace, slots_fit};
use super::steps::Steps;
use super::time::Time;
use super::trust::Trust;
use super::{FrameView, Joint, Part, Received, Withheld};
use crate::event::{
    Addresses, CodeOf, DecoderStateOf, Event, Keyframe, SampleOf, Schemes, States, Tick, addressed,
    bank_fingerprint,
};
use crate::{Code, ConfigError, Fingerprint, NeuronSpike, Polarity, Recovery, Sample, Scheme};

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
///   sample is over when an event of another tick or a heartbeat arrives, or at [`advance`](Self::advance); however early
///   or late it is.
/// - **Rate codes** ([`Recovery::Samples`]) are exact after as many whole samples as the filter has taps. The sender
///   must take a sample every [period](super::Coding::period) of the link, with a jitter of each tick of at most an eighth
///   of a period, since samples without events are decoded, too: after as many of them as the filter has taps the value no
///   longer changes, and the others are passed over.
/// - **Means** ([`Recovery::Fading`]) take their samples every period too. They are never exact: the error of an
///   estimate fades.
/// - **Codes with sub-timesteps** need the sender's [`with_slot_ticks`](Self::with_slot_ticks), and a
///   [heartbeat](crate::Item::Heartbeat) after each loss, which says when a sample was taken: no value is decoded before.
///   The sender must take a sample every period, with a jitter of each tick of at most an eighth of a sub-timestep. A period
///   less the clock's tolerance is as long as all sub-timesteps or longer; at most half a sub-timestep may be missing: see
///   [`longest_slot`](super::longest_slot).
///
/// **Time:** however long a link is down, or a sender at rest, a frame's time says how many samples have passed. The
/// sender must know it: see [`Transmitter::observe`](super::Transmitter::observe). A time that goes back, or that lies
/// between two samples, withholds every value of a code that counts samples. The samples' clock may run slow or fast by the
/// [tolerance](Self::with_clock_tolerance), and change within it at any time: where samples can then not be counted for
/// certain, values are withheld.
///
/// **Identity:** a receiver compares the sender's [fingerprint](Fingerprint) with that of its own schemes, and calls no
/// value exact if they differ or none has come yet. A sender without fingerprint is believed until a keyframe contradicts
/// the exact value before it. If a sender with the same fingerprint contradicts itself, 256 keyframes must agree before it is
/// believed again. Receivers of banks that share a link are [joined](super::join).
///
/// - **Memory:** on a 32-bit part about 120 bytes; per channel the decoder's state, a sample and 8 bytes; and 8 bytes
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
    /// How many addresses the joined receivers have, from 0 on; 0 of one by itself.
    joined: u32,
    /// How many sub-timesteps a sample has, in the channel with most; 1 where they do not matter.
    slots: u32,
    /// From so many samples without events on, further ones change no channel; 0 where samples need not be counted.
    settled: u32,
    sample: Sampled<EVENTS>,
    trust: Trust,
    outside: u32,
    misfits: u32,
    compared: u32,
    contradicted: u32,
}

#[derive(Clone, Copy, Debug)]
struct Channel<D, S> {
    state: D,
    value: S,
    is_exact: bool,
    /// How many samples were decoded since the last loss.
    whole: usize,
    /// The low bits of the step number after the last event or keyframe, if they are known.
    step: Option<u8>,
}

impl<D, S> Channel<D, S> {
    fn mark_stale(&mut self) {
        self.is_exact = false;
        self.whole = 0;
    }

    /// Goes on to the step number of an event, and returns how many steps were lost before it, up less down: the fewest
    /// that the low bits allow.
    fn step(&mut self, next: Numbered, mask: u8) -> i8 {
        let Numbered { event, number } = next;
        let expected = self.step.map(|step| match event.polarity {
            Polarity::Up => step.wrapping_add(1) & mask,
            Polarity::Down => step.wrapping_sub(1) & mask,
        });
        self.step = number.or(expected);
        let (Some(expected), Some(number)) = (expected, number) else { return 0 };
        let ahead = number.wrapping_sub(expected) & mask;
        let back = if ahead > mask / 2 { mask.wrapping_add(1) } else { 0 };
        ahead.wrapping_sub(back).cast_signed()
    }
}

/// The sample that is being received, of codes that take all events of a sample at once.
#[derive(Clone, Copy, Debug)]
struct Sampled<const EVENTS: usize> {
    /// The time of the last sample of which it is known; `None` if there is none.
    time: Option<Time>,
    /// How many samples, from that one on, are over.
    over: u64,
    /// The events of that sample, each at the tick of its sub-timestep from 0 on.
    events: [Event; EVENTS],
    count: usize,
    /// Whether none of its events was lost.
    is_whole: bool,
    /// Whether none of the next sample's events was lost.
    is_next_whole: bool,
    /// Whether the time is too long ago to tell sub-timesteps apart until the next heartbeat.
    is_clock_lost: bool,
    pace: Pace,
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

impl<'a, P: Scheme, const N: usize> Receiver<[&'a P; N], N> {
    /// A receiver with a scheme for each channel, those of the sender, and room for the 32 events of a sample that are the
    /// type's default. The compiler finds the number of channels by itself.
    ///
    /// ```
    /// use spikewire::{link::Receiver, temporal::StepForward};
    ///
    /// static GYRO: StepForward<f32> = StepForward::new(0.1);
    /// let receiver = Receiver::for_schemes([&GYRO; 6]);
    /// assert_eq!(receiver.exact(5), None);
    /// ```
    pub fn for_schemes(schemes: [&'a P; N]) -> Self {
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
        let (mut slots, mut settled) = (1, 0);
        let channels = schemes.channels(|scheme| {
            if T::Scheme::RECOVERY != Recovery::Keyframe {
                slots = slots.max(scheme.slots() as u32);
            }
            settled = settled.max(match scheme.recovery() {
                Recovery::Samples(samples)
                | Recovery::TimedKeyframe(samples)
                | Recovery::Fading(samples) => samples as u32,
                Recovery::Keyframe | Recovery::Spike => 0,
            });
            let state = scheme.decoder_state();
            let value = scheme.held(&state).unwrap_or_default();
            Channel { state, value, is_exact: false, whole: 0, step: None }
        });
        let addresses = Addresses { first: 0, slot_ticks: 0 };
        let (sample, trust) = (Sampled::NONE, Trust::NONE);
        Self {
            channels,
            addresses,
            joined: 0,
            slots,
            settled,
            sample,
            trust,
            outside: 0,
            misfits: 0,
            compared: 0,
            contradicted: 0,
        }
    }

    addressed! {
        /// Sets the first address, 0 by default; events of addresses without a channel are counted as
        /// [outside](Self::outside).
        addresses.first;
        /// Sets the length of a sub-timestep in microseconds, that of the sender's
        /// [bank](crate::Bank::with_slot_ticks). By default it is 0: a code with sub-timesteps is then not decoded.
        addresses.slot_ticks;
    }

    /// Sets by how many millionths the time from sample to sample may differ from the link's period, in ticks of the
    /// sender; 20 000 (2 %) by default, for a sensor that takes samples by its own clock. 0 is a timer of the clock that the
    /// ticks come from. Within the tolerance the clock may change at any time. Samples of a silence are thus counted while the
    /// most that drift and jitter make of it stays below three eighths of a period: 18 samples of 2 % without jitter, 6 with
    /// all of it. Sub-timesteps are told apart by the time that the receiver measures; while it does, over some 200 samples,
    /// the clock may change by a 128th of the tolerance (156 millionths of 2 %).
    #[must_use]
    pub const fn with_clock_tolerance(mut self, millionths: u32) -> Self {
        self.sample.pace = self.sample.pace.with_tolerance(millionths);
        self
    }

    /// Sets the fingerprint that the sender must have, instead of that of this receiver's own schemes: where several banks
    /// share a link, or the far end stands in for another type.
    #[must_use]
    pub const fn with_fingerprint(mut self, fingerprint: Fingerprint) -> Self {
        self.trust = self.trust.with_own(fingerprint);
        self
    }

    /// Adds the label that the sender has: see [`Transmitter::with_label`](super::Transmitter::with_label).
    #[must_use]
    pub const fn with_label(mut self, label: &str) -> Self {
        self.trust = self.trust.with_label(label);
        self
    }

    /// The fingerprint that the sender must have.
    pub fn fingerprint(&self) -> Fingerprint {
        self.trust.own(|| Part::fingerprint(self))
    }

    /// Decodes a frame, and passes the channel, tick and new value of each keyframe, event or sample to `on_value`, in
    /// order.
    pub fn apply(
        &mut self,
        received: &Received<'_>,
        mut on_value: impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        let frame = &received.frame;
        self.verify(received);
        if received.is_after_break() {
            self.begin_again(received.is_start, &mut on_value);
        }
        let period = frame.period().get();
        let unit = if self.has_slots() { self.addresses.slot_ticks.max(1) } else { period };
        self.sample.pace.set(period, unit);
        let step_mask = frame.step_mask();
        if frame.has_entries() {
            self.entries(frame, step_mask, &mut on_value);
        }
        let mut events = frame.events();
        while let Some(next) = events.next_numbered() {
            if step_mask > 0 {
                self.heal(next, step_mask, &mut on_value);
            }
            self.event(frame.time(), next.event, &mut on_value);
        }
        if !events.is_complete() {
            self.misfits = self.misfits.saturating_add(1);
            self.mark_stale();
        }
    }

    /// Takes the keyframes or heartbeats of a frame.
    #[inline(never)]
    fn entries(
        &mut self,
        frame: &FrameView<'_>,
        step_mask: u8,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        // A bank's keyframes come by rising address: one that does not rise is another bank's, or the same once more.
        let mut highest = None;
        for (keyframe, number) in frame.numbered_keyframes() {
            let is_again = highest.is_some_and(|highest| keyframe.address <= highest);
            if self.keyframe(frame.time(), keyframe, is_again, on_value) {
                highest = highest.max(Some(keyframe.address));
                self.number(keyframe.address, step_mask, number);
            }
        }
        for address in frame.heartbeats() {
            self.heartbeat(frame.time(), address, on_value);
        }
    }

    /// Compares the sender's fingerprint with that of the receiver.
    fn verify(&mut self, received: &Received<'_>) {
        if received.is_start {
            self.trust.begin();
        }
        let frame = &received.frame;
        if let Some(sender) = frame.fingerprint() {
            if !self.trust.has_own() {
                self.trust = self.trust.with_own(self.fingerprint());
            }
            self.trust.compare(sender);
        } else {
            self.trust.lack();
        }
    }

    /// Tells the receiver that all events before this tick have arrived: samples that are over by then are decoded and
    /// passed to `on_value`. Otherwise a sample is decoded when an event of a later one arrives. `now` must lie less than
    /// 2³¹ µs (35.8 minutes) after the last event or call. Codes of [`Recovery::Keyframe`] do not need this.
    pub fn advance(&mut self, now: Tick, mut on_value: impl FnMut(u16, Tick, SampleOf<T, N>)) {
        if let Some(time) = self.sample.time {
            let samples = self.sample.pace.over(time.nearest(now).since(time));
            self.finish(samples, &mut on_value);
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
        self.sample.pace.cut();
        if is_start || self.has_slots() {
            if self.sample.count > 0 {
                self.finish(1, on_value);
            }
            self.sample.time = None;
            self.sample.count = 0;
        }
        self.sample.is_clock_lost = false;
        if is_start {
            self.sample.pace.forget();
            T::each_mut(&mut self.channels).for_each(|(_, channel)| channel.step = None);
        }
    }

    /// The value of a channel if it is exact, else `None`. For a code of [`Recovery::Keyframe`] it is the value after
    /// the last event, for others that of the last sample that is over.
    pub fn exact(&self, channel: u16) -> Option<SampleOf<T, N>> {
        let (_, channel) = T::each(&self.channels).nth(channel.into())?;
        (channel.is_exact && self.trust.is_given()).then_some(channel.value)
    }

    /// The value of a channel, exact or not; 0 for a channel that does not exist.
    pub fn estimate(&self, channel: u16) -> SampleOf<T, N> {
        let channel = T::each(&self.channels).nth(channel.into());
        channel.map(|(_, channel)| channel.value).unwrap_or_default()
    }

    /// Why a channel has no exact value; `None` if it has one, or does not exist.
    pub fn withheld(&self, channel: u16) -> Option<Withheld> {
        let (scheme, channel) = T::each(&self.channels).nth(channel.into())?;
        let Sampled { time, pace, is_clock_lost, .. } = self.sample;
        let slot_ticks = self.addresses.slot_ticks;
        let doubt = self.trust.doubt();
        Some(match scheme.recovery() {
            Recovery::Fading(_) if doubt.is_none() => Withheld::Always,
            _ if self.has_slots() && slot_ticks == 0 => Withheld::SlotTicks,
            _ if self.is_blind() && pace.period() > 1 => {
                Withheld::Slots { slots: self.slots, slot_ticks, period: pace.shortest_period() }
            }
            _ if let Some(doubt) = doubt => doubt,
            _ if channel.is_exact => return None,
            _ if is_clock_lost => Withheld::Clock,
            Recovery::Keyframe | Recovery::TimedKeyframe(_) => Withheld::Keyframe,
            _ if self.has_slots() && time.is_none() => Withheld::Heartbeat,
            Recovery::Samples(needed) => Withheld::Samples(needed.saturating_sub(channel.whole)),
            Recovery::Spike | Recovery::Fading(_) => Withheld::Spike,
        })
    }

    /// Number of events, keyframes and heartbeats whose address belongs to no channel of this receiver, nor of those that it is
    /// [joined](super::join) with.
    pub const fn outside(&self) -> u32 {
        self.outside
    }

    /// Number of things that do not fit the schemes: keyframes of another sample type or for a code without keyframes;
    /// frames with bits that code no event; events beyond the `EVENTS` of a sample, after their sample was over, or in
    /// none of its sub-timesteps; samples with events that are no code; ticks that go back, or lie between two samples, of a
    /// code that counts samples.
    pub const fn misfits(&self) -> u32 {
        self.misfits
    }

    /// Number of keyframes of codes whose decoders [hold](Scheme::holds_keyframes) what a keyframe says, after a value
    /// without a loss; and of those that come once more in a frame.
    pub const fn compared(&self) -> u32 {
        self.compared
    }

    /// Number of [those](Self::compared) that had another value: the sender has other schemes or parameters, banks that share
    /// addresses, or lost items without telling.
    pub const fn contradicted(&self) -> u32 {
        self.contradicted
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

    /// Counts an address that belongs to no channel.
    fn pass_by(&mut self, address: u16) {
        let is_outside = u32::from(address) >= self.joined;
        self.outside = self.outside.saturating_add(is_outside.into());
    }

    /// Whether the code tells values by sub-timesteps that are not known.
    fn is_blind(&self) -> bool {
        if !self.has_slots() {
            return false;
        }
        let Addresses { slot_ticks, .. } = self.addresses;
        let pace = &self.sample.pace;
        slot_ticks == 0 || !slots_fit(self.slots, slot_ticks, pace.period(), pace.tolerance())
    }

    /// Takes a keyframe, the second one of its address in the frame if `is_again`. Returns whether it has a channel.
    fn keyframe(
        &mut self,
        time: Time,
        keyframe: Keyframe,
        is_again: bool,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) -> bool {
        let address = usize::from(keyframe.address.wrapping_sub(self.addresses.first));
        let channel = address / self.neurons();
        if channel < N && matches!(T::Scheme::RECOVERY, Recovery::TimedKeyframe(_)) {
            self.sample_taken(time, on_value);
        }
        let Some((scheme, known)) = T::each_mut(&mut self.channels).nth(channel) else {
            self.pass_by(keyframe.address);
            return false;
        };
        match keyframe.value::<SampleOf<T, N>>() {
            Some(value) if Self::HAS_KEYFRAMES => {
                if known.is_exact && (is_again || scheme.holds_keyframes()) {
                    self.compared = self.compared.saturating_add(1);
                    if value.to_bits32() == known.value.to_bits32() {
                        self.trust.agree();
                    } else {
                        self.contradicted = self.contradicted.saturating_add(1);
                        self.trust.contradict();
                    }
                }
                scheme.resync(&mut known.state, value);
                known.value = value;
                known.is_exact = true;
                on_value(channel as u16, keyframe.tick, value);
            }
            _ => self.misfits = self.misfits.saturating_add(1),
        }
        true
    }

    fn heartbeat(
        &mut self,
        time: Time,
        address: u16,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        let place = usize::from(address.wrapping_sub(self.addresses.first));
        if place >= N * self.neurons() {
            self.pass_by(address);
        } else if T::Scheme::RECOVERY != Recovery::Keyframe {
            self.sample_taken(time, on_value);
        }
    }

    /// Goes on from the step number of a keyframe.
    fn number(&mut self, address: u16, mask: u8, number: u8) {
        let channel = address.wrapping_sub(self.addresses.first);
        let is_there = mask > 0 && Steps::has(address) && self.neurons() == 1;
        if let Some((_, known)) = T::each_mut(&mut self.channels).nth(channel.into()) {
            known.step = is_there.then_some(number & mask);
        }
    }

    /// Takes the steps that were lost before an event, as its step number says. The value then has the bits of the
    /// sender's in fixed point, if nothing but these steps was lost; but a frame that is missing may have said that the
    /// sender lost events or started again, so that it is an estimate until its keyframe.
    fn heal(
        &mut self,
        next: Numbered,
        mask: u8,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        if T::Scheme::RECOVERY != Recovery::Keyframe || self.neurons() > 1 {
            return;
        }
        let channel = next.event.address.wrapping_sub(self.addresses.first);
        let Some((_, known)) = T::each_mut(&mut self.channels).nth(channel.into()) else { return };
        let lost = known.step(next, mask);
        if lost == 0 {
            return;
        }
        if known.is_exact {
            // No frame is missing: the sender's numbers are not those of its events.
            self.misfits = self.misfits.saturating_add(1);
            known.mark_stale();
        }
        let polarity = if lost > 0 { Polarity::Up } else { Polarity::Down };
        let step = Event { polarity, ..next.event };
        for _ in 0..lost.unsigned_abs() {
            self.step_event(step, on_value);
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
            self.pass_by(event.address);
        } else if T::Scheme::RECOVERY == Recovery::Keyframe {
            self.step_event(event, on_value);
        } else {
            self.sampled_event(frame.nearest(event.tick), event, on_value);
        }
    }

    /// Takes an event of a code that takes each event by itself.
    #[inline]
    fn step_event(&mut self, event: Event, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let address = usize::from(event.address.wrapping_sub(self.addresses.first));
        let neurons = self.neurons();
        let channel = address / neurons;
        if let Some((scheme, known)) = T::each_mut(&mut self.channels).nth(channel) {
            let neuron = (address % neurons) as u16;
            let firing = NeuronSpike { neuron, slot: 0, polarity: event.polarity };
            let code = Code::assemble(core::iter::once(firing));
            known.value = scheme.decode(&mut known.state, code);
            on_value(channel as u16, event.tick, known.value);
        }
    }

    /// Takes an event of a code that takes all events of a sample at once.
    fn sampled_event(
        &mut self,
        time: Time,
        event: Event,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) {
        if self.is_blind() || self.has_slots() && !self.sample.is_timed() {
            return;
        }
        let last = self.sample.events.get(self.sample.count.wrapping_sub(1));
        let is_behind = last.is_some_and(|last| event.address < last.address);
        if is_behind && !self.has_slots() && self.sample.time == Some(time) {
            // Another sample of the same tick: events of a sample come by rising address.
            self.lose_time(true, on_value);
        }
        let slot = match self.place(time, on_value) {
            Some(slot) => slot,
            None if self.has_slots() => return,
            // The first event of which the sample is known again.
            None => self.place(time, on_value).unwrap_or(0),
        };
        // Events that were lost before this one belong to its sample or to an earlier one.
        self.sample.is_next_whole = true;
        if let Some(place) = self.sample.events.get_mut(self.sample.count) {
            let after = slot.wrapping_mul(self.addresses.slot_ticks);
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

    /// Finds the sample and the sub-timestep of an event at this time, after the samples before it are over. `None` if the
    /// time fits no sample, or its sample is over: every channel is then stale, and the time of samples not known.
    fn place(
        &mut self,
        time: Time,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) -> Option<u32> {
        let Some(anchor) = self.sample.time else {
            self.sample.pace.begin();
            self.go_to(time);
            return Some(0);
        };
        let since = time.since(anchor);
        if !self.has_slots() && (self.settled == 0 || since == 0) {
            // All events of a sample have its tick.
            if since == 0 && self.sample.over > 0 {
                return self.lose_time(true, on_value);
            }
            if since != 0 {
                self.finish(1, on_value);
                self.go_to(time);
            }
            return Some(0);
        }
        let (slot_ticks, slots) = (self.addresses.slot_ticks, self.slots);
        let elapsed = if self.has_slots() {
            self.sample.pace.slot(since, slots)
        } else {
            self.sample.pace.elapsed(since, self.settled)
        };
        match elapsed {
            Elapsed::Samples { samples, slot } if samples >= self.sample.over => {
                if samples > 0 {
                    self.finish(samples, on_value);
                    let taken = time.before(slot.wrapping_mul(slot_ticks).into());
                    self.sample.pace.learn(taken.since(anchor), samples);
                    self.go_to(taken);
                }
                Some(slot)
            }
            Elapsed::Settled { samples } if samples >= self.sample.over => {
                self.finish(samples, on_value);
                self.sample.pace.begin();
                self.go_to(time);
                Some(0)
            }
            Elapsed::Unknown => self.lose_time(false, on_value),
            Elapsed::Settled { .. } | Elapsed::Samples { .. } | Elapsed::Misfit => {
                self.lose_time(true, on_value)
            }
        }
    }

    /// Gives up the time of samples, since what arrived does not fit it, or since it is not known well enough any more.
    fn lose_time(
        &mut self,
        is_misfit: bool,
        on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>),
    ) -> Option<u32> {
        self.misfits = self.misfits.saturating_add(is_misfit.into());
        let Sampled { time, pace, .. } = self.sample;
        self.begin_again(true, on_value);
        if !is_misfit {
            self.sample.pace = pace;
        }
        self.sample.is_clock_lost = !is_misfit;
        if !is_misfit && self.has_slots() {
            // From the last heartbeat to the next the pace can still be measured.
            self.sample.time = time;
        }
        None
    }

    /// Goes on to the sample taken at this time, of which nothing has come yet.
    fn go_to(&mut self, time: Time) {
        self.sample.is_whole = self.sample.is_next_whole;
        (self.sample.time, self.sample.over, self.sample.count) = (Some(time), 0, 0);
    }

    /// Takes note that a sample was taken at this time, and that all its events have come.
    fn sample_taken(&mut self, time: Time, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        if self.is_blind() {
            return;
        }
        if let Some(anchor) = self.sample.time {
            let since = time.since(anchor);
            let counts = self.settled > 0 || self.has_slots();
            let elapsed = match since {
                0 => Elapsed::Samples { samples: 0, slot: 0 },
                _ if !counts => Elapsed::Samples { samples: 1, slot: 0 },
                _ if self.has_slots() => self.sample.pace.beat(since, self.settled),
                _ => self.sample.pace.elapsed(since, self.settled),
            };
            match elapsed {
                Elapsed::Samples { samples, .. }
                    if samples.saturating_add(1) >= self.sample.over =>
                {
                    self.finish(samples.saturating_add(1), on_value);
                    if samples > 0 {
                        self.sample.pace.learn(since, samples);
                    }
                }
                Elapsed::Settled { samples } if samples >= self.sample.over => {
                    self.finish(samples.saturating_add(1), on_value);
                    self.sample.pace.begin();
                }
                Elapsed::Unknown => {
                    self.lose_time(false, on_value);
                    self.sample.pace.begin();
                }
                Elapsed::Settled { .. } | Elapsed::Samples { .. } | Elapsed::Misfit => {
                    self.lose_time(true, on_value);
                }
            }
        }
        if self.sample.time.is_none() {
            self.sample.pace.begin();
        }
        // Events that come from here on belong to the next sample or to a later one.
        (self.sample.time, self.sample.over, self.sample.count) = (Some(time), 1, 0);
        (self.sample.is_whole, self.sample.is_next_whole) = (true, true);
        self.sample.is_clock_lost = false;
    }

    /// Decodes so many samples from the last known one on, those that are not over yet.
    fn finish(&mut self, samples: u64, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let Sampled { time: Some(time), over, is_next_whole, pace, .. } = self.sample else {
            return;
        };
        if samples <= over {
            return;
        }
        if over == 0 {
            self.decode(time, on_value);
            self.sample.is_whole = is_next_whole;
            self.sample.count = 0;
        }
        // From the longest recovery on, samples without events change no channel.
        for sample in (over.max(1)..samples).take(self.settled as usize) {
            self.decode(time.after(pace.time_of(sample)), on_value);
        }
        self.sample.over = samples;
    }

    /// Decodes a sample that is over, in every channel.
    fn decode(&mut self, time: Time, on_value: &mut impl FnMut(u16, Tick, SampleOf<T, N>)) {
        let events = self.sample.events.get(..self.sample.count).unwrap_or_default();
        let tick = time.tick();
        for (channel, (scheme, known)) in (0..N).zip(T::each_mut(&mut self.channels)) {
            let neurons = scheme.neurons();
            let code: CodeOf<T, N> = self.addresses.code(channel, neurons, 0.into(), events);
            known.value = scheme.decode(&mut known.state, code);
            let fired = number_of(self.addresses.events_of(channel, neurons, events));
            if self.sample.is_whole && number_of(code.firings()) != fired {
                // No encoder fires these neurons together: two banks may have the same addresses.
                self.misfits = self.misfits.saturating_add(1);
                known.mark_stale();
            } else if self.sample.is_whole {
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

/// The number of items. `Iterator::count` would have a check for overflow, and with it a panic.
fn number_of(items: impl Iterator) -> usize {
    items.fold(0, |number: usize, _| number.wrapping_add(1))
}

impl<T: Schemes<N>, const N: usize, const EVENTS: usize> Part for Receiver<T, N, EVENTS> {
    fn addresses(&self) -> usize {
        N.wrapping_mul(self.neurons())
    }

    fn set_first_address(&mut self, first_address: u16) {
        self.addresses.first = first_address;
    }

    fn fingerprint(&self) -> Fingerprint {
        let schemes = T::each(&self.channels).map(|(scheme, _)| scheme);
        bank_fingerprint(schemes, self.addresses.first, self.addresses.slot_ticks)
    }

    fn join(&mut self, joint: Joint) {
        self.joined = joint.addresses();
        self.trust = self.trust.with_joint(joint.fingerprint());
    }
}

impl<const EVENTS: usize> Sampled<EVENTS> {
    const NONE: Self = Self {
        time: None,
        over: 0,
        events: [Event::ZERO; EVENTS],
        count: 0,
        is_whole: false,
        is_next_whole: false,
        is_clock_lost: false,
        pace: Pace::new(CLOCK_TOLERANCE),
    };

    /// Whether it is known when samples are taken, well enough to tell sub-timesteps apart.
    const fn is_timed(&self) -> bool {
        self.time.is_some() && !self.is_clock_lost
    }
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
