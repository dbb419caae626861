//! A flight: what the vehicle codes and the far end decodes, checked.

use crate::{Filter, Filtering, FlightError, FlightErrorKind};
use catalogue::run::{Asked, Error, Known, RunTime, SampleType, Settings, Value, Visit};
use catalogue::{Info, Kind, Parameter, for_sample_type};
use spikewire::link::Coding;
use spikewire::{Fingerprint, Sample, Scheme};
use std::collections::BTreeSet;
use std::num::NonZeroU16;
use std::ops::Deref;

/// A channel of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The name, different from every other channel's.
    pub name: String,
    /// The column of a table, or the topic and field of a log, that holds its samples.
    pub source: String,
    /// The unit of the recording's values, such as `rad/s`; empty if it is not known.
    pub unit: String,
    /// The number of counts for one unit, above 0: a sample is this many times the recording's value. 1 where samples are
    /// in that unit themselves.
    pub counts: f64,
    /// The parameters of this channel alone, in samples.
    pub asked: Asked,
}

/// The parts of a flight, as they stand in its file. [`Flight::new`] checks that they fit together.
#[derive(Clone, Debug)]
pub struct Parts {
    /// The scheme of every channel.
    pub scheme: &'static Info,
    /// The type of the samples.
    pub sample: SampleType,
    /// The time from sample to sample, in µs.
    pub period: NonZeroU16,
    /// The number of samples from one keyframe, or heartbeat, to the next; 1 or more.
    pub keyframe_every: u32,
    /// By how many millionths the time from sample to sample may differ from the period, in the sender's ticks.
    pub clock_ppm: u32,
    /// The filter before every channel's code.
    pub filter: Option<Filter>,
    /// The parameters that all channels share.
    pub shared: Asked,
    /// The channels, in the order of a sample.
    pub channels: Vec<Channel>,
}

/// A flight whose parts fit together: what the vehicle codes, and what its far end decodes.
///
/// Its channels have one scheme. Numbers, such as a threshold or a range, may differ from channel to channel; words,
/// filters and counts, such as neurons, slots and spikes, are shared, as a [`Bank`](spikewire::Bank) shares a type.
///
/// ```
/// use spikewire_flight::Flight;
///
/// let flight = Flight::parse(r#"
/// version = 1
/// scheme = "sod"
/// period = 2000
/// keyframe_every = 10
/// parameters = { spikes = 4 }
///
/// [[channel]]
/// name = "roll"
/// unit = "rad/s"
/// parameters = { threshold = 0.1 }
///
/// [[channel]]
/// name = "thrust"
/// unit = "m/s²"
/// parameters = { threshold = 0.5 }
/// "#)?;
/// assert_eq!(flight.settings()[1].number("threshold").unwrap(), 0.5);
/// assert_eq!(flight.coding().period.get(), 2000);
///
/// let told = Flight::parse("version = 1\nscheme = \"sod\"\nperiod = 0").unwrap_err();
/// assert_eq!(told.place.line, Some(3));
/// # Ok::<(), spikewire_flight::FlightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Flight {
    parts: Parts,
    settings: Vec<Settings>,
    fingerprint: Fingerprint,
}

impl Deref for Flight {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        &self.parts
    }
}

/// The most channels: a receiver on the laptop has no more.
const MOST: usize = 64;

impl Flight {
    /// Checks that parts fit together.
    ///
    /// # Errors
    /// Returns an error if there are no channels or too many, two have one name, a number is out of its range, the
    /// scheme refuses a parameter or misses one, or no bank holds all channels.
    pub fn new(parts: Parts) -> Result<Self, FlightError> {
        let range = |name: &str, given: f64, min: f64, max: f64| {
            let is_within = (min..=max).contains(&given);
            let kind = FlightErrorKind::Range { given, min, max };
            if is_within { Ok(()) } else { Err(FlightError::new(name, kind)) }
        };
        range("channel", parts.channels.len() as f64, 1.0, MOST as f64)?;
        range("keyframe_every", parts.keyframe_every.into(), 1.0, f64::from(u32::MAX))?;
        range("clock_ppm", parts.clock_ppm.into(), 0.0, 1e5)?;
        let mut names = BTreeSet::new();
        for (place, channel) in parts.channels.iter().enumerate() {
            range("counts", channel.counts, f64::MIN_POSITIVE, f64::MAX)
                .map_err(|error| error.of_channel(place))?;
            if !names.insert(&channel.name) {
                return Err(FlightError::new("name", FlightErrorKind::Twice).of_channel(place));
            }
        }
        let rate = rate(&parts);
        if let Some(filter) = parts.filter {
            let started = filter.start(parts.sample, rate as f32);
            started.map(drop).map_err(|error| FlightError::refused("filter", error))?;
        }
        let mut settings = Vec::new();
        for (place, channel) in parts.channels.iter().enumerate() {
            let own = settle(&parts, channel).map_err(|error| error.of_channel(place))?;
            settings.push(own.with_stream(place as u64));
        }
        let mut flight = Self { parts, settings, fingerprint: Fingerprint::new("") };
        flight.check_bank()?;
        flight.fingerprint = flight.described()?;
        Ok(flight)
    }

    /// Refuses channels that no bank holds, and sub-timesteps that do not fit into a sample.
    fn check_bank(&self) -> Result<(), FlightError> {
        let shape = |settings: &Settings| -> Vec<String> {
            let parameters = self.scheme.parameters.iter().filter(|own| own.kind != Kind::Number);
            parameters.filter_map(|own| Some(settings.get(own.key())?.to_string())).collect()
        };
        let first = shape(&self.settings[0]);
        if let Some(place) = self.settings.iter().position(|settings| shape(settings) != first) {
            let error = FlightError::new("parameters", FlightErrorKind::NotOneBank);
            return Err(error.of_channel(place));
        }
        let (slots, period) = (self.slots(), f64::from(self.period.get()));
        if self.is_slotted() && slots as f64 > period {
            let kind = FlightErrorKind::Range { given: slots as f64, min: 1.0, max: period };
            return Err(FlightError::new("slots", kind));
        }
        Ok(())
    }

    /// The scheme of every channel, to be run.
    pub fn run_time(&self) -> &'static dyn RunTime {
        run_time(self.scheme)
    }

    /// The settings of each channel, in samples, as they run.
    pub fn settings(&self) -> &[Settings] {
        &self.settings
    }

    /// The parameters of all channels: a number that differs from channel to channel is a list of one each.
    pub fn asked_of_all(&self) -> Asked {
        let each: Vec<Asked> = self.channels.iter().map(|own| self.asked(own)).collect();
        let mut all = each.first().cloned().unwrap_or_default();
        for parameter in self.scheme.parameters.iter().filter(|own| own.kind == Kind::Number) {
            let name = parameter.name;
            if each.iter().all(|own| own.get(name) == each[0].get(name)) {
                continue;
            }
            // One that is not given everywhere has its default elsewhere.
            let numbers = self.settings.iter().map(|own| own.get(name).and_then(Value::number));
            if let Some(numbers) = numbers.collect::<Option<Vec<f64>>>() {
                all.set(name, numbers);
            }
        }
        all
    }

    /// The parameters of a channel: its own, and those that all share.
    pub fn asked(&self, channel: &Channel) -> Asked {
        channel.asked.or(&self.shared)
    }

    /// Starts the filter of each channel; none if the flight has no filter.
    ///
    /// # Errors
    /// Returns no error: that the filter fits the rate was checked.
    pub fn filters(&self) -> Result<Vec<Filtering>, FlightError> {
        let Some(filter) = self.filter else { return Ok(Vec::new()) };
        let start = |_: &Channel| {
            let started = filter.start(self.sample, self.rate() as f32);
            started.map_err(|error| FlightError::refused("filter", error))
        };
        self.channels.iter().map(start).collect()
    }

    /// Samples a second.
    pub fn rate(&self) -> f64 {
        rate(&self.parts)
    }

    /// The number of neurons of each channel.
    pub fn neurons(&self) -> usize {
        self.shape().0
    }

    fn slots(&self) -> usize {
        self.shape().1
    }

    fn shape(&self) -> (usize, usize) {
        let shape = self.run_time().shape(&self.settings[0]);
        shape.map_or((1, 1), |shape| (shape.neurons, shape.slots))
    }

    /// Whether the sub-timestep of a spike carries a value. The spikes of a temporal code are all alike.
    fn is_slotted(&self) -> bool {
        !self.scheme.has_first_value() && self.slots() > 1
    }

    /// The length of a sub-timestep in µs; 0 for codes without.
    pub fn slot_ticks(&self) -> u32 {
        if self.is_slotted() { u32::from(self.period.get()) / self.slots() as u32 } else { 0 }
    }

    /// What a scheme's parameters do not say: the period, and each channel's name, unit and counts, in one text. Two flights
    /// with the same schemes and another label mean other things by the same spikes.
    pub fn label(&self) -> String {
        let channel = |own: &Channel| format!("; {} [{}] {}", own.name, own.unit, own.counts);
        let channels: String = self.channels.iter().map(channel).collect();
        format!("{} us{channels}", self.period)
    }

    /// The fingerprint that the flight's frames carry: that of its bank, filters included, with its [label](Self::label).
    pub fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    fn described(&self) -> Result<Fingerprint, FlightError> {
        let name = self.scheme.name;
        let filter = self.filter.map(|own| own.fingerprint(self.sample, self.rate() as f32));
        let filter = filter.transpose().map_err(|error| FlightError::refused("filter", error))?;
        let scheme = |settings| {
            let scheme = for_sample_type!(self.sample, S => catalogue::visit::<S, _>(name, settings, Described))?;
            Ok(filter.map_or(scheme, |filter| filter.and(scheme)))
        };
        let schemes: Result<Vec<_>, _> = self.settings.iter().map(scheme).collect();
        let schemes = schemes.map_err(|error: Error| FlightError::refused("", error))?;
        let bank = Fingerprint::of_bank(self.sample.into(), 0, self.slot_ticks(), &schemes);
        Ok(bank.labelled(&self.label()))
    }

    /// The number of bits that the parts of an event take on the link, and the period.
    pub fn coding(&self) -> Coding {
        let addresses = self.channels.len() * self.neurons();
        let jitter = self.slot_ticks().checked_ilog2().map_or(0, |bits| bits as u8 + 2);
        Coding::for_channels(addresses as u16, self.period.get()).with_jitter_bits(jitter)
    }

    /// The most events of one sample over all channels, as a receiver keeps them; 0 for codes whose receiver keeps none.
    pub fn events(&self) -> usize {
        let Parts { scheme, channels, .. } = &self.parts;
        if scheme.has_first_value() && !is_timed(scheme) {
            return 0;
        }
        let settings = &self.settings[0];
        let spikes = settings.count("spikes", 1..=usize::MAX).ok();
        let (neurons, slots) = self.shape();
        // A neuron fires once a sample; without sub-timesteps, chance or a count of spikes, one neuron names the value.
        let fires_together = slots > 1 || scheme.parameter("seed").is_some();
        let most = if neurons > 1 && fires_together { neurons } else { slots };
        channels.len() * spikes.unwrap_or(most)
    }
}

/// Takes the fingerprint of a scheme.
struct Described;

impl<S: Sample> Visit<S> for Described {
    type Output = Fingerprint;

    fn visit<P: Scheme<Sample = S> + 'static>(
        self,
        scheme: P,
        _: P::EncoderState,
    ) -> Result<Fingerprint, Error> {
        Ok(scheme.fingerprint())
    }
}

/// Whether a decoder of steps counts samples, too: its step adapts, so that silent samples change it.
fn is_timed(scheme: &Info) -> bool {
    scheme.parameter("doublings").is_some()
}

fn rate(parts: &Parts) -> f64 {
    1e6 / f64::from(parts.period.get())
}

/// The scheme of this description.
fn run_time(info: &'static Info) -> &'static dyn RunTime {
    let own = catalogue::ALL.iter().find(|own| own.info().name == info.name);
    *own.unwrap_or(&catalogue::ALL[0]) // descriptions come from the catalogue alone
}

/// The settings of a channel as it flies: where its signal begins is no parameter.
fn settle(parts: &Parts, channel: &Channel) -> Result<Settings, FlightError> {
    let scheme = run_time(parts.scheme);
    let asked = channel.asked.or(&parts.shared);
    if asked.get("start").is_some() {
        return Err(FlightError::new("start", FlightErrorKind::NoStart));
    }
    let past = vec![0.0; scheme.looks_back(&asked)];
    let known = Known { calibrated: None, first: &past, can_calibrate: false };
    let refused = |error| FlightError::refused("", error);
    let is_open = |own: &&Parameter| {
        let is_given = asked.get(own.name).is_some() || own.default.is_some();
        own.is_recorded && own.name != "start" && !is_given
    };
    let settings = scheme.resolve(parts.sample, &asked, &known).map_err(|error| {
        match parts.scheme.parameters.iter().find(is_open) {
            Some(open) => FlightError::new(open.name, FlightErrorKind::Missing),
            None => refused(error),
        }
    })?;
    scheme.codec(&settings).map_err(refused)?;
    Ok(settings)
}
