//! `spikewire advise`: what a log is like, and which scheme suits each of its channels.

use super::plot::known_unit;
use crate::brief::{brief, short};
use crate::events::{Format, Item};
use crate::input::InputOptions;
use crate::look::{Look, Verdict};
use crate::options::SchemeOptions;
use crate::plot::{Picture, draw};
use crate::scheme::Scheme;
use crate::stop::Stop;
use crate::trial::{Recording, Trial};
use crate::tune::report::{Cut, Row};
use crate::tune::search::{Budget, Method, search, share};
use crate::tune::stretch::{HoldOut, cut};
use crate::tune::{Goal, Limits, Problem, Stretch, costs, emit};
use anyhow::{Result, bail};
use catalogue::run::SampleType;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use spikewire::{Event, Keyframe, Tick};
use std::io::{Write, stdout};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Look at a log and say which scheme suits each channel, with which parameters, and why.
///
/// Each scheme is tuned for a moment, with blocks held out. Of those that come as near to the signal as asked, on the
/// blocks tuned on and on those held out, the one with the fewest bytes a second on the crate's link is advised.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire advise flight.csv
  spikewire advise flight.csv --channel gyro_x --max-rmse 0.05 --max-latency 0 --picture roll.svg
  spikewire advise flight.ulg --topic sensor_combined --field 'gyro_rad[0]' --json")]
pub(crate) struct Advise {
    #[command(flatten)]
    input: InputOptions,
    /// Sample type of the codecs: f32, i16, i32, or fixed point such as q16.16
    #[arg(long, default_value_t)]
    pub(crate) sample: SampleType,
    /// The RMSE that the control loop bears, in the signal's unit; a fifth of the signal's deviation unless given
    #[arg(long, value_name = "RMSE", value_parser = crate::input::above_zero)]
    max_rmse: Option<f64>,
    /// Samples until a code comes out at most
    #[arg(long, value_name = "SAMPLES")]
    max_latency: Option<f64>,
    /// Core of the measured table: M0 or M4F
    #[arg(long, default_value = "M4F", value_parser = core)]
    pub(crate) core: String,
    /// Stop after so many seconds in all; Ctrl-C stops as well
    #[arg(long, default_value_t = 20.0, value_parser = crate::input::above_zero)]
    pub(crate) seconds: f64,
    /// Settings of each scheme and channel to score at most
    #[arg(long, default_value_t = 1500)]
    evaluations: usize,
    /// Where the search's chance starts
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Draw one channel's signal, spikes and reconstruction by the scheme advised, `.svg` or `.png`
    #[arg(long)]
    picture: Option<PathBuf>,
    /// All of it as JSON, for programs
    #[arg(long)]
    json: bool,
}

fn core(name: &str) -> Result<String> {
    costs::core(name)
}

/// What is said of a channel.
#[derive(Debug, Serialize)]
pub(crate) struct Advice {
    look: Look,
    /// Why nothing is advised, if so.
    objection: Option<String>,
    max_rmse: f64,
    /// The schemes that reach it, the advised one first.
    reaching: Vec<Candidate>,
    /// Those that do not, and why.
    others: Vec<String>,
    /// What raw samples would take on a wire.
    raw_bytes_per_second: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Candidate {
    link_bytes_per_second: Option<f64>,
    #[serde(flatten)]
    row: Row,
    #[serde(skip)]
    scheme: Option<Scheme>,
}

/// Runs the command.
///
/// # Errors
/// The log or the options are not good, or there is nothing to say of any channel.
pub(crate) fn run(options: &Advise) -> Result<()> {
    let input = options.input.or_all()?;
    let recordings = Recording::read_all(&input)?;
    if options.picture.is_some() && recordings.len() > 1 {
        bail!("--picture draws one channel; --channel says which");
    }
    if let Some(first) = recordings.first() {
        eprint!("{}", first.notes());
    }
    let stop = Stop::new(Some(options.seconds))?;
    let bar = ProgressBar::no_length()
        .with_style(ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}")?);
    let all = advise(options, &recordings, &stop, &|done, total, words| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        bar.set_message(words.to_owned());
    })?;
    bar.finish_and_clear();
    if options.json {
        writeln!(stdout(), "{}", serde_json::to_string_pretty(&all)?)?;
    } else {
        for advice in &all {
            write!(stdout(), "{}", advice.page(&options.core, options.sample))?;
        }
    }
    if let (Some(path), [advice], [recording]) = (&options.picture, &all[..], &recordings[..]) {
        advice.draw(options, path, recording)?;
    }
    if all.iter().all(|advice| advice.reaching.is_empty()) {
        bail!(
            "nothing can be advised: {}",
            all.iter().map(Advice::why_not).collect::<Vec<_>>().join("; ")
        );
    }
    Ok(())
}

/// Looks at each recording and tunes all schemes on it; `tell` is told how many are done, of how many, and which is next.
///
/// # Errors
/// A recording is too short to hold something out.
pub(crate) fn advise(
    options: &Advise,
    recordings: &[Recording],
    stop: &Stop,
    tell: &dyn Fn(usize, usize, &str),
) -> Result<Vec<Advice>> {
    let end = Instant::now() + Duration::from_secs_f64(options.seconds);
    let schemes: Vec<Scheme> = Scheme::all().collect();
    let total = schemes.len() * recordings.len();
    let mut done = 0;
    let mut all = Vec::new();
    for recording in recordings {
        let mut advice = Advice::new(options, recording);
        for scheme in &schemes {
            tell(done, total, &format!("{} {}", recording.name, scheme.name()));
            let deadline = share(end, total - done);
            if advice.objection.is_none() {
                advice.consider(options, *scheme, recording, deadline, stop)?;
            }
            done += 1;
        }
        advice.rank();
        all.push(advice);
    }
    Ok(all)
}

impl Advice {
    /// The scheme advised and its settings, if there is one.
    pub(crate) fn best(&self) -> Option<(Scheme, &Row)> {
        let best = self.reaching.first()?;
        Some((best.scheme?, &best.row))
    }

    fn new(options: &Advise, recording: &Recording) -> Self {
        /// 14 dB.
        const PART: f64 = 0.2;
        let look = Look::at(recording);
        let objection = look.objection().filter(|_| look.verdict != Verdict::Clipped);
        let bytes = if matches!(options.sample, SampleType::Fixed16 { .. }) { 2.0 } else { 4.0 };
        Self {
            objection,
            max_rmse: options.max_rmse.unwrap_or(PART * look.deviation),
            reaching: Vec::new(),
            others: Vec::new(),
            raw_bytes_per_second: recording.rate.map(|rate| rate * bytes),
            look,
        }
    }

    /// Tunes a scheme for a moment.
    fn consider(
        &mut self,
        options: &Advise,
        scheme: Scheme,
        recording: &Recording,
        deadline: Instant,
        stop: &Stop,
    ) -> Result<()> {
        /// A chance difference between blocks is no failure.
        const MARGIN: f64 = 1.25;
        let (train, held_out) = cut(recording, HoldOut { blocks: 10, part: 0.3 })?;
        let whole = vec![Stretch::whole(recording)];
        let cut = Cut { name: recording.name.clone(), train, held_out, whole };
        let limits = Limits { latency: options.max_latency, ..Limits::default() };
        let goal = Goal::MostEfficient(self.max_rmse);
        let fixed = SchemeOptions::default();
        let problem = Problem::new(
            scheme,
            options.sample,
            &fixed,
            &cut.train,
            (goal, &limits, &options.core),
        );
        let budget = Budget {
            evaluations: options.evaluations,
            deadline,
            is_stopped: &|| stop.is_due(),
            tick: &|_, _| (),
        };
        let found = search(&problem, Method { seed: options.seed, free_taps: false }, &budget);
        let Some(best) = &found.best else {
            self.others.push(format!("{} cannot be built", scheme.name()));
            return Ok(());
        };
        if !best.is_allowed() {
            let what = match best.excess.first() {
                Some(excess) if excess.limit == "--max-latency" => {
                    format!("has a latency of {} samples", best.costs.latency)
                }
                _ => format!("reaches {} at best", short(best.tally.rmse())),
            };
            self.others.push(format!("{} {what}", scheme.name()));
            return Ok(());
        }
        let row = Row::new(&problem, &cut, &found, best, None)?;
        if let Some(held_out) = row.held_out.filter(|own| own.rmse > MARGIN * self.max_rmse) {
            self.others.push(format!(
                "{} reaches it where it is tuned only: {} on held-out blocks",
                scheme.name(),
                short(held_out.rmse)
            ));
            return Ok(());
        }
        let options = SchemeOptions(emit::options(scheme, &row.settings));
        let trial = Trial::new(scheme, &options, problem.sample, recording)?;
        let link_bytes_per_second = match recording.rate {
            Some(rate) => Some(link_bytes(&trial, rate)? * rate / recording.values.len() as f64),
            None => None,
        };
        self.reaching.push(Candidate { link_bytes_per_second, row, scheme: Some(scheme) });
        Ok(())
    }

    /// The fewest bytes first, or events where no rate is known.
    fn rank(&mut self) {
        let cost =
            |one: &Candidate| one.link_bytes_per_second.unwrap_or(one.row.whole.spikes as f64);
        self.reaching.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    }

    fn why_not(&self) -> String {
        self.objection.clone().unwrap_or_else(|| {
            format!(
                "{}: no scheme comes within an RMSE of {}",
                self.look.name,
                short(self.max_rmse)
            )
        })
    }

    /// What a person reads.
    pub(crate) fn page(&self, core: &str, sample: SampleType) -> String {
        let Look { name, samples, seconds, rate, jitter_ms, gaps, rejected, .. } = &self.look;
        let unit = known_unit(name).map_or(String::new(), |unit| format!(" {unit}"));
        let round = |value: f64| short((value * 1000.0).round() / 1000.0);
        let mut lines = vec![name.clone()];
        let time = seconds.zip(*rate).map_or(", no times".to_owned(), |(seconds, rate)| {
            format!(" in {} s, {} a second", round(seconds), round(rate))
        });
        let jitter = jitter_ms
            .map_or(String::new(), |jitter| format!(", jitter {} ms, {gaps} gaps", round(jitter)));
        let holes = if *rejected > 0 { format!(", {rejected} missing") } else { String::new() };
        lines.push(format!("  {samples} samples{time}{jitter}{holes}"));
        let Look { min, max, rest, resting, noise, bandwidth, clipped, deviation, .. } = &self.look;
        let rest = rest.map_or("no stretch at rest".to_owned(), |[low, high]| {
            format!("at rest {} to {} ({resting:.0} % of the time)", short(low), short(high))
        });
        lines.push(format!(
            "  range {} to {}{unit}, {rest}; deviation {}",
            short(*min),
            short(*max),
            short(*deviation)
        ));
        let band = bandwidth
            .map_or(String::new(), |band| format!("; 99 % of the power below {} Hz", round(band)));
        lines.push(format!("  noise floor {}{band}; clipped {} %", short(*noise), round(*clipped)));
        if let Some(words) = self.look.objection() {
            lines.push(format!("  ! {words}"));
        }
        if let Some(best) = self.reaching.first() {
            lines.extend(self.reasons(best, core, sample));
        } else if self.objection.is_none() {
            lines.push(format!("  no scheme comes within an RMSE of {}", short(self.max_rmse)));
        }
        if !self.others.is_empty() {
            lines.push(format!("  not: {}", self.others.join("; ")));
        }
        lines.join("\n") + "\n\n"
    }

    fn reasons(&self, best: &Candidate, core: &str, sample: SampleType) -> Vec<String> {
        let bytes = |one: &Candidate| {
            one.link_bytes_per_second.map_or("-".to_owned(), |bytes| format!("{bytes:.1}"))
        };
        let Candidate { row, .. } = best;
        let held_out =
            row.held_out.map_or(String::new(), |own| format!(" ({} held out)", short(own.rmse)));
        let raw = self.raw_bytes_per_second.map_or("-".to_owned(), |bytes| format!("{bytes:.0}"));
        let ram = row.costs.ram.map_or("unknown".to_owned(), |bytes| bytes.to_string());
        let next = self.reaching.iter().skip(1).take(3);
        let next: Vec<String> =
            next.map(|one| format!("{} {}", one.row.scheme, bytes(one))).collect();
        let next = if next.is_empty() {
            "it is the only one".to_owned()
        } else {
            format!("next: {}", next.join(", "))
        };
        vec![
            format!("  take {} in {sample}: {}", row.scheme, brief(row.settings.entries())),
            format!(
                "    RMSE {}{held_out}, {:.1} % of the samples without a spike, {} events a second",
                short(row.tuned_on.rmse),
                row.tuned_on.efficiency,
                row.whole.events_per_second.map_or("-".to_owned(), |rate| format!("{rate:.1}")),
            ),
            format!(
                "    latency {} samples; {} instructions a sample on a Cortex-{core}; {ram} bytes of RAM a channel",
                row.costs.latency,
                row.costs.instructions()
            ),
            format!(
                "    {} bytes a second on the link, where samples take {raw}: the fewest of {} schemes within an RMSE of {}; {next}",
                bytes(best),
                self.reaching.len(),
                short(self.max_rmse)
            ),
        ]
    }

    fn draw(&self, options: &Advise, path: &std::path::Path, recording: &Recording) -> Result<()> {
        let Some(Candidate { row, scheme: Some(scheme), .. }) = self.reaching.first() else {
            return Ok(());
        };
        let parameters = SchemeOptions(emit::options(*scheme, &row.settings));
        let trials = [Trial::new(*scheme, &parameters, options.sample, recording)?];
        let unit = known_unit(&recording.name);
        let shown = 0..recording.values.len();
        draw(path, &options.input.input, &Picture { recording, trials: &trials, unit, shown })
    }
}

/// What the crate's link takes for all events, in full frames, with a keyframe a second where a decoder needs them.
fn link_bytes(trial: &Trial, rate: f64) -> Result<f64> {
    let period = (1e6 / rate).round().max(1.0);
    let format: Format = format!("link,period={period}").parse()?;
    let mut writer = format.writer(true);
    let mut bytes: Vec<u8> = Vec::new();
    let tick = |sample: u64| Tick::from_micros((sample as f64 * period) as u64);
    let (mut next, every) = (0, rate.round().max(1.0) as u64);
    for event in &trial.events {
        while trial.scheme.info().has_first_value && event.sample >= next {
            let value = trial.decoded.get(next as usize).copied().unwrap_or_default();
            writer
                .write(&Item::Keyframe(Keyframe::new(tick(next), 0, value as f32)), &mut bytes)?;
            next += every;
        }
        let spike =
            Event { tick: tick(event.sample), address: event.neuron, polarity: event.polarity };
        writer.write(&Item::Event(spike), &mut bytes)?;
    }
    writer.finish(&mut bytes)?;
    Ok(bytes.len() as f64)
}
