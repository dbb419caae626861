//! Decodes link frames (packets of events from a sender) to values in any sample type. The decoding is done by
//! [`Receiver`], which also runs on boards.

use crate::Result;
use crate::events::{Held, Item, Known, LinkTally, Values};
use crate::scheme::Scheme as Chosen;
use crate::tune::RequestKind;
use catalogue::for_sample_type;
use catalogue::run::{SampleType, Settings, Visit};
use spikewire::link::{Received, Receiver, Withheld};
use spikewire::{Fingerprint, Recovery, Sample, SampleKind, Scheme, Spike, Tick};
use std::any::Any;

/// Maximum number of channels if each channel has one neuron.
const MOST: usize = 256;

/// Maximum number of channels if each channel has several neurons. 64 channels of 1024 neurons fill all addresses.
const FEWER: usize = 64;

/// Maximum number of events in one sample, over all channels.
const EVENTS: usize = 1 << 14;

/// The caller's function, to which [`with_receiver`] passes the finished receiver.
type Then<'a> = Box<dyn FnOnce(Box<dyn Values + '_>) -> Result<()> + 'a>;

/// Facts about the sender that a receiver uses in addition to the schemes: sub-timesteps, fingerprint and clock.
#[derive(Clone, Copy, Debug, Default)]
pub struct Link {
    /// Length of a sub-timestep in µs. `None` if the code does not divide samples into sub-timesteps.
    pub slot_ticks: Option<u32>,
    /// Fingerprint (hash of the parameters) that the sender's frames carry. If `None`, the receiver computes the
    /// fingerprint from the channels' schemes. If the receiver does not know the number of channels, it tries each
    /// number from 1 up, until the computed fingerprint equals the one in the frames.
    pub fingerprint: Option<Fingerprint>,
    /// Largest deviation of the sample period from its nominal length, in parts per million. If `None`, the receiver
    /// uses its default.
    pub clock_ppm: Option<u32>,
}

impl From<Option<u32>> for Link {
    fn from(slot_ticks: Option<u32>) -> Self {
        Self { slot_ticks, ..Self::default() }
    }
}

/// Relabels the sample type of a frame's keyframes for a receiver, which accepts only the decoders' type, `ours`.
///
/// The decoders use one type for all fixed-point types of a width, so their type may differ from the sender's. Then
/// there are two cases. Keyframes labelled with the sender's type are correct. They get the decoders' type, and the
/// receiver accepts them. Keyframes labelled with the decoders' type are wrong, because the sender has another type.
/// They get the sender's type, and the receiver rejects them and counts them as misfits.
pub fn with_kind<'f>(
    received: &Received<'f>,
    senders: SampleKind,
    ours: SampleKind,
) -> Received<'f> {
    let known = received.frame.keyframes().next().map(|keyframe| keyframe.kind);
    let kind = match known {
        Some(kind) if kind == senders => ours,
        Some(kind) if kind == ours => senders,
        _ => return *received,
    };
    let frame = received.frame.with_kind(kind).unwrap_or(received.frame);
    Received { frame, ..*received }
}

/// Makes a receiver and passes it to `then`. `settings` holds the settings of each channel, or a single item for all
/// channels.
///
/// # Errors
/// Returns an error if a parameter is outside its range, if there are too many channels, or if `then` returns an error.
pub fn with_receiver<'a>(
    scheme: Chosen,
    sample: SampleType,
    settings: &'a [Settings],
    link: impl Into<Link>,
    then: impl FnOnce(Box<dyn Values + '_>) -> Result<()> + 'a,
) -> Result<()> {
    let first = settings.first().ok_or(RequestKind::NoChannel)?;
    let link = link.into();
    let visitor = Receive { scheme, sample, settings, link, then: Box::new(then) };
    for_sample_type!(sample, S => catalogue::visit::<S, _>(scheme.name(), first, visitor))?
}

struct Receive<'a> {
    scheme: Chosen,
    sample: SampleType,
    settings: &'a [Settings],
    link: Link,
    then: Then<'a>,
}

impl<S: Sample> Visit<S> for Receive<'_> {
    type Output = Result<()>;

    fn visit<P: Scheme<Sample = S> + 'static>(
        self,
        _: P,
        _: P::EncoderState,
    ) -> catalogue::run::Result<Result<()>> {
        Ok(self.receive::<P, FEWER, EVENTS>())
    }

    fn visit_steps<P: Scheme<Sample = S, Code = Spike> + 'static>(
        self,
        _: P,
        _: P::EncoderState,
    ) -> catalogue::run::Result<Result<()>> {
        Ok(self.receive::<P, MOST, 0>())
    }
}

impl Receive<'_> {
    /// Makes a receiver of up to `N` channels, and passes the receiver to the function `self.then`.
    fn receive<P: Scheme + 'static, const N: usize, const EVENTS: usize>(self) -> Result<()> {
        let Self { scheme, sample, settings, link, then } = self;
        let Link { slot_ticks, fingerprint, clock_ppm } = link;
        if settings.len() > N {
            let (channels, scheme) = (settings.len(), scheme.name());
            return Err(RequestKind::Channels { channels, scheme, most: N }.into());
        }
        let mut started = Vec::new();
        // The first scheme once more: a placeholder for channel numbers beyond those given.
        let beyond = settings.first().filter(|_| settings.len() > 1);
        for (place, own) in settings.iter().chain(beyond).enumerate() {
            let built = catalogue::visit::<P::Sample, _>(scheme.name(), own, Boxed)?;
            let start = own.first_value().map(|start| P::Sample::from_f64(start * sample.one()));
            let Ok(scheme) = built.downcast::<P>() else {
                return Err(RequestKind::Differ.into());
            };
            started.push(Started { scheme: *scheme, is_given: place < settings.len(), start });
        }
        let last = started.last().ok_or(RequestKind::NoChannel)?;
        let given = started.get(..settings.len()).unwrap_or_default();
        let channels = if given.len() == 1 { N } else { given.len() };
        let schemes = std::array::from_fn(|channel| given.get(channel).unwrap_or(last));
        let mut receiver = Receiver::<_, N, EVENTS>::per_channel(schemes);
        if let Some(length) = slot_ticks {
            receiver = receiver.with_slot_ticks(length);
        }
        if let Some(millionths) = clock_ppm {
            receiver = receiver.with_clock_tolerance(millionths);
        }
        then(Box::new(Receiving {
            receiver,
            channels,
            neurons: last.neurons(),
            has_fired: [P::RECOVERY == Recovery::Keyframe; N],
            end: None,
            unused_keyframes: 0,
            one: sample.one(),
            kind: sample.into(),
            outside: 0,
            slot_ticks: slot_ticks.unwrap_or(0),
            known: fingerprint,
            schemes: given.iter().map(Scheme::fingerprint).collect(),
            has_exact: false,
            decoded: Vec::new(),
        }))
    }
}

/// A visitor that returns the visited scheme in a box.
struct Boxed;

impl<S: Sample> Visit<S> for Boxed {
    type Output = Box<dyn Any>;

    fn visit<P: Scheme<Sample = S> + 'static>(
        self,
        scheme: P,
        _: P::EncoderState,
    ) -> catalogue::run::Result<Box<dyn Any>> {
        Ok(Box::new(scheme))
    }
}

/// A scheme whose decoders start from the value `start`. If `start` is `None`, they start from the scheme's own initial
/// value. Only the decoders are used, never the encoders.
struct Started<P: Scheme> {
    scheme: P,
    /// Whether the channel exists. False for the placeholders that fill the array after the last channel.
    is_given: bool,
    start: Option<P::Sample>,
}

impl<P: Scheme> Scheme for Started<P> {
    type Sample = P::Sample;
    type Code = P::Code;
    type Output = P::Output;
    type EncoderState = P::EncoderState;
    type DecoderState = P::DecoderState;

    const LATENCY: usize = P::LATENCY;
    const RECOVERY: Recovery = P::RECOVERY;

    fn fingerprint(&self) -> Fingerprint {
        self.scheme.fingerprint()
    }

    fn holds_keyframes(&self) -> bool {
        self.is_given && self.scheme.holds_keyframes()
    }

    fn encode(&self, state: &mut P::EncoderState, sample: P::Sample) -> P::Output {
        self.scheme.encode(state, sample)
    }

    fn rejected(state: &P::EncoderState) -> u32 {
        P::rejected(state)
    }

    fn decoder_state(&self) -> P::DecoderState {
        let mut state = self.scheme.decoder_state();
        if let Some(start) = self.start {
            self.scheme.resync(&mut state, start);
        }
        state
    }

    fn decode(&self, state: &mut P::DecoderState, code: P::Code) -> P::Sample {
        self.scheme.decode(state, code)
    }

    fn held(&self, state: &P::DecoderState) -> Option<P::Sample> {
        self.scheme.held(state)
    }

    fn resync(&self, state: &mut P::DecoderState, value: P::Sample) {
        self.scheme.resync(state, value);
    }

    fn recovery(&self) -> Recovery {
        self.scheme.recovery()
    }

    fn neurons(&self) -> usize {
        self.scheme.neurons()
    }

    fn slots(&self) -> usize {
        self.scheme.slots()
    }
}

struct Receiving<'a, P: Scheme, const N: usize, const EVENTS: usize> {
    receiver: Receiver<[&'a Started<P>; N], N, EVENTS>,
    channels: usize,
    /// Number of neurons of each channel.
    neurons: usize,
    /// Whether the decoded values of each channel are passed on. If keyframes resynchronize the code, the values of all
    /// channels are passed on from the start. Otherwise, a channel's values are passed on from its first event.
    has_fired: [bool; N],
    /// End of the sample to which the last received event belongs: one sample period after the event's tick.
    end: Option<Tick>,
    /// Number of keyframes received although the code uses none.
    unused_keyframes: u64,
    /// Number by which decoded values are divided: the decoders' representation of 1.0.
    one: f64,
    /// Sample type of the sender.
    kind: SampleKind,
    /// Number of events and keyframes whose channel is not among `channels`. This number does not include those beyond
    /// the receiver's `N` channels, which the receiver counts itself.
    outside: u64,
    /// Length of a sub-timestep in µs; 0 if the length was not given.
    slot_ticks: u32,
    /// Fingerprint (hash of the parameters) of the sender, if the caller gave it.
    known: Option<Fingerprint>,
    /// Fingerprint (hash of the parameters) of each channel's scheme. A list of one fingerprint stands for any number
    /// of channels with the same scheme.
    schemes: Vec<Fingerprint>,
    /// Whether any decoded value so far was known to equal the encoder's value.
    has_exact: bool,
    decoded: Vec<(u16, Tick, P::Sample)>,
}

impl<P: Scheme, const N: usize, const EVENTS: usize> Receiving<'_, P, N, EVENTS> {
    /// Returns for each channel whether its decoded value is exact: known to equal the encoder's value.
    fn exact(&self) -> [bool; N] {
        let is_exact = |channel| self.receiver.exact(channel as u16).is_some();
        std::array::from_fn(|channel| channel < self.channels && is_exact(channel))
    }

    /// Counts the frame's events and keyframes of channels that do not exist.
    fn count_outside(&mut self, received: &Received<'_>) {
        let keyframes = received.frame.keyframes().map(|keyframe| keyframe.address);
        let addresses = keyframes.chain(received.frame.events().map(|event| event.address));
        let missing = self.channels * self.neurons..N * self.neurons;
        let outside = addresses.filter(|address| missing.contains(&usize::from(*address))).count();
        self.outside += outside as u64;
    }

    /// Records the channels that have an event in the frame. Also records the tick, in µs, at which the sample of the
    /// frame's last event ends.
    fn observe(&mut self, received: &Received<'_>) {
        for event in received.frame.events() {
            if let Some(has_fired) =
                self.has_fired.get_mut(usize::from(event.address) / self.neurons)
            {
                *has_fired = true;
            }
            self.end = Some(event.tick + received.frame.period().get());
        }
    }

    /// Converts the decoded values to items, and appends the items to `items`. The first `keyframes` values come from
    /// keyframes. The keyframe of a sender with another fingerprint makes no value exact. A channel is exact if its decoded value is known to equal the encoder's value. `before` says for
    /// each channel whether the channel was exact before the frame.
    ///
    /// A channel may become exact in the middle of a frame. With a code that recovers by keyframes, all values of the
    /// channel in this frame are marked exact. With any other code, the channel's values are marked exact from the next
    /// frame on. Estimates from the first part of the frame are thus never marked exact.
    fn tell(&mut self, keyframes: usize, before: [bool; N], items: &mut Vec<Item>) {
        let after = self.exact();
        for (place, (channel, tick, value)) in self.decoded.drain(..).enumerate() {
            let at = usize::from(channel);
            let is_known = |exact: &[bool; N]| exact.get(at).is_some_and(|is_exact| *is_exact);
            if at < self.channels && is_known(&self.has_fired) {
                let by_keyframe = P::RECOVERY == Recovery::Keyframe;
                let known = match is_known(&after) {
                    true if place < keyframes => Known::Keyframe,
                    true if by_keyframe || is_known(&before) => Known::Exact,
                    _ => Known::Estimate,
                };
                self.has_exact |= known != Known::Estimate;
                let address = (at * self.neurons) as u16;
                items.push(Item::Value { tick, address, value: value.to_f64() / self.one, known });
            }
        }
    }

    /// Returns the fingerprint (hash of the parameters) that the sender must have if its schemes equal those of this
    /// receiver. The fingerprint is computed for the sender's sample type.
    ///
    /// If one scheme stands for all channels, the number of channels is unknown. In this case, all numbers from 1 to
    /// `N` are tried, until a fingerprint equals `sender`. If none does, the result is the fingerprint for one channel.
    fn fingerprint(&self, sender: Fingerprint) -> Fingerprint {
        let of = |schemes: &[_]| Fingerprint::of_bank(self.kind, 0, self.slot_ticks, schemes);
        match *self.schemes {
            [scheme] => {
                let mut any = (1..=N).map(|channels| of(&vec![scheme; channels]));
                any.find(|own| *own == sender).unwrap_or_else(|| of(&[scheme]))
            }
            _ => of(&self.schemes),
        }
    }
}

impl<P: Scheme, const N: usize, const EVENTS: usize> Values for Receiving<'_, P, N, EVENTS> {
    fn apply(&mut self, received: &Received<'_>, items: &mut Vec<Item>) {
        let received = &with_kind(received, self.kind, <P::Sample as Sample>::KIND);
        self.count_outside(received);
        if let Some(sender) = received.frame.fingerprint() {
            let own = self.known.unwrap_or_else(|| self.fingerprint(sender));
            if own != self.receiver.fingerprint() {
                self.receiver = self.receiver.clone().with_fingerprint(own);
            }
        }
        let keyframes = received.frame.keyframes().filter(|keyframe| {
            usize::from(keyframe.address) < N * self.neurons
                && keyframe.value::<P::Sample>().is_some()
        });
        let mut keyframes = keyframes.count();
        match P::RECOVERY {
            Recovery::Keyframe => {}
            // Timed keyframes replace samples, and are counted as samples.
            Recovery::TimedKeyframe(_) => keyframes = 0,
            _ => self.unused_keyframes += std::mem::take(&mut keyframes) as u64,
        }
        if P::RECOVERY != Recovery::Keyframe {
            self.observe(received);
        }
        let before = if received.is_after_break() { [false; N] } else { self.exact() };
        let decoded = &mut self.decoded;
        self.receiver.apply(received, |channel, tick, value| decoded.push((channel, tick, value)));
        self.tell(keyframes, before, items);
    }

    fn finish(&mut self, items: &mut Vec<Item>) {
        if let Some(end) = self.end {
            let before = self.exact();
            let decoded = &mut self.decoded;
            self.receiver.advance(end, |channel, tick, value| decoded.push((channel, tick, value)));
            self.tell(0, before, items);
        }
    }

    fn count(&self, tally: &mut LinkTally) {
        tally.outside = self.outside + u64::from(self.receiver.outside());
        tally.misfits = u64::from(self.receiver.misfits()).saturating_sub(self.unused_keyframes);
        tally.unused_keyframes = self.unused_keyframes;
        let (compared, contradicted) = (self.receiver.compared(), self.receiver.contradicted());
        tally.held = Held { compared: compared.into(), contradicted: contradicted.into() };
        let heard = self.has_fired.iter().position(|has_fired| *has_fired).unwrap_or(0);
        let is_heard = tally.frames > 0 && !self.has_exact;
        tally.withheld = self.receiver.withheld(heard as u16).filter(|_| is_heard);
    }

    fn withheld(&self, channel: u16) -> Option<Withheld> {
        self.receiver.withheld(channel)
    }
}
