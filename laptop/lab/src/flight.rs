//! Reads the channels of a flight from a recording, and decodes the sender's frames to values. A flight is the scheme
//! and the channels of a drone's sender, as a file `flight.toml` describes them.

use crate::Result;
use crate::coding::Coding;
use crate::events::{Item, LinkTally, Values};
use crate::input::{Chunk, InputOptions, Source, is_other_rate};
use crate::scheme::Scheme;
use crate::tune::RequestKind;
use crate::tune::report::Row;
use crate::unit::unit_of_name;
use crate::values;
use catalogue::run::{Asked, Given, SampleType, Words};
use spikewire::link::{self, Received, Transmitter, Withheld};
use spikewire_flight::{FlightError, UnitSize};
use std::num::NonZeroU32;

pub use spikewire_flight::{Channel, Filter, Filtering, Flight, Parts, rust, visible};

impl From<FlightError> for crate::Error {
    fn from(error: FlightError) -> Self {
        Self::other(error)
    }
}

impl Coding {
    /// Returns the scheme and sample type of a `flight.toml`, with the parameters of all its channels.
    pub fn of_flight(flight: &Flight) -> Self {
        let scheme = Scheme::from(flight.run_time());
        Self { scheme, sample: flight.sample, asked: flight.asked_of_all() }
    }
}

/// The result of tuning a channel.
#[derive(Clone, Copy, Debug)]
pub struct TunedChannel<'a> {
    /// Name of the channel.
    pub name: &'a str,
    /// Name by which the channel is found in its log: `TOPIC.FIELD`, or the column of a table.
    pub source: &'a str,
    /// Scheme.
    pub scheme: Scheme,
    /// Settings of the scheme, and their figures.
    pub row: &'a Row,
}

/// Makes a [`Flight`] from the results of tuning, in the order of its channels. `sample` is the sample type, and `rate` is the number of samples a second. The flight sends 20 keyframes a second.
///
/// # Errors
/// Returns an error if there are no channels, or if their schemes differ. Returns an error if the channels differ in a
/// parameter that must be equal, such as a filter or the number of neurons. Returns an error if the sample period
/// cannot be expressed in whole µs.
pub fn of_rows(rows: &[TunedChannel<'_>], sample: SampleType, rate: f64) -> Result<Flight> {
    let scheme = rows.first().ok_or(RequestKind::NoRecording)?.scheme;
    if rows.iter().any(|channel| channel.scheme != scheme) {
        return Err(RequestKind::SeveralSchemes.into());
    }
    let mut channels = Vec::new();
    for TunedChannel { name, source, row, .. } in rows {
        let asked = row.settings.to_asked(scheme.info());
        channels.push(Channel { source: (*source).to_owned(), ..channel(name, asked) });
    }
    of_channels(scheme, sample, rate, channels)
}

/// Returns a channel with the unit that its name shows, if any.
fn channel(name: &str, asked: Asked) -> Channel {
    Channel {
        name: name.to_owned(),
        source: name.to_owned(),
        unit: unit_of_name(name).unwrap_or_default().to_owned(),
        counts: 1.0,
        asked,
    }
}

/// Makes a [`Flight`] that sends 20 keyframes a second. `channels` gives the name of each channel, and the parameters
/// that are set for it.
///
/// # Errors
/// Returns an error if there are no channels, or if the sample period cannot be expressed in whole µs. Returns an error
/// if the channels differ in a parameter that must be equal, such as a filter or a count.
pub fn of_settings(
    scheme: Scheme,
    sample: SampleType,
    rate: f64,
    channels: impl Iterator<Item = (String, Asked)>,
) -> Result<Flight> {
    let channels = channels.map(|(name, asked)| channel(&name, asked)).collect();
    of_channels(scheme, sample, rate, channels)
}

/// See [`of_settings`].
fn of_channels(
    scheme: Scheme,
    sample: SampleType,
    rate: f64,
    channels: Vec<Channel>,
) -> Result<Flight> {
    const KEYFRAMES: f64 = 20.0;
    Ok(Flight::new(Parts {
        scheme: scheme.info(),
        sample,
        period: period(rate)?,
        keyframe_every: (rate / KEYFRAMES).round().max(1.0) as u32,
        clock_ppm: CLOCK_PPM,
        step_bits: 0,
        gathering: 0,
        full_every: Transmitter::FULL_EVERY,
        filter: None,
        shared: Asked::default(),
        channels,
    })?)
}

/// Default tolerance of the sample period, in parts per million: the deviation of a sensor's own oscillator.
pub(crate) const CLOCK_PPM: u32 = 20_000;

/// Returns the sample period in µs at `rate` samples a second.
///
/// # Errors
/// Returns an error if the link cannot express the period.
pub(crate) fn period(rate: f64) -> Result<NonZeroU32> {
    let period = (1e6 / rate).round();
    let is_in_frame = period <= f64::from(link::Coding::LONGEST_PERIOD);
    let period = is_in_frame.then_some(period as u32);
    period
        .and_then(NonZeroU32::new)
        .ok_or_else(|| RequestKind::NoPeriod.of(Given::new("rate", rate)))
}

/// Returns a note for the user if a recording has another rate than the flight, by a fifth or more.
pub(crate) fn other_rate(flight: &Flight, rate: Option<f64>) -> Option<Words> {
    let rate = rate.filter(|rate| is_other_rate(*rate, flight.rate()))?;
    let what = "its filter and its times are those of other samples";
    let words = format!(
        "the recording has {rate:.2} samples a second, and the flight {:.2}: {what}",
        flight.rate()
    );
    Some(words.into())
}

/// Returns a copy of `options` that chooses the sources of the flight's channels: columns of a table, or topic and fields
/// of a log. The sources are fields alone if `options` names their topic, or if they name none and the log's kind has a
/// usual one.
///
/// # Errors
/// Returns an error if the file cannot be opened.
pub fn input(flight: &Flight, options: &InputOptions) -> Result<InputOptions> {
    let mut own = options.clone();
    let sources: Vec<String> = flight.channels.iter().map(|own| own.source.clone()).collect();
    let kind = if own.is_stdin() { None } else { flight_logs::Kind::of(&own.input)? };
    let usual = kind.and_then(flight_logs::Kind::usual_topic);
    let name_topics = sources.iter().all(|source| source.contains('.'));
    if own.topic.is_some() || (usual.is_some() && !name_topics) {
        own.channel.fields = sources;
    } else {
        own.channel.columns = sources;
    }
    Ok(own)
}

/// Returns the size of each channel's unit, in rad/s or m/s²; 1 for a unit of another quantity.
///
/// # Errors
/// Returns an error for the first channel without a unit.
pub fn unit_sizes(flight: &Flight) -> Result<Vec<f64>> {
    flight.check_units()?;
    let size = |channel: &Channel| match UnitSize::of(&channel.unit) {
        Some(UnitSize::Rate(size) | UnitSize::Acceleration(size)) => size,
        None => 1.0,
    };
    Ok(flight.channels.iter().map(size).collect())
}

/// A source of samples. It converts the samples to the sensor's counts, and then filters them, as the flight's sender
/// does.
pub(crate) struct Sampled<'a> {
    flight: &'a Flight,
    source: Box<dyn Source>,
    filters: Vec<Filtering>,
}

impl<'a> Sampled<'a> {
    pub(crate) fn new(flight: &'a Flight, source: Box<dyn Source>) -> Result<Self, FlightError> {
        Ok(Self { flight, source, filters: flight.filters()? })
    }
}

impl Source for Sampled<'_> {
    fn next(&mut self, chunk: &mut Chunk) -> Result<()> {
        self.source.next(chunk)?;
        for (column, channel) in chunk.columns.iter_mut().zip(&self.flight.channels) {
            for value in column {
                *value *= channel.counts;
            }
        }
        for (column, filter) in chunk.columns.iter_mut().zip(&mut self.filters) {
            for value in column {
                *value = filter(*value);
            }
        }
        Ok(())
    }

    fn names(&self) -> Vec<&str> {
        self.source.names()
    }

    fn units(&self) -> Vec<Option<String>> {
        self.source.units()
    }

    fn origin(&self) -> &[(&'static str, String)] {
        self.source.origin()
    }

    fn notes(&self) -> &[Words] {
        self.source.notes()
    }
}

/// Makes the receiver of a flight and passes it to `then`. The decoded values are in the channels' units.
///
/// # Errors
/// Returns an error if `then` returns an error, or if no receiver can be made with the flight's settings.
pub fn with_receiver<'a>(
    flight: &'a Flight,
    then: impl FnOnce(Box<dyn Values + '_>) -> Result<()> + 'a,
) -> Result<()> {
    let slot_ticks = Some(flight.slot_ticks()).filter(|ticks| *ticks > 0);
    let scheme = Scheme::from(flight.run_time());
    let (fingerprint, clock_ppm) = (Some(flight.fingerprint()), Some(flight.clock_ppm));
    let link = values::Link { slot_ticks, fingerprint, clock_ppm };
    values::with_receiver(scheme, flight.sample, flight.settings(), link, move |values| {
        then(Box::new(InUnits { flight, values }))
    })
}

/// A decoder whose values are converted from the sensor's counts to the channels' units.
struct InUnits<'a, 'b> {
    flight: &'a Flight,
    values: Box<dyn Values + 'b>,
}

impl InUnits<'_, '_> {
    fn divide(&self, items: &mut [Item]) {
        let neurons = self.flight.neurons();
        for item in items {
            if let Item::Value { address, value, .. } = item
                && let Some(channel) = self.flight.channels.get(usize::from(*address) / neurons)
            {
                *value /= channel.counts;
            }
        }
    }
}

impl Values for InUnits<'_, '_> {
    fn apply(&mut self, received: &Received<'_>, items: &mut Vec<Item>) {
        let known = items.len();
        self.values.apply(received, items);
        self.divide(&mut items[known..]);
    }

    fn finish(&mut self, items: &mut Vec<Item>) {
        let known = items.len();
        self.values.finish(items);
        self.divide(&mut items[known..]);
    }

    fn count(&self, tally: &mut LinkTally) {
        self.values.count(tally);
    }

    fn withheld(&self, channel: u16) -> Option<Withheld> {
        self.values.withheld(channel)
    }
}
