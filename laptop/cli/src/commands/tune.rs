//! `spikewire tune`: finds the parameters of a scheme that suit flight logs best.

use crate::inputs::{LogOptions, ManyChannels};
use crate::options::{FREE, answer, augment, check_ending, given, option_group, whole};
use crate::report::{Counts, Log, Report};
use crate::stop::Stop;
use crate::words::{self, option, tell_of};
use anyhow::{Context, Result, bail};
use catalogue::Parameter;
use catalogue::run::{Asked, SampleType, Worded};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use lab::dataset::Found;
use lab::flight::{TunedChannel, of_rows, visible};
use lab::input::{InputOptions, Unnamed};
use lab::output::Output;
use lab::plot::draw_fronts;
use lab::plot::front::Panel;
use lab::scheme::Scheme;
use lab::trial::Recording;
use lab::tune::report::{Cut, Row, print};
use lab::tune::stretch::HoldOut;
use lab::tune::{Goal, Limits, Over, Stretch, TuneRequest, Tuned, costs, emit, tune};
use lab::unit::unit_of_name;
use lab::watch::{Progress, Watch};
use serde::Serialize;
use serde_json::json;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Search a scheme's parameters for a goal: the least RMSE at a given spiking efficiency, the greatest efficiency at a
/// given RMSE, or the Pareto front of both.
///
/// The spiking efficiency is 100 less the number of spikes for every 100 samples. Of several logs, some are held out; of
/// a single log, some blocks. The settings found are scored on what is held out, too. Settings are scored with the
/// encoder and decoder that run on the drone, in the sample type of --sample. Settings are tuned on all logs together.
/// Parameters that are given stay fixed; the others are searched. The default goal is the least RMSE at the efficiency
/// that the settings of Dupeyroux et al. (2022) reach.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire tune flight.csv --channels gyro_x --scheme sf --min-efficiency 95
  spikewire tune a.ulg b.ulg --channels 'sensor_combined.gyro_rad[0]' --scheme all --max-rmse 0.1 --core M0 --sample q16.16
  spikewire tune flight.csv --channels gyro_x --scheme hsa --filter free --sample q8.8 --emit rust -o src/roll.rs
  spikewire tune flight.csv --scheme sod --spikes 8 --max-rmse 0.1 --emit flight -o flight.toml
  spikewire tune flight.csv --channels gyro_x,gyro_y --scheme all --front front.svg")]
pub(crate) struct Tune {
    #[command(flatten)]
    logs: LogOptions,
    /// Scheme to tune, or `all`
    #[arg(long, value_parser = schemes)]
    scheme: Schemes,
    /// Sample type of the codec: f32, i16, i32, or fixed point such as q16.16
    #[arg(long, default_value_t)]
    sample: SampleType,
    #[command(flatten)]
    channels: ManyChannels,
    #[command(flatten)]
    parameters: Fixed,
    /// Goal: least RMSE, with at least this percentage of samples without a spike
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, help_heading = "Goal")]
    min_efficiency: Option<f64>,
    /// Goal: greatest efficiency, with at most this RMSE, in the signal's unit
    #[arg(long, value_name = "RMSE", conflicts_with = "min_efficiency", value_parser = lab::input::above_zero, help_heading = "Goal")]
    max_rmse: Option<f64>,
    /// Goal: the Pareto front, drawn in this `.svg` or `.png` file. The front consists of the settings that no other
    /// settings beat in both RMSE and efficiency
    #[arg(long, value_name = "PICTURE", conflicts_with_all = ["min_efficiency", "max_rmse", "emit"], help_heading = "Goal")]
    front: Option<PathBuf>,
    /// Maximum RAM of a channel's encoder, in bytes
    #[arg(long, value_name = "BYTES", value_parser = lab::input::above_zero, help_heading = "Limits")]
    max_ram: Option<f64>,
    /// Maximum of the mean number of instructions that the core given by --core needs to encode a sample
    #[arg(long, value_name = "COUNT", value_parser = lab::input::above_zero, help_heading = "Limits")]
    max_instructions: Option<f64>,
    /// Maximum delay of the code, in samples
    #[arg(long, value_name = "SAMPLES", help_heading = "Limits")]
    max_latency: Option<f64>,
    /// Maximum number of events a second
    #[arg(long, value_name = "RATE", value_parser = lab::input::above_zero, help_heading = "Limits")]
    max_rate: Option<f64>,
    /// Core on which instructions are counted, for the reported costs and for --max-instructions: Cortex-M0 (`M0`) or
    /// Cortex-M4F (`M4F`)
    #[arg(long, default_value = "M4F", value_parser = costs::core, help_heading = "Limits")]
    core: String,
    /// Share to hold out, of the logs or, if there is only one, of its blocks; 0 holds out nothing
    #[arg(long, value_name = "PART", default_value_t = 0.3, help_heading = "Search")]
    hold_out: f64,
    /// Number of blocks of equal length into which a single log is cut
    #[arg(long, default_value_t = 20, value_parser = whole::<usize>, help_heading = "Search")]
    blocks: usize,
    /// Reduce the error on the log where it is largest, instead of the error over all logs
    #[arg(long, help_heading = "Search")]
    worst_flight: bool,
    /// Stop after this many seconds in total, and keep the best settings found by then. With this limit, the result
    /// depends on the machine's speed. Ctrl-C stops the search too
    #[arg(long, value_parser = lab::input::above_zero, help_heading = "Search")]
    seconds: Option<f64>,
    /// Maximum number of settings to score for each scheme and channel
    #[arg(long, default_value_t = TuneRequest::EVALUATIONS, value_parser = whole::<usize>, help_heading = "Search")]
    evaluations: usize,
    /// Seed of the search; the same seed and budget of evaluations give the same settings
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>, help_heading = "Search")]
    seed: u64,
    /// Search even if the log is unsuitable: nothing but noise, never in the air, full of gaps, or clipped
    #[arg(long, help_heading = "Search")]
    anyway: bool,
    /// Also report the RMSE after the error is low-pass filtered at this frequency, such as `40Hz`
    #[arg(long, value_name = "FREQUENCY", value_parser = hertz)]
    below: Option<f64>,
    /// Form in which to write the settings: a constant in Rust, a file for --params, or a flight file (`flight.toml`)
    /// of all channels
    #[arg(long)]
    emit: Option<Emit>,
    /// File to write the settings to; default: standard output
    #[arg(short, long, requires = "emit")]
    output: Option<PathBuf>,
    /// Print figures and settings as JSON
    #[arg(long, conflicts_with = "emit")]
    json: bool,
}

/// The value of `--scheme`: one scheme, or `all`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Schemes {
    One(Scheme),
    All,
}

fn schemes(name: &str) -> Result<Schemes> {
    if name == "all" {
        return Ok(Schemes::All);
    }
    let names: Vec<&str> = Scheme::all().map(Scheme::name).collect();
    let scheme = Scheme::named(name)
        .with_context(|| format!("there are {}, and `all`", names.join(", ")))?;
    Ok(Schemes::One(scheme))
}

/// Parses a frequency in Hz: `40Hz`, `40 Hz` or `40`.
fn hertz(text: &str) -> lab::Result<f64> {
    let number = text.trim_end_matches("Hz").trim_end();
    lab::input::above_zero(number)
}

/// The value of `--emit`: the form in which settings are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Emit {
    /// A Rust constant with parameters and filter coefficients, which compiles without std
    Rust,
    /// A file of parameters, for --params
    Toml,
    /// A flight file (`flight.toml`) of all channels
    Flight,
}

/// Parameters given on the command line, which the search keeps fixed.
#[derive(Clone, Debug)]
struct Fixed(Asked);

option_group!(Fixed, |command| augment(command, is_fixable), |matches| given(matches, is_fixable));

/// Returns whether the command line can fix this parameter. A scheme's `seed` cannot be fixed, because `--seed` is the
/// seed of the search.
fn is_fixable(parameter: &Parameter) -> bool {
    parameter.name != "seed"
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the logs or options are invalid, or if no settings satisfy the limits.
pub(crate) fn run(options: &Tune) -> Result<()> {
    let (ending, what) = match options.emit {
        Some(Emit::Rust) => ("rs", "Rust"),
        Some(Emit::Flight) => ("toml", "a flight file"),
        // Without `--emit` there is no output.
        Some(Emit::Toml) | None => ("toml", "a file of parameters"),
    };
    check_ending(options.output.as_deref(), ending, what)?;
    let mut request = options.request()?;
    request.check()?;
    let Found { logs: paths, is_single, .. } = options.logs.find()?;
    let logs;
    (logs, request.logs) = options.recordings(&paths, is_single)?;
    let stop = Stop::new(None)?;
    let start = Instant::now();
    let bar = ProgressBar::new(BAR)
        .with_style(ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}")?);
    let tell = |Progress { done, total, words }: &Progress| {
        let time = options.seconds.map_or(0.0, |most| start.elapsed().as_secs_f64() / most);
        bar.set_position(position(*done as f64 / *total as f64, time));
        bar.set_message(format!("{done} of {total} settings, {}", visible(words)));
    };
    let watch = Watch { is_stopped: &|| stop.is_due(), tell: &tell };
    let all = tune(&request, &watch)?;
    bar.finish_and_clear();
    let (mut panels, mut emitted, mut results) = (Vec::new(), String::new(), Vec::new());
    for Tuned { channel, rows, curves, missed, notes } in all {
        for words in notes {
            say!("{words}");
        }
        for words in missed {
            say!("{}: {}", channel.name, words.spelled(option));
        }
        if rows.is_empty() && curves.is_empty() {
            bail!("{}: of the settings tried none keeps to all limits", channel.name);
        }
        if let Some((scheme, row)) = rows.first() {
            emitted += &options.emitted(*scheme, &channel, row)?;
        }
        if !curves.is_empty() {
            panels.push(Tune::panel(&channel, curves));
        }
        results.push((channel, rows));
    }
    if let Some(picture) = &options.front {
        draw_fronts(picture, &paths[0], &panels)?;
        return Ok(());
    }
    if options.json {
        return print_json(&logs, &results);
    }
    options.tell(&results)?;
    if options.emit == Some(Emit::Flight) {
        emitted = options.flight(&request, &results)?;
    }
    if options.emit.is_some() {
        let mut output = Output::open(options.output.as_deref(), &paths[0])?;
        output.write_all(emitted.as_bytes())?;
        output.finish()?;
    }
    Ok(())
}

impl Tune {
    /// Converts the options to a request to the library. The request holds no logs yet.
    fn request(&self) -> Result<TuneRequest> {
        let schemes = match self.scheme {
            Schemes::One(scheme) => vec![scheme],
            Schemes::All if !self.parameters.0.is_empty() => {
                bail!("--scheme all searches all parameters; with one scheme those given stay")
            }
            Schemes::All => Scheme::all().collect(),
        };
        let mut fixed = self.parameters.0.clone();
        let free_taps = fixed.word("filter") == Some(FREE);
        if free_taps {
            fixed.unset("filter");
        }
        let goal = match (self.min_efficiency, self.max_rmse, &self.front) {
            (Some(efficiency), ..) => Some(Goal::LeastError(efficiency)),
            (_, Some(rmse), _) => Some(Goal::MostEfficient(rmse)),
            (.., Some(_)) => Some(Goal::Front),
            (None, None, None) => None,
        };
        Ok(TuneRequest {
            sample: self.sample,
            fixed,
            free_taps,
            goal,
            limits: Limits {
                ram: self.max_ram,
                instructions: self.max_instructions,
                latency: self.max_latency,
                rate: self.max_rate,
            },
            core: self.core.clone(),
            hold_out: HoldOut { blocks: self.blocks, part: self.hold_out },
            over: if self.worst_flight { Over::Worst } else { Over::Mean },
            below: self.below,
            evaluations: self.evaluations,
            seconds: self.seconds,
            seed: self.seed,
            anyway: self.anyway,
            ..TuneRequest::new(Vec::new(), schemes)
        })
    }

    /// Reads the chosen channels of each log. Returns the entry of each log in a report, and its recordings, one for
    /// each channel. With `--channels-of`, the channels of all logs have the names of the first log's, in order.
    ///
    /// # Errors
    /// Returns an error if a log cannot be read, or if its channels are not those of the first log.
    fn recordings(&self, paths: &[PathBuf], is_single: bool) -> Result<Read> {
        let (mut logs, mut all): (Vec<Log<Channels>>, Vec<Vec<Recording>>) = Default::default();
        let by_place = !self.channels.channels_of.is_empty();
        for path in paths {
            let log = path.display().to_string();
            let read = |input: &InputOptions| Recording::read_all(&input.or(Unnamed::Inertial));
            let mut recordings = self.channels.read(path, is_single, read)?;
            let notes = recordings.first().map(Recording::notes).unwrap_or_default();
            let notes = words::notes(&notes);
            if !self.json {
                tell_of((!is_single).then_some(&*log), &notes);
            }
            let channels: Vec<_> = recordings.iter().map(|own| own.name.clone()).collect();
            if let (Some(first), Some(Log { log: name, content: Some(own), .. })) =
                (all.first(), logs.first())
            {
                if own.channels != channels && !(by_place && own.channels.len() == channels.len()) {
                    let (own, other) = (own.channels.join(", "), channels.join(", "));
                    bail!(
                        "the logs have other channels: {own} in {name}, {other} in {log}; --channels-of names those of each kind"
                    );
                }
                for (recording, first) in recordings.iter_mut().zip(first) {
                    recording.name.clone_from(&first.name);
                }
            }
            logs.push(Log { log, refused: None, notes, content: Some(Channels { channels }) });
            all.push(recordings);
        }
        if self.emit == Some(Emit::Toml) && all.first().is_some_and(|log| log.len() > 1) {
            bail!("--emit toml writes one channel; there are {}", all[0].len());
        }
        Ok((logs, all))
    }

    fn emitted(&self, scheme: Scheme, cut: &Cut, row: &Row) -> Result<String> {
        let comments = row.comments(&cut.name);
        match self.emit {
            // A flight file is written once, for all channels.
            None | Some(Emit::Flight) => Ok(String::new()),
            Some(Emit::Rust) => Ok(emit::rust(&comments, &cut.name, scheme, &row.settings)?),
            Some(Emit::Toml) => Ok(emit::toml(&comments, scheme, &row.settings)),
        }
    }

    /// Returns the text of a flight file (`flight.toml`) with the settings found for each channel.
    ///
    /// # Errors
    /// Returns an error if the first log has no sample rate, if its times contradict themselves, or if the channels cannot share a flight file, for example
    /// because two have the same name.
    fn flight(
        &self,
        request: &TuneRequest,
        results: &[(Cut, Vec<(Scheme, Row)>)],
    ) -> Result<String> {
        let mut rows = Vec::new();
        for (cut, found) in results {
            let Some((scheme, row)) = found.first() else { continue };
            let name = cut.name.as_str();
            let recording = request.logs.iter().flatten().find(|recording| recording.name == name);
            let source = recording.map_or(name, |recording| recording.source.as_str());
            rows.push(TunedChannel { name, source, scheme: *scheme, row });
        }
        let rate = match request.logs.first().and_then(|log| log.first()) {
            Some(recording) => recording.steady_rate()?,
            None => None,
        };
        let flight =
            of_rows(&rows, self.sample, rate.context("a flight needs the rate of its log")?)?;
        let comments = rows.iter().flat_map(|channel| channel.row.comments(channel.name));
        Ok(flight.to_toml(&comments.collect::<Vec<_>>()))
    }

    fn panel(cut: &Cut, curves: Vec<lab::tune::Curve>) -> Panel {
        Panel { title: cut.name.clone(), unit: unit_of_name(&cut.name).map(str::to_owned), curves }
    }

    /// Prints a table of the tuned settings for each channel. The tables go to standard output, or to standard error if
    /// `--emit` writes the settings to standard output.
    fn tell(&self, results: &[(Cut, Vec<(Scheme, Row)>)]) -> Result<()> {
        let is_to_stdout =
            self.emit.is_some() && self.output.as_deref().is_none_or(|path| path == Path::new("-"));
        for (cut, rows) in results {
            let text = words::page(&texts(cut, rows, &self.core, self.below));
            if is_to_stdout {
                eprint!("{text}");
            } else {
                answer(text)?;
            }
        }
        Ok(())
    }
}

/// Names of the channels that were read from a log.
#[derive(Debug, Serialize)]
struct Channels {
    channels: Vec<String>,
}

/// The entry of each log in a report, and the log's recordings, one for each channel.
type Read = (Vec<Log<Channels>>, Vec<Vec<Recording>>);

/// Settings found on all logs together: rows of figures and parameters, by channel.
#[derive(Debug, Serialize)]
struct Summary {
    #[serde(flatten)]
    counts: Counts,
    channels: BTreeMap<String, Vec<serde_json::Value>>,
}

/// Prints the report of `--json`: the notes on each log, and for each channel a row of figures and parameters for each
/// scheme.
fn print_json(logs: &[Log<Channels>], results: &[(Cut, Vec<(Scheme, Row)>)]) -> Result<()> {
    let rows = |(cut, rows): &(Cut, Vec<(Scheme, Row)>)| {
        let rows = rows.iter().map(|(_, row)| json!(row)).collect();
        (cut.name.clone(), rows)
    };
    let channels = results.iter().map(rows).collect();
    let summary = Summary { counts: Counts::of(logs), channels };
    Report { command: "tune", logs, summary }.print()
}

/// Length of the progress bar in steps.
const BAR: u64 = 1000;

/// Returns the position of the progress bar, 0 to [`BAR`]. `settings` is the number of scored settings divided by its
/// maximum. `time` is the elapsed time divided by the time limit. The bar shows the larger quotient, because the search
/// ends at the limit that is reached first.
fn position(settings: f64, time: f64) -> u64 {
    (settings.max(time).clamp(0.0, 1.0) * BAR as f64) as u64
}

fn texts(cut: &Cut, rows: &[(Scheme, Row)], core: &str, below: Option<f64>) -> String {
    let count = |stretches: &[Stretch]| -> usize { stretches.iter().map(Stretch::samples).sum() };
    let head = format!(
        "{}: {} samples to tune on, {} held out\n",
        cut.name,
        count(&cut.train),
        count(&cut.held_out)
    );
    let mut text = head;
    // One table holds the rows of all schemes.
    let rows: Vec<&Row> = rows.iter().map(|(_, row)| row).collect();
    text += &print(&rows, core, below);
    text
}

#[cfg(test)]
mod tests {
    use super::{BAR, position};

    #[test]
    fn a_bar_ends_with_the_settings_or_the_time() {
        assert_eq!([position(0.5, 0.1), position(0.001, 0.5)], [BAR / 2; 2]);
        assert_eq!([position(1.0, 0.2), position(0.02, 1.01)], [BAR; 2]);
    }
}
