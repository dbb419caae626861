//! `spikewire encode`: a recording to spikes, in constant memory.

use crate::inputs::InputOptions;
use crate::options::Coding;
use anyhow::{Result, bail};
use catalogue::run::{Calibrated, Event, Known, SET, SampleType, Settings};
use clap::Args;
use lab::bank::Bank;
use lab::fit::{Fit, explained, rounding};
use lab::input::{Chunk, Clock, Source};
use lab::output::Output;
use lab::spikes::{Format, Header, Record, Recorder, Summary, Writer, unrecorded};
use std::path::PathBuf;

/// Encode channels of a recording: `index,address,polarity` and, where it has times, `time_us`.
///
/// With several columns the address says which: the second column's neurons are numbered on from the
/// first's. All columns have the same parameters; what is calibrated is each one's own.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire encode --scheme sf --threshold 0.1 --column gyro_x flight.csv -o spikes.csv
  spikewire encode --scheme sf --threshold 0.1 --columns gyro_x,gyro_y,gyro_z flight.csv
  spikewire encode --scheme hsa --filter triang:15,peak=2 --topic sensor_combined --field 'gyro_rad[0]' flight.ulg
  spikewire encode --scheme mw --threshold 120 --window 5 --sample i16 --rate 1000 counts.csv")]
pub(crate) struct Encode {
    #[command(flatten)]
    coding: Coding,
    #[command(flatten)]
    input: InputOptions,
    /// File of spikes, of the toolbox's messages if it is called `.bag` (ROS 1) or `.mcap` (ROS 2); standard output unless given
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// The recording, the parameters or the output are not good.
pub(crate) fn run(options: &Encode) -> Result<()> {
    let Encode { coding, input, output } = options;
    let (scheme, sample, parameters) = coding.one()?;
    parameters.check(scheme.info())?;
    let format = output.as_deref().and_then(Format::of);
    if format.is_some() && input.is_stdin() {
        bail!("messages tell the signal's range, which standard input gives only at its end");
    }
    let calibrated = match scheme.needs_signal(&parameters) {
        None => None,
        Some(what) if input.is_stdin() => bail!(
            "{} calibrates over the whole signal, which standard input gives only once; give {what}",
            scheme.name()
        ),
        Some(_) => Some(calibrate(input, sample)?),
    };

    let mut source = input.open()?;
    let mut chunk = first(source.as_mut(), scheme.looks_back(&parameters))?;
    let mut clock = Clock::new(&chunk.times, input.rate, input.gap);
    let rows = chunk.finite_rows();
    let (count, firsts) = (rows.len(), chunk.kept(&rows));
    if firsts.first().is_none_or(Vec::is_empty) {
        bail!("{}: none of the {count} samples is finite", input.name());
    }
    let mut told = Vec::new();
    let mut channels: Vec<Settings> = Vec::new();
    for (channel, first) in firsts.iter().enumerate() {
        let calibrated = calibrated.as_ref().and_then(|all| all.get(channel));
        let known = Known { calibrated, first, can_calibrate: !input.is_stdin() };
        let own = parameters.channel(scheme.info(), channel, firsts.len())?;
        let settings = scheme.resolve(sample, &own, &known);
        let settings = settings.map_err(|error| explained(error, sample, first))?;
        told.extend(rounding(&settings).filter(|rounding| !told.contains(rounding)));
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
    let output = Output::open(output.as_deref(), &input.input)?;
    let mut writer: Box<dyn Record> = match format {
        None => Box::new(Writer::new(output, &header, is_timed)?),
        Some(format) => {
            let calibrated = calibrated.map_or_else(|| calibrate(input, sample), Ok)?;
            let ranges: Vec<_> = calibrated.iter().filter_map(Calibrated::range).collect();
            Box::new(Recorder::new(output, format, &header, is_timed, &ranges)?)
        }
    };

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
    output.finish()?;
    for note in source.notes().iter().chain(&told) {
        eprintln!("{note}");
    }
    report(&summary, &clock, header.channels.len());
    let names = source.origin().last().map_or("", |(_, names)| names.as_str());
    for (((fit, settings), spikes), name) in
        fits.iter().zip(&header.channels).zip(spikes).zip(names.split(','))
    {
        let of = if fits.len() > 1 { format!("{name}: ") } else { String::new() };
        for note in fit.notes(settings, spikes).lines() {
            eprintln!("{of}{note}");
        }
    }
    Ok(())
}

/// The first samples: at least so many finite ones, or all there are.
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

/// A pass over the recording.
///
/// # Errors
/// It cannot be read.
fn calibrate(input: &InputOptions, sample: SampleType) -> Result<Vec<Calibrated>> {
    let mut calibrated = Vec::new();
    let (mut source, mut chunk) = (input.open()?, Chunk::default());
    loop {
        source.next(&mut chunk)?;
        if chunk.is_empty() {
            return Ok(calibrated);
        }
        let finite = chunk.kept(&chunk.finite_rows());
        calibrated.resize_with(finite.len(), || Calibrated::new(sample));
        for (calibrated, column) in calibrated.iter_mut().zip(&finite) {
            calibrated.observe(column);
        }
    }
}

/// What a user should know, on standard error.
fn report(summary: &Summary, clock: &Clock, channels: usize) {
    let Summary { samples, rejected, events } = *summary;
    let of = if channels > 1 { format!(" of {channels} channels") } else { String::new() };
    eprintln!("{samples} samples{of}, {events} spikes");
    if rejected > 0 {
        eprintln!("{rejected} samples were not finite or missing and emitted nothing");
    }
    eprintln!("{clock}");
}
