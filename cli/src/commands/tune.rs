//! `spikewire tune`: the parameters of a scheme, from flight logs.

use crate::input::{ChannelOptions, InputOptions};
use crate::look::Look;
use crate::options::{SchemeOptions, augment, given};
use crate::output::Output;
use crate::plot::draw_fronts;
use crate::plot::front::{Curve, Panel};
use crate::scheme::Scheme;
use crate::stop::Stop;
use crate::trial::Recording;
use crate::tune::problem::front;
use crate::tune::report::{Cut, Row, missed, print};
use crate::tune::search::{Budget, Found, Method, search, share};
use crate::tune::stretch::{HoldOut, cut};
use crate::tune::{Goal, Limits, Problem, Scored, Stretch, costs, emit};
use anyhow::{Context, Result, bail};
use catalogue::Parameter;
use catalogue::run::SampleType;
use clap::{ArgMatches, Args, Command, Error, FromArgMatches, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{Write, stdout};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Search a scheme's parameters for a goal: the least RMSE at a spiking efficiency, the greatest efficiency at an
/// RMSE, or the front of both.
///
/// Some blocks of each log are held out, and the settings are scored on them too. What is scored is the codec that
/// flies, in the sample type given. Parameters that are given stay; the others are searched. Without a goal it is
/// the least RMSE at the efficiency of the paper's settings.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire tune flight.csv --channel gyro_x --scheme sf --min-efficiency 95
  spikewire tune a.ulg b.ulg --channel 'sensor_combined.gyro_rad[0]' --scheme all --max-rmse 0.1 --core M0 --sample q16.16
  spikewire tune flight.csv --channel gyro_x --scheme hsa --filter free --sample q8.8 --emit rust -o src/roll.rs
  spikewire tune flight.csv --channel gyro_x,gyro_y --scheme all --front front.svg")]
pub(crate) struct Tune {
    /// CSV tables or PX4 flight logs, tuned on together
    #[arg(required = true, value_name = "LOG")]
    inputs: Vec<PathBuf>,
    /// The scheme, or `all`
    #[arg(long, value_parser = which)]
    scheme: Which,
    /// Sample type of the codec that is scored: f32, i16, i32, or fixed point such as q16.16
    #[arg(long, default_value_t)]
    sample: SampleType,
    #[command(flatten)]
    channel: ChannelOptions,
    #[command(flatten)]
    parameters: Kept,
    /// Least RMSE at so many percent of samples without a spike, or more
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, help_heading = "Goal")]
    min_efficiency: Option<f64>,
    /// Greatest efficiency at this RMSE, in the signal's unit, or less
    #[arg(long, value_name = "RMSE", conflicts_with = "min_efficiency", value_parser = crate::input::above_zero, help_heading = "Goal")]
    max_rmse: Option<f64>,
    /// The settings that no other beats in both, drawn here, `.svg` or `.png`
    #[arg(long, value_name = "PICTURE", conflicts_with_all = ["min_efficiency", "max_rmse", "emit"], help_heading = "Goal")]
    front: Option<PathBuf>,
    /// Bytes of RAM of a channel's encoder at most
    #[arg(long, value_name = "BYTES", value_parser = crate::input::above_zero, help_heading = "Limits")]
    max_ram: Option<f64>,
    /// Instructions a sample to encode at most, in the mean, as measured on --core
    #[arg(long, value_name = "COUNT", value_parser = crate::input::above_zero, help_heading = "Limits")]
    max_instructions: Option<f64>,
    /// Samples until a code comes out at most
    #[arg(long, value_name = "SAMPLES", help_heading = "Limits")]
    max_latency: Option<f64>,
    /// Events a second at most
    #[arg(long, value_name = "RATE", value_parser = crate::input::above_zero, help_heading = "Limits")]
    max_rate: Option<f64>,
    /// Core of the measured table: M0 or M4F
    #[arg(long, default_value = "M4F", value_parser = core, help_heading = "Limits")]
    core: String,
    /// The part of the blocks that is held out; 0 holds out nothing
    #[arg(long, value_name = "PART", default_value_t = 0.3, help_heading = "Search")]
    hold_out: f64,
    /// Blocks of equal length that each log is cut into
    #[arg(long, default_value_t = 20, help_heading = "Search")]
    blocks: usize,
    /// Stop after so many seconds in all; Ctrl-C stops as well, and the best is kept
    #[arg(long, default_value_t = 25.0, value_parser = crate::input::above_zero, help_heading = "Search")]
    pub(crate) seconds: f64,
    /// Settings of each scheme and channel to score at most
    #[arg(long, default_value_t = 40_000, help_heading = "Search")]
    pub(crate) evaluations: usize,
    /// Where the search's chance starts; the same seed and budget of evaluations give the same settings
    #[arg(long, default_value_t = 1, help_heading = "Search")]
    seed: u64,
    /// Search although the log says little: noise, all on the ground, full of holes, clipped
    #[arg(long, help_heading = "Search")]
    anyway: bool,
    /// Tell the RMSE below this frequency too, such as `40Hz`
    #[arg(long, value_name = "FREQUENCY", value_parser = hertz)]
    below: Option<f64>,
    /// Write the settings: a constant in Rust, or a file for --params
    #[arg(long)]
    emit: Option<Emit>,
    /// Where they are written; standard output unless given
    #[arg(short, long, requires = "emit")]
    output: Option<PathBuf>,
    /// Figures and settings as JSON, for programs
    #[arg(long, conflicts_with = "emit")]
    json: bool,
}

/// One scheme or all.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Which {
    One(Scheme),
    All,
}

fn which(name: &str) -> Result<Which> {
    if name == "all" {
        return Ok(Which::All);
    }
    let names: Vec<&str> = Scheme::all().map(Scheme::name).collect();
    let scheme = Scheme::named(name)
        .with_context(|| format!("there are {}, and `all`", names.join(", ")))?;
    Ok(Which::One(scheme))
}

fn core(name: &str) -> Result<String> {
    costs::core(name)
}

/// `40Hz`, `40 Hz` or `40`.
fn hertz(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches("Hz").trim_end();
    crate::input::above_zero(number)
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Emit {
    /// A constant with parameters and taps, which compiles without std
    Rust,
    /// A file of parameters
    Toml,
}

/// Parameters that stay as they are given.
#[derive(Clone, Debug, Default)]
struct Kept(SchemeOptions);

/// The search has a seed of its own.
fn is_kept(parameter: &Parameter) -> bool {
    parameter.name != "seed"
}

impl Args for Kept {
    fn augment_args(command: Command) -> Command {
        augment(command, |_| true, is_kept)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Kept {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        Ok(Self(SchemeOptions(given(matches, |_| true, is_kept))))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Runs the command.
///
/// # Errors
/// The logs or options are not good, or nothing keeps to the limits.
pub(crate) fn run(options: &Tune) -> Result<()> {
    options.check()?;
    let cuts = options.cuts()?;
    let schemes = options.schemes();
    let stop = Stop::new(Some(options.seconds))?;
    let end = Instant::now() + Duration::from_secs_f64(options.seconds);
    let mut left = cuts.len() * schemes.len();
    let bar =
        ProgressBar::new(options.evaluations as u64).with_style(ProgressStyle::with_template(
            "{bar:40} {percent:>3} %  {human_pos} of {human_len} settings, {msg}",
        )?);
    let (mut panels, mut emitted, mut told) = (Vec::new(), String::new(), Vec::new());
    for cut in &cuts {
        let (mut rows, mut curves, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for scheme in &schemes {
            let deadline = share(end, left);
            left -= 1;
            let tick = |evaluated: usize, best: Option<&Scored>| {
                bar.set_position(evaluated as u64);
                if let Some(best) = best {
                    bar.set_message(so_far(&cut.name, *scheme, best));
                }
            };
            match options.tuned(*scheme, cut, deadline, &stop, &tick)? {
                Outcome::Row(row) => rows.push((*scheme, *row)),
                Outcome::Curve(curve) => curves.push(curve),
                Outcome::Missed(words) => missing.push(words),
            }
        }
        for words in &missing {
            eprintln!("{}: {words}", cut.name);
        }
        if rows.is_empty() && curves.is_empty() {
            bail!("{}: no settings keep to all limits", cut.name);
        }
        options.sort(&mut rows);
        for (scheme, row) in rows.iter().take(1) {
            emitted += &options.emitted(*scheme, cut, row)?;
        }
        if !curves.is_empty() {
            panels.push(options.panel(cut, curves));
        }
        told.push((cut, rows));
    }
    bar.finish_and_clear();
    if let Some(picture) = &options.front {
        draw_fronts(picture, &options.inputs[0], &panels)?;
        return Ok(());
    }
    options.tell(&told)?;
    if options.emit.is_some() {
        let mut output = Output::open(options.output.as_deref(), &options.inputs[0])?;
        output.write_all(emitted.as_bytes())?;
        output.finish()?;
    }
    Ok(())
}

/// The best settings so far, in words.
fn so_far(channel: &str, scheme: Scheme, best: &Scored) -> String {
    let state = if best.is_allowed() { "best" } else { "nearest" };
    let (efficiency, rmse) = (best.tally.efficiency(), best.tally.rmse());
    format!("{channel} {}: {state} {efficiency:.2} %, RMSE {rmse:.4}", scheme.name())
}

/// What became of a scheme on a channel.
pub(crate) enum Outcome {
    Row(Box<Row>),
    Curve(Curve),
    Missed(String),
}

impl Tune {
    /// The schemes that are tuned.
    pub(crate) fn schemes(&self) -> Vec<Scheme> {
        match self.scheme {
            Which::One(scheme) => vec![scheme],
            Which::All => Scheme::all().collect(),
        }
    }

    /// Refuses what makes no sense together.
    ///
    /// # Errors
    /// What it is.
    pub(crate) fn check(&self) -> Result<()> {
        let Self { hold_out, blocks, evaluations, .. } = self;
        if !(0.0..1.0).contains(hold_out) {
            bail!("--hold-out {hold_out} must be 0 or more and below 1");
        }
        if *blocks < 2 && *hold_out > 0.0 {
            bail!("--blocks {blocks} must be 2 or more");
        }
        if *evaluations == 0 {
            bail!("--evaluations 0 must be above 0");
        }
        if let Some(efficiency) = self.min_efficiency.filter(|own| own.is_nan() || *own > 100.0) {
            bail!("--min-efficiency {efficiency} must be 100 or less");
        }
        if let (Which::One(scheme), false) = (self.scheme, self.parameters.0.is_empty()) {
            self.parameters.0.check(scheme.info())?;
        }
        if self.scheme == Which::All {
            if !self.parameters.0.is_empty() {
                bail!("--scheme all searches all parameters; with one scheme those given stay");
            }
            if self.min_efficiency.is_none() && self.max_rmse.is_none() && self.front.is_none() {
                bail!(
                    "--scheme all needs one goal for all: --min-efficiency, --max-rmse or --front"
                );
            }
        }
        Ok(())
    }

    /// Refuses a recording that says little, unless it is to be tuned on anyway.
    ///
    /// # Errors
    /// What speaks against it.
    pub(crate) fn look_at(&self, recording: &Recording, name: &str) -> Result<()> {
        match Look::at(recording).objection() {
            Some(words) if self.anyway && recording.values.len() > 1 => eprintln!("{words}"),
            Some(words) => bail!("{name}: {words} (--anyway searches all the same)"),
            None => {}
        }
        Ok(())
    }

    /// A recording in stretches to tune on, and those held out.
    ///
    /// # Errors
    /// It is too short for that.
    pub(crate) fn cut(&self, recording: &Recording) -> Result<Cut> {
        let hold_out = HoldOut { blocks: self.blocks, part: self.hold_out };
        let (train, kept_back) = cut(recording, hold_out)?;
        let whole = vec![Stretch::whole(recording)];
        Ok(Cut { name: recording.name.clone(), train, held_out: kept_back, whole })
    }

    /// The channels of all logs, cut.
    fn cuts(&self) -> Result<Vec<Cut>> {
        let mut cuts: Vec<Cut> = Vec::new();
        for input in &self.inputs {
            let input = InputOptions { input: input.clone(), channel: self.channel.clone() };
            let recordings = Recording::read_all(&input)?;
            for (place, recording) in recordings.iter().enumerate() {
                self.look_at(recording, &input.name())?;
                if place == 0 {
                    eprint!("{}", recording.notes());
                }
                let own = self.cut(recording)?;
                match cuts.get_mut(place) {
                    Some(known) if known.name == recording.name => {
                        known.train.extend(own.train);
                        known.held_out.extend(own.held_out);
                        known.whole.extend(own.whole);
                    }
                    Some(known) => {
                        bail!("the logs have other channels: {}, {}", known.name, recording.name)
                    }
                    None => cuts.push(own),
                }
            }
        }
        if self.emit == Some(Emit::Toml) && cuts.len() > 1 {
            bail!("--emit toml writes one channel; there are {}", cuts.len());
        }
        Ok(cuts)
    }

    /// Searches one scheme on one channel.
    pub(crate) fn tuned(
        &self,
        scheme: Scheme,
        cut: &Cut,
        deadline: Instant,
        stop: &Stop,
        tick: &(dyn Fn(usize, Option<&Scored>) + Sync),
    ) -> Result<Outcome> {
        let mut kept = self.parameters.0.clone();
        let free_taps = free(&mut kept);
        let limits = Limits {
            ram: self.max_ram,
            instructions: self.max_instructions,
            latency: self.max_latency,
            rate: self.max_rate,
        };
        let mut problem = Problem::new(
            scheme,
            self.sample,
            &kept,
            &cut.train,
            (Goal::Front, &limits, &self.core),
        );
        let mut paper = problem.fixed.clone();
        paper.paper = true;
        let paper = problem.score(&paper).ok();
        problem.goal = match (self.min_efficiency, self.max_rmse, &self.front) {
            (Some(efficiency), ..) => Goal::LeastError(efficiency),
            (_, Some(rmse), _) => Goal::MostEfficient(rmse),
            (.., Some(_)) => Goal::Front,
            (None, None, None) => {
                let paper = paper.as_ref().context("the paper has no such setting; give a goal")?;
                Goal::LeastError(paper.tally.efficiency())
            }
        };
        let budget =
            Budget { evaluations: self.evaluations, deadline, is_stopped: &|| stop.is_due(), tick };
        let found = search(&problem, Method { seed: self.seed, free_taps }, &budget);
        let Some(best) = &found.best else {
            return Ok(Outcome::Missed(format!("{} cannot be built", scheme.name())));
        };
        if problem.goal == Goal::Front {
            return Ok(match found.front[..] {
                [] => Outcome::Missed(missed(&problem, best)),
                _ => Outcome::Curve(curve(&problem, cut, &found, paper.as_ref())),
            });
        }
        if !best.is_allowed() {
            return Ok(Outcome::Missed(missed(&problem, best)));
        }
        Ok(Outcome::Row(Box::new(Row::new(&problem, cut, &found, best, self.below)?)))
    }

    /// The best first, by what the goal is.
    pub(crate) fn sort(&self, rows: &mut [(Scheme, Row)]) {
        rows.sort_by(|(_, a), (_, b)| match self.max_rmse {
            Some(_) => b.tuned_on.efficiency.total_cmp(&a.tuned_on.efficiency),
            None => a.tuned_on.rmse.total_cmp(&b.tuned_on.rmse),
        });
    }

    fn emitted(&self, scheme: Scheme, cut: &Cut, row: &Row) -> Result<String> {
        let comments = row.comments(&cut.name);
        match self.emit {
            None => Ok(String::new()),
            Some(Emit::Rust) => {
                emit::rust(&comments, &cut.name, scheme, self.sample, &row.settings)
            }
            Some(Emit::Toml) => Ok(emit::toml(&comments, scheme, self.sample, &row.settings)),
        }
    }

    fn panel(&self, cut: &Cut, curves: Vec<Curve>) -> Panel {
        let scored =
            if cut.held_out.is_empty() { "the blocks tuned on" } else { "held-out blocks" };
        let samples: usize = cut.whole.iter().map(|stretch| stretch.values.len()).sum();
        Panel {
            title: cut.name.clone(),
            details: vec![format!("{samples} samples, {}; scored on {scored}", self.sample)],
            unit: super::plot::known_unit(&cut.name).map(str::to_owned),
            curves,
        }
    }

    /// The tables, on standard error where settings go to standard output.
    fn tell(&self, told: &[(&Cut, Vec<(Scheme, Row)>)]) -> Result<()> {
        if self.json {
            let channels: serde_json::Map<String, serde_json::Value> = told
                .iter()
                .map(|(cut, rows)| {
                    let rows: Vec<&Row> = rows.iter().map(|(_, row)| row).collect();
                    (cut.name.clone(), serde_json::json!(rows))
                })
                .collect();
            writeln!(stdout(), "{:#}", serde_json::Value::Object(channels))?;
            return Ok(());
        }
        let is_to_stdout =
            self.emit.is_some() && self.output.as_deref().is_none_or(|path| path == Path::new("-"));
        for (cut, rows) in told {
            let text = texts(cut, rows, &self.core, self.below);
            if is_to_stdout {
                eprint!("{text}");
            } else {
                write!(stdout(), "{text}")?;
            }
        }
        Ok(())
    }
}

fn texts(cut: &Cut, rows: &[(Scheme, Row)], core: &str, below: Option<f64>) -> String {
    let count = |stretches: &[Stretch]| -> usize {
        stretches.iter().map(|stretch| stretch.values.len()).sum()
    };
    let head = format!(
        "{}: {} samples to tune on, {} held out\n",
        cut.name,
        count(&cut.train),
        count(&cut.held_out)
    );
    let mut text = head;
    // The rows are printed together.
    let rows: Vec<&Row> = rows.iter().map(|(_, row)| row).collect();
    text += &print(&rows, core, below);
    text
}

/// Whether `--filter free` asks for the taps themselves.
fn free(kept: &mut SchemeOptions) -> bool {
    let is_free = kept.get("filter") == Some("free");
    if is_free {
        kept.0.unset("filter");
    }
    is_free
}

/// The curve of a front, by its score on held-out blocks where there are any.
fn curve(problem: &Problem, cut: &Cut, found: &Found, paper: Option<&Scored>) -> Curve {
    let stretches = if cut.held_out.is_empty() { &cut.train } else { &cut.held_out };
    let scored = |one: &Scored| {
        let (tally, _) = problem.tally(&one.options, problem.sample, stretches).ok()?;
        Some(Scored { tally, ..one.clone() })
    };
    let stride = found.front.len().div_ceil(400).max(1);
    let all: Vec<Scored> = found.front.iter().step_by(stride).filter_map(scored).collect();
    let point = |one: &Scored| (one.tally.efficiency(), one.tally.rmse());
    Curve {
        scheme: problem.scheme,
        points: front(all).iter().map(point).collect(),
        paper: paper.and_then(scored).map(|one| point(&one)),
    }
}
