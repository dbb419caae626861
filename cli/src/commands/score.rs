//! `spikewire score`: how few spikes, and how near to the signal.

use crate::input::InputOptions;
use crate::options::SchemeOptions;
use crate::sample_type::SampleType;
use crate::scheme::SchemeName;
use crate::steep;
use crate::trial::{Recording, Trial};
use anyhow::{Result, bail};
use clap::Args;
use serde::Serialize;
use std::io::{self, Write, stdout};

/// Score one scheme, or all with the paper's settings, on a recording.
#[derive(Args, Debug)]
pub(crate) struct Score {
    /// The scheme; all unless given
    #[arg(long)]
    scheme: Option<SchemeName>,
    /// Sample type: f32, i16, i32, or fixed point such as q16.16 or q8.8
    #[arg(long, default_value_t)]
    sample: SampleType,
    #[command(flatten)]
    input: InputOptions,
    #[command(flatten)]
    parameters: SchemeOptions,
    /// For programs
    #[arg(long)]
    json: bool,
}

/// The figures of one scheme.
#[derive(Debug, Serialize)]
struct Figures {
    scheme: String,
    samples: usize,
    spikes: usize,
    /// Percent of samples without a spike, where each has one at most.
    efficiency: f64,
    /// Root mean square error, in the signal's unit.
    rmse: f64,
    /// Signal to noise in dB: variance of the signal to mean square of the error.
    snr: f64,
    spikes_per_second: Option<f64>,
}

/// Runs the command.
///
/// # Errors
/// The recording or the parameters are not good.
pub(crate) fn run(options: &Score) -> Result<()> {
    let Score { scheme, sample, input, parameters, json } = options;
    let (schemes, parameters) = chosen(*scheme, parameters)?;
    let recording = Recording::read(input)?;
    let scored = schemes.into_iter().map(|scheme| {
        let trial = Trial::new(scheme, &parameters, *sample, &recording)?;
        Ok((figures(&recording, &trial), steep::note(&recording, &trial.settings)))
    });
    let (figures, steep): (Vec<_>, Vec<_>) =
        scored.collect::<Result<Vec<_>>>()?.into_iter().unzip();
    eprint!("{}", recording.notes(*sample));
    for note in steep.iter().flatten() {
        eprintln!("{note}");
    }
    if *json {
        writeln!(stdout(), "{}", serde_json::to_string_pretty(&figures)?)?;
    } else {
        print_table(&figures)?;
    }
    Ok(())
}

/// One scheme with its parameters, or all with the paper's.
///
/// # Errors
/// Parameters without a scheme to take them.
pub(crate) fn chosen(
    scheme: Option<SchemeName>,
    parameters: &SchemeOptions,
) -> Result<(Vec<SchemeName>, SchemeOptions)> {
    match scheme {
        Some(scheme) => Ok((vec![scheme], parameters.clone())),
        None if !parameters.is_empty() => {
            bail!(
                "all schemes run with the paper's settings; --scheme says which takes the parameters given"
            )
        }
        None => Ok((SchemeName::ALL.to_vec(), SchemeOptions { paper: true, ..parameters.clone() })),
    }
}

fn figures(recording: &Recording, trial: &Trial) -> Figures {
    let samples = recording.values.len();
    let mean = recording.values.iter().sum::<f64>() / samples as f64;
    let mean_square = |differences: &mut dyn Iterator<Item = f64>| {
        differences.map(|difference| difference * difference).sum::<f64>() / samples as f64
    };
    let noise = mean_square(&mut recording.values.iter().zip(&trial.decoded).map(|(x, y)| x - y));
    let variance = mean_square(&mut recording.values.iter().map(|x| x - mean));
    Figures {
        scheme: trial.scheme.name(),
        samples,
        spikes: trial.events.len(),
        efficiency: trial.efficiency(),
        rmse: noise.sqrt(),
        snr: 10.0 * (variance / noise).log10(),
        spikes_per_second: recording.seconds().map(|seconds| trial.events.len() as f64 / seconds),
    }
}

fn print_table(figures: &[Figures]) -> io::Result<()> {
    let mut output = stdout().lock();
    writeln!(output, "| scheme    |  spikes | efficiency % |       RMSE |  SNR dB | spikes/s |")?;
    writeln!(output, "|-----------|--------:|-------------:|-----------:|--------:|---------:|")?;
    for Figures { scheme, spikes, efficiency, rmse, snr, spikes_per_second, .. } in figures {
        let rate = spikes_per_second.map_or("-".to_owned(), |rate| format!("{rate:.1}"));
        writeln!(
            output,
            "| {scheme:9} | {spikes:7} | {efficiency:12.2} | {rmse:10.5} | {snr:7.2} | {rate:>8} |"
        )?;
    }
    Ok(())
}
