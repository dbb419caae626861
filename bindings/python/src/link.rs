//! A bank of channels at one end of a link, and its decoders at the other.

use std::any::Any;
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use anyhow::{Result, anyhow, bail};
use catalogue::for_sample_type;
use catalogue::run::{RunTime, Runs, SampleType, Settings, Visit};
use lab::events::LinkTally;
use lab::flight::Parts;
use lab::values::with_kind;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use spikewire::link::{
    CLOCK_TOLERANCE, Coding, MAX_FRAME, Reader, Received, Receiver, Session, Transmitter,
    longest_slot,
};
use spikewire::{
    Bank, Fingerprint, FromItems, Item, Keyframe, Recovery, Sample, SampleKind, Scheme, Spike, Tick,
};

use crate::coder::Coder;
use crate::error::value;
use crate::filter::{Chain, Filter};

/// The most channels of a bank, as of a flight file. Banks and receivers have as many, because their number is a part of
/// their type: those behind the last channel encode what the last one encodes, and nothing of them is sent.
const CHANNELS: usize = 64;

/// The most events of one sample, over all channels.
const EVENTS: usize = 1 << 14;

/// The sender's half: a bank.
trait Near: Send {
    /// Encodes a sample of every channel.
    fn encode(&mut self, tick: Tick, samples: &[f64], items: &mut Vec<Item>);

    /// Adds the keyframes or the heartbeat after the sample of this tick.
    fn keyframe(&self, tick: Tick, items: &mut Vec<Item>);
}

/// The receiver's half: the decoders.
trait Far: Send {
    /// Decodes a frame.
    fn hear(&mut self, received: &Received<'_>);

    /// Decodes the samples that are over at this tick.
    fn advance(&mut self, now: Tick);

    /// The value of each channel, and whether it is exact.
    fn values(&self) -> (Vec<f64>, Vec<bool>);

    /// Why a channel has no exact value, in words.
    fn withheld(&self) -> Vec<Option<String>>;
}

struct NearEnd<P: Scheme + 'static> {
    /// The filter of each channel.
    filters: Vec<Chain<P::Sample>>,
    bank: Bank<[&'static P; CHANNELS], CHANNELS>,
    one: f64,
    wire: Wire,
}

/// What the items of a bank become on the link.
#[derive(Clone, Copy)]
struct Wire {
    /// The first address behind those of the channels.
    end: u16,
    /// The sample type by which keyframes are labelled: the bank's own is one for all of a width.
    kind: SampleKind,
}

impl<P: Scheme<EncoderState: Send> + Sync> Near for NearEnd<P> {
    fn encode(&mut self, tick: Tick, samples: &[f64], items: &mut Vec<Item>) {
        let mut filtered = Vec::with_capacity(CHANNELS);
        for (sample, filter) in samples.iter().zip(&mut self.filters) {
            filtered.push(filter.next(P::Sample::from_f64(sample * self.one)));
        }
        let last = filtered.len().saturating_sub(1);
        let samples = std::array::from_fn(|channel| filtered[channel.min(last)]);
        self.bank.encode_into(tick, samples, Items { list: items, wire: self.wire });
    }

    fn keyframe(&self, tick: Tick, items: &mut Vec<Item>) {
        self.bank.keyframe_into(tick, Items { list: items, wire: self.wire });
    }
}

/// A list as the end of a queue.
struct Items<'a> {
    list: &'a mut Vec<Item>,
    wire: Wire,
}

impl spikewire::Put for Items<'_> {
    fn put(&mut self, item: Item) {
        let Wire { end, kind } = self.wire;
        match item {
            Item::Event(event) if event.address >= end => {}
            Item::Keyframe(keyframe) if keyframe.address >= end => {}
            Item::Keyframe(keyframe) => {
                self.list.push(Item::Keyframe(Keyframe { kind, ..keyframe }));
            }
            item => self.list.push(item),
        }
    }
}

struct FarEnd<P: Scheme + 'static, const EVENTS: usize> {
    receiver: Receiver<[&'static P; CHANNELS], CHANNELS, EVENTS>,
    channels: u16,
    one: f64,
    /// The sender's sample type.
    kind: SampleKind,
}

impl<P: Scheme<DecoderState: Send> + Sync, const EVENTS: usize> Far for FarEnd<P, EVENTS> {
    fn hear(&mut self, received: &Received<'_>) {
        let received = with_kind(received, self.kind, <P::Sample as Sample>::KIND);
        self.receiver.apply(&received, |_, _, _| ());
    }

    fn advance(&mut self, now: Tick) {
        self.receiver.advance(now, |_, _, _| ());
    }

    fn values(&self) -> (Vec<f64>, Vec<bool>) {
        let value = |channel| self.receiver.estimate(channel).to_f64() / self.one;
        let is_exact = |channel| self.receiver.exact(channel).is_some();
        ((0..self.channels).map(value).collect(), (0..self.channels).map(is_exact).collect())
    }

    fn withheld(&self) -> Vec<Option<String>> {
        let why = |channel| self.receiver.withheld(channel).map(|why| why.to_string());
        (0..self.channels).map(why).collect()
    }
}

/// Both ends of a link, of which a caller keeps the one it wants.
struct Ends {
    near: Box<dyn Near>,
    far: Box<dyn Far>,
    coding: Coding,
    fingerprint: Fingerprint,
}

/// Builds both ends from the settings of each channel.
struct Build<'a> {
    scheme: &'static dyn RunTime,
    settings: &'a [Settings],
    sample: SampleType,
    link: &'a Link,
    /// In millionths.
    clock_tolerance: u32,
}

/// What both ends have in common beside the schemes.
struct Link {
    filters: Vec<Option<Filter>>,
    period: u32,
    label: Option<String>,
}

/// Settings that the sender alone decides: bits of step numbers, and times in µs.
#[derive(FromPyObject)]
struct Sends {
    #[pyo3(item)]
    step_bits: u8,
    #[pyo3(item)]
    gathering: u32,
    /// `None` for the usual time.
    #[pyo3(item)]
    full_every: Option<u32>,
}

impl Sends {
    /// Checks that the settings are in the ranges of a flight's file, and that the schemes have steps if their numbers are
    /// to be sent.
    fn check(&self, scheme: &catalogue::Info) -> Result<()> {
        let Self { step_bits, gathering, full_every } = *self;
        for (name, given, most) in [
            ("step_bits", step_bits.into(), Parts::MOST_STEP_BITS.into()),
            ("gathering", gathering, Parts::LONGEST_GATHERING),
            ("full_every", full_every.unwrap_or_default(), Parts::LONGEST_FULL_EVERY),
        ] {
            if given > most {
                bail!("{name} {given} must lie in 0..={most}");
            }
        }
        if step_bits > 0 && !scheme.has_first_value() {
            bail!("step_bits {step_bits}: {} has no steps whose number could be sent", scheme.name);
        }
        Ok(())
    }
}

impl<S: Sample> Visit<S> for Build<'_> {
    type Output = Result<Ends>;

    fn visit<P: Runs<S>>(self, _: P, _: P::EncoderState) -> catalogue::run::Result<Result<Ends>> {
        Ok(self.ends::<S, P, EVENTS>())
    }

    fn visit_steps<P: Runs<S> + Scheme<Code = Spike>>(
        self,
        _: P,
        _: P::EncoderState,
    ) -> catalogue::run::Result<Result<Ends>> {
        Ok(if P::RECOVERY == Recovery::Keyframe {
            self.ends::<S, P, 0>()
        } else {
            self.ends::<S, P, CHANNELS>()
        })
    }
}

impl Build<'_> {
    fn ends<S: Sample, P: Runs<S>, const EVENTS: usize>(self) -> Result<Ends> {
        let Self { scheme, settings, sample, link, clock_tolerance } = self;
        let Link { filters, period, label } = link;
        let mut channels = Vec::new();
        for own in settings {
            let built = catalogue::visit::<S, _>(scheme.info().name, own, Boxed)?;
            let Ok(built) = built.downcast::<(P, P::EncoderState)>() else {
                bail!("the channels of a bank differ in more than numbers")
            };
            let (scheme, mut state) = *built;
            if own.get("start").is_some() {
                scheme.prime(&mut state, &[own.signal("start")?]);
            }
            // A bank borrows its schemes for as long as it lives, and those of a firmware lie in flash: a few hundred
            // bytes that are not given back.
            channels.push((&*Box::leak(Box::new(scheme)), state));
        }
        let count = channels.len();
        let schemes: Vec<&'static P> = channels.iter().map(|(scheme, _)| *scheme).collect();
        let neurons = schemes[0].neurons();
        if schemes.iter().any(|own| own.neurons() != neurons) {
            bail!("the channels of a bank have the same number of neurons");
        }
        let slots = schemes.iter().map(|own| own.slots()).max().unwrap_or(1);
        let is_slotted = P::RECOVERY != Recovery::Keyframe && slots > 1;
        let slots = slots as u32;
        let slot_ticks = if is_slotted { longest_slot(slots, *period, CLOCK_TOLERANCE) } else { 0 };
        if is_slotted
            && (slot_ticks == 0 || slot_ticks > longest_slot(slots, *period, clock_tolerance))
        {
            bail!(
                "{slots} sub-timesteps do not fit into {period} µs with a clock tolerance of {clock_tolerance} ppm"
            );
        }
        let jitter = if is_slotted { slot_ticks.ilog2() as u8 + 2 } else { 0 };
        let end = (count * neurons) as u16;
        let coding = Coding::for_channels(end, *period);
        let one = sample.one();
        let built = |own: &Option<Filter>| own.as_ref().map_or(Ok(Chain::none()), Filter::build);
        let filters = filters.iter().map(built).collect::<Result<Vec<_>>>()?;
        if filters.len() != count {
            bail!("there are {} filters for {count} channels", filters.len());
        }
        let pairs = filters.iter().zip(&schemes);
        let fingerprints: Vec<Fingerprint> =
            pairs.map(|(filter, scheme)| filter.before(scheme.fingerprint())).collect();
        let last = count - 1;
        let started = std::array::from_fn(|channel: usize| channels[channel.min(last)].clone());
        let bank = Bank::per_channel_with_states(started).with_slot_ticks(slot_ticks);
        let kind = sample.into();
        let mut fingerprint = Fingerprint::of_bank(kind, 0, slot_ticks, &fingerprints);
        if let Some(label) = label {
            fingerprint = fingerprint.labelled(label);
        }
        let schemes = std::array::from_fn(|channel: usize| schemes[channel.min(last)]);
        let receiver = Receiver::<_, CHANNELS, EVENTS>::per_channel(schemes)
            .with_slot_ticks(slot_ticks)
            .with_fingerprint(fingerprint)
            .with_clock_tolerance(clock_tolerance);
        Ok(Ends {
            near: Box::new(NearEnd { filters, bank, one, wire: Wire { end, kind } }),
            far: Box::new(FarEnd { receiver, channels: count as u16, one, kind }),
            coding: coding.with_jitter_bits(jitter),
            fingerprint,
        })
    }
}

/// Hands a scheme and the state of its encoder on by themselves.
struct Boxed;

impl<S: Sample> Visit<S> for Boxed {
    type Output = Box<dyn Any>;

    fn visit<P: Runs<S>>(
        self,
        scheme: P,
        start: P::EncoderState,
    ) -> catalogue::run::Result<Box<dyn Any>> {
        Ok(Box::new((scheme, start)))
    }
}

/// Both ends of a link whose channels have these schemes, which are of one kind.
fn ends(coders: &[Coder], link: &Link, clock_tolerance: u32) -> Result<Ends> {
    let first = match coders {
        [first, ..] if coders.len() <= CHANNELS => first,
        _ => bail!("a bank has 1 to {CHANNELS} channels, not {}", coders.len()),
    };
    let is_other = |own: &Coder| {
        own.scheme.info().name != first.scheme.info().name || own.sample != first.sample
    };
    if coders.iter().any(is_other) {
        bail!("the channels of a bank have one kind of scheme and one sample type");
    }
    let mut settings = Vec::new();
    for (stream, coder) in (0..).zip(coders) {
        if coder.asked.get("start").is_some() && !coder.scheme.info().has_baseline() {
            bail!(
                "a bank of {} starts from its first samples, not from start=",
                coder.scheme.info().name
            );
        }
        let past = vec![0.0; coder.looks_back()];
        settings.push(coder.settle(&past, None)?.with_stream(stream));
    }
    let settings = &settings[..];
    let (scheme, sample) = (first.scheme, first.sample);
    let build = Build { scheme, settings, sample, link, clock_tolerance };
    for_sample_type!(sample, S => catalogue::visit::<S, _>(scheme.info().name, &settings[0], build))?
}

/// The frames of a sample, and for each of its events the address and whether it went up.
type Sent<'py> = (Bound<'py, PyList>, Vec<(u16, bool)>);

/// A bank and the frames of its events.
#[pyclass(frozen, module = "spikewire._native")]
pub(crate) struct Sender(Mutex<Sending>);

struct Sending {
    near: Box<dyn Near>,
    channels: usize,
    transmitter: Transmitter,
    period: u64,
    keyframe_every: u64,
    samples: u64,
    items: Vec<Item>,
    /// Items that wait for others.
    waiting: VecDeque<Item>,
}

#[pymethods]
impl Sender {
    #[new]
    fn new(
        coders: Vec<Coder>,
        filters: Vec<Option<Filter>>,
        period: u32,
        keyframe_every: u64,
        session: u32,
        label: Option<String>,
        sends: Sends,
    ) -> PyResult<Self> {
        let link = Link { filters, period, label };
        let Ends { near, coding, fingerprint, .. } = ends(&coders, &link, 0).map_err(value)?;
        if let Some(coder) = coders.first() {
            sends.check(coder.scheme.info()).map_err(value)?;
        }
        let Sends { step_bits, gathering, full_every } = sends;
        let transmitter =
            Transmitter::new(coding.with_step_bits(step_bits), Session::counted(session))
                .with_fingerprint(fingerprint)
                .with_gathering(gathering)
                .with_full_every(full_every.unwrap_or(Transmitter::FULL_EVERY));
        Ok(Self(Mutex::new(Sending {
            near,
            channels: coders.len(),
            transmitter,
            period: period.into(),
            keyframe_every: keyframe_every.max(1),
            samples: 0,
            items: Vec::new(),
            waiting: VecDeque::new(),
        })))
    }

    /// Encodes a sample of each channel.
    fn encode<'py>(&self, py: Python<'py>, samples: Vec<f64>) -> PyResult<Sent<'py>> {
        let mut own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Sending {
            near,
            channels,
            transmitter,
            period,
            keyframe_every,
            samples: count,
            items,
            waiting,
        } = &mut *own;
        if samples.len() != *channels {
            let values = samples.len();
            return Err(value(anyhow!(
                "a sample has {channels} values, one a channel, not {values}"
            )));
        }
        items.clear();
        let tick = Tick::from_micros(*count * *period);
        near.encode(tick, &samples, items);
        let fired = items.iter().filter_map(|item| match item {
            Item::Event(event) => Some((event.address, event.polarity == spikewire::Polarity::Up)),
            _ => None,
        });
        let fired = fired.collect();
        if count.is_multiple_of(*keyframe_every) {
            near.keyframe(tick, items);
        }
        *count += 1;
        let frames = PyList::empty(py);
        waiting.extend(items.drain(..));
        transmitter.observe(tick);
        let mut source = FromItems(std::iter::from_fn(|| waiting.pop_front()));
        let mut buffer = [0; MAX_FRAME];
        while let Some(frame) = transmitter
            .next_frame(&mut source, &mut buffer)
            .map_err(|error| value(anyhow!("{error}")))?
        {
            frames.append(PyBytes::new(py, frame))?;
        }
        Ok((frames, fired))
    }
}

/// The decoders of a bank, at the other end.
#[pyclass(frozen, module = "spikewire._native")]
pub(crate) struct Hearer(Mutex<Hearing>);

struct Hearing {
    far: Box<dyn Far>,
    reader: Reader<MAX_FRAME>,
}

#[pymethods]
impl Hearer {
    #[new]
    fn new(
        coders: Vec<Coder>,
        filters: Vec<Option<Filter>>,
        period: u32,
        clock_tolerance: f64,
        label: Option<String>,
    ) -> PyResult<Self> {
        if !(0.0..=0.1).contains(&clock_tolerance) {
            return Err(value(anyhow!("clock_tolerance {clock_tolerance} must lie in 0..=0.1")));
        }
        // A whole number of millionths stays what it is, though a double holds its fraction inexactly.
        let millionths = (clock_tolerance * 1e6 - 1e-3).ceil() as u32;
        let link = Link { filters, period, label };
        let Ends { far, .. } = ends(&coders, &link, millionths).map_err(value)?;
        Ok(Self(Mutex::new(Hearing { far, reader: Reader::new() })))
    }

    /// Takes the next bytes of the link, cut anywhere. Returns whether frames seem to come from two senders.
    fn hear(&self, mut bytes: &[u8]) -> bool {
        let mut own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Hearing { far, reader } = &mut *own;
        while let Some(received) = reader.next_frame(&mut bytes) {
            far.hear(&received);
        }
        let tally = LinkTally {
            frames: reader.frames().into(),
            late: reader.late().into(),
            lost: reader.lost_frames().into(),
            bad_checksums: reader.bad_checksums().into(),
            ..LinkTally::default()
        };
        tally.has_two_senders()
    }

    /// Says that all events before this time in µs have arrived.
    fn advance(&self, now: u64) {
        let mut own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        own.far.advance(Tick::from_micros(now));
    }

    /// Why a channel has no exact value, in words.
    fn withheld(&self) -> Vec<Option<String>> {
        let own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        own.far.withheld()
    }

    /// The values of the channels, and whether each is exact.
    fn values(&self) -> (Vec<f64>, Vec<bool>) {
        let own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        own.far.values()
    }

    /// How many frames were lost, as far as later ones tell.
    fn lost(&self) -> u32 {
        let own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        own.reader.lost_frames()
    }

    /// How many frames came after later ones, or from another sender, and were left out.
    fn late(&self) -> u32 {
        let own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        own.reader.late()
    }
}
