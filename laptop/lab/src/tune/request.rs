//! Requests to tune schemes on logs, and their results.

use super::RequestKind;
use super::problem::Over;
use super::report::{Cut, Row, missed};
use super::search::{Budget, Found, Method, search, share};
use super::stretch::{HoldOut, cut};
use super::{Goal, Limits, Problem, Scored, Stretch, costs};
use crate::Result;
use crate::look::ChannelSummary;
use crate::scheme::Scheme;
use crate::trial::Recording;
use crate::watch::{Progress, Watch};
use catalogue::run::{Asked, Given, SampleType, Words};
use std::time::{Duration, Instant};

/// The logs, schemes and goal of a search, for [`tune`].
pub struct TuneRequest {
    /// Logs from which one result is found for each channel. Each log has one recording for each channel, and all logs
    /// have the same channels.
    pub logs: Vec<Vec<Recording>>,
    /// The schemes whose parameters are searched, each scheme by itself.
    pub schemes: Vec<Scheme>,
    /// Sample type of the codec that is scored.
    pub sample: SampleType,
    /// Parameters that keep the given values.
    pub fixed: Asked,
    /// Whether the search also varies each tap of a filter by itself, after it has varied the filter's shape, length
    /// and sum.
    pub free_taps: bool,
    /// Goal of the search. `None` stands for the goal [`Goal::LeastError`] with the efficiency that the paper's
    /// settings reach.
    pub goal: Option<Goal>,
    /// Upper limits on what settings may cost.
    pub limits: Limits,
    /// Processor core, such as `M4F`, whose measured instruction counts apply.
    pub core: String,
    /// The part that is held out from tuning, to check the settings found: of the blocks of a single log, or of several
    /// logs.
    pub hold_out: HoldOut,
    /// How the errors of several logs count.
    pub over: Over,
    /// Frequency in Hz below which the error is also reported.
    pub below: Option<f64>,
    /// Number of settings to score for each scheme and channel, 1 or more.
    pub evaluations: usize,
    /// Seconds after which the search stops. If this limit ends the search, the result depends on the machine's speed.
    pub seconds: Option<f64>,
    /// Seed of the search: the same seed and number of settings give the same result however busy a machine is and
    /// however many cores it has. Another operating system or processor may round logarithms differently, and then the
    /// result differs.
    pub seed: u64,
    /// Whether to search even if a recording is unfit for tuning: only noise, too short, full of holes, or clipped.
    pub anyway: bool,
}

impl TuneRequest {
    /// Default number of settings to score for each scheme and channel.
    pub const EVALUATIONS: usize = 4000;

    /// Makes a request to tune `schemes` on `logs`, in `f32`. The goal is the least error at the efficiency of the
    /// paper's settings. Of several logs 30 % are held out; a single log is cut into 20 blocks, 30 % of which are held
    /// out.
    pub fn new(logs: Vec<Vec<Recording>>, schemes: Vec<Scheme>) -> Self {
        Self {
            logs,
            schemes,
            sample: SampleType::F32,
            fixed: Asked::default(),
            free_taps: false,
            goal: None,
            limits: Limits::default(),
            core: "M4F".to_owned(),
            hold_out: HoldOut { blocks: 20, part: 0.3 },
            over: Over::default(),
            below: None,
            evaluations: Self::EVALUATIONS,
            seconds: None,
            seed: 1,
            anyway: false,
        }
    }

    /// Checks that all settings of the request are within their ranges and fit each other.
    ///
    /// # Errors
    /// Returns an error if a setting is outside its range, or does not fit the schemes.
    pub fn check(&self) -> Result<()> {
        let HoldOut { blocks, part } = self.hold_out;
        if !(0.0..1.0).contains(&part) {
            return Err(RequestKind::NotAPart.of(Given::new("hold_out", part)));
        }
        if blocks < 2 && part > 0.0 {
            return Err(RequestKind::TooFewBlocks.of(Given::new("blocks", blocks)));
        }
        if self.evaluations == 0 {
            return Err(RequestKind::NotAboveZero.of(Given::new("evaluations", 0)));
        }
        if let Some(Goal::LeastError(efficiency)) = self.goal
            && (efficiency.is_nan() || efficiency > 100.0)
        {
            return Err(RequestKind::AboveHundred.of(Given::new("min_efficiency", efficiency)));
        }
        let Limits { ram, instructions, latency: _, rate } = self.limits;
        let rmse = match self.goal {
            Some(Goal::MostEfficient(rmse)) => Some(rmse),
            _ => None,
        };
        for (name, value) in [
            ("max_rmse", rmse),
            ("max_ram", ram),
            ("max_instructions", instructions),
            ("max_rate", rate),
            ("below", self.below),
            ("seconds", self.seconds),
        ] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(RequestKind::NotPositive.of(Given::new(name, value)));
            }
        }
        costs::core(&self.core)?;
        match &self.schemes[..] {
            [] => Err(RequestKind::NoSchemes.into()),
            [scheme] => Ok(self.fixed.check(scheme.info())?),
            _ if !self.fixed.is_empty() || self.free_taps => {
                Err(RequestKind::SeveralSearchAll.into())
            }
            _ if self.goal.is_none() => Err(RequestKind::NoGoal.into()),
            _ => Ok(()),
        }
    }

    /// Returns whether the log at `place` is held out as a whole. A single log never is; of several logs at least one
    /// is held out, and one is not, unless the part to hold out is 0.
    fn is_held_out(&self, place: usize) -> bool {
        let logs = self.logs.len();
        if logs < 2 || self.hold_out.part == 0.0 {
            return false;
        }
        let count = ((logs as f64 * self.hold_out.part).round() as usize).clamp(1, logs - 1);
        // Spread evenly: every share of the logs has one of them in its middle.
        let before = |place: usize| (2 * place * count + logs) / (2 * logs);
        before(place + 1) > before(place)
    }

    /// Cuts the channels of all logs into stretches; also returns notes for the user. Of several logs, whole logs are
    /// held out; of a single log, blocks.
    fn channels(&self) -> Result<(Vec<Cut>, Vec<String>)> {
        let (mut cuts, mut notes): (Vec<Cut>, _) = (Vec::new(), Vec::new());
        for (flight, log) in self.logs.iter().enumerate() {
            for (place, recording) in log.iter().enumerate() {
                match ChannelSummary::of(recording).objection() {
                    Some(words) if self.anyway && recording.values.len() > 1 => notes.push(words),
                    Some(why) => return Err(RequestKind::NothingToSearch { why }.into()),
                    None => {}
                }
                let (name, mut whole) = (recording.name.clone(), Stretch::whole(recording));
                for own in &mut whole {
                    own.flight = flight;
                }
                let (train, held_out) = match self.logs.len() {
                    0 | 1 => cut(recording, self.hold_out)?,
                    _ if self.is_held_out(flight) => (Vec::new(), whole.clone()),
                    _ => (whole.clone(), Vec::new()),
                };
                match cuts.get_mut(place) {
                    Some(known) if known.name == name => {
                        known.train.extend(train);
                        known.held_out.extend(held_out);
                        known.whole.extend(whole);
                    }
                    Some(known) => {
                        let (one, other) = (known.name.clone(), name);
                        return Err(RequestKind::OtherChannels { one, other }.into());
                    }
                    None => cuts.push(Cut { name, train, held_out, whole }),
                }
            }
        }
        if cuts.is_empty() {
            return Err(RequestKind::NoRecording.into());
        }
        Ok((cuts, notes))
    }
}

/// The settings found for one channel.
pub struct Tuned {
    /// The channel, cut into stretches.
    pub channel: Cut,
    /// The schemes that reach the goal, with their settings. The best scheme comes first. Empty for [`Goal::Front`].
    pub rows: Vec<(Scheme, Row)>,
    /// The Pareto front of each scheme, for [`Goal::Front`]; otherwise empty.
    pub curves: Vec<Curve>,
    /// For each scheme that misses the goal, the reason and how near the scheme comes.
    pub missed: Vec<Words>,
    /// Reasons not to trust the recordings. Empty unless [`TuneRequest::anyway`] is set.
    pub notes: Vec<String>,
}

/// The Pareto front of one scheme: the settings that no other settings beat in both spikes and error.
pub struct Curve {
    /// The scheme.
    pub scheme: Scheme,
    /// Efficiency in percent and RMSE of each of the settings on the Pareto front.
    pub points: Vec<(f64, f64)>,
    /// Efficiency in percent and RMSE of the paper's settings, if the scheme has any.
    pub paper: Option<(f64, f64)>,
}

/// Searches for parameters of schemes on the channels of logs. If a scheme misses the goal, [`Tuned::missed`] gives the
/// reason.
///
/// # Errors
/// Returns an error if the request is invalid, or if a recording is unfit for tuning.
pub fn tune(request: &TuneRequest, watch: &Watch) -> Result<Vec<Tuned>> {
    request.check()?;
    let (channels, notes) = request.channels()?;
    let end = request.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    let searches = channels.len() * request.schemes.len();
    let mut before = 0;
    let mut all = Vec::new();
    for channel in channels {
        let (mut rows, mut curves, mut missed) = (Vec::new(), Vec::new(), Vec::new());
        for &scheme in &request.schemes {
            let tick = |evaluated: usize, best: Option<&Scored>| {
                let words = best.map_or(String::new(), |best| so_far(&channel.name, scheme, best));
                let done = before * request.evaluations + evaluated;
                (watch.tell)(&Progress { done, total: searches * request.evaluations, words });
            };
            let budget = Budget {
                evaluations: request.evaluations,
                deadline: share(end, searches - before),
                is_stopped: watch.is_stopped,
                tick: &tick,
            };
            match one(request, scheme, &channel, &budget)? {
                Outcome::Row(row, rmse) => rows.push((rmse, scheme, *row)),
                Outcome::Curve(curve) => curves.push(curve),
                Outcome::Missed(words) => missed.push(words),
            }
            before += 1;
        }
        rows.sort_by(|(one, _, a), (other, _, b)| match request.goal {
            Some(Goal::MostEfficient(_)) => b.tuned_on.efficiency.total_cmp(&a.tuned_on.efficiency),
            _ => one.total_cmp(other),
        });
        let rows = rows.into_iter().map(|(_, scheme, row)| (scheme, row)).collect();
        all.push(Tuned { channel, rows, curves, missed, notes: notes.clone() });
    }
    Ok(all)
}

/// Returns words for a progress report: the best settings of a scheme so far.
fn so_far(channel: &str, scheme: Scheme, best: &Scored) -> String {
    let state = if best.is_allowed() { "best" } else { "nearest" };
    let (efficiency, rmse) = (best.tally.efficiency(), best.tally.rmse());
    format!("{channel} {}: {state} {efficiency:.2} %, RMSE {rmse:.4}", scheme.name())
}

/// The outcome of one scheme on one channel.
enum Outcome {
    /// The settings found, and the RMSE that the search reduced.
    Row(Box<Row>, f64),
    Curve(Curve),
    Missed(Words),
}

/// Searches for parameters of one scheme on one channel.
fn one(request: &TuneRequest, scheme: Scheme, channel: &Cut, budget: &Budget) -> Result<Outcome> {
    let TuneRequest { sample, fixed, limits, .. } = request;
    let core = costs::core(&request.core)?;
    let known = (Goal::Front, limits, core.as_str());
    let mut problem = Problem::new(scheme, *sample, fixed, &channel.train, known);
    problem.over = request.over;
    let mut paper = problem.fixed.clone();
    paper.paper = true;
    let paper = problem.score(&paper).ok();
    problem.goal = if let Some(goal) = request.goal {
        goal
    } else {
        let paper = paper.as_ref().ok_or(RequestKind::NoPaper)?;
        Goal::LeastError(paper.tally.efficiency())
    };
    let method = Method {
        seed: request.seed,
        free_taps: request.free_taps,
        is_unchecked: channel.held_out.is_empty(),
    };
    let found = search(&problem, method, budget);
    let Some(best) = &found.best else {
        return Ok(Outcome::Missed(format!("{} cannot be built", scheme.name()).into()));
    };
    if problem.goal == Goal::Front && !found.front.is_empty() {
        return Ok(Outcome::Curve(curve(&problem, channel, &found, paper.as_ref())));
    }
    if problem.goal == Goal::Front || !best.is_allowed() {
        return Ok(Outcome::Missed(missed(&problem, &found, best)));
    }
    let rmse = problem.mean_square(&best.tally).sqrt();
    let row = Row::new(&problem, channel, &found, best, request.below)?;
    Ok(Outcome::Row(Box::new(row), rmse))
}

/// Scores the settings of a Pareto front, and returns the curve of their efficiencies and errors. The settings are
/// scored on the held-out blocks or, if no block is held out, on the blocks used for tuning.
fn curve(problem: &Problem, cut: &Cut, found: &Found, paper: Option<&Scored>) -> Curve {
    let stretches = if cut.held_out.is_empty() { &cut.train } else { &cut.held_out };
    let scored = |one: &Scored| {
        let (tally, _) = problem.tally(&one.options, problem.sample, stretches).ok()?;
        Some(Scored { tally, ..one.clone() })
    };
    let stride = found.front.len().div_ceil(400).max(1);
    let all: Vec<Scored> = found.front.iter().step_by(stride).filter_map(scored).collect();
    let point = |one: &Scored| (one.tally.efficiency(), problem.mean_square(&one.tally).sqrt());
    Curve {
        scheme: problem.scheme,
        points: problem.front(all).iter().map(point).collect(),
        paper: paper.and_then(scored).map(|one| point(&one)),
    }
}
