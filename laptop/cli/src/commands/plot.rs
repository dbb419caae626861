//! `spikewire plot`: draws a signal, its spikes and its reconstruction.

use super::score::chosen;
use crate::inputs::InputOptions;
use crate::options::Coding;
use crate::words::{of_lab, tell};
use anyhow::{Context, Result, bail};
use clap::Args;
use lab::plot::draw;
use lab::scheme::Scheme;
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
  spikewire plot --scheme sf --threshold 0.1 --channels gyro_x --unit rad/s flight.csv -o sf.png
  spikewire plot --all --channels gyro_x --range 2350..2700 flight.csv -o flight.svg")]
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
    // The paper's figure has one population code, GRF.
    let is_drawn = |scheme: &Scheme| !options.all || scheme.info().is_drawn;
    let schemes: Vec<Scheme> = schemes.into_iter().filter(is_drawn).collect();
    let shown = range.as_deref().map(shown).transpose()?;
    let read = lab::plot::read(&input.to_lab()?, &schemes, &parameters, sample, shown.clone())?;
    if let Some(Range { start, end }) = shown.filter(|own| own.end > read.samples) {
        bail!("--range {start}..{end}: two samples at least, within 0..{}", read.samples);
    }
    let (mut notes, mut refused) = (Vec::new(), Vec::new());
    for (scheme, own) in read.schemes {
        match own {
            Ok(own) => notes.extend(own.iter().map(|note| format!("{}: {note}", scheme.name()))),
            Err(error) if options.all => {
                refused.push(format!("{}: {}", scheme.name(), of_lab(&error)));
            }
            Err(error) => return Err(error.into()),
        }
    }
    if refused.len() == schemes.len() {
        bail!("no scheme takes this recording: {}", refused.join("; "));
    }
    tell(&read.notes);
    for words in &refused {
        say!("not drawn: {words}");
    }
    for note in &notes {
        say!("{note}");
    }
    let mut picture = read.picture;
    picture.unit = options.unit.clone().or(picture.unit);
    Ok(draw(output, &input.input, &picture)?)
}

fn shown(text: &str) -> Result<Range<usize>> {
    let (start, end) =
        text.split_once("..").with_context(|| format!("--range {text}: give it as START..END"))?;
    match (start.parse(), end.parse()) {
        (Ok(start), Ok(end)) if start + 1 < end => Ok(start..end),
        _ => bail!("--range {text}: two samples at least"),
    }
}
