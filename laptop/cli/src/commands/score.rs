//! `spikewire score`: counts a scheme's spikes, and measures how closely the values decoded from them follow the
//! signal.

use crate::inputs::InputOptions;
use crate::options::{Coding, answer};
use crate::words::{of_lab, tell};
use anyhow::{Result, bail};
use catalogue::run::{Asked, SampleType};
use clap::Args;
use lab::output::Output;
use lab::scheme::Scheme;
use lab::score::Figures;
use lab::trial::{Recording, Trial};
use serde::Serialize;
use std::io::Write;

/// Score one scheme on one channel of a recording, or all schemes if `--scheme` is not given.
///
/// If no parameters are given, a scheme runs with the settings of Dupeyroux et al. (2022). When all schemes are scored,
/// a scheme that cannot encode the recording gets a table row with the reason.
///
/// Efficiency is the percentage of samples without a spike. RMSE is in the signal's unit; each decoded value is
/// compared with the sample that it stands for, so that a code's latency adds no error. SNR is in dB.
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
    /// Print figures and parameters as JSON
    #[arg(long)]
    json: bool,
}

/// Result of scoring one scheme.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Scored {
    Figures(Box<Figures>),
    /// The scheme cannot encode this recording; `refused` is the reason.
    Refused {
        scheme: String,
        refused: String,
    },
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the recording or the parameters are invalid.
pub(crate) fn run(options: &Score) -> Result<()> {
    let Score { coding, input, json } = options;
    let (schemes, sample, parameters) = chosen(coding)?;
    let recording = Recording::read(&input.to_lab()?)?;
    let is_single = schemes.len() == 1;
    let mut scored = Vec::new();
    for scheme in schemes {
        scored.push(match Trial::new(scheme, &parameters, sample, &recording) {
            Ok(trial) => Scored::Figures(Box::new(Figures::of(&recording, &trial))),
            Err(error) if is_single => return Err(error.into()),
            Err(error) => {
                Scored::Refused { scheme: scheme.name().to_owned(), refused: of_lab(&error) }
            }
        });
    }
    if let [Scored::Refused { refused, .. }, ..] = &scored[..]
        && scored.iter().all(|outcome| matches!(outcome, Scored::Refused { .. }))
    {
        bail!("no scheme takes this recording: {refused}");
    }
    tell(&recording.notes());
    let figures = scored.iter().filter_map(|outcome| match outcome {
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
        answer(serde_json::to_string_pretty(&scored)? + "\n")?;
    } else {
        print_table(&scored)?;
    }
    Ok(())
}

/// Returns the schemes to run, and their sample type and parameters. If the user named a scheme, only this scheme runs,
/// with the parameters given. If no parameters are given, the scheme runs with those of the paper, Dupeyroux et al.
/// (2022). If the user named no scheme, all schemes run with the paper's parameters.
///
/// # Errors
/// Returns an error if parameters are given without a scheme.
pub(crate) fn chosen(coding: &Coding) -> Result<(Vec<Scheme>, SampleType, Asked)> {
    let (scheme, sample, mut parameters) = coding.chosen()?;
    match scheme {
        Some(scheme) => {
            parameters.paper |= parameters.is_empty();
            Ok((vec![scheme], sample, parameters))
        }
        None if !parameters.is_empty() => {
            bail!(
                "all schemes run with the paper's settings; --scheme says which takes the parameters given"
            )
        }
        None => {
            parameters.paper = true;
            Ok((Scheme::all().collect(), sample, parameters))
        }
    }
}

fn print_table(scored: &[Scored]) -> Result<()> {
    let mut output = Output::to(None)?;
    writeln!(
        output,
        "| scheme              |  spikes | efficiency % |       RMSE |  SNR dB | spikes/s | parameters |"
    )?;
    writeln!(
        output,
        "|---------------------|--------:|-------------:|-----------:|--------:|---------:|------------|"
    )?;
    for outcome in scored {
        let Figures { scheme, spikes, efficiency, rmse, snr, spikes_per_second, brief, .. } =
            match outcome {
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
    Ok(output.finish()?)
}
