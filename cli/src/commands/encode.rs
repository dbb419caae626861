//! `spikewire encode`: a recording to spikes, in constant memory.

use crate::codec::{Calibrated, Codec};
use crate::input::{Chunk, Clock, InputOptions};
use crate::options::SchemeOptions;
use crate::output::Output;
use crate::resolve::{Known, missing, resolve};
use crate::sample_type::SampleType;
use crate::saturated::Saturated;
use crate::scheme::SchemeName;
use crate::spikes::{Header, Summary, Writer};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;

/// Encode one channel of a recording.
#[derive(Args, Debug)]
pub(crate) struct Encode {
    /// The scheme
    #[arg(long)]
    scheme: SchemeName,
    /// Sample type: f32, i16, i32, or fixed point such as q16.16 or q8.8
    #[arg(long, default_value_t)]
    sample: SampleType,
    #[command(flatten)]
    input: InputOptions,
    #[command(flatten)]
    parameters: SchemeOptions,
    /// File of spikes; standard output unless given
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// The recording, the parameters or the output are not good.
pub(crate) fn run(options: &Encode) -> Result<()> {
    let Encode { scheme, sample, input, parameters, output } = options;
    parameters.check(*scheme)?;
    let calibrated = match missing(*scheme, parameters) {
        None => None,
        Some(what) if input.is_stdin() => bail!(
            "{} calibrates over the whole signal, which standard input gives only once; give {what}",
            scheme.name()
        ),
        Some(_) => Some(calibrate(input, *sample)?),
    };

    let mut source = input.open()?;
    let mut chunk = Chunk::default();
    source.next(&mut chunk)?;
    let mut clock = Clock::new(&chunk.times, input.rate, input.gap);
    let first: Vec<f64> = chunk.values.iter().copied().filter(|value| value.is_finite()).collect();
    let known =
        Known { calibrated: calibrated.as_ref(), first: &first, can_calibrate: !input.is_stdin() };
    let settings = resolve(*scheme, parameters, known)?;
    let mut codec = Codec::new(*sample, &settings)?;

    let mut notes = source.origin().to_vec();
    notes.extend(parameters.factor.map(|factor| ("factor", factor.to_string())));
    notes.extend(parameters.filter.clone().map(|filter| ("filter", filter)));
    let header = Header { scheme: *scheme, sample: *sample, settings, rate: clock.rate(), notes };
    let is_timed = !chunk.times.is_empty();
    let mut writer = Writer::new(Output::open(output.as_deref())?, &header, is_timed)?;

    let mut events = Vec::new();
    let mut saturated = Saturated::new(*sample);
    let mut finite: u64 = 0;
    while !chunk.values.is_empty() {
        let gaps = clock.observe(&chunk.times);
        writer.observe(&mut chunk.values, &chunk.times, &gaps);
        saturated.observe(&chunk.values);
        codec.encode(&chunk.values, &mut events);
        finite += chunk.values.len() as u64;
        writer.write(&mut events, finite.saturating_sub(codec.latency() as u64))?;
        source.next(&mut chunk)?;
    }
    codec.finish(&mut events);
    let (output, summary) = writer.finish(&mut events)?;
    output.finish()?;
    report(&summary, &clock, &saturated);
    Ok(())
}

/// A pass over the recording.
///
/// # Errors
/// It cannot be read.
pub(crate) fn calibrate(input: &InputOptions, sample: SampleType) -> Result<Calibrated> {
    let mut calibrated = Calibrated::new(sample);
    let (mut source, mut chunk) = (input.open()?, Chunk::default());
    loop {
        source.next(&mut chunk)?;
        if chunk.values.is_empty() {
            return Ok(calibrated);
        }
        chunk.values.retain(|value| value.is_finite());
        calibrated.observe(&chunk.values);
    }
}

/// What a user should know, on standard error.
fn report(summary: &Summary, clock: &Clock, saturated: &Saturated) {
    let Summary { samples, rejected, events } = *summary;
    eprintln!("{samples} samples, {events} spikes");
    if rejected > 0 {
        eprintln!("{rejected} samples were not finite and emitted nothing");
    }
    eprint!("{saturated}");
    eprintln!("{clock}");
}
