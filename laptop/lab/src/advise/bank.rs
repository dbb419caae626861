//! Advice on one scheme for all channels together. The schemes are ranked by bytes a second on the link.

use super::bytes::{Rival, Traffic, rivals, sent};
use super::flown::{self, Error, Flown, flown};
use super::{Advice, AdviseRequest, CUT_SHORT, Errors, Tuning};
use crate::Result;
use crate::brief::{brief, short};
use crate::flight::{CLOCK_PPM, Channel, Filter, Flight, Parts, period};
use crate::scheme::Scheme;
use crate::trial::{Recording, Trial};
use crate::tune::RequestKind;
use crate::tune::report::Row;
use crate::tune::search::Budget;
use crate::watch::{Progress, Watch};
use catalogue::run::{Asked, Value};
use catalogue::{Kind, Parameter, Search};
use serde::Serialize;
use spikewire::link::Transmitter;

/// Sample rate of the slowest control loop that the simulator flew, in Hz.
const SLOWEST: f64 = 250.0;

/// Default time between keyframes, in seconds. A receiver that joins late waits up to this long for a keyframe. If the
/// request has a control loop, a scheme whose simulated flights had keyframes keeps the time of those flights instead.
const KEYFRAMES: f64 = 1.0;

/// Time between keyframes of a code whose lost steps heal at the next event, in seconds. A receiver that joins late waits up
/// to this long.
const HEALING_KEYFRAMES: f64 = 0.5;

/// Low bits of a step number that an event of a step code carries, so that a loss of 7 net steps or fewer heals at the next
/// event.
const STEP_BITS: u8 = 4;

/// Reason that there is no bank, and what helps.
const NONE: &str = "no scheme suits all channels, for the reasons on their pages; fewer channels, a larger RMSE given for \
     each, or a recording of livelier flight may help";

/// Number of items in the smallest queue of the example firmware for a flight file. All events of a sample must fit, and
/// a keyframe of each channel.
const QUEUE: usize = 256;

/// The advice on all channels together.
#[derive(Debug, Serialize)]
pub struct BankAdvice {
    /// The schemes that can serve all channels, with their settings. The advised scheme comes first.
    banks: Vec<Bank>,
    /// The schemes that cannot serve all channels, each with the reason.
    others: Vec<String>,
    /// The names of the channels that are unfit for tuning, and that no bank has. The [`Advice`] on each such channel gives
    /// the reason.
    left_out: Vec<String>,
    /// The reasons that channels are left out.
    #[serde(skip)]
    reasons: Vec<String>,
    /// The names of the channels that are unfit for tuning, and therefore coded as they flew.
    as_flown: Vec<String>,
    /// The reason that no frame of the link can be sent at this sample rate, if there is one.
    unsent: Option<String>,
    /// Whether a search for settings was cut short, by the time limit or by the user.
    is_cut_short: bool,
    /// Questions that the advice leaves open, such as how the user's drone flies with the code.
    unknown: Vec<String>,
    /// Reasons not to trust what is advised on a channel.
    warnings: Vec<String>,
    /// Share of frames that the link loses, in percent.
    frame_loss: f64,
}

/// One scheme for all channels, with its settings and their cost on the link.
#[derive(Debug, Serialize)]
struct Bank {
    scheme: &'static str,
    /// Bytes a second on the link, including keyframes.
    bytes_per_second: f64,
    /// What could be sent in place of the code: the samples first.
    rivals: Vec<Rival>,
    /// Events a second, over all channels.
    events_per_second: f64,
    /// Number of samples from one keyframe to the next.
    keyframe_every: u32,
    /// Maximum number of events of a sample, over all channels.
    most_events: usize,
    /// Whether the scheme's simulated flights used a filter that the recordings' sample rate does not allow.
    lacks_filter: bool,
    /// What the simulated flights with this very bank came to at the requested frame loss. `None` if it did not fly.
    flown: Option<Error>,
    /// The same of flights of a minute.
    flown_minutes: Option<Error>,
    /// The conditions in which a drone was lost on this very bank, and not without a code.
    lost_in: &'static [String],
    /// Whether the scheme flew, with other settings than these.
    flew_otherwise: bool,
    /// The channels on which the bank is coarser than the one that flew.
    coarser: Vec<String>,
    /// Whether a search for settings that all channels can share was cut short.
    is_cut_short: bool,
    channels: Vec<BankChannel>,
    #[serde(skip)]
    flight: Flight,
}

#[derive(Debug, Serialize)]
struct BankChannel {
    name: String,
    unit: String,
    parameters: String,
    /// RMSE of the whole recording beside the signal behind the filter.
    rmse: f64,
    /// The same on held-out blocks. `None` if the channel was not tuned.
    held_out: Option<f64>,
    /// RMSE of the whole recording beside its samples, before the filter.
    rmse_of_samples: f64,
}

impl BankAdvice {
    /// Finds the schemes that suit every channel, apart from channels that are unfit for tuning. Ranks these schemes by
    /// the number of bytes that they send on the link.
    ///
    /// # Errors
    /// Returns an error if the sample rate is unknown, or if the sample period cannot be expressed in whole µs.
    pub fn new(request: &AdviseRequest, advice: &[Advice], watch: &Watch) -> Result<Self> {
        let pairs = || advice.iter().zip(&request.recordings);
        let heard: Vec<(&Advice, &Recording)> =
            pairs().filter(|(own, _)| own.objection.is_none() || own.is_coded_as_flown()).collect();
        let objected = || advice.iter().filter(|own| own.objection.is_some());
        let left_out = || objected().filter(|own| !own.is_coded_as_flown());
        let as_flown = objected().filter(|own| own.is_coded_as_flown());
        let mut all = Self {
            banks: Vec::new(),
            others: Vec::new(),
            left_out: left_out().map(|own| own.look.name.clone()).collect(),
            reasons: left_out().filter_map(|own| own.objection.clone()).collect(),
            as_flown: as_flown.map(|own| own.look.name.clone()).collect(),
            unsent: None,
            is_cut_short: heard.iter().any(|(own, _)| own.is_cut_short),
            unknown: Vec::new(),
            warnings: Vec::new(),
            frame_loss: request.frame_loss,
        };
        let Some((advised, first)) = heard.iter().find(|(own, _)| own.objection.is_none()) else {
            return Ok(all);
        };
        all.others.clone_from(&advised.unflown);
        let rate = first.rate.ok_or(RequestKind::BankNeedsRate)?;
        if let Err(error) = period(rate) {
            all.unsent = Some(error.to_string());
            return Ok(all);
        }
        all.unknown = unknown(request, rate, &heard);
        all.warnings = heard.iter().filter_map(|(own, _)| own.warning.clone()).collect();
        let schemes: Vec<Scheme> = Scheme::all().collect();
        for (done, scheme) in schemes.iter().enumerate() {
            let words = format!("bank of {}", scheme.name());
            (watch.tell)(&Progress { done, total: schemes.len(), words });
            match bank(request, *scheme, &heard, rate, watch)? {
                Ok(Some(bank)) => all.banks.push(bank),
                // The reason stands on the page of the channel that no setting suits.
                Ok(None) => {}
                Err(words) => all.others.push(format!("{} {words}", scheme.name())),
            }
        }
        all.is_cut_short |= all.banks.iter().any(|own| own.is_cut_short);
        all.banks.sort_by(|a, b| a.bytes_per_second.total_cmp(&b.bytes_per_second));
        Ok(all)
    }

    /// Returns the advised scheme and channels, in the form of a file `flight.toml`, of all channels.
    ///
    /// # Errors
    /// Returns the reason if no scheme is advised, or if a channel is left out.
    pub fn flight(&self) -> Result<&Flight, String> {
        if let Some(reason) = &self.unsent {
            return Err(reason.clone());
        }
        let Some(bank) = self.banks.first() else { return Err(NONE.to_owned()) };
        if !self.left_out.is_empty() {
            return Err(format!("its bank would lack channels: {}", self.reasons.join("; ")));
        }
        Ok(&bank.flight)
    }

    /// Returns the name of the advised scheme, if there is one.
    pub fn scheme(&self) -> Option<&'static str> {
        self.banks.first().map(|bank| bank.scheme)
    }

    /// Returns the comments for `flight.toml`. They say how the advice was found and what remains unknown.
    pub fn comments(&self) -> Vec<String> {
        self.lines().map(|line| line.trim_start().to_owned()).collect()
    }

    /// Formats the advice as text for people.
    pub fn page(&self) -> String {
        let mut text = "the bank\n".to_owned();
        for line in self.lines() {
            text = text + "  " + &line + "\n";
        }
        text + "\n"
    }

    fn lines(&self) -> impl Iterator<Item = String> {
        let mut lines = Vec::new();
        if let Some(best) = self.banks.first() {
            let shared = best.flight.shared.iter().map(|(name, value)| (name, value.clone()));
            let shared = brief(&shared.collect::<Vec<_>>());
            let with = if shared.is_empty() { String::new() } else { format!(" with {shared}") };
            lines.push(format!(
                "take {} for all channels, in {}{with}",
                best.scheme, best.flight.sample
            ));
            for channel in &best.channels {
                lines.push(format!("  {}", channel.words(best.flight.filter.is_some())));
            }
            lines.push(format!(
                "{:.0} events and {:.0} bytes a second, with a keyframe every {} samples; {} events a sample at most, \
                 which a queue must hold",
                best.events_per_second, best.bytes_per_second, best.keyframe_every, best.most_events
            ));
            lines.push(best.beside_rivals());
            if let Some(filter) = best.flight.filter {
                lines.push(format!("{} before the code: vibration takes spikes", words(filter)));
            }
            if best.lacks_filter {
                lines.push(format!(
                    "not known: how it flies without the low-pass that {} flew with, which does not fit the rate",
                    best.scheme
                ));
            }
            lines.extend(best.of_flights(self.frame_loss));
            if !best.coarser.is_empty() {
                lines.push(format!(
                    "not known: how any drone flies on it: coarser than what flew on {}",
                    best.coarser.join(", ")
                ));
            }
            let next = self.banks.iter().skip(1).take(3);
            let next = next.map(|own| format!("{} {:.0}", own.scheme, own.bytes_per_second));
            let next = next.collect::<Vec<_>>().join(", ");
            if !next.is_empty() {
                lines.push(format!("next: {next}"));
            }
        } else if let Some(reason) = &self.unsent {
            lines.push(format!("none: {reason}"));
        } else {
            lines.push(format!("none: {NONE}"));
        }
        lines.extend(self.warnings.iter().map(|words| format!("! {words}")));
        if self.is_cut_short {
            lines.push(format!("! {CUT_SHORT}"));
        }
        if !self.others.is_empty() {
            lines.push(format!("not: {}", self.others.join("; ")));
        }
        if !self.left_out.is_empty() {
            lines.push(format!("left out, as unfit for tuning: {}", self.left_out.join(", ")));
        }
        if !self.as_flown.is_empty() {
            let names = self.as_flown.join(", ");
            lines.push(format!("coded as it flew, as too still for tuning: {names}"));
        }
        lines.extend(self.unknown.iter().map(|words| format!("not known: {words}")));
        lines.into_iter()
    }
}

impl Bank {
    /// Says how a simulated drone flew on this very bank, if it did.
    fn of_flights(&self, frame_loss: f64) -> Vec<String> {
        let mut lines = Vec::new();
        let words = |own: &Error, long: &str| {
            format!(
                "in {} flights {long} a simulated drone strayed by {}° on this bank, without a code by {}°; {} lost",
                own.flights,
                short(own.coded),
                short(own.plain),
                own.lost
            )
        };
        if let Some(own) = &self.flown {
            lines.push(words(own, &format!("of 3 or 4 s with {frame_loss} % of the frames lost")));
        }
        if let Some(own) = &self.flown_minutes {
            lines.push(words(own, "of 60 s on Betaflight's loop with 1 % of the frames lost"));
        }
        if !self.lost_in.is_empty() {
            let all = self.lost_in.join(", ");
            lines.push(format!("it lost flights that samples did not lose: {all}"));
        }
        if self.flew_otherwise && self.coarser.is_empty() && !self.lacks_filter {
            lines.push(format!(
                "not known: how a drone flies on these settings: {} flew with others, no finer than these",
                self.scheme
            ));
        }
        lines
    }

    /// Says how many bytes its rivals take, and which of them take fewer than the code.
    fn beside_rivals(&self) -> String {
        let words = |own: &Rival| format!("{} would take {:.0}", own.name, own.bytes_per_second);
        let all = self.rivals.iter().map(words).collect::<Vec<_>>().join(", ");
        let line = format!("in frames of 4 bytes and the values, {all}");
        let is_better = |own: &&Rival| own.bytes_per_second <= self.bytes_per_second;
        let better: Vec<&str> =
            self.rivals.iter().filter(is_better).map(|own| own.name.as_str()).collect();
        if better.is_empty() {
            line
        } else {
            format!("{line}; the code saves no bytes beside {}", better.join(", nor beside "))
        }
    }
}

impl BankChannel {
    fn words(&self, is_filtered: bool) -> String {
        let Self { name, unit, parameters, rmse, held_out, rmse_of_samples } = self;
        let space = if unit.is_empty() { "" } else { " " };
        let held_out = held_out.map_or(String::new(), |own| format!(" ({} held out)", short(own)));
        let beside = if is_filtered {
            format!(" of the filtered signal, {} beside its samples", short(*rmse_of_samples))
        } else {
            String::new()
        };
        format!("{name}: {parameters}; RMSE {}{space}{unit}{held_out}{beside}", short(*rmse))
    }
}

/// Returns the channels whose unit is known. The others are among the open questions.
fn of_known_unit(mut names: Vec<String>, heard: &[(&Advice, &Recording)]) -> Vec<String> {
    names.retain(|name| {
        let is_unknown = |advice: &Advice| advice.inertial.is_none() && advice.look.name == *name;
        !heard.iter().any(|(advice, _)| is_unknown(advice))
    });
    names
}

/// Makes a bank: one scheme, with settings for all channels. Returns `Ok(Ok(None))` if no settings of the scheme suit a
/// channel, and `Ok(Err(reason))` if the channels cannot share the scheme.
fn bank(
    request: &AdviseRequest,
    scheme: Scheme,
    heard: &[(&Advice, &Recording)],
    rate: f64,
    watch: &Watch,
) -> Result<Result<Option<Bank>, String>> {
    let tuned = heard.iter().filter(|(own, _)| own.objection.is_none());
    let rows: Option<Vec<&Row>> = tuned.map(|(own, _)| own.row(scheme)).collect();
    let Some(rows) = rows else { return Ok(Ok(None)) };
    let in_loop = request.loop_bandwidth.is_some();
    let flown = flown(scheme.name(), Some(rate)).filter(|_| in_loop);
    let heals = scheme.info().has_baseline();
    let apart = apart(scheme, flown);
    let mut shared = shared(scheme, &rows, heard.len());
    let mut is_cut_short = false;
    let (mut parts, mut held_out) = (Vec::new(), Vec::new());
    for (advice, recording) in heard {
        let mut asked = match advice.row(scheme) {
            Some(row) => {
                held_out.push(row.held_out.map(|own| own.rmse));
                row.settings.to_asked(scheme.info())
            }
            // A channel that is unfit for tuning is coded as it flew.
            None => match advice.flown_parameters(scheme) {
                Some(asked) => {
                    held_out.push(None);
                    shared.or(&asked)
                }
                None => return Ok(Err(format!("did not fly, as {} needs", recording.name))),
            },
        };
        if shared.iter().any(|(name, value)| asked.get(name) != Some(value)) {
            let budget = Budget {
                evaluations: request.evaluations,
                deadline: None,
                is_stopped: watch.is_stopped,
                tick: &|_, _| (),
            };
            let fixed = shared.or(&advice.anchored(scheme));
            match advice.tuned(request, scheme, recording, &fixed, &budget)? {
                Tuning::Reached(own) => {
                    is_cut_short |= own.row.is_cut_short;
                    held_out.pop();
                    held_out.push(own.row.held_out.map(|own| own.rmse));
                    asked = own.row.settings.to_asked(scheme.info());
                }
                Tuning::Missed(words) => {
                    let name = &recording.name;
                    return Ok(Err(format!("cannot be shared by all channels: {name} {words}")));
                }
            }
        }
        shared.iter().for_each(|(name, _)| asked.unset(name));
        parts.push(Channel {
            name: recording.name.clone(),
            source: recording.source.clone(),
            unit: advice.unit(),
            counts: 1.0,
            asked,
        });
    }
    share_start(&mut parts, &mut shared);
    let flight = Flight::new(Parts {
        scheme: scheme.info(),
        sample: request.sample,
        period: period(rate)?,
        keyframe_every: (rate * apart).round().max(1.0) as u32,
        clock_ppm: CLOCK_PPM,
        step_bits: if heals { STEP_BITS } else { 0 },
        gathering: 0,
        full_every: Transmitter::FULL_EVERY,
        filter: heard[0].0.filter(scheme, request.sample).map(|own| own.filter),
        shared,
        channels: parts,
    });
    let flight = match flight {
        Ok(flight) => flight,
        Err(error) => return Ok(Err(format!("makes no bank: {error}"))),
    };
    let Judged { trials, encoded, channels, coarser } =
        judged(request, scheme, heard, &flight, held_out)?;
    let lacks_filter = flown.is_some_and(|own| own.filter().is_some()) && flight.filter.is_none();
    let is_as_flown = flown.is_some_and(|flown| is_as_flown(scheme, heard, &flight, flown));
    let samples = heard.iter().map(|(_, own)| own.values.len()).min().unwrap_or_default() as u64;
    let Traffic { events, bytes } = sent(&flight, &trials, samples, in_loop)?;
    let seconds = samples as f64 / rate;
    Ok(Ok(Some(Bank {
        scheme: scheme.name(),
        bytes_per_second: bytes as f64 / seconds,
        rivals: rivals(&flight, &encoded, rate),
        events_per_second: events as f64 / seconds,
        keyframe_every: flight.keyframe_every,
        most_events: most_events(&flight),
        lacks_filter,
        flown: is_as_flown
            .then(|| flown::error(scheme.name(), Some(rate), request.frame_loss))
            .flatten(),
        flown_minutes: is_as_flown.then(|| flown::minutes(scheme.name(), Some(rate))).flatten(),
        lost_in: flown.filter(|_| is_as_flown).map_or(&[], Flown::lost_in),
        flew_otherwise: flown.is_some() && !is_as_flown,
        coarser: if in_loop { of_known_unit(coarser, heard) } else { Vec::new() },
        is_cut_short,
        channels,
        flight,
    })))
}

/// Returns the time between keyframes, in seconds. `flown` has the flights of the scheme in a control loop.
fn apart(scheme: Scheme, flown: Option<&Flown>) -> f64 {
    if scheme.info().has_baseline() {
        return HEALING_KEYFRAMES;
    }
    flown.and_then(Flown::keyframes).unwrap_or(KEYFRAMES)
}

/// Returns whether a flight file describes the very bank that flew: its six axes, parameters, filter, keyframes and step
/// numbers.
fn is_as_flown(
    scheme: Scheme,
    heard: &[(&Advice, &Recording)],
    flight: &Flight,
    flown: &Flown,
) -> bool {
    /// Groups of the channels that flew: turn rates, sideways forces, the force along the thrust.
    const GROUPS: [usize; 6] = [0, 0, 0, 1, 1, 2];
    /// Largest deviation of the time between keyframes, in samples, as it is rounded.
    const ROUNDING: f64 = 1.0;
    let axes = heard.iter().map(|(own, _)| own.inertial.as_ref().map(|axis| axis.group));
    let Some(mut groups) = axes.collect::<Option<Vec<usize>>>() else { return false };
    groups.sort_unstable();
    let apart = flown.keyframes().map(|own| own * 1e6 / f64::from(flight.period.get()));
    let is_apart =
        apart.is_some_and(|own| (own - f64::from(flight.keyframe_every)).abs() <= ROUNDING);
    let is_same_bank = groups == GROUPS
        && is_apart
        && flight.step_bits == flown.step_bits()
        && flight.filter == flown.filter();
    is_same_bank
        && heard.iter().zip(&flight.channels).all(|((own, _), channel)| {
            let asked = flight.asked(channel);
            own.flown_parameters(scheme).is_some_and(|flown| is_same(&flown, &asked))
        })
}

/// Returns whether `asked` has all values of `flown`. Numbers may differ by their rounding.
fn is_same(flown: &Asked, asked: &Asked) -> bool {
    const ROUNDING: f64 = 1e-6;
    flown.iter().all(|(name, value)| match (value, asked.get(name)) {
        (Value::Number(own), Some(Value::Number(other))) => {
            (own - other).abs() <= ROUNDING * own.abs()
        }
        (own, other) => other == Some(own),
    })
}

/// Moves the value from which all channels start to the shared parameters, if it is the same for all.
fn share_start(channels: &mut [Channel], shared: &mut Asked) {
    let Some(start) = channels.first().and_then(|own| own.asked.get("start")).cloned() else {
        return;
    };
    if channels.iter().all(|own| own.asked.get("start") == Some(&start)) {
        shared.set("start", start);
        for channel in channels {
            channel.asked.unset("start");
        }
    }
}

/// A bank's channels as they are coded: a trial of each, its words, and the names of those that are coarser than what flew.
struct Judged {
    trials: Vec<Trial>,
    /// The samples of each channel behind its filter.
    encoded: Vec<Vec<f64>>,
    channels: Vec<BankChannel>,
    coarser: Vec<String>,
}

/// Codes each channel with a flight's settings, and compares its error with that of the settings that flew.
fn judged(
    request: &AdviseRequest,
    scheme: Scheme,
    heard: &[(&Advice, &Recording)],
    flight: &Flight,
    held_out: Vec<Option<f64>>,
) -> Result<Judged> {
    let (mut trials, mut encoded) = (Vec::new(), Vec::new());
    let (mut channels, mut coarser) = (Vec::new(), Vec::new());
    for (((advice, recording), channel), held_out) in
        heard.iter().zip(&flight.channels).zip(held_out)
    {
        let ready = advice.ready(request, scheme, recording)?;
        let trial = Trial::new(scheme, &flight.asked(channel), flight.sample, ready.recording())?;
        let errors = Errors::of(ready.recording(), &trial.decoded);
        if ready.flown.as_ref().is_none_or(|(_, flown)| !errors.are_within(*flown)) {
            coarser.push(recording.name.clone());
        }
        let asked = channel.asked.iter().map(|(name, value)| (name, value.clone()));
        channels.push(BankChannel {
            name: recording.name.clone(),
            unit: channel.unit.clone(),
            parameters: brief(&asked.collect::<Vec<_>>()),
            rmse: errors.rmse,
            held_out,
            rmse_of_samples: Errors::of(recording, &trial.decoded).rmse,
        });
        trials.push(trial);
        encoded.push(ready.recording().values.clone());
    }
    Ok(Judged { trials, encoded, channels, coarser })
}

/// Returns the maximum number of events of a sample, over all channels.
fn most_events(flight: &Flight) -> usize {
    let spikes = flight.settings()[0].count("spikes", 1..=usize::MAX).unwrap_or(1);
    flight.events().max(flight.channels.len() * spikes)
}

/// Lists the questions that the advice leaves open, such as how the user's drone flies with the code.
fn unknown(request: &AdviseRequest, rate: f64, heard: &[(&Advice, &Recording)]) -> Vec<String> {
    let mut all = Vec::new();
    let with = |is_it: fn(&Advice) -> bool| {
        let names = heard.iter().filter(|(own, _)| is_it(own)).map(|(_, own)| own.name.as_str());
        names.collect::<Vec<_>>().join(", ")
    };
    let assumed = with(|own| own.inertial.as_ref().is_some_and(|axis| axis.is_assumed));
    let unnamed = with(|own| own.inertial.is_none());
    if request.loop_bandwidth.is_none() {
        all.push(
            "whether a control loop flies on it: given its bandwidth, codes that do not fly are left out"
                .to_owned(),
        );
    } else {
        all.push("how your drone flies on it: others flew, in a simulator".to_owned());
        if rate < SLOWEST {
            all.push(format!(
                "how a loop of {} samples a second flies: none slower than {SLOWEST} was flown",
                short(rate.round())
            ));
        }
    }
    if !assumed.is_empty() {
        all.push(format!(
            "the units of {assumed}: taken to be rad/s and m/s², as neither log nor name tells them; a name such as \
             gyro_x_dps or accel_z_g does"
        ));
    }
    if request.loop_bandwidth.is_some() && !unnamed.is_empty() {
        all.push(format!(
            "whether it is as fine as what flew, on {unnamed}: they are no axes in a known unit; an RMSE that the loop \
             bears would tell"
        ));
    }
    all.push("what this log did not do: faster turns, a harder landing, other rotors".to_owned());
    all.push("the sensor's counts: samples are in the log's unit, until `counts` and `sample` in the file say otherwise".to_owned());
    all
}

/// Describes a filter in words.
fn words(filter: Filter) -> String {
    match filter {
        Filter::FirstOrder { corner } => format!("a low-pass of first order at {corner} Hz"),
        Filter::LowPass { corner } => format!("a low-pass at {corner} Hz"),
        Filter::Notch { centre, q } => format!("a notch at {centre} Hz with q {q}"),
    }
}

/// Returns the parameters that all channels of a bank must share, each with one value. A parameter that is a count gets
/// the largest value among the channels; but the largest number of spikes of a sample is such that those of `channels`
/// channels fit a queue. Any other parameter gets the value of the first channel.
fn shared(scheme: Scheme, rows: &[&Row], channels: usize) -> Asked {
    let mut shared = Asked::default();
    let is_shared = |own: &&Parameter| own.is_recorded && own.kind != Kind::Number;
    for parameter in scheme.info().parameters.iter().filter(is_shared) {
        let values = rows.iter().filter_map(|row| row.settings.get(parameter.key()));
        let largest = |most: Option<Value>, own: &Value| match (&most, own) {
            (Some(Value::Count(known)), Value::Count(count)) if count > known => Some(own.clone()),
            (None, own) => Some(own.clone()),
            _ => most,
        };
        let value = match (values.fold(None, largest), parameter.search) {
            (Some(Value::Count(count)), Some(Search::Most(least, _))) => Some(Value::Count(
                count.min((QUEUE / channels).saturating_sub(1).max(least as usize) as u64),
            )),
            (value, _) => value,
        };
        if let Some(value) = value {
            shared.set(parameter.name, value);
        }
    }
    shared
}
