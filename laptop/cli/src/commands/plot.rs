//! `spikewire plot`: draws a signal, its spikes and its reconstruction.

use super::score::chosen;
use crate::inputs::InputOptions;
use crate::options::Coding;
use crate::words::{of_lab, tell};
use anyhow::{Context, Result, bail};
use clap::Args;
use lab::look::known_unit;
use lab::plot::{Picture, draw};
use lab::scheme::Scheme;
use lab::trial::{Recording, Trial};
use std::ops::Range;
use std::path::PathBuf;

/// Draw signal and reconstruction above the spikes, in the layout of the first figure in the paper, Dupeyroux et al.
/// (2022).
///
/// If no parameters are given, each scheme runs with the paper's settings. A long recording is decimated to the
/// resolution of the picture. If a code delays the decoded values, their curve is shifted back by this latency, and the
/// picture states the latency.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire plot --scheme sf --threshold 0.1 --column gyro_x --unit rad/s flight.csv -o sf.png
  spikewire plot --all --column gyro_x --range 2350..2700 flight.csv -o flight.svg")]
pub(crate) struct Plot {
    /// Draw the first figure in the paper, Dupeyroux et al. (2022): panels A-G for the paper's schemes, with the
    /// paper's settings, and panel H for the efficiency of these schemes
    #[arg(long, conflicts_with_all = ["scheme", "params"])]
    all: bool,
    #[command(flatten)]
    coding: Coding,
    #[command(flatten)]
    input: InputOptions,
    /// Range of samples to show, such as `1000..1400`; samples outside the range are encoded too
    #[arg(long)]
    range: Option<String>,
    /// Unit of the signal, such as `rad/s`; default: the unit in the column's name, such as `gyro_x (rad/s)`
    #[arg(long)]
    unit: Option<String>,
    /// Picture to write, as `.svg` or `.png`
    #[arg(short, long)]
    output: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the recording or the parameters are invalid, or if the output cannot be written.
pub(crate) fn run(options: &Plot) -> Result<()> {
    let Plot { coding, input, range, output, .. } = options;
    if !options.all && !coding.is_named() {
        bail!("--scheme must say which, or --params, or --all");
    }
    let (schemes, sample, parameters) = chosen(coding)?;
    let recording = Recording::read(&input.to_lab()?)?;
    let shown = shown(range.as_deref(), recording.values.len())?;
    // The paper's figure has one population code, GRF.
    let is_drawn = |scheme: &Scheme| !options.all || scheme.info().is_drawn;
    let mut trials = Vec::new();
    let mut refused = Vec::new();
    for scheme in schemes.into_iter().filter(is_drawn) {
        match Trial::new(scheme, &parameters, sample, &recording) {
            Ok(trial) => trials.push(trial),
            Err(error) if options.all => {
                refused.push(format!("{}: {}", scheme.name(), of_lab(&error)));
            }
            Err(error) => return Err(error.into()),
        }
    }
    if trials.is_empty() {
        bail!("no scheme takes this recording: {}", refused.join("; "));
    }
    tell(&recording.notes());
    for words in &refused {
        eprintln!("not drawn: {words}");
    }
    for trial in &trials {
        for note in &trial.notes {
            eprintln!("{}: {note}", trial.scheme.name());
        }
    }
    let unit = options.unit.as_deref().or_else(|| known_unit(&recording.name));
    let picture = Picture { recording: &recording, trials: &trials, unit, shown };
    Ok(draw(output, &input.input, &picture)?)
}

fn shown(range: Option<&str>, samples: usize) -> Result<Range<usize>> {
    let Some(text) = range else {
        return Ok(0..samples);
    };
    let (start, end) =
        text.split_once("..").with_context(|| format!("--range {text}: give it as START..END"))?;
    match (start.parse(), end.parse()) {
        (Ok(start), Ok(end)) if start + 1 < end && end <= samples => Ok(start..end),
        _ => bail!("--range {text}: two samples at least, within 0..{samples}"),
    }
}
