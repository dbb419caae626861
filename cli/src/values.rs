//! From frames to values, with the receiver that runs on boards, in any sample type.

use crate::events::{Held, Item, Known, Values};
use crate::scheme::Scheme as Chosen;
use anyhow::{Context, Result, bail};
use catalogue::for_sample_type;
use catalogue::run::{Given, SampleType, Settings, Visit};
use spikewire::link::{Received, Receiver};
use spikewire::{Recovery, Sample, SampleKind, Scheme, Spike, Tick};
use std::any::Any;

/// The channels that a receiver has, at addresses from 0 on.
const MOST: usize = 256;

/// What is done with a receiver.
type Then<'a> = Box<dyn FnOnce(Box<dyn Values + '_>) -> Result<()> + 'a>;

/// Makes a receiver with these settings, one for each channel, or one for all, and hands it on.
///
/// # Errors
/// A scheme whose decoder does not add up steps, a parameter that makes no sense, or those of what is done with it.
pub(crate) fn with_receiver<'a>(
    scheme: Chosen,
    sample: SampleType,
    settings: &'a [Settings],
    then: impl FnOnce(Box<dyn Values + '_>) -> Result<()> + 'a,
) -> Result<()> {
    let Some(first) = settings.first().filter(|_| settings.len() <= MOST) else {
        bail!("a receiver has 1 to {MOST} channels")
    };
    let given = Given::new(first, sample.one());
    let visitor = Receive { scheme, sample, settings, then: Box::new(then) };
    for_sample_type!(sample, S => catalogue::visit::<S, _>(scheme.name(), &given, visitor))
}

struct Receive<'a> {
    scheme: Chosen,
    sample: SampleType,
    settings: &'a [Settings],
    then: Then<'a>,
}

impl<S: Sample> Visit<S> for Receive<'_> {
    type Output = ();

    fn visit<P: Scheme<Sample = S> + 'static>(self, _: P, _: P::EncoderState) -> Result<()> {
        bail!("a link's receiver adds up steps, which {} does not", self.scheme.name())
    }

    fn visit_steps<P: Scheme<Sample = S, Code = Spike> + 'static>(
        self,
        _: P,
        _: P::EncoderState,
    ) -> Result<()> {
        let Self { scheme, sample, settings, then } = self;
        let mut started = Vec::new();
        for own in settings {
            let given = Given::new(own, sample.one());
            let built = catalogue::visit::<S, _>(scheme.name(), &given, Boxed)?;
            let start = own.first_value().map(|start| S::from_f64(start * sample.one()));
            let Ok(scheme) = built.downcast::<P>() else {
                bail!("channels of one scheme differ in more than numbers")
            };
            started.push(Started { scheme: *scheme, start: start.unwrap_or_default() });
        }
        let first = started.first().context("a receiver has a channel at least")?;
        let channels = if started.len() == 1 { MOST } else { started.len() };
        let schemes = std::array::from_fn(|channel| started.get(channel).unwrap_or(first));
        then(Box::new(Receiving {
            receiver: Receiver::<_, MOST, 0>::per_channel(schemes),
            channels,
            one: sample.one(),
            kind: kind(sample),
            outside: 0,
            are_held: scheme.info().climbs_by.is_some(),
            held: Held::default(),
            decoded: Vec::new(),
        }))
    }
}

/// Hands a scheme on by itself.
struct Boxed;

impl<S: Sample> Visit<S> for Boxed {
    type Output = Box<dyn Any>;

    fn visit<P: Scheme<Sample = S> + 'static>(
        self,
        scheme: P,
        _: P::EncoderState,
    ) -> Result<Box<dyn Any>> {
        Ok(Box::new(scheme))
    }
}

/// What a link calls a sample type.
fn kind(sample: SampleType) -> SampleKind {
    match sample {
        SampleType::F32 => SampleKind::F32,
        SampleType::Fixed16 { fraction } => SampleKind::Fixed16 { fraction },
        SampleType::Fixed32 { fraction } => SampleKind::Fixed32 { fraction },
    }
}

/// A scheme whose decoders start from a value other than 0. Only the decoding half is of use.
struct Started<P: Scheme> {
    scheme: P,
    start: P::Sample,
}

impl<P: Scheme> Scheme for Started<P> {
    type Sample = P::Sample;
    type Code = P::Code;
    type Output = P::Output;
    type EncoderState = P::EncoderState;
    type DecoderState = P::DecoderState;

    const LATENCY: usize = P::LATENCY;
    const RECOVERY: Recovery = P::RECOVERY;

    fn encode(&self, state: &mut P::EncoderState, sample: P::Sample) -> P::Output {
        self.scheme.encode(state, sample)
    }

    fn rejected(state: &P::EncoderState) -> u32 {
        P::rejected(state)
    }

    fn decoder_state(&self) -> P::DecoderState {
        let mut state = self.scheme.decoder_state();
        self.scheme.resync(&mut state, self.start);
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
}

struct Receiving<'a, P: Scheme<Code = Spike>> {
    receiver: Receiver<[&'a Started<P>; MOST], MOST, 0>,
    channels: usize,
    /// What a 1 is in the unit of the decoders.
    one: f64,
    /// The sample type of the sender.
    kind: SampleKind,
    /// Beside what the receiver itself counts.
    outside: u64,
    /// Whether keyframes are what a decoder holds already.
    are_held: bool,
    held: Held,
    decoded: Vec<(u16, Tick, P::Sample)>,
}

impl<P: Scheme<Code = Spike>> Receiving<'_, P> {
    /// The frame with keyframes of the sender's type as those of the decoders, which run all fixed point of one width
    /// as one type; keyframes of any other type stay another.
    fn in_our_type<'f>(&self, received: &Received<'f>) -> Received<'f> {
        let ours = <P::Sample as Sample>::KIND;
        let known = received.frame.keyframes().next().map(|keyframe| keyframe.kind);
        let kind = match known {
            Some(kind) if kind == self.kind => ours,
            Some(kind) if kind == ours => self.kind,
            _ => return *received,
        };
        let frame = received.frame.with_kind(kind).unwrap_or(received.frame);
        Received { frame, ..*received }
    }

    /// Compares keyframes with what their channels hold before them, where that is exact.
    fn compare(&mut self, received: &Received<'_>) {
        if received.is_after_break() {
            return;
        }
        for keyframe in received.frame.keyframes() {
            let known = self.receiver.exact(keyframe.address);
            let told = keyframe.value::<P::Sample>();
            if let (Some(value), Some(told)) = (known, told)
                && usize::from(keyframe.address) < self.channels
            {
                self.held.compared += 1;
                self.held.contradicted += u64::from(value.to_bits32() != told.to_bits32());
            }
        }
    }
}

impl<P: Scheme<Code = Spike>> Values for Receiving<'_, P> {
    fn apply(&mut self, received: &Received<'_>, items: &mut Vec<Item>) {
        let received = &self.in_our_type(received);
        if self.are_held {
            self.compare(received);
        }
        let Self { receiver, channels, one, outside, decoded, .. } = self;
        // Keyframes come first.
        let keyframes = received.frame.keyframes().filter(|keyframe| {
            usize::from(keyframe.address) < MOST && keyframe.value::<P::Sample>().is_some()
        });
        let keyframes = keyframes.count();
        receiver.apply(received, |address, tick, value| decoded.push((address, tick, value)));
        for (place, (address, tick, value)) in decoded.drain(..).enumerate() {
            if usize::from(address) >= *channels {
                *outside += 1;
                continue;
            }
            let known = if place < keyframes {
                Known::Keyframe
            } else if receiver.exact(address).is_some() {
                Known::Exact
            } else {
                Known::Estimate
            };
            items.push(Item::Value { tick, address, value: value.to_f64() / *one, known });
        }
    }

    fn outside(&self) -> u64 {
        self.outside + u64::from(self.receiver.outside())
    }

    fn misfits(&self) -> u64 {
        self.receiver.misfits().into()
    }

    fn held(&self) -> Held {
        self.held
    }
}
