//! Encodes a recording to a file of spikes, in constant memory.

use crate::Result;
use crate::bank::Bank;
use crate::coding::Coding;
use crate::fit::{Fit, explained, rounding};
use crate::flight::{self, Flight, Sampled};
use crate::input::TableKind;
use crate::input::{Chunk, Clock, InputOptions, Source};
use crate::output::Output;
use crate::scheme::Scheme;
use crate::spikes::{Format, Header, Record, Recorder, Summary, Writer, unrecorded};
use crate::tune::RequestKind;
use catalogue::run::{Asked, Calibrated, Event, Known, SET, SampleType, Settings, Words};

/// Encodes a recording as the sender on the drone does. `flight` gives the scheme and the channels; for the other
/// arguments and the results, see [`encode`].
///
/// # Errors
/// Returns an error if the recording lacks a channel, or if the output cannot be written.
pub fn encode_flight(
    flight: &Flight,
    input: &InputOptions,
    format: Option<Format>,
    output: impl FnOnce() -> Result<Output>,
) -> Result<(Output, Vec<Words>)> {
    let Coding { scheme, sample, asked } = Coding::of_flight(flight);
    let input = flight::input(flight, input)?;
    let open =
        || -> Result<Box<dyn Source + '_>> { Ok(Box::new(Sampled::new(flight, input.open()?)?)) };
    let mut encoded = encode_to(&open, &input, (scheme, sample, &asked), format, output)?;
    encoded.notes.extend(flight::other_rate(flight, encoded.clock.rate()));
    Ok((encoded.output, encoded.notes))
}

/// Encodes channels of a recording. Writes a log in `format`, or a table of spikes if `format` is `None`. The output is
/// opened last, once the recording and the parameters are known to be valid.
///
/// Returns the output, which the caller must finish, and notes for the user, a line each.
///
/// # Errors
/// Returns an error if the recording or the parameters are invalid, or if the output cannot be written.
pub fn encode(
    input: &InputOptions,
    scheme: Scheme,
    sample: SampleType,
    parameters: &Asked,
    format: Option<Format>,
    output: impl FnOnce() -> Result<Output>,
) -> Result<(Output, Vec<Words>)> {
    let open = || input.open().map(|own| -> Box<dyn Source> { own });
    let encoded = encode_to(&open, input, (scheme, sample, parameters), format, output)?;
    Ok((encoded.output, encoded.notes))
}

/// A function that opens the recording at its start. It may be called several times.
pub(crate) type Open<'a> = dyn Fn() -> Result<Box<dyn Source + 'a>> + 'a;

/// Properties of a recording that a writer of spikes needs before the first sample.
#[cfg_attr(not(feature = "datasets"), allow(dead_code, reason = "a data set reads all fields"))]
pub(crate) struct Start<'a> {
    pub header: &'a Header,
    /// Names of the channels.
    pub names: Vec<&'a str>,
    /// Whether the samples have times.
    pub is_timed: bool,
    /// Number of samples in the first part of the recording. The usual time between samples was measured in this part.
    pub first: usize,
    /// Function that reads the whole recording, and returns the smallest and largest sample of each channel.
    pub ranges: &'a dyn Fn() -> Result<Vec<(f64, f64)>>,
}

/// The outcome of encoding a recording.
#[cfg_attr(not(feature = "datasets"), allow(dead_code, reason = "a data set reads all fields"))]
pub(crate) struct Encoded {
    /// The output with all spikes. The caller must call its [`finish`](Output::finish), which completes the file.
    pub output: Output,
    /// Names of the channels.
    pub names: Vec<String>,
    /// Number of spikes of each channel.
    pub spikes: Vec<u64>,
    pub summary: Summary,
    pub clock: Clock,
    /// Notes of the reader, followed by notes of the encoder, a line each.
    pub notes: Vec<Words>,
}

fn encode_to(
    open: &Open<'_>,
    input: &InputOptions,
    coding: (Scheme, SampleType, &Asked),
    format: Option<Format>,
    output: impl FnOnce() -> Result<Output>,
) -> Result<Encoded> {
    if format.is_some() && input.is_read_once() {
        return Err(RequestKind::RangeAtEnd.into());
    }
    encode_from(open, input, coding, |start| {
        let output = output()?;
        Ok(match format {
            None => Box::new(Writer::new(output, start.header, start.is_timed)?),
            Some(format) => {
                let ranges = (start.ranges)()?;
                Box::new(Recorder::new(output, format, start.header, start.is_timed, &ranges)?)
            }
        })
    })
}

/// Encodes channels of a recording, and passes the spikes to the writer that `write` makes. Calls `write` only after
/// the recording and the parameters have proved valid.
///
/// # Errors
/// Returns an error if the recording or the parameters are invalid, or if the output cannot be written.
pub(crate) fn encode_from(
    open: &Open<'_>,
    input: &InputOptions,
    (scheme, sample, parameters): (Scheme, SampleType, &Asked),
    write: impl FnOnce(&Start<'_>) -> Result<Box<dyn Record>>,
) -> Result<Encoded> {
    parameters.check(scheme.info())?;
    let calibrated = match scheme.needs_signal(parameters) {
        None => None,
        Some(needs) if input.is_read_once() => {
            return Err(RequestKind::ReadOnce { scheme: scheme.name(), needs }.into());
        }
        Some(_) => Some(calibrate(open, sample, parameters)?),
    };

    let mut source = open()?;
    let mut chunk = first(source.as_mut(), scheme.looks_back(parameters))?;
    let mut clock = Clock::new(&chunk.times, input.rate, input.gap);
    let rows = chunk.finite_rows();
    let (count, firsts) = (rows.len(), chunk.kept(&rows));
    if firsts.first().is_none_or(Vec::is_empty) {
        return Err(TableKind::NoneFinite { samples: count }.at(input.name()));
    }
    let mut rounded = Vec::new();
    let mut channels: Vec<Settings> = Vec::new();
    for (channel, first) in firsts.iter().enumerate() {
        let calibrated = calibrated.as_ref().and_then(|all| all.get(channel));
        let known = Known { calibrated, first, can_calibrate: !input.is_read_once() };
        let own = parameters.channel(scheme.info(), channel, firsts.len())?;
        let settings = scheme.resolve(sample, &own, &known);
        let settings = settings.map_err(|error| explained(error.into(), sample, first))?;
        rounded.extend(rounding(&settings).filter(|rounding| !rounded.contains(rounding)));
        channels.push(settings);
    }
    let mut bank = Bank::new(scheme, &channels)?;

    let mut notes = source.origin().to_vec();
    let made_from = unrecorded(scheme).into_iter().filter_map(|name| {
        parameters.get(name).filter(|value| **value != SET).map(|value| (name, value.to_string()))
    });
    notes.extend(made_from);
    let mut fits: Vec<Fit> = channels.iter().map(|own| Fit::new(scheme, own)).collect();
    let rate = clock.rate();
    let header = Header { scheme, sample, channels, rate, notes };
    let is_timed = !chunk.times.is_empty();
    let ranges = || -> Result<Vec<(f64, f64)>> {
        let ranges = |all: &[Calibrated]| all.iter().filter_map(Calibrated::range).collect();
        match &calibrated {
            Some(all) => Ok(ranges(all)),
            None => Ok(ranges(&calibrate(open, sample, parameters)?)),
        }
    };
    let mut writer = write(&Start {
        header: &header,
        names: source.names(),
        is_timed,
        first: chunk.len(),
        ranges: &ranges,
    })?;

    let mut events = Vec::new();
    let mut spikes = vec![0; header.channels.len()];
    let neurons = bank.neurons();
    let mut count = |events: &[Event]| {
        for event in events {
            spikes[usize::from(event.neuron) / neurons] += 1;
        }
    };
    let mut finite: u64 = 0;
    while !chunk.is_empty() {
        let steps = clock.observe(&chunk.times);
        writer.observe(&mut chunk, &steps)?;
        for (fit, column) in fits.iter_mut().zip(&chunk.columns) {
            fit.observe(column);
        }
        bank.encode(&chunk.columns, &mut events);
        finite += chunk.len() as u64;
        count(&events);
        writer.write(&mut events, finite.saturating_sub(bank.latency() as u64))?;
        source.next(&mut chunk)?;
    }
    bank.finish(&mut events);
    count(&events);
    let (output, summary) = writer.finish(&mut events)?;
    let mut notes = source.notes().to_vec();
    let lines = report(&summary, &clock, header.channels.len());
    notes.extend(rounded.into_iter().map(Words::from).chain(lines));
    for (((fit, settings), &spikes), name) in
        fits.iter().zip(&header.channels).zip(&spikes).zip(source.names())
    {
        let of = if fits.len() > 1 { format!("{name}: ") } else { String::new() };
        for note in fit.notes(settings, spikes).lines() {
            notes.push(format!("{of}{note}").into());
        }
    }
    let names = source.names().into_iter().map(str::to_owned).collect();
    Ok(Encoded { output, names, spikes, summary, clock, notes })
}

/// Reads the start of a recording until `enough` samples are finite, or to the end of the recording.
fn first(source: &mut dyn Source, enough: usize) -> Result<Chunk> {
    let (mut all, mut chunk) = (Chunk::default(), Chunk::default());
    let mut finite = 0;
    while finite < enough {
        source.next(&mut chunk)?;
        if chunk.is_empty() {
            break;
        }
        finite += chunk.finite_rows().iter().filter(|finite| **finite).count();
        all.append(&mut chunk);
    }
    Ok(all)
}

/// Calibrates each channel for these parameters, by reading the whole recording once.
///
/// # Errors
/// Returns an error if the input cannot be read.
fn calibrate(open: &Open<'_>, sample: SampleType, parameters: &Asked) -> Result<Vec<Calibrated>> {
    let mut calibrated = Vec::new();
    let (mut source, mut chunk) = (open()?, Chunk::default());
    loop {
        source.next(&mut chunk)?;
        if chunk.is_empty() {
            return Ok(calibrated);
        }
        let finite = chunk.kept(&chunk.finite_rows());
        calibrated.resize_with(finite.len(), || Calibrated::of(sample, parameters));
        for (calibrated, column) in calibrated.iter_mut().zip(&finite) {
            calibrated.observe(column);
        }
    }
}

/// Returns the numbers of samples and spikes, and the summary of the times, as notes.
fn report(summary: &Summary, clock: &Clock, channels: usize) -> Vec<Words> {
    let Summary { samples, rejected, events } = *summary;
    let of = if channels > 1 { format!(" of {channels} channels") } else { String::new() };
    let counts = Words::from(format!("{samples} samples{of}, {events} spikes"));
    crate::trial::notes(&[counts], rejected as usize, clock)
}
