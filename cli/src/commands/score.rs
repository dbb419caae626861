//! `spikewire score`: how few spikes, and how near to the signal.

use crate::inputs::InputOptions;
use crate::options::{Coding, SchemeOptions};
use anyhow::{Result, bail};
use catalogue::run::SampleType;
use clap::Args;
use lab::brief::brief;
use lab::scheme::Scheme;
use lab::steep::Steep;
use lab::trial::{Recording, Trial};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{self, Write, stdout};

/// Score one scheme, or without `--scheme` all with the paper's settings, on one channel of a recording.
///
/// A scheme without parameters takes the paper's settings. Of all schemes, one that does not take the recording is a
/// row that says why.
///
/// Efficiency is the percentage of samples without a spike; RMSE is in the signal's unit and compares each
/// decoded value with the sample it belongs to, so without a rate code's latency; SNR is in dB.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire score --column gyro_x flight.csv
  spikewire score --scheme sf --threshold 0.1 --column gyro_x --json flight.csv")]
pub(crate) struct Score {
    #[command(flatten)]
    coding: Coding,
    #[command(flatten)]
    input: InputOptions,
    /// Figures and parameters as JSON, for programs
    #[arg(long)]
    json: bool,
}

/// The outcome of one scheme.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Scored {
    Figures(Box<Figures>),
    /// The scheme does not take this recording, and why.
    Refused {
        scheme: String,
        refused: String,
    },
}

/// The figures of one scheme.
#[derive(Debug, Serialize)]
pub(crate) struct Figures {
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
    /// What it ran with.
    parameters: BTreeMap<&'static str, Value>,
    /// Of step forward only.
    slope: Option<Steep>,
    /// What a user should know.
    notes: Vec<String>,
    #[serde(skip)]
    brief: String,
}

/// Runs the command.
///
/// # Errors
/// The recording or the parameters are not good.
pub(crate) fn run(options: &Score) -> Result<()> {
    let Score { coding, input, json } = options;
    let (schemes, sample, parameters) = chosen(coding)?;
    let recording = Recording::read(input)?;
    let is_single = schemes.len() == 1;
    let mut scored = Vec::new();
    for scheme in schemes {
        scored.push(match Trial::new(scheme, &parameters, sample, &recording) {
            Ok(trial) => Scored::Figures(Box::new(figures(&recording, &trial))),
            Err(error) if is_single => return Err(error),
            Err(error) => {
                Scored::Refused { scheme: scheme.name().to_owned(), refused: format!("{error:#}") }
            }
        });
    }
    if let [Scored::Refused { refused, .. }, ..] = &scored[..]
        && scored.iter().all(|own| matches!(own, Scored::Refused { .. }))
    {
        bail!("no scheme takes this recording: {refused}");
    }
    eprint!("{}", recording.notes());
    let figures = scored.iter().filter_map(|own| match own {
        Scored::Figures(figures) => Some(figures),
        Scored::Refused { .. } => None,
    });
    for Figures { scheme, slope, notes, .. } in figures.map(Box::as_ref) {
        for note in notes {
            eprintln!("{scheme}: {note}");
        }
        if let Some(slope) = slope {
            eprintln!("{}", slope.words());
        }
    }
    if *json {
        writeln!(stdout(), "{}", serde_json::to_string_pretty(&scored)?)?;
    } else {
        print_table(&scored)?;
    }
    Ok(())
}

/// One scheme with its parameters, or with the paper's where none are given; or all with the paper's.
///
/// # Errors
/// Parameters without a scheme to take them.
pub(crate) fn chosen(coding: &Coding) -> Result<(Vec<Scheme>, SampleType, SchemeOptions)> {
    let (scheme, sample, mut parameters) = coding.chosen()?;
    match scheme {
        Some(scheme) => {
            parameters.0.paper |= parameters.is_empty();
            Ok((vec![scheme], sample, parameters))
        }
        None if !parameters.is_empty() => {
            bail!(
                "all schemes run with the paper's settings; --scheme says which takes the parameters given"
            )
        }
        None => {
            parameters.0.paper = true;
            Ok((Scheme::all().collect(), sample, parameters))
        }
    }
}

/// What a trial comes to.
pub(crate) fn figures(recording: &Recording, trial: &Trial) -> Figures {
    let samples = recording.values.len();
    let mean = recording.values.iter().sum::<f64>() / samples as f64;
    let mean_square = |differences: &mut dyn Iterator<Item = f64>| {
        differences.map(|difference| difference * difference).sum::<f64>() / samples as f64
    };
    let noise = mean_square(&mut recording.values.iter().zip(&trial.decoded).map(|(x, y)| x - y));
    let variance = mean_square(&mut recording.values.iter().map(|x| x - mean));
    let parameters = trial.settings.entries();
    Figures {
        scheme: trial.scheme.name().to_owned(),
        samples,
        spikes: trial.events.len(),
        efficiency: trial.efficiency(),
        rmse: noise.sqrt(),
        snr: 10.0 * (variance / noise).log10(),
        spikes_per_second: recording
            .seconds()
            .filter(|seconds| *seconds > 0.0)
            .map(|seconds| trial.events.len() as f64 / seconds),
        brief: brief(parameters),
        parameters: parameters
            .iter()
            .map(|(key, value)| (*key, value_of(&value.to_string())))
            .collect(),
        slope: Steep::new(trial.scheme, recording, &trial.settings),
        notes: trial.notes.clone(),
    }
}

/// A number, a list of numbers, or a word.
fn value_of(text: &str) -> Value {
    let numbers: Option<Vec<Value>> =
        text.split(',').map(|number| serde_json::from_str(number).ok()).collect();
    match numbers.as_deref() {
        Some([number]) => number.clone(),
        Some(numbers) => numbers.into(),
        None => text.into(),
    }
}

fn print_table(scored: &[Scored]) -> io::Result<()> {
    let mut output = stdout().lock();
    writeln!(
        output,
        "| scheme              |  spikes | efficiency % |       RMSE |  SNR dB | spikes/s | parameters |"
    )?;
    writeln!(
        output,
        "|---------------------|--------:|-------------:|-----------:|--------:|---------:|------------|"
    )?;
    for own in scored {
        let Figures { scheme, spikes, efficiency, rmse, snr, spikes_per_second, brief, .. } =
            match own {
                Scored::Figures(figures) => figures.as_ref(),
                Scored::Refused { scheme, refused } => {
                    let empty = "-";
                    writeln!(
                        output,
                        "| {scheme:19} | {empty:>7} | {empty:>12} | {empty:>10} | {empty:>7} | {empty:>8} | refused: {refused} |"
                    )?;
                    continue;
                }
            };
        let rate = spikes_per_second.map_or("-".to_owned(), |rate| format!("{rate:.1}"));
        writeln!(
            output,
            "| {scheme:19} | {spikes:7} | {efficiency:12.2} | {rmse:10.5} | {snr:7.2} | {rate:>8} | {brief} |"
        )?;
    }
    Ok(())
}
