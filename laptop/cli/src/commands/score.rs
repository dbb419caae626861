//! `spikewire score`: counts a scheme's spikes, and measures how closely the values decoded from them follow the
//! signal.

use crate::inputs::{LogOptions, ManyChannels, as_file, read_flight};
use crate::options::{Coding, answer};
use crate::report::{Counts, Log, Report};
use crate::words::{self, of_lab, tell_of};
use anyhow::{Result, bail};
use catalogue::run::{Asked, SampleType};
use clap::Args;
use lab::dataset::Found;
use lab::flight::Flight;
use lab::scheme::Scheme;
use lab::score::{Figures, Scored, score, score_flight};
use lab::slope::Slope;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

/// Score one scheme on one channel of each log, or all schemes if `--scheme` is not given.
///
/// If no parameters are given, a scheme runs with the settings of Dupeyroux et al. (2022). When all schemes are scored,
/// a scheme that cannot encode the recording gets a table row with the reason. Several logs get a row each for each
/// scheme, and for each scheme a row over all logs together.
///
/// Efficiency is the percentage of samples without a spike. RMSE is in the signal's unit; each decoded value is
/// compared with the sample that it stands for, so that a code's latency adds no error. SNR is in dB.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire score --channels gyro_x flight.csv
  spikewire score --scheme sf --threshold 0.1 --channels gyro_x --json flight.csv
  spikewire score --flight flight.toml flight.csv
  spikewire score --scheme sf --threshold 0.1 --split test spikes")]
pub(crate) struct Score {
    #[command(flatten)]
    coding: Coding,
    /// Flight file (`flight.toml`), as written by `advise -o`: scores each of its channels as the sender encodes it,
    /// behind its filter
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scheme", "sample", "params", "column", "columns", "field", "fields", "channels_of"])]
    flight: Option<PathBuf>,
    #[command(flatten)]
    logs: LogOptions,
    #[command(flatten)]
    channels: ManyChannels,
    /// Print figures and parameters as JSON
    #[arg(long)]
    json: bool,
}

/// Result of scoring one scheme on a log.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Outcome {
    Figures(Box<Figures>),
    /// The scheme cannot encode this recording; `refused` is the reason.
    Refused {
        scheme: String,
        refused: String,
    },
}

/// Results of all schemes on a log.
#[derive(Debug, Serialize)]
struct Content {
    channel: String,
    schemes: Vec<Outcome>,
}

/// A scheme's results on all logs together.
#[derive(Debug, Default, Serialize)]
struct Total {
    scheme: String,
    /// Number of logs that the scheme encoded.
    logs: usize,
    samples: usize,
    spikes: usize,
    /// Percentage of all samples that are without a spike.
    efficiency: f64,
    /// Root mean square error over all samples.
    rmse: f64,
    /// The largest RMSE of a log, and the log.
    worst_rmse: f64,
    worst_log: String,
}

/// Results on all logs together.
#[derive(Debug, Serialize)]
struct Summary {
    #[serde(flatten)]
    counts: Counts,
    schemes: Vec<Total>,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if a recording or the parameters are invalid. The other logs are scored first.
pub(crate) fn run(options: &Score) -> Result<()> {
    let Score { coding, flight, logs, channels, json } = options;
    if let Some(flight) = flight {
        if !coding.chosen()?.2.is_empty() {
            bail!("--flight says all parameters");
        }
        return run_flight(&read_flight(flight)?, options);
    }
    let (schemes, sample, parameters) = chosen(coding)?;
    let Found { logs, is_single, .. } = logs.find()?;
    let mut all = Vec::new();
    for path in &logs {
        let log = path.display().to_string();
        let scored =
            channels.read(path, is_single, |input| score(input, &schemes, &parameters, sample));
        match scored.and_then(content) {
            Ok((notes, content)) => {
                if !json {
                    let of = (!is_single).then_some(&*log);
                    tell_of(of, &notes);
                    tell_of(of, &content.notes());
                }
                all.push(Log { log, refused: None, notes, content: Some(content) });
            }
            Err(error) => all.push(Log::refused(log, error, is_single && !json)?),
        }
    }
    let counts = Counts::of(&all);
    let summary = Summary { counts, schemes: totals(&schemes, &all) };
    if *json {
        Report { command: "score", logs: &all, summary }.print()?;
    } else {
        // A single log has no name in the table.
        let rows = all.iter().filter_map(|own| {
            let log = if is_single { "" } else { &*own.log };
            Some((log, &*own.content.as_ref()?.schemes))
        });
        print_table(&rows.collect::<Vec<_>>(), &summary, !is_single)?;
    }
    counts.check()
}

/// Scores the channels of a flight, in a row each.
///
/// # Errors
/// Returns an error if a recording is invalid. The other logs are scored first.
fn run_flight(flight: &Flight, options: &Score) -> Result<()> {
    let Score { logs, channels, json, .. } = options;
    let Found { logs, is_single, .. } = logs.find()?;
    let mut all = Vec::new();
    for path in &logs {
        let log = path.display().to_string();
        let input = channels.channel.of(&as_file(path)?);
        let scored = match score_flight(flight, &input) {
            Ok(scored) => scored,
            Err(error) => {
                all.push(Log::refused(log, error.into(), is_single && !json)?);
                continue;
            }
        };
        for (index, scored) in scored.into_iter().enumerate() {
            let channel = scored.channel.clone();
            let (notes, content) = content(scored)?;
            if !json {
                // The notes on the recording are those of all its channels.
                let of = (!is_single).then_some(&*log);
                tell_of(of, if index == 0 { &notes } else { &[] });
                tell_of(Some(&channel), &content.notes());
            }
            let name = if is_single { channel } else { format!("{log} {channel}") };
            all.push(Log { log: name, refused: None, notes, content: Some(content) });
        }
    }
    // Each log has an entry for each channel.
    let counts = Counts { logs: logs.len(), ..Counts::of(&all) };
    if *json {
        let summary = Summary { counts, schemes: Vec::new() };
        Report { command: "score", logs: &all, summary }.print()?;
    } else {
        let rows = all.iter().filter_map(|own| Some((&*own.log, &*own.content.as_ref()?.schemes)));
        let summary = Summary { counts, schemes: Vec::new() };
        print_table(&rows.collect::<Vec<_>>(), &summary, false)?;
    }
    counts.check()
}

/// Takes the results on a log apart: its notes, and what was scored.
///
/// # Errors
/// Returns an error if no scheme can encode the log.
fn content(scored: Scored) -> Result<(Vec<String>, Content)> {
    let Scored { channel, notes, schemes } = scored;
    let is_one = schemes.len() == 1;
    let mut outcomes = Vec::new();
    for (scheme, figures) in schemes {
        outcomes.push(match figures {
            Ok(figures) => Outcome::Figures(Box::new(figures)),
            Err(error) if is_one => return Err(error.into()),
            Err(error) => {
                Outcome::Refused { scheme: scheme.name().to_owned(), refused: of_lab(&error) }
            }
        });
    }
    if let [Outcome::Refused { refused, .. }, ..] = &outcomes[..]
        && outcomes.iter().all(|outcome| matches!(outcome, Outcome::Refused { .. }))
    {
        bail!("no scheme takes this recording: {refused}");
    }
    Ok((words::notes(&notes), Content { channel, schemes: outcomes }))
}

impl Content {
    fn figures(&self) -> impl Iterator<Item = &Figures> {
        self.schemes.iter().filter_map(|outcome| match outcome {
            Outcome::Figures(figures) => Some(&**figures),
            Outcome::Refused { .. } => None,
        })
    }

    /// Returns the notes of each scheme, after its name.
    fn notes(&self) -> Vec<String> {
        let mut all = Vec::new();
        for Figures { scheme, slope, notes, .. } in self.figures() {
            all.extend(notes.iter().map(|note| format!("{scheme}: {note}")));
            all.extend(slope.as_ref().map(Slope::words));
        }
        all
    }
}

/// Adds up each scheme's results on all logs.
fn totals(schemes: &[Scheme], logs: &[Log<Content>]) -> Vec<Total> {
    let total = |scheme: &Scheme| {
        let mut total = Total { scheme: scheme.name().to_owned(), ..Total::default() };
        let mut squares = 0.0;
        for Log { log, content, .. } in logs {
            let all = content.iter().flat_map(Content::figures);
            for figures in all.filter(|own| own.scheme == scheme.name()) {
                total.logs += 1;
                total.samples += figures.samples;
                total.spikes += figures.spikes;
                squares += figures.rmse * figures.rmse * figures.samples as f64;
                if total.logs == 1 || figures.rmse > total.worst_rmse {
                    (total.worst_rmse, total.worst_log) = (figures.rmse, log.clone());
                }
            }
        }
        let samples = total.samples as f64;
        total.efficiency = (1.0 - total.spikes as f64 / samples) * 100.0;
        total.rmse = (squares / samples).sqrt();
        total
    };
    schemes.iter().map(total).filter(|total| total.samples > 0).collect()
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

/// Prints a table with a row for each log and scheme. If `is_list` is set, the rows begin with the logs' names, and each
/// scheme has a row over all logs that it encoded. Prints nothing if there are no rows.
fn print_table(logs: &[(&str, &[Outcome])], summary: &Summary, is_list: bool) -> Result<()> {
    if logs.is_empty() {
        return Ok(());
    }
    let requested = summary.counts.logs;
    let label = |total: &Total| match total.logs {
        logs if logs == requested => format!("all {logs} logs"),
        logs => format!("{logs} of {requested} logs"),
    };
    let totals = if is_list { &summary.schemes[..] } else { &[] };
    let names = logs.iter().map(|(log, _)| (*log).to_owned()).chain(totals.iter().map(label));
    let width = names.map(|name| name.chars().count()).max().unwrap_or(0);
    let first = |name: &str| match width {
        0 => String::new(),
        width => format!("| {name:width$} "),
    };
    let mut output = String::new();
    writeln!(
        output,
        "{}| scheme              |  spikes | efficiency % |       RMSE |  SNR dB | spikes/s | parameters |",
        first("log")
    )?;
    let line = if width == 0 { String::new() } else { format!("|{}", "-".repeat(width + 2)) };
    writeln!(
        output,
        "{line}|---------------------|--------:|-------------:|-----------:|--------:|---------:|------------|"
    )?;
    let empty = "-";
    for (log, outcome) in logs.iter().flat_map(|(log, own)| own.iter().map(move |own| (log, own))) {
        let log = first(log);
        let Figures { scheme, spikes, efficiency, rmse, snr, spikes_per_second, brief, .. } =
            match outcome {
                Outcome::Figures(figures) => figures.as_ref(),
                Outcome::Refused { scheme, refused } => {
                    writeln!(
                        output,
                        "{log}| {scheme:19} | {empty:>7} | {empty:>12} | {empty:>10} | {empty:>7} | {empty:>8} | refused: {refused} |"
                    )?;
                    continue;
                }
            };
        let rate = spikes_per_second.map_or(empty.to_owned(), |rate| format!("{rate:.1}"));
        writeln!(
            output,
            "{log}| {scheme:19} | {spikes:7} | {efficiency:12.2} | {rmse:10.5} | {snr:7.2} | {rate:>8} | {brief} |"
        )?;
    }
    for total in totals {
        let Total { scheme, spikes, efficiency, rmse, worst_rmse, worst_log, .. } = total;
        writeln!(
            output,
            "{}| {scheme:19} | {spikes:7} | {efficiency:12.2} | {rmse:10.5} | {empty:>7} | {empty:>8} | worst RMSE {worst_rmse:.5} in {worst_log} |",
            first(&label(total))
        )?;
    }
    answer(words::page(&output))
}
