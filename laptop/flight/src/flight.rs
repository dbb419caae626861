//! A flight: the description from which both sender and receiver are made, checked for consistency.

use crate::units::{self, unit_of_name};
use crate::{Filter, Filtering, FlightError, FlightErrorKind};
use catalogue::run::{Asked, Error, Known, RunTime, SampleType, Settings, Value, Visit};
use catalogue::{Info, Kind, Parameter, for_sample_type};
use spikewire::link::{CLOCK_TOLERANCE, Coding, Session, Transmitter, longest_slot};
use spikewire::{ConfigError, Fingerprint, Sample, Scheme};
use std::collections::BTreeSet;
use std::num::NonZeroU32;
use std::ops::Deref;
use std::path::PathBuf;

/// A channel of a flight: one sensor signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name, unique among the flight's channels.
    pub name: String,
    /// Name of the column, or topic and field, that holds the channel's values in a recording.
    pub source: String,
    /// Unit of the recording's values, such as `rad/s`; empty if it is unknown. [`Flight::new`] fills in the unit for
    /// which the end of `name` or `source` [stands](crate::unit_of_name).
    pub unit: String,
    /// Number of counts in one unit, above 0. A sample is the recording's value times this number. 1 if samples are in
    /// the unit itself.
    pub counts: f64,
    /// Parameters of this channel that the other channels do not share, in units of samples.
    pub asked: Asked,
}

/// The parts of a flight, as they are in the flight file. [`Flight::new`] checks that they fit together.
#[derive(Clone, Debug)]
pub struct Parts {
    /// Encoding scheme of all channels.
    pub scheme: &'static Info,
    /// Type of the samples.
    pub sample: SampleType,
    /// Time from one sample to the next, in µs.
    pub period: NonZeroU32,
    /// Number of samples from one keyframe, or heartbeat, to the next; 1 or more.
    pub keyframe_every: u32,
    /// Maximum deviation from the period of the time between samples, as measured by the sender's clock, in millionths
    /// of the period, 0 to 100 000.
    pub clock_ppm: u32,
    /// Low bits of a channel's step number that its first event in a frame carries, 0 to 4: a receiver that missed fewer
    /// net steps than half of 2 to this power has the sender's value again at the next event. Step codes only.
    pub step_bits: u8,
    /// Time in µs that events wait for others before they are sent, 0 to 1 000 000.
    pub gathering: u32,
    /// Time in µs from one full frame to the next, by which a receiver joins, 0 to 10 000 000; 0 if every frame is full.
    pub full_every: u32,
    /// Filter that runs before the encoder of each channel.
    pub filter: Option<Filter>,
    /// Parameters that all channels share, in units of samples.
    pub shared: Asked,
    /// Channels, in the order in which a sample holds their values.
    pub channels: Vec<Channel>,
}

impl Parts {
    /// Most low bits of a step number.
    pub const MOST_STEP_BITS: u8 = 4;
    /// Longest time in µs that events may wait for others.
    pub const LONGEST_GATHERING: u32 = 1_000_000;
    /// Longest time in µs from one full frame to the next.
    pub const LONGEST_FULL_EVERY: u32 = 10_000_000;
}

/// A flight whose parts fit together, from which sender and receiver are made.
///
/// All channels have the same scheme. Parameters that are numbers, such as a threshold or a range, may differ between
/// channels. Words, filters and counts, such as the number of neurons, are the same for all, because a
/// [`Bank`](spikewire::Bank) holds schemes of one type.
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
/// let error = Flight::parse("version = 1\nscheme = \"sod\"\nperiod = 0").unwrap_err();
/// assert_eq!((error.parameter.as_str(), error.place.line), ("period", Some(3)));
/// # Ok::<(), spikewire_flight::FlightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Flight {
    parts: Parts,
    settings: Vec<Settings>,
    fingerprint: Fingerprint,
    /// Line of each channel in the flight file; empty if the flight was not parsed from text.
    pub(crate) lines: Vec<Option<usize>>,
    /// Other files from which the flight was read, such as a file of taps.
    pub(crate) files: Vec<PathBuf>,
}

impl Deref for Flight {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        &self.parts
    }
}

/// Maximum number of channels: that of a receiver on the laptop.
const MOST: usize = 64;

/// Shortest period in µs. The fastest inertial sensors take a sample in 31 µs; a shorter period was meant in ms.
const SHORTEST: u32 = 30;

impl Flight {
    /// Checks that the parts fit together, and makes a flight of them.
    ///
    /// # Errors
    /// Returns an error if there are no channels or more than 64, if two have the same name, if a number is out of its
    /// range, if the scheme refuses a parameter or lacks one, or if a [`Bank`](spikewire::Bank) cannot hold all
    /// channels.
    pub fn new(mut parts: Parts) -> Result<Self, FlightError> {
        let range = |name: &str, given: f64, min: f64, max: f64| {
            let is_within = (min..=max).contains(&given);
            let kind = FlightErrorKind::Range { given, min, max };
            if is_within { Ok(()) } else { Err(FlightError::new(name, kind)) }
        };
        let given = parts.period.get();
        if given < SHORTEST {
            let kind =
                FlightErrorKind::Period { given, min: SHORTEST, max: Coding::LONGEST_PERIOD };
            return Err(FlightError::new("period", kind));
        }
        range("period", given.into(), SHORTEST.into(), Coding::LONGEST_PERIOD.into())?;
        range("channel", parts.channels.len() as f64, 1.0, MOST as f64)?;
        range("keyframe_every", parts.keyframe_every.into(), 1.0, f64::from(u32::MAX))?;
        range("clock_ppm", parts.clock_ppm.into(), 0.0, 1e5)?;
        range("step_bits", parts.step_bits.into(), 0.0, Parts::MOST_STEP_BITS.into())?;
        if parts.step_bits > 0 && !parts.scheme.has_first_value() {
            return Err(FlightError::new("step_bits", FlightErrorKind::NoSteps));
        }
        range("gathering", parts.gathering.into(), 0.0, Parts::LONGEST_GATHERING.into())?;
        range("full_every", parts.full_every.into(), 0.0, Parts::LONGEST_FULL_EVERY.into())?;
        let mut names = BTreeSet::new();
        for (index, channel) in parts.channels.iter_mut().enumerate() {
            let error = |name, kind| FlightError::new(name, kind).of_channel(index);
            range("counts", channel.counts, f64::MIN_POSITIVE, f64::MAX)
                .map_err(|error| error.of_channel(index))?;
            if let Some(meant) = units::meant(&channel.unit) {
                let given = channel.unit.clone();
                return Err(error("unit", FlightErrorKind::Unit { given, meant }));
            }
            if channel.unit.is_empty() {
                let unit = unit_of_name(&channel.name).or_else(|| unit_of_name(&channel.source));
                channel.unit = unit.unwrap_or_default().to_owned();
            }
            if !names.insert(&channel.name) {
                return Err(error("name", FlightErrorKind::Twice));
            }
        }
        let rate = rate(&parts);
        if let Some(filter) = parts.filter {
            filter.start(parts.sample, rate as f32).map(drop).map_err(refused_filter)?;
        }
        let mut settings = Vec::new();
        for (index, channel) in parts.channels.iter().enumerate() {
            let settled = settle(&parts, channel).map_err(|error| error.of_channel(index))?;
            settings.push(settled.with_stream(index as u64));
        }
        let fingerprint = Fingerprint::new("");
        let mut flight =
            Self { parts, settings, fingerprint, lines: Vec::new(), files: Vec::new() };
        flight.check_bank()?;
        flight.check_rounding()?;
        flight.fingerprint = flight.described()?;
        Ok(flight)
    }

    /// Checks that each channel has a unit, as a firmware needs it to bring its sensor's counts to samples. The unit of
    /// a ratio is `1`.
    ///
    /// # Errors
    /// Returns an error for the first channel without a unit.
    pub fn check_units(&self) -> Result<(), FlightError> {
        let Some(index) = self.channels.iter().position(|channel| channel.unit.is_empty()) else {
            return Ok(());
        };
        let kind = FlightErrorKind::NoUnit { name: self.channels[index].name.clone() };
        Err(FlightError::new("unit", kind).of_channel(index).at(self.line_of(index)))
    }

    /// Checks that a [`Bank`](spikewire::Bank) can hold all channels, that a sub-timestep takes at least 1 µs, and that a
    /// receiver can tell sub-timesteps apart with a clock as fast as its tolerance allows.
    fn check_bank(&self) -> Result<(), FlightError> {
        let [first, others @ ..] = &self.settings[..] else { return Ok(()) };
        for parameter in self.scheme.parameters {
            if parameter.kind == Kind::Number {
                continue;
            }
            let key = parameter.key();
            let differs = |settings: &Settings| settings.get(key) != first.get(key);
            if let Some(index) = others.iter().position(differs) {
                let error = FlightError::new(parameter.name, FlightErrorKind::NotOneBank);
                return Err(error.of_channel(index + 1));
            }
        }
        let slots = self.slots() as u32;
        if self.is_slotted() && !self.has_room(slots) {
            let mut most = slots;
            while most > 1 && !self.has_room(most) {
                most -= 1;
            }
            let kind = FlightErrorKind::Range { given: slots.into(), min: 1.0, max: most.into() };
            return Err(FlightError::new("slots", kind));
        }
        Ok(())
    }

    /// Returns the line of a channel in the flight file; `None` if the flight was not parsed from text.
    pub fn line_of(&self, channel: usize) -> Option<usize> {
        self.lines.get(channel).copied().flatten()
    }

    /// Returns whether a sample has time for so many sub-timesteps.
    fn has_room(&self, slots: u32) -> bool {
        let length = longest_slot(slots, self.period.get(), CLOCK_TOLERANCE);
        length > 0 && length <= longest_slot(slots, self.period.get(), self.clock_ppm)
    }

    /// Returns the scheme of all channels, in the form that runs on the laptop.
    pub fn run_time(&self) -> &'static dyn RunTime {
        run_time(self.scheme)
    }

    /// Returns the settings with which each channel runs, in units of samples.
    pub fn settings(&self) -> &[Settings] {
        &self.settings
    }

    /// Returns the parameters of all channels as one set. A number that differs between channels becomes a list with
    /// one item for each channel.
    pub fn asked_of_all(&self) -> Asked {
        let each: Vec<Asked> = self.channels.iter().map(|channel| self.asked(channel)).collect();
        let mut all = each.first().cloned().unwrap_or_default();
        for parameter in
            self.scheme.parameters.iter().filter(|parameter| parameter.kind == Kind::Number)
        {
            let name = parameter.name;
            if each.iter().all(|asked| asked.get(name) == each[0].get(name)) {
                continue;
            }
            // Channels without the parameter have its default.
            let numbers =
                self.settings.iter().map(|settings| settings.get(name).and_then(Value::number));
            if let Some(numbers) = numbers.collect::<Option<Vec<f64>>>() {
                all.set(name, numbers);
            }
        }
        all
    }

    /// Returns the parameters of a channel: its own, completed by the shared ones.
    pub fn asked(&self, channel: &Channel) -> Asked {
        channel.asked.or(&self.shared)
    }

    /// Starts the filter of each channel; returns an empty list if the flight has no filter.
    ///
    /// # Errors
    /// Never returns an error, because the filter was checked when the flight was made.
    pub fn filters(&self) -> Result<Vec<Filtering>, FlightError> {
        let Some(filter) = self.filter else { return Ok(Vec::new()) };
        let start = |_: &Channel| {
            let started = filter.start(self.sample, self.rate() as f32);
            started.map_err(refused_filter)
        };
        self.channels.iter().map(start).collect()
    }

    /// Returns the sample rate in Hz.
    pub fn rate(&self) -> f64 {
        rate(&self.parts)
    }

    /// Returns the number of neurons of each channel.
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

    /// Returns whether the sub-timestep of a spike affects the decoded value. It does not for temporal codes.
    fn is_slotted(&self) -> bool {
        !self.scheme.has_first_value() && self.slots() > 1
    }

    /// Returns the length of a sub-timestep in µs, or 0 if the scheme has no sub-timesteps: the longest that leaves room for a
    /// clock that is 2 % fast.
    pub fn slot_ticks(&self) -> u32 {
        if !self.is_slotted() {
            return 0;
        }
        longest_slot(self.slots() as u32, self.period.get(), CLOCK_TOLERANCE)
    }

    /// Returns the period and each channel's name, unit and counts as one text. The text is part of the
    /// [fingerprint](Self::fingerprint), because the same spikes have a different meaning if it differs.
    pub fn label(&self) -> String {
        let channel =
            |channel: &Channel| format!("; {} [{}] {}", channel.name, channel.unit, channel.counts);
        let channels: String = self.channels.iter().map(channel).collect();
        format!("{} us{channels}", self.period)
    }

    /// Returns the fingerprint in the frames of this flight: that of its bank, filters included, and its
    /// [label](Self::label).
    pub fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    fn described(&self) -> Result<Fingerprint, FlightError> {
        let name = self.scheme.name;
        let filter = self.filter.map(|filter| filter.fingerprint(self.sample, self.rate() as f32));
        let filter = filter.transpose().map_err(refused_filter)?;
        let scheme = |settings| {
            let scheme = for_sample_type!(self.sample, S => catalogue::visit::<S, _>(name, settings, Described))?;
            Ok(filter.map_or(scheme, |filter| filter.and(scheme)))
        };
        let schemes: Result<Vec<_>, _> = self.settings.iter().map(scheme).collect();
        let schemes = schemes.map_err(|error: Error| FlightError::refused("", error))?;
        let bank = Fingerprint::of_bank(self.sample.into(), 0, self.slot_ticks(), &schemes);
        Ok(bank.labelled(&self.label()))
    }

    /// Returns the frame format: the number of bits for each part of an event, and the period. It is no part of the
    /// fingerprint, because each full frame contains it.
    pub fn coding(&self) -> Coding {
        let addresses = self.channels.len() * self.neurons();
        let jitter = self.slot_ticks().checked_ilog2().map_or(0, |bits| bits as u8 + 2);
        Coding::for_channels(addresses as u16, self.period.get())
            .with_jitter_bits(jitter)
            .with_step_bits(self.step_bits)
    }

    /// Returns the sender's half of the link, before the first frame of this session.
    pub fn transmitter(&self, session: Session) -> Transmitter {
        let addresses = self.channels.len() * self.neurons();
        Transmitter::new(self.coding(), session)
            .with_addresses(0..=(addresses - 1) as u16)
            .with_fingerprint(self.fingerprint())
            .with_gathering(self.gathering)
            .with_full_every(self.full_every)
    }

    /// Returns the maximum number of events that a receiver stores for a sample, over all channels; 0 if the receiver
    /// of the scheme stores none.
    pub fn events(&self) -> usize {
        let Parts { scheme, channels, .. } = &self.parts;
        if scheme.has_first_value() && !is_timed(scheme) {
            return 0;
        }
        let settings = &self.settings[0];
        let spikes = settings.count("spikes", 1..=usize::MAX).ok();
        let (neurons, slots) = self.shape();
        // Without sub-timesteps, randomness or a count of spikes, only one neuron of a channel fires in a sample.
        let fires_together = slots > 1 || scheme.parameter("seed").is_some();
        let most = if neurons > 1 && fires_together { neurons } else { slots };
        channels.len() * spikes.unwrap_or(most)
    }
}

/// Visitor that returns the fingerprint of a scheme.
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

/// Returns whether the decoder of a temporal code depends on the number of samples, because its step adapts in samples
/// without spikes.
fn is_timed(scheme: &Info) -> bool {
    scheme.parameter("doublings").is_some()
}

fn rate(parts: &Parts) -> f64 {
    1e6 / f64::from(parts.period.get())
}

/// Returns the scheme in the catalogue that has this description, in the form that runs on the laptop.
fn run_time(info: &'static Info) -> &'static dyn RunTime {
    let found = catalogue::ALL.iter().find(|scheme| scheme.info().name == info.name);
    *found.unwrap_or(&catalogue::ALL[0]) // descriptions come from the catalogue alone
}

/// Returns the settings of a channel as it flies.
///
/// # Errors
/// Returns an error if a parameter is missing or refused, or if `start` is given for a scheme without a baseline, which
/// starts from its first samples.
fn settle(parts: &Parts, channel: &Channel) -> Result<Settings, FlightError> {
    let scheme = run_time(parts.scheme);
    let asked = channel.asked.or(&parts.shared);
    if asked.get("start").is_some() && !parts.scheme.has_baseline() {
        return Err(FlightError::new("start", FlightErrorKind::NoStart));
    }
    let past = vec![0.0; scheme.looks_back(&asked)];
    let known = Known { calibrated: None, first: &past, can_calibrate: false };
    let is_open = |parameter: &&Parameter| {
        let is_given = asked.get(parameter.name).is_some() || parameter.default.is_some();
        parameter.is_recorded && parameter.name != "start" && !is_given
    };
    let settings = scheme.resolve(parts.sample, &asked, &known).map_err(|error| {
        match parts.scheme.parameters.iter().find(is_open) {
            Some(open) => FlightError::new(open.name, FlightErrorKind::Missing),
            None => refused(parts.scheme, error),
        }
    })?;
    scheme.codec(&settings).map_err(|error| refused(parts.scheme, error))?;
    Ok(settings)
}

/// Returns the error of a scheme's parameter, under the name that it has in the flight file.
fn refused(scheme: &Info, error: Error) -> FlightError {
    let name = error.parameter.as_ref().map_or("", |given| given.name.as_ref());
    let parameter = scheme.parameters.iter().find(|own| [own.name, own.key()].contains(&name));
    FlightError::refused(parameter.map_or(name, |parameter| parameter.name).to_owned(), error)
}

/// Returns the error of a filter's number, under its name.
fn refused_filter(error: ConfigError) -> FlightError {
    let parameter = Error::from(error).parameter;
    FlightError::refused(parameter.map_or("filter".into(), |given| given.name), error)
}
