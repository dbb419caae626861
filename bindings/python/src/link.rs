//! A bank of six channels, those of an inertial sensor, at one end of a link, and its decoders at the other.

use std::any::Any;
use std::sync::{Mutex, PoisonError};

use anyhow::{Result, anyhow, bail};
use catalogue::for_sample_type;
use catalogue::run::{RunTime, Runs, SampleType, Settings, Visit};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use spikewire::link::{
    CLOCK_TOLERANCE, Coding, MAX_FRAME, Reader, Received, Receiver, Session, Transmitter,
    longest_slot,
};
use spikewire::{Bank, Fingerprint, FromItems, Item, Recovery, Sample, Scheme, Spike, Tick};

use crate::coder::Coder;
use crate::error::value;
use crate::filter::{Chain, Filter};

/// The channels of an inertial sensor.
const CHANNELS: usize = 6;

/// The most events of one sample, over all channels.
const EVENTS: usize = 1 << 12;

/// The sender's half: a bank.
trait Near: Send {
    /// Encodes a sample of every channel.
    fn encode(&mut self, tick: Tick, samples: [f64; CHANNELS], items: &mut Vec<Item>);

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
    fn values(&self) -> [(f64, bool); CHANNELS];

    /// Why a channel has no exact value, in words.
    fn withheld(&self) -> [Option<String>; CHANNELS];
}

struct NearEnd<P: Scheme + 'static> {
    filters: [Chain<P::Sample>; CHANNELS],
    bank: Bank<[&'static P; CHANNELS], CHANNELS>,
    one: f64,
}

impl<P: Scheme<EncoderState: Send> + Sync> Near for NearEnd<P> {
    fn encode(&mut self, tick: Tick, samples: [f64; CHANNELS], items: &mut Vec<Item>) {
        let mut filters = self.filters.iter_mut();
        let samples = samples.map(|sample| {
            let sample = P::Sample::from_f64(sample * self.one);
            filters.next().map_or(sample, |filter| filter.next(sample))
        });
        self.bank.encode(tick, samples, |event| items.push(event.into()));
    }

    fn keyframe(&self, tick: Tick, items: &mut Vec<Item>) {
        self.bank.keyframe_into(tick, Items(items));
    }
}

/// A list as the end of a queue.
struct Items<'a>(&'a mut Vec<Item>);

impl spikewire::Put for Items<'_> {
    fn put(&mut self, item: Item) {
        self.0.push(item);
    }
}

struct FarEnd<P: Scheme + 'static, const EVENTS: usize> {
    receiver: Receiver<[&'static P; CHANNELS], CHANNELS, EVENTS>,
    one: f64,
}

impl<P: Scheme<DecoderState: Send> + Sync, const EVENTS: usize> Far for FarEnd<P, EVENTS> {
    fn hear(&mut self, received: &Received<'_>) {
        self.receiver.apply(received, |_, _, _| ());
    }

    fn advance(&mut self, now: Tick) {
        self.receiver.advance(now, |_, _, _| ());
    }

    fn values(&self) -> [(f64, bool); CHANNELS] {
        std::array::from_fn(|channel| {
            let value = self.receiver.estimate(channel as u16).to_f64() / self.one;
            (value, self.receiver.exact(channel as u16).is_some())
        })
    }

    fn withheld(&self) -> [Option<String>; CHANNELS] {
        std::array::from_fn(|channel| {
            self.receiver.withheld(channel as u16).map(|why| why.to_string())
        })
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
    settings: &'a [Settings; CHANNELS],
    sample: SampleType,
    link: &'a Link,
    /// In millionths.
    clock_tolerance: u32,
}

/// What both ends have in common beside the schemes.
struct Link {
    filters: Vec<Option<Filter>>,
    period: u16,
    label: Option<String>,
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
            let (scheme, state) = *built;
            // A bank borrows its schemes for as long as it lives, and those of a firmware lie in flash: a few hundred
            // bytes that are not given back.
            channels.push((&*Box::leak(Box::new(scheme)), state));
        }
        let schemes: Vec<&'static P> = channels.iter().map(|(scheme, _)| *scheme).collect();
        let six = || anyhow!("there are {CHANNELS} channels");
        let schemes: [&'static P; CHANNELS] = schemes.try_into().map_err(|_| six())?;
        let channels: [(&'static P, P::EncoderState); CHANNELS] =
            channels.try_into().map_err(|_| six())?;
        let neurons = schemes[0].neurons();
        if schemes.iter().any(|own| own.neurons() != neurons) {
            bail!("the channels of a bank have the same number of neurons");
        }
        let slots = schemes.iter().map(|own| own.slots()).max().unwrap_or(1);
        let is_slotted = P::RECOVERY != Recovery::Keyframe && slots > 1;
        let slots = slots as u32;
        let slot_ticks =
            if is_slotted { longest_slot(slots, (*period).into(), CLOCK_TOLERANCE) } else { 0 };
        if is_slotted
            && (slot_ticks == 0
                || slot_ticks > longest_slot(slots, (*period).into(), clock_tolerance))
        {
            bail!(
                "{slots} sub-timesteps do not fit into {period} µs with a clock tolerance of {clock_tolerance} ppm"
            );
        }
        let jitter = if is_slotted { slot_ticks.ilog2() as u8 + 2 } else { 0 };
        let coding = Coding::for_channels((CHANNELS * neurons) as u16, (*period).into());
        let one = sample.one();
        let built = |own: &Option<Filter>| own.as_ref().map_or(Ok(Chain::none()), Filter::build);
        let filters = filters.iter().map(built).collect::<Result<Vec<_>>>()?;
        let filters: [Chain<S>; CHANNELS] = filters.try_into().map_err(|_| six())?;
        let fingerprints: [Fingerprint; CHANNELS] =
            std::array::from_fn(|own| filters[own].before(schemes[own].fingerprint()));
        let bank = Bank::per_channel_with_states(channels).with_slot_ticks(slot_ticks);
        let mut fingerprint = Fingerprint::of_bank(sample.into(), 0, slot_ticks, &fingerprints);
        if let Some(label) = label {
            fingerprint = fingerprint.labelled(label);
        }
        let receiver = Receiver::<_, CHANNELS, EVENTS>::per_channel(schemes)
            .with_slot_ticks(slot_ticks)
            .with_fingerprint(fingerprint)
            .with_clock_tolerance(clock_tolerance);
        Ok(Ends {
            near: Box::new(NearEnd { filters, bank, one }),
            far: Box::new(FarEnd { receiver, one }),
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
    let [first, ..] = coders else { bail!("a bank has {CHANNELS} channels, not 0") };
    if coders.len() != CHANNELS {
        bail!("a bank has {CHANNELS} channels, not {}", coders.len());
    }
    let is_other = |own: &Coder| {
        own.scheme.info().name != first.scheme.info().name || own.sample != first.sample
    };
    if coders.iter().any(is_other) {
        bail!("the channels of a bank have one kind of scheme and one sample type");
    }
    let mut settings = Vec::new();
    for (stream, coder) in (0..).zip(coders) {
        if coder.asked.get("start").is_some() {
            bail!("a bank starts from its first samples, not from start=");
        }
        let past = vec![0.0; coder.looks_back()];
        settings.push(coder.settle(&past, None)?.with_stream(stream));
    }
    let settings = &settings.try_into().map_err(|_| anyhow!("there are {CHANNELS} channels"))?;
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
    transmitter: Transmitter,
    period: u64,
    keyframe_every: u64,
    samples: u64,
    items: Vec<Item>,
}

#[pymethods]
impl Sender {
    #[new]
    fn new(
        coders: Vec<Coder>,
        filters: Vec<Option<Filter>>,
        period: u16,
        keyframe_every: u64,
        session: u32,
        label: Option<String>,
    ) -> PyResult<Self> {
        let link = Link { filters, period, label };
        let Ends { near, coding, fingerprint, .. } = ends(&coders, &link, 0).map_err(value)?;
        let session = Session::counted(session);
        let transmitter = Transmitter::new(coding, session).with_fingerprint(fingerprint);
        Ok(Self(Mutex::new(Sending {
            near,
            transmitter,
            period: period.into(),
            keyframe_every: keyframe_every.max(1),
            samples: 0,
            items: Vec::new(),
        })))
    }

    /// Encodes a sample of each channel.
    fn encode<'py>(&self, py: Python<'py>, samples: [f64; CHANNELS]) -> PyResult<Sent<'py>> {
        let mut own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Sending { near, transmitter, period, keyframe_every, samples: count, items } =
            &mut *own;
        items.clear();
        let tick = Tick::from_micros(*count * *period);
        near.encode(tick, samples, items);
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
        let mut source = FromItems(items.drain(..));
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
        period: u16,
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

    /// Takes the next bytes of the link, cut anywhere.
    fn hear(&self, mut bytes: &[u8]) {
        let mut own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Hearing { far, reader } = &mut *own;
        while let Some(received) = reader.next_frame(&mut bytes) {
            far.hear(&received);
        }
    }

    /// Says that all events before this time in µs have arrived.
    fn advance(&self, now: u64) {
        let mut own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        own.far.advance(Tick::from_micros(now));
    }

    /// Why a channel has no exact value, in words.
    fn withheld(&self) -> [Option<String>; CHANNELS] {
        let own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        own.far.withheld()
    }

    /// The values of the channels, and whether each is exact.
    fn values(&self) -> ([f64; CHANNELS], [bool; CHANNELS]) {
        let own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let values = own.far.values();
        (values.map(|(value, _)| value), values.map(|(_, is_exact)| is_exact))
    }

    /// How many frames were lost, as far as later ones tell.
    fn lost(&self) -> u32 {
        let own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        own.reader.lost_frames()
    }
}
