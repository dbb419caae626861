//! Advice on recordings: describes each channel, and names the scheme that suits it.

mod bank;
mod bytes;
mod flown;

pub use bank::BankAdvice;
pub use bytes::link_bytes;
pub use flown::{Verdict as FlightVerdict, verdict};

use self::bytes::Lean;
use crate::Result;
use crate::brief::{brief, short};
use crate::flight::{Filter, Filtering, period};
use crate::look::{ChannelSummary, Verdict};
use crate::scheme::Scheme;
use crate::slope::Slope;
use crate::trial::{Recording, Trial};
use crate::tune::RequestKind;
use crate::tune::problem::Limit;
use crate::tune::report::{Cut, DRIFTS, Row};
use crate::tune::search::{Budget, Method, search, share};
use crate::tune::stretch::{HoldOut, cut};
use crate::tune::{Goal, Limits, Problem, Stretch, costs};
use crate::unit::Inertial;
use crate::watch::{Progress, Watch};
use catalogue::Kind;
use catalogue::run::{Asked, Given, SampleType};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Largest phase lag, in degrees at the control loop's bandwidth, that a code's latency may cause: a third of a phase
/// margin of 60°. In the flights of `docs/loop.md`, the drone strays with codes that cause 18°, and is lost with codes
/// that cause 80°.
const PHASE: f64 = 20.0;

/// Largest share of steep samples with which a step code is advised for a control loop. A sample is steep if the signal
/// has changed by more than one threshold since the sample before. The decoded value cannot follow, because it moves by
/// at most one threshold a sample. In the flights of `docs/loop.md`, the drone flies well if 0.9 % of the samples are
/// steep. If 3.9 % are steep, the code loses steps, and the drone flips.
const STEEP: f64 = 0.02;

/// Smallest sample rate with which a control loop works, as a multiple of the loop's bandwidth. The Nyquist rate, twice
/// the bandwidth, is too small.
const FEWEST: f64 = 4.0;

/// Largest RMSE on held-out blocks, as a multiple of the allowed RMSE. It is above 1 because blocks differ by chance.
const MARGIN: f64 = 1.25;

/// Warning of a search that ended early.
const CUT_SHORT: &str = "the search was cut short: what is advised depends on this machine's speed, and on when it was stopped";

/// Returns the largest latency, in samples, that a control loop tolerates. `bandwidth` is the loop's bandwidth in Hz,
/// and `rate` is the number of samples a second.
fn borne(bandwidth: f64, rate: f64) -> f64 {
    (PHASE / 360.0 * rate / bandwidth).floor()
}

/// The recordings to advise on, and limits on what a scheme may cost, for [`advise`].
pub struct AdviseRequest {
    /// The recordings, one for each channel. Each channel gets an [`Advice`] of its own.
    pub recordings: Vec<Recording>,
    /// Sample type of the codecs.
    pub sample: SampleType,
    /// Largest RMSE that the control loop tolerates, in the signal's unit: one for each recording, or one for all if
    /// their units do not differ. It applies as given.
    ///
    /// If it is empty, the largest RMSE is a fifth of the signal's standard deviation. If `loop_bandwidth` is given too,
    /// and the channel is an axis of a gyroscope or an accelerometer whose unit is known, no code is advised that is
    /// coarser than the parameters with which the simulated drone flew. These parameters themselves are taken if they
    /// come near enough.
    pub max_rmse: Vec<f64>,
    /// Maximum latency of the code, in samples; unlimited if `None`.
    pub max_latency: Option<f64>,
    /// Bandwidth in Hz of the control loop that will use the decoded values, at most a quarter of the sample rate. If
    /// the bandwidth is given, a code with too long a latency for the loop is not advised. Neither is a code whose
    /// decoded value changes too slowly to follow the signal.
    pub loop_bandwidth: Option<f64>,
    /// Percentage of frames that the link loses, 0 to 10. If `loop_bandwidth` is given, a code is not advised if a
    /// simulated drone crashed or strayed far with the code while the link lost 1 % of the frames. For a percentage
    /// above 1, the code is also not advised if the drone crashed while the link lost 10 % of the frames.
    pub frame_loss: f64,
    /// Name of the processor core that will run the codecs, such as `M4F` for a Cortex-M4F. A core on which the codecs'
    /// instructions were not counted is an error.
    pub core: String,
    /// Number of settings to score for each scheme and channel, 1 or more.
    pub evaluations: usize,
    /// Seconds after which the search stops. If this limit ends the search, the advice depends on the machine's speed.
    pub seconds: Option<f64>,
    /// Seed of the search.
    pub seed: u64,
}

impl AdviseRequest {
    /// Default number of settings to score for each scheme and channel.
    pub const EVALUATIONS: usize = 300;

    /// Default share of frames that the link loses, in percent.
    pub const FRAME_LOSS: f64 = 1.0;

    /// Requests advice on codecs in `f32`, with default limits. The allowed RMSE is a fifth of the signal's standard
    /// deviation.
    pub fn new(recordings: Vec<Recording>) -> Self {
        Self {
            recordings,
            sample: SampleType::F32,
            max_rmse: Vec::new(),
            max_latency: None,
            loop_bandwidth: None,
            frame_loss: Self::FRAME_LOSS,
            core: "M4F".to_owned(),
            evaluations: Self::EVALUATIONS,
            seconds: None,
            seed: 1,
        }
    }
}

impl AdviseRequest {
    /// Returns the RMSE that is allowed for a channel, if it is given.
    fn rmse(&self, channel: usize) -> Option<f64> {
        self.max_rmse.get(channel).or(self.max_rmse.first()).copied()
    }

    /// Checks the allowed RMSE.
    ///
    /// # Errors
    /// Returns an error if there is neither one for all recordings nor one for each, if one is not above 0, or if one for
    /// all would serve several units.
    fn check_rmse(&self) -> Result<()> {
        if let Some(rmse) = self.max_rmse.iter().find(|own| !(own.is_finite() && **own > 0.0)) {
            return Err(RequestKind::NotPositive.of(Given::new("max_rmse", rmse)));
        }
        let (values, channels) = (self.max_rmse.len(), self.recordings.len());
        if values > 1 && values != channels {
            return Err(RequestKind::OneAChannel { values, channels }.of(Given::named("max_rmse")));
        }
        if values != 1 {
            return Ok(());
        }
        let mut first: Option<(&str, String)> = None;
        for recording in &self.recordings {
            let unit = Inertial::of(recording).map(|own| own.unit);
            let Some(unit) = unit.or_else(|| recording.unit().map(str::to_owned)) else { continue };
            let (one, known) = first.get_or_insert((&recording.name, unit.clone()));
            if *known != unit {
                let kind = RequestKind::SeveralUnits {
                    one: format!("{one} in {known}"),
                    other: format!("{} in {unit}", recording.name),
                };
                return Err(kind.of(Given::new("max_rmse", self.max_rmse[0])));
            }
        }
        Ok(())
    }
}

/// The advice on one channel.
#[derive(Debug, Serialize)]
pub struct Advice {
    look: ChannelSummary,
    /// The reason that no scheme is advised; `None` if a scheme is advised.
    objection: Option<String>,
    /// A reason not to trust what is advised; `None` if there is none.
    warning: Option<String>,
    max_rmse: f64,
    /// The schemes that stay within the allowed RMSE and break no limit. The advised scheme comes first.
    reaching: Vec<Candidate>,
    /// The schemes that miss the allowed RMSE or break a limit, each by name and with the reason.
    others: Vec<String>,
    /// The entries of `others` whose schemes were left out because a simulated drone flew badly with them. All channels
    /// have the same entries here.
    #[serde(skip)]
    unflown: Vec<String>,
    /// Whether the search for good settings of a scheme in `reaching` was cut short, by the time limit or by the user.
    is_cut_short: bool,
    /// Largest latency that the control loop tolerates, in samples. `None` if the bandwidth of the loop is unknown.
    loop_latency: Option<f64>,
    /// The axis of an inertial sensor that the channel is, if its unit is known.
    #[serde(skip)]
    inertial: Option<Inertial>,
    /// Whether no scheme may be coarser on this channel than it flew: in a control loop, on an axis of an inertial
    /// sensor, without an RMSE of the user's.
    #[serde(skip)]
    stays_as_flown: bool,
    /// Bytes a second that the raw samples take in lean frames.
    raw_bytes_per_second: Option<f64>,
    #[serde(skip)]
    sample: SampleType,
    #[serde(skip)]
    core: String,
    /// Whether the request has several channels, which must all use the same scheme.
    #[serde(skip)]
    is_one_of_many: bool,
}

/// A filter before the encoder, with a corner frequency that the recording's sample rate allows.
#[derive(Clone, Copy)]
struct Filtered {
    filter: Filter,
    sample: SampleType,
    rate: f32,
    /// Delay that the filter adds to slow signals, in samples.
    delay: f64,
}

impl Filtered {
    /// Prepares a filter for a signal of `rate` samples a second. Returns `None` if the filter's corner frequency is
    /// not possible at this rate.
    fn new(filter: Filter, sample: SampleType, rate: f64) -> Option<Self> {
        let rate = rate as f32;
        drop(filter.start(sample, rate).ok()?);
        let delay = filter.delay(rate).ok()?;
        Some(Self { filter, sample, rate, delay: delay.into() })
    }

    fn start(&self) -> Filtering {
        // `new` has checked that the filter can start.
        self.filter.start(self.sample, self.rate).unwrap_or_else(|_| Box::new(|sample| sample))
    }
}

/// A recording as a scheme's encoder gets it, behind its filter, with limits on the scheme's settings.
struct Ready<'a> {
    scheme: Scheme,
    /// The samples before the filter.
    samples: &'a Recording,
    /// The samples behind the filter, if there is one.
    filtered: Option<Recording>,
    limits: Limits,
    /// The parameters that flew, and their errors on this recording. `None` if the scheme did not fly, or if the unit of
    /// the recording is unknown.
    flown: Option<(Asked, Errors)>,
}

impl Ready<'_> {
    fn recording(&self) -> &Recording {
        self.filtered.as_ref().unwrap_or(self.samples)
    }
}

/// The errors of decoded values beside a recording.
#[derive(Clone, Copy, Debug)]
struct Errors {
    /// Root mean square of all errors.
    rmse: f64,
    /// Root mean square of the errors without the largest twentieth of them: those where the signal jumps farther than
    /// the spikes of a sample reach.
    usual: f64,
}

impl Errors {
    fn of(recording: &Recording, decoded: &[f64]) -> Self {
        const LEFT_OUT: usize = 20;
        let errors = recording.values.iter().zip(decoded);
        let mut squares: Vec<f64> =
            errors.map(|(value, decoded)| (value - decoded).powi(2)).collect();
        squares.sort_by(f64::total_cmp);
        let usual = &squares[..squares.len() - squares.len() / LEFT_OUT];
        Self { rmse: root_mean(&squares), usual: root_mean(usual) }
    }

    /// Returns whether these errors are no larger than `others`, all of them and the usual ones.
    fn are_within(self, others: Self) -> bool {
        /// Errors of the same settings may differ by their rounding.
        const SAME: f64 = 1.0 + 1e-9;
        self.rmse <= others.rmse * SAME && self.usual <= others.usual * SAME
    }
}

fn root_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// The outcome of tuning one scheme on one channel.
enum Tuning {
    /// Settings that reach the allowed RMSE and keep all limits.
    Reached(Box<Candidate>),
    /// The reason that the scheme is excluded: a text to be put after the scheme's name.
    Missed(String),
}

#[derive(Debug, Serialize)]
struct Candidate {
    link_bytes_per_second: Option<f64>,
    /// Whether the parameters are those with which the simulated drone flew.
    is_as_flown: bool,
    /// Largest RMSE that was allowed.
    max_rmse: f64,
    /// RMSE of the whole recording beside the samples before the filter.
    rmse_of_samples: f64,
    #[serde(flatten)]
    row: Row,
    #[serde(skip)]
    scheme: Option<Scheme>,
}

/// Describes each recording, tunes all schemes on it, and ranks the schemes that suit the recording.
///
/// # Errors
/// Returns an error if a field of the request is invalid, or if a recording is too short to be cut into a part for
/// tuning and a held-out part.
pub fn advise(request: &AdviseRequest, watch: &Watch) -> Result<Vec<Advice>> {
    if request.evaluations == 0 {
        return Err(RequestKind::NotAboveZero.of(Given::new("evaluations", 0)));
    }
    let most = flown::LOSSES[flown::LOSSES.len() - 1];
    if !(0.0..=most).contains(&request.frame_loss) {
        return Err(RequestKind::NotFlown { most }.of(Given::new("frame_loss", request.frame_loss)));
    }
    costs::core(&request.core)?;
    request.check_rmse()?;
    let end = request.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    let schemes: Vec<Scheme> = Scheme::all().collect();
    let searches = schemes.len() * request.recordings.len();
    let mut before = 0;
    let mut all = Vec::new();
    for (channel, recording) in request.recordings.iter().enumerate() {
        let mut advice = Advice::new(request, channel, recording)?;
        for &scheme in &schemes {
            let words = format!("{} {}", recording.name, scheme.name());
            let tick = |evaluated: usize, _: Option<&_>| {
                let done = before * request.evaluations + evaluated;
                let total = searches * request.evaluations;
                (watch.tell)(&Progress { done, total, words: words.clone() });
            };
            tick(0, None);
            let budget = Budget {
                evaluations: request.evaluations,
                deadline: share(end, searches - before),
                is_stopped: watch.is_stopped,
                tick: &tick,
            };
            if advice.objection.is_none() {
                advice.consider(request, scheme, recording, &budget)?;
            }
            before += 1;
        }
        advice.rank();
        all.push(advice);
    }
    Ok(all)
}

impl Advice {
    /// Returns the advised scheme and its settings, if there is one.
    pub fn best(&self) -> Option<(Scheme, &Row)> {
        let best = self.reaching.first()?;
        Some((best.scheme?, &best.row))
    }

    /// Returns the filter before the advised scheme's encoder, behind which its settings were searched.
    pub fn best_filter(&self) -> Option<Filter> {
        let (scheme, _) = self.best()?;
        Some(self.filter(scheme, self.sample)?.filter)
    }

    fn new(request: &AdviseRequest, channel: usize, recording: &Recording) -> Result<Self> {
        /// Default of the allowed RMSE, as a share of the signal's standard deviation. The share gives a
        /// signal-to-noise ratio of 14 dB.
        const PART: f64 = 0.2;
        recording.steady_rate()?;
        let look = ChannelSummary::of(recording);
        let objection = look.objection().filter(|_| look.verdict != Verdict::Clipped);
        let lean = Lean { channels: 1, sample: request.sample };
        let loop_latency = match (request.loop_bandwidth, recording.rate) {
            (None, _) => None,
            (Some(bandwidth), Some(rate)) if bandwidth * FEWEST > rate => {
                let kind = RequestKind::TooFast {
                    most: short(rate / FEWEST),
                    recording: recording.name.clone(),
                    rate: short(rate),
                    fewest: FEWEST,
                };
                return Err(kind.of(Given::new("loop_bandwidth", bandwidth)));
            }
            (Some(bandwidth), Some(rate)) if bandwidth > 0.0 => Some(borne(bandwidth, rate)),
            (Some(_), None) => {
                let kind = RequestKind::NeedsRate { recording: recording.name.clone() };
                return Err(kind.of(Given::named("loop_bandwidth")));
            }
            (Some(bandwidth), _) => {
                return Err(RequestKind::NotAboveZero.of(Given::new("loop_bandwidth", bandwidth)));
            }
        };
        let inertial = Inertial::of(recording);
        let stays_as_flown =
            loop_latency.is_some() && request.max_rmse.is_empty() && inertial.is_some();
        let rest = inertial.as_ref().and_then(|axis| look.rest(axis));
        // At rest, a fifth of the deviation is a part of the noise: what flew is fine enough.
        let (objection, warning) = match (objection, rest) {
            (None, rest) if stays_as_flown => (rest, None),
            (None, rest) => (None, rest),
            (objection, _) => (objection, None),
        };
        Ok(Self {
            objection,
            warning,
            loop_latency,
            inertial,
            stays_as_flown,
            max_rmse: request.rmse(channel).unwrap_or(PART * look.deviation),
            reaching: Vec::new(),
            others: Vec::new(),
            unflown: Vec::new(),
            is_cut_short: false,
            raw_bytes_per_second: recording.rate.map(|rate| lean.bytes_per_second(rate)),
            is_one_of_many: request.recordings.len() > 1,
            sample: request.sample,
            core: costs::core(&request.core).unwrap_or_default(),
            look,
        })
    }

    /// Tunes a scheme briefly, and decides whether it suits the recording. A scheme that suits is added to `reaching`,
    /// with its settings. A scheme that does not suit is added to `others`, with the reason.
    ///
    /// If a loop bandwidth is given, a scheme with which a simulated drone flew badly is not tuned. Such a scheme is
    /// added to `unflown` and to `others`.
    fn consider(
        &mut self,
        request: &AdviseRequest,
        scheme: Scheme,
        recording: &Recording,
        budget: &Budget,
    ) -> Result<()> {
        let objection = match self.loop_latency {
            Some(_) => flown::objection(scheme.name(), request.frame_loss, self.look.rate),
            None => None,
        };
        if let Some(words) = objection {
            self.unflown.push(format!("{} {words}", scheme.name()));
            self.others.extend(self.unflown.last().cloned());
            return Ok(());
        }
        match self.tuned(request, scheme, recording, &self.anchored(scheme), budget)? {
            Tuning::Reached(candidate) => {
                self.is_cut_short |= candidate.row.is_cut_short;
                self.reaching.push(*candidate);
            }
            Tuning::Missed(words) => self.others.push(format!("{} {words}", scheme.name())),
        }
        Ok(())
    }

    /// Tunes a scheme within `budget`. The parameters in `fixed` keep their values.
    ///
    /// If no scheme may be coarser than it flew, the parameters that flew are taken if they come near enough. Otherwise
    /// settings as fine are searched: first with the numbers that flew, such as the threshold, then with the counts, then
    /// with neither.
    fn tuned(
        &self,
        request: &AdviseRequest,
        scheme: Scheme,
        recording: &Recording,
        fixed: &Asked,
        budget: &Budget,
    ) -> Result<Tuning> {
        let ready = match self.ready(request, scheme, recording) {
            Ok(ready) => ready,
            Err(error) => {
                return Ok(Tuning::Missed(format!("cannot code it as it flew: {error}")));
            }
        };
        if let Some((asked, _)) = ready.flown.as_ref().filter(|_| self.stays_as_flown) {
            let (mut numbers, mut counts) = (asked.clone(), asked.clone());
            for parameter in scheme.info().parameters {
                let others =
                    if parameter.kind == Kind::Number { &mut counts } else { &mut numbers };
                others.unset(parameter.name);
            }
            let bound = self.bound(&ready);
            // A log that jumps farther than any flight, as in a crash, needs more spikes a sample.
            for flown in [asked, &numbers, &counts] {
                let own = fixed.or(flown);
                let searched = self.searched(request, &ready, &own, bound, budget)?;
                if let Tuning::Reached(mut own) = searched {
                    own.is_as_flown = flown == asked && fixed.or(asked) == *asked;
                    return Ok(Tuning::Reached(own));
                }
            }
        }
        self.searched(request, &ready, fixed, self.max_rmse, budget)
    }

    /// Returns the largest RMSE with which the parameters that flew are taken. Those of the bank that flew in every loop
    /// are fine enough in any case, as a drone flew with them as well as on samples; the blocks on which they are scored
    /// may have more error than the whole.
    fn bound(&self, ready: &Ready) -> f64 {
        match &ready.flown {
            Some((_, errors)) if flown::is_every_loop(ready.scheme.name(), self.look.rate) => {
                self.max_rmse.max(MARGIN * errors.rmse)
            }
            _ => self.max_rmse,
        }
    }

    /// Filters a recording as the scheme's flights did, and finds the limits on the scheme's settings.
    ///
    /// # Errors
    /// Returns an error if the recording cannot be coded with the parameters that flew.
    fn ready<'a>(
        &self,
        request: &AdviseRequest,
        scheme: Scheme,
        samples: &'a Recording,
    ) -> Result<Ready<'a>> {
        let filter = self.filter(scheme, request.sample);
        let delay = filter.map_or(0.0, |own| own.delay);
        let borne = self.loop_latency.map(|borne| borne - delay);
        let latency = [request.max_latency, borne].into_iter().flatten().reduce(f64::min);
        let limits = Limits { latency, ..Limits::default() };
        let filtered = filter.map(|own| samples.filtered(|| own.start()));
        let mut ready = Ready { scheme, samples, filtered, limits, flown: None };
        if let Some(asked) = self.flown_parameters(scheme) {
            let trial = Trial::new(scheme, &asked, self.sample, ready.recording())?;
            let errors = Errors::of(ready.recording(), &trial.decoded);
            ready.flown = Some((asked, errors));
        }
        Ok(ready)
    }

    /// Returns the parameters with which the scheme flew on this channel, in the channel's unit. Returns `None` outside a
    /// control loop, if the channel's unit is unknown, or if the scheme did not fly.
    fn flown_parameters(&self, scheme: Scheme) -> Option<Asked> {
        self.loop_latency?;
        Some(self.anchored(scheme).or(&flown::parameters(
            scheme,
            self.inertial.as_ref()?,
            self.look.rate,
        )?))
    }

    /// Returns the parameters that every advice on a scheme has for this channel. On an axis of an inertial sensor a code with
    /// a baseline starts from 0, so that baselines are multiples of the threshold and do not depend on the first sample,
    /// which the rotors may shake. Other signals, such as a pressure, may lie too far from 0.
    fn anchored(&self, scheme: Scheme) -> Asked {
        let mut asked = Asked::default();
        if scheme.info().has_baseline() && self.inertial.is_some() {
            asked.set("start", 0.0);
        }
        asked
    }

    /// Searches for settings of a scheme within `budget`, whose RMSE is at most `max_rmse`. The parameters in `fixed` keep
    /// their values.
    fn searched(
        &self,
        request: &AdviseRequest,
        ready: &Ready,
        fixed: &Asked,
        max_rmse: f64,
        budget: &Budget,
    ) -> Result<Tuning> {
        let Ready { scheme, limits, flown, .. } = ready;
        let (scheme, recording) = (*scheme, ready.recording());
        let (train, held_out) = cut(recording, HoldOut { blocks: 10, part: 0.3 })?;
        let whole = Stretch::whole(recording);
        let cut = Cut { name: recording.name.clone(), train, held_out, whole };
        let known = (Goal::MostEfficient(max_rmse), limits, self.core.as_str());
        let problem = Problem::new(scheme, request.sample, fixed, &cut.train, known);
        let method = Method { seed: request.seed, free_taps: false, is_unchecked: false };
        let found = search(&problem, method, budget);
        let cut_short = if found.is_cut_short { ", its search cut short" } else { "" };
        let missed = |words: String| Ok(Tuning::Missed(words + cut_short));
        let Some(best) = &found.best else { return missed("cannot be built".to_owned()) };
        if !best.is_allowed() {
            let what = match best.excess.first() {
                Some(excess) if excess.limit == Limit::Latency => {
                    format!("has a latency of {} samples", best.costs.latency)
                }
                _ => format!(
                    "comes to {}, allowed {}, at the nearest of {} settings",
                    short(best.tally.rmse()),
                    short(max_rmse),
                    found.evaluated
                ),
            };
            let bounds = found.bounds.iter().map(|bound| format!(" ({})", bound.words()));
            return missed(what + &bounds.collect::<String>());
        }
        let row = Row::new(&problem, &cut, &found, best, None)?;
        if let Some(held_out) = row.held_out.filter(|own| own.rmse > MARGIN * max_rmse) {
            return missed(format!(
                "reaches {} where it is tuned only: {} on held-out blocks",
                short(max_rmse),
                short(held_out.rmse)
            ));
        }
        let slope = Slope::new(scheme, recording, &row.settings).filter(|own| own.part() > STEEP);
        if let Some(slope) = slope.filter(|_| self.loop_latency.is_some()) {
            return missed(format!("falls behind in a loop: {}", slope.words()));
        }
        let options = row.settings.to_asked(scheme.info());
        let trial = Trial::new(scheme, &options, problem.sample, recording)?;
        let errors = Errors::of(recording, &trial.decoded);
        if let Some((_, flown)) = flown.as_ref().filter(|_| self.stays_as_flown)
            && !errors.are_within(*flown)
        {
            return missed(format!(
                "is coarser than it flew at the nearest settings: {}, as it flew {}",
                short(errors.usual),
                short(flown.usual)
            ));
        }
        let link_bytes_per_second = match recording.rate.filter(|rate| period(*rate).is_ok()) {
            Some(rate) => {
                // One keyframe a second, as it suits a recorder: a loop's bank has more.
                let bytes = link_bytes(&trial, rate, rate.round() as u64)?;
                Some(bytes * rate / recording.values.len() as f64)
            }
            None => None,
        };
        let rmse_of_samples = Errors::of(ready.samples, &trial.decoded).rmse;
        let scheme = Some(scheme);
        let is_as_flown = false;
        Ok(Tuning::Reached(Box::new(Candidate {
            link_bytes_per_second,
            is_as_flown,
            max_rmse,
            rmse_of_samples,
            row,
            scheme,
        })))
    }

    /// Returns the unit of the channel, as a flight file has it; empty if it is unknown.
    fn unit(&self) -> String {
        let axis = self.inertial.as_ref().map(|own| own.unit.clone());
        axis.or_else(|| self.look.unit.clone()).unwrap_or_default()
    }

    /// Returns the low-pass filter that stood before the scheme's encoder in the simulated flights. Returns `None` if
    /// no loop bandwidth was given, if the flights had no filter, or if the recording's sample rate does not allow the
    /// filter's corner frequency.
    fn filter(&self, scheme: Scheme, sample: SampleType) -> Option<Filtered> {
        self.loop_latency?;
        let filter = flown::flown(scheme.name(), self.look.rate)?.filter()?;
        Filtered::new(filter, sample, self.look.rate?)
    }

    /// Returns whether a bank codes this channel as it flew, although its recording is unfit for tuning: it holds nothing
    /// but noise, or rests.
    fn is_coded_as_flown(&self) -> bool {
        let is_still = !matches!(
            self.look.verdict,
            Verdict::TooShort | Verdict::FullOfHoles | Verdict::Clipped
        );
        self.stays_as_flown && self.objection.is_some() && is_still
    }

    /// Returns the tuned settings of a scheme. Returns `None` if the scheme misses the allowed RMSE or breaks a limit.
    fn row(&self, scheme: Scheme) -> Option<&Row> {
        let own = self.reaching.iter().find(|own| own.scheme == Some(scheme));
        own.map(|own| &own.row)
    }

    /// Sorts the schemes by bytes a second, or by number of events if the sample rate is unknown. The lowest number
    /// comes first.
    fn rank(&mut self) {
        let cost =
            |one: &Candidate| one.link_bytes_per_second.unwrap_or(one.row.whole.spikes as f64);
        self.reaching.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    }

    /// Returns the reason that no scheme is advised.
    pub fn why_not(&self) -> String {
        self.objection.clone().unwrap_or_else(|| format!("{}: {}", self.look.name, self.none()))
    }

    /// Says that no scheme comes near enough.
    fn none(&self) -> String {
        let flown = if self.stays_as_flown { "as near as it flew and " } else { "" };
        format!("no scheme comes {flown}within an RMSE of {}", short(self.max_rmse))
    }

    /// Formats the advice as text for people.
    pub fn page(&self) -> String {
        let ChannelSummary {
            name, unit, samples, seconds, rate, jitter_ms, gaps, rejected, ..
        } = &self.look;
        let unit = unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
        let round = |value: f64| short((value * 1000.0).round() / 1000.0);
        let mut lines = vec![name.clone()];
        let time = seconds.zip(*rate).map_or(", no times".to_owned(), |(seconds, rate)| {
            format!(" in {} s, {} a second", round(seconds), round(rate))
        });
        let jitter = jitter_ms
            .map_or(String::new(), |jitter| format!(", jitter {} ms, {gaps} gaps", round(jitter)));
        let holes = if *rejected > 0 { format!(", {rejected} missing") } else { String::new() };
        lines.push(format!("  {samples} samples{time}{jitter}{holes}"));
        let ChannelSummary {
            min, max, rest, resting, noise, bandwidth, clipped, deviation, ..
        } = &self.look;
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
        let objection = self.look.objection().or_else(|| self.objection.clone());
        for words in [&objection, &self.warning].into_iter().flatten() {
            lines.push(format!("  ! {words}"));
        }
        if self.is_coded_as_flown() {
            lines.push("  a bank codes it as it flew".to_owned());
        }
        if let Some(latency) = self.loop_latency {
            lines.push(format!(
                "  the loop bears a latency of {latency} samples, {PHASE}° at its bandwidth"
            ));
        }
        if let Some(best) = self.reaching.first() {
            lines.extend(self.reasons(best));
        } else if self.objection.is_none() {
            lines.push("  ".to_owned() + &self.none());
        }
        // With several channels, the page of the bank lists the schemes that did not fly, and the channels' pages leave
        // them out.
        let is_told = |own: &&String| !self.is_one_of_many || !self.unflown.contains(own);
        let others: Vec<&str> = self.others.iter().filter(is_told).map(String::as_str).collect();
        if !others.is_empty() {
            lines.push(format!("  not: {}", others.join("; ")));
        }
        if self.is_cut_short {
            lines.push(format!("  ! {CUT_SHORT}"));
        }
        lines.join("\n") + "\n\n"
    }

    fn reasons(&self, best: &Candidate) -> Vec<String> {
        let Self { core, sample, .. } = self;
        let bytes = |one: &Candidate| {
            one.link_bytes_per_second.map_or("-".to_owned(), |bytes| format!("{bytes:.1}"))
        };
        let Candidate { row, .. } = best;
        let held_out =
            row.held_out.map_or(String::new(), |own| format!(" ({} held out)", short(own.rmse)));
        let is_filtered = best.scheme.is_some_and(|own| self.filter(own, self.sample).is_some());
        let beside = if is_filtered {
            format!(" of the filtered signal, {} beside its samples", short(best.rmse_of_samples))
        } else {
            String::new()
        };
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
        let flown = if best.is_as_flown { ", with the parameters that flew" } else { "" };
        let take = if self.is_one_of_many { "alone" } else { "take" };
        // Every encoder starts from its own first sample, so that the log's first is no parameter to take.
        let entries = row.settings.entries().iter();
        let parameters: Vec<_> = entries.filter(|(key, _)| *key != "first").cloned().collect();
        let mut reasons = vec![
            format!("  {take} {} in {sample}: {}", row.scheme, brief(&parameters)),
            format!(
                "    RMSE {}{held_out}{beside}, {:.1} % of the samples without a spike, {} events a second",
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
                "    {} bytes a second on the link, where samples in frames of 4 bytes more take {raw}: the fewest of {} schemes that come near enough, this one within an RMSE of {}{flown}; {next}",
                bytes(best),
                self.reaching.len(),
                short(best.max_rmse)
            ),
        ];
        if let (Some(bytes), Some(raw)) = (best.link_bytes_per_second, self.raw_bytes_per_second)
            && bytes >= raw
        {
            reasons.push("    ! it saves no bytes beside the samples".to_owned());
        }
        if best.scheme.is_some_and(|scheme| scheme.info().drifts()) {
            reasons.push(format!("    ! {DRIFTS}"));
        }
        reasons
    }
}
