//! Advice on a recording: the character of each channel, and the scheme that suits it.

use crate::brief::{brief, short};
use crate::events::{Format, Item};
use crate::look::{Look, Verdict, known_unit};
use crate::scheme::Scheme;
use crate::steep::Steep;
use crate::trial::{Recording, Trial};
use crate::tune::problem::Limit;
use crate::tune::report::{Cut, DRIFTS, Row};
use crate::tune::search::{Budget, Method, search, share};
use crate::tune::stretch::{HoldOut, cut};
use crate::tune::{Goal, Limits, Problem, Stretch, costs};
use crate::watch::{Progress, Watch};
use anyhow::{Result, bail};
use catalogue::run::{Asked, SampleType};
use serde::Serialize;
use spikewire::{Event, Keyframe, Tick};
use std::time::{Duration, Instant};

/// The most phase that a code's latency may take from a control loop at its bandwidth, in degrees: a third of a margin of
/// 60°. In the flights of `docs/loop.md` codes that take 18° stray, and those that take 80° lose the drone.
const PHASE: f64 = 20.0;

/// The part of a log's samples at which step forward may fall behind. In those flights a threshold that does so at 0.9 %
/// flies, and one that does so at 3.9 % loses steps and flips.
const STEEP: f64 = 0.02;

/// Samples that a control loop takes in a period of its bandwidth at least. Two are Nyquist's, with which nobody controls
/// anything.
const FEWEST: f64 = 4.0;

/// The latency in samples that a loop of this bandwidth bears.
fn borne(bandwidth: f64, rate: f64) -> f64 {
    (PHASE / 360.0 * rate / bandwidth).floor()
}

/// Recordings and what a scheme may cost, for [`advise`].
pub struct AdviseRequest {
    /// The channels, each of which gets advice of its own.
    pub recordings: Vec<Recording>,
    /// Sample type of the codecs.
    pub sample: SampleType,
    /// The RMSE that the control loop bears, in the signal's unit; a fifth of the signal's deviation unless given.
    pub max_rmse: Option<f64>,
    /// Number of samples at most until a code comes out.
    pub max_latency: Option<f64>,
    /// The frequency up to which the control loop acts that is to fly on the code, in Hz, a quarter of the rate at most. Codes that are too late for it, or
    /// that fall behind the signal, are not advised.
    pub loop_bandwidth: Option<f64>,
    /// Core of the measured table that tells instructions.
    pub core: String,
    /// Number of settings of each scheme and channel to score, 1 or more.
    pub evaluations: usize,
    /// Seconds after which the search ends, which makes the advice depend on the machine's speed.
    pub seconds: Option<f64>,
    /// Seed of the search.
    pub seed: u64,
}

impl AdviseRequest {
    /// Settings of each scheme and channel to score unless said otherwise.
    pub const EVALUATIONS: usize = 300;

    /// Asks for advice on recordings, in `f32`, for a fifth of the deviation.
    pub fn new(recordings: Vec<Recording>) -> Self {
        Self {
            recordings,
            sample: SampleType::F32,
            max_rmse: None,
            max_latency: None,
            loop_bandwidth: None,
            core: "M4F".to_owned(),
            evaluations: Self::EVALUATIONS,
            seconds: None,
            seed: 1,
        }
    }
}

/// The advice on one channel.
#[derive(Debug, Serialize)]
pub struct Advice {
    look: Look,
    /// The reason that nothing is advised, if so.
    objection: Option<String>,
    max_rmse: f64,
    /// The schemes that reach it, the advised one first.
    reaching: Vec<Candidate>,
    /// The schemes that do not, each with the reason.
    others: Vec<String>,
    /// Whether a search ended before its budget of settings.
    is_cut_short: bool,
    /// The latency in samples that the control loop bears, if its bandwidth is known.
    loop_latency: Option<f64>,
    /// Bytes a second that raw samples would take on a wire.
    raw_bytes_per_second: Option<f64>,
    #[serde(skip)]
    sample: SampleType,
    #[serde(skip)]
    core: String,
}

#[derive(Debug, Serialize)]
struct Candidate {
    link_bytes_per_second: Option<f64>,
    #[serde(flatten)]
    row: Row,
    #[serde(skip)]
    scheme: Option<Scheme>,
}

/// Looks at each recording, tunes all schemes on it, and says which suits it.
///
/// # Errors
/// A recording is too short to hold something out, or there is no setting to score.
pub fn advise(request: &AdviseRequest, watch: &Watch) -> Result<Vec<Advice>> {
    if request.evaluations == 0 {
        bail!("`evaluations` 0 must be above 0");
    }
    costs::core(&request.core)?;
    let end = request.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    let schemes: Vec<Scheme> = Scheme::all().collect();
    let searches = schemes.len() * request.recordings.len();
    let mut before = 0;
    let mut all = Vec::new();
    for recording in &request.recordings {
        let mut advice = Advice::new(request, recording)?;
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
    /// The scheme advised and its settings, if there is one.
    pub fn best(&self) -> Option<(Scheme, &Row)> {
        let best = self.reaching.first()?;
        Some((best.scheme?, &best.row))
    }

    fn new(request: &AdviseRequest, recording: &Recording) -> Result<Self> {
        /// 14 dB.
        const PART: f64 = 0.2;
        let look = Look::at(recording);
        let objection = look.objection().filter(|_| look.verdict != Verdict::Clipped);
        let bytes = if matches!(request.sample, SampleType::Fixed16 { .. }) { 2.0 } else { 4.0 };
        let loop_latency = match (request.loop_bandwidth, recording.rate) {
            (None, _) => None,
            (Some(bandwidth), Some(rate)) if bandwidth * FEWEST > rate => bail!(
                "`loop_bandwidth` {bandwidth} must be {} or less: {} has {} samples a second, and a loop acts on {FEWEST} \
                 or more in a period of its bandwidth",
                short(rate / FEWEST),
                recording.name,
                short(rate)
            ),
            (Some(bandwidth), Some(rate)) if bandwidth > 0.0 => Some(borne(bandwidth, rate)),
            (Some(_), None) => bail!("`loop_bandwidth` needs the rate of {}", recording.name),
            (Some(bandwidth), _) => bail!("`loop_bandwidth` {bandwidth} must be above 0"),
        };
        Ok(Self {
            objection,
            loop_latency,
            max_rmse: request.max_rmse.unwrap_or(PART * look.deviation),
            reaching: Vec::new(),
            others: Vec::new(),
            is_cut_short: false,
            raw_bytes_per_second: recording.rate.map(|rate| rate * bytes),
            sample: request.sample,
            core: costs::core(&request.core).unwrap_or_default(),
            look,
        })
    }

    /// Tunes a scheme for a moment.
    fn consider(
        &mut self,
        request: &AdviseRequest,
        scheme: Scheme,
        recording: &Recording,
        budget: &Budget,
    ) -> Result<()> {
        /// A chance difference between blocks is no failure.
        const MARGIN: f64 = 1.25;
        let (train, held_out) = cut(recording, HoldOut { blocks: 10, part: 0.3 })?;
        let whole = Stretch::whole(recording);
        let cut = Cut { name: recording.name.clone(), train, held_out, whole };
        let latencies = [request.max_latency, self.loop_latency].into_iter().flatten();
        let limits = Limits { latency: latencies.reduce(f64::min), ..Limits::default() };
        let goal = Goal::MostEfficient(self.max_rmse);
        let core = self.core.clone();
        let known = (goal, &limits, core.as_str());
        let problem = Problem::new(scheme, request.sample, &Asked::default(), &cut.train, known);
        let method = Method { seed: request.seed, free_taps: false };
        let found = search(&problem, method, budget);
        self.is_cut_short |= found.is_cut_short;
        let Some(best) = &found.best else {
            self.others.push(format!("{} cannot be built", scheme.name()));
            return Ok(());
        };
        if !best.is_allowed() {
            let what = match best.excess.first() {
                Some(excess) if excess.limit == Limit::Latency => {
                    format!("has a latency of {} samples", best.costs.latency)
                }
                _ => format!(
                    "comes to {} at the nearest of {} settings",
                    short(best.tally.rmse()),
                    found.evaluated
                ),
            };
            let ends = found.ends.iter().map(|end| format!(" ({})", end.words()));
            let what = what + &ends.collect::<String>();
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
        let steep = Steep::new(scheme, recording, &row.settings).filter(|own| own.part() > STEEP);
        if let Some(steep) = steep.filter(|_| self.loop_latency.is_some()) {
            self.others.push(format!("in a loop {}", steep.words()));
            return Ok(());
        }
        let options = row.settings.to_asked(scheme.info());
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

    /// The reason that nothing is advised.
    pub fn why_not(&self) -> String {
        self.objection.clone().unwrap_or_else(|| {
            format!(
                "{}: no scheme comes within an RMSE of {}",
                self.look.name,
                short(self.max_rmse)
            )
        })
    }

    /// The advice as a page for people.
    pub fn page(&self) -> String {
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
        if let Some(latency) = self.loop_latency {
            lines.push(format!(
                "  the loop bears a latency of {latency} samples, {PHASE}° at its bandwidth"
            ));
        }
        if let Some(best) = self.reaching.first() {
            lines.extend(self.reasons(best));
        } else if self.objection.is_none() {
            lines.push(format!("  no scheme comes within an RMSE of {}", short(self.max_rmse)));
        }
        if !self.others.is_empty() {
            lines.push(format!("  not: {}", self.others.join("; ")));
        }
        if self.is_cut_short {
            lines.push(
                "  ! the search was cut short: what is advised depends on this machine's speed"
                    .to_owned(),
            );
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
        let mut reasons = vec![
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
        ];
        if best.scheme.is_some_and(|scheme| scheme.info().drifts()) {
            reasons.push(format!("    ! {DRIFTS}"));
        }
        reasons
    }
}

/// Bytes that all events take on the crate's link, in full frames, with a keyframe a second where a decoder needs them.
///
/// # Errors
/// The link cannot hold the rate or the events.
pub fn link_bytes(trial: &Trial, rate: f64) -> Result<f64> {
    let period = (1e6 / rate).round().max(1.0);
    let format: Format = format!("link,period={period}").parse()?;
    let mut writer = format.writer(true);
    let mut bytes: Vec<u8> = Vec::new();
    let tick = |sample: u64| Tick::from_micros((sample as f64 * period) as u64);
    let (mut next, every) = (0, rate.round().max(1.0) as u64);
    for event in &trial.events {
        while trial.scheme.info().has_first_value() && event.sample >= next {
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
