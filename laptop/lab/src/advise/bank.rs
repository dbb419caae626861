//! Advice on one scheme for all channels together. The schemes are ranked by bytes a second on the link.

use super::flown::{Error, Flown, flown};
use super::{Advice, AdviseRequest, Tuning};
use crate::Result;
use crate::brief::{brief, short};
use crate::flight::{CLOCK_PPM, Channel, Filter, Flight, Parts, period};
use crate::look::known_unit;
use crate::scheme::Scheme;
use crate::trial::{Recording, Trial};
use crate::tune::RequestKind;
use crate::tune::report::Row;
use crate::tune::search::Budget;
use crate::watch::{Progress, Watch};
use catalogue::run::{Asked, Event as Fired, Value};
use catalogue::{Kind, Parameter};
use serde::Serialize;
use spikewire::link::{MAX_FRAME, Session, Transmitter};
use spikewire::{Event, FromItems, Item, Keyframe, Tick};

/// Sample rate of the slowest control loop that the simulator flew, in Hz.
const SLOWEST: f64 = 250.0;

/// Default time between keyframes, in seconds. A receiver that joins late waits up to this long for a keyframe. If the
/// request has a control loop, a scheme whose simulated flights had keyframes keeps the time of those flights instead.
const KEYFRAMES: f64 = 1.0;

/// The advice on all channels together.
#[derive(Debug, Serialize)]
pub struct BankAdvice {
    /// The schemes that can serve all channels, with their settings. The advised scheme comes first.
    banks: Vec<Bank>,
    /// The schemes that cannot serve all channels, each with the reason.
    others: Vec<String>,
    /// The names of the channels that are unfit for tuning. The [`Advice`] on each such channel gives the reason.
    left_out: Vec<String>,
    /// Questions that the advice leaves open, such as how the user's drone flies with the code.
    unknown: Vec<String>,
    /// Share of frames that the link loses, in percent.
    frame_loss: f64,
}

/// One scheme for all channels, with its settings and their cost on the link.
#[derive(Debug, Serialize)]
struct Bank {
    scheme: &'static str,
    /// Bytes a second on the link, including keyframes.
    bytes_per_second: f64,
    /// Events a second, over all channels.
    events_per_second: f64,
    /// Number of samples from one keyframe to the next.
    keyframe_every: u32,
    /// Whether the scheme's simulated flights used a filter that the recordings' sample rate does not allow.
    lacks_filter: bool,
    /// Mean attitude error of the simulated drone at the requested frame loss, with and without the code. `None` if no
    /// flights with the code were simulated.
    flown: Option<Error>,
    channels: Vec<BankChannel>,
    #[serde(skip)]
    flight: Flight,
}

#[derive(Debug, Serialize)]
struct BankChannel {
    name: String,
    parameters: String,
    rmse: f64,
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
            pairs().filter(|(own, _)| own.objection.is_none()).collect();
        let objected = advice.iter().filter(|own| own.objection.is_some());
        let left_out = objected.map(|own| own.look.name.clone()).collect();
        let mut all = Self {
            banks: Vec::new(),
            others: Vec::new(),
            left_out,
            unknown: Vec::new(),
            frame_loss: request.frame_loss,
        };
        let Some((advised, first)) = heard.first() else { return Ok(all) };
        all.others.clone_from(&advised.unflown);
        let rate = first.rate.ok_or(RequestKind::BankNeedsRate)?;
        all.unknown = unknown(request, rate);
        let unnamed = heard.iter().filter(|(own, _)| own.flown.is_none());
        let unnamed: Vec<_> = unnamed.map(|(_, own)| own.name.as_str()).collect();
        if request.loop_bandwidth.is_some() && request.max_rmse.is_none() && !unnamed.is_empty() {
            all.unknown.push(format!(
                "whether it is as fine as what flew, on {}: their names tell no unit; an RMSE that the loop bears would tell",
                unnamed.join(", ")
            ));
        }
        let schemes: Vec<Scheme> = Scheme::all().collect();
        for (done, scheme) in schemes.iter().enumerate() {
            let words = format!("bank of {}", scheme.name());
            (watch.tell)(&Progress { done, total: schemes.len(), words });
            let rows: Option<Vec<&Row>> = heard.iter().map(|(own, _)| own.row(*scheme)).collect();
            // The reason stands on the page of the channel that no setting suits.
            let Some(rows) = rows else { continue };
            match bank(request, *scheme, &heard, &rows, rate, watch)? {
                Ok(bank) => all.banks.push(bank),
                Err(words) => all.others.push(format!("{} {words}", scheme.name())),
            }
        }
        all.banks.sort_by(|a, b| a.bytes_per_second.total_cmp(&b.bytes_per_second));
        Ok(all)
    }

    /// Returns the advised scheme and channels, in the form of a file `flight.toml`. Returns `None` if no scheme is
    /// advised.
    pub fn flight(&self) -> Option<&Flight> {
        self.banks.first().map(|bank| &bank.flight)
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
            for BankChannel { name, parameters, rmse } in &best.channels {
                lines.push(format!("  {name}: {parameters}; RMSE {}", short(*rmse)));
            }
            lines.push(format!(
                "{:.0} events and {:.0} bytes a second, with a keyframe every {} samples",
                best.events_per_second, best.bytes_per_second, best.keyframe_every
            ));
            if let Some(filter) = best.flight.filter {
                lines.push(format!("{} before the code: vibration takes spikes", words(filter)));
            }
            if best.lacks_filter {
                lines.push(format!(
                    "not known: how it flies without the low-pass that {} flew with, which does not fit the rate",
                    best.scheme
                ));
            }
            if let Some(Error { coded, plain }) = best.flown {
                lines.push(format!(
                    "on {} a simulated drone strayed by {}°, without a code by {}°, with {} % of its frames lost",
                    best.scheme,
                    short(coded),
                    short(plain),
                    self.frame_loss
                ));
            }
            let next = self.banks.iter().skip(1).take(3);
            let next = next.map(|own| format!("{} {:.0}", own.scheme, own.bytes_per_second));
            let next = next.collect::<Vec<_>>().join(", ");
            if !next.is_empty() {
                lines.push(format!("next: {next}"));
            }
        } else {
            lines.push("none: no scheme suits all channels".to_owned());
        }
        if !self.others.is_empty() {
            lines.push(format!("not: {}", self.others.join("; ")));
        }
        if !self.left_out.is_empty() {
            lines.push(format!("left out, as their pages say: {}", self.left_out.join(", ")));
        }
        lines.extend(self.unknown.iter().map(|words| format!("not known: {words}")));
        lines.into_iter()
    }
}

/// Makes a bank: one scheme, with settings for all channels. If the scheme cannot serve all channels, returns
/// `Ok(Err(reason))`.
fn bank(
    request: &AdviseRequest,
    scheme: Scheme,
    heard: &[(&Advice, &Recording)],
    rows: &[&Row],
    rate: f64,
    watch: &Watch,
) -> Result<Result<Bank, String>> {
    let in_loop = request.loop_bandwidth.is_some();
    let flown = flown(scheme.name()).filter(|_| in_loop);
    let apart = flown.and_then(Flown::keyframes).unwrap_or(KEYFRAMES);
    let shared = shared(scheme, rows);
    let mut channels = Vec::new();
    let mut parts = Vec::new();
    for ((advice, recording), row) in heard.iter().zip(rows) {
        let own = row.settings.to_asked(scheme.info());
        let has_shared = shared.iter().all(|(name, value)| own.get(name) == Some(value));
        let mut asked = own;
        let mut rmse = row.tuned_on.rmse;
        if !has_shared {
            let budget = Budget {
                evaluations: request.evaluations,
                deadline: None,
                is_stopped: watch.is_stopped,
                tick: &|_, _| (),
            };
            match advice.tuned(request, scheme, recording, &shared, &budget)? {
                Tuning::Reached(own) => {
                    asked = own.row.settings.to_asked(scheme.info());
                    rmse = own.row.tuned_on.rmse;
                }
                Tuning::Missed(words) => {
                    let name = &recording.name;
                    return Ok(Err(format!("cannot be shared by all channels: {name} {words}")));
                }
            }
        }
        shared.iter().for_each(|(name, _)| asked.unset(name));
        let parameters =
            brief(&asked.iter().map(|(name, value)| (name, value.clone())).collect::<Vec<_>>());
        channels.push(BankChannel { name: recording.name.clone(), parameters, rmse });
        parts.push(Channel {
            name: recording.name.clone(),
            source: recording.source.clone(),
            unit: known_unit(&recording.name).unwrap_or_default().to_owned(),
            counts: 1.0,
            asked,
        });
    }
    let flight = Flight::new(Parts {
        scheme: scheme.info(),
        sample: request.sample,
        period: period(rate)?,
        keyframe_every: (rate * apart).round().max(1.0) as u32,
        clock_ppm: CLOCK_PPM,
        filter: heard[0].0.filter(scheme, request.sample).map(|own| own.filter),
        shared,
        channels: parts,
    });
    let flight = match flight {
        Ok(flight) => flight,
        Err(error) => return Ok(Err(format!("makes no bank: {error}"))),
    };
    let (events, bytes) = sent(&flight, scheme, heard, in_loop)?;
    let seconds = heard[0].1.values.len() as f64 / rate;
    Ok(Ok(Bank {
        scheme: scheme.name(),
        bytes_per_second: bytes as f64 / seconds,
        events_per_second: events as f64 / seconds,
        keyframe_every: flight.keyframe_every,
        lacks_filter: flown.is_some_and(|own| own.filter().is_some()) && flight.filter.is_none(),
        flown: flown.and_then(|own| own.error(request.frame_loss)),
        channels,
        flight,
    }))
}

/// Lists the questions that the advice leaves open, such as how the user's drone flies with the code.
fn unknown(request: &AdviseRequest, rate: f64) -> Vec<String> {
    let mut all = Vec::new();
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
/// the largest value among the channels. Any other parameter gets the value of the first channel.
fn shared(scheme: Scheme, rows: &[&Row]) -> Asked {
    let mut shared = Asked::default();
    let is_shared = |own: &&Parameter| own.is_recorded && own.kind != Kind::Number;
    for parameter in scheme.info().parameters.iter().filter(is_shared) {
        let values = rows.iter().filter_map(|row| row.settings.get(parameter.key()));
        let largest = |most: Option<Value>, own: &Value| match (&most, own) {
            (Some(Value::Count(known)), Value::Count(count)) if count > known => Some(own.clone()),
            (None, own) => Some(own.clone()),
            _ => most,
        };
        if let Some(value) = values.fold(None, largest) {
            shared.set(parameter.name, value);
        }
    }
    shared
}

/// Returns the total number of events of all channels, and the number of bytes that the link sends, including
/// keyframes. If `in_loop` is true, each sample is sent in a frame of its own, as a control loop needs it. Otherwise,
/// events of several samples share a frame.
fn sent(
    flight: &Flight,
    scheme: Scheme,
    heard: &[(&Advice, &Recording)],
    in_loop: bool,
) -> Result<(usize, usize)> {
    let trials = heard.iter().zip(&flight.channels).map(|((advice, recording), channel)| {
        let filter = advice.filter(scheme, flight.sample);
        let recording = match &filter {
            Some(filter) => &recording.filtered(|| filter.start()),
            None => *recording,
        };
        Trial::new(scheme, &flight.asked(channel), flight.sample, recording)
    });
    let trials: Vec<Trial> = trials.collect::<Result<_>>()?;
    let (neurons, period) = (flight.neurons() as u16, u64::from(flight.period.get()));
    let mut events: Vec<Fired> = Vec::new();
    for (channel, trial) in (0..).zip(&trials) {
        let own = trial.events.iter();
        events.extend(own.map(|own| Fired { neuron: channel * neurons + own.neuron, ..*own }));
    }
    events.sort_by_key(|own| (own.sample, own.slot, own.neuron));
    let mut rest = &events[..];
    let mut transmitter = Transmitter::new(flight.coding(), Session::counted(0))
        .with_fingerprint(flight.fingerprint());
    let (mut items, mut bytes, mut buffer) = (Vec::new(), 0, [0; MAX_FRAME]);
    let samples = heard.iter().map(|(_, own)| own.values.len()).min().unwrap_or_default() as u64;
    for sample in 0..samples {
        let tick = Tick::from_micros(sample * period);
        let own = rest.iter().take_while(|own| own.sample <= sample).count();
        let (now, later) = rest.split_at(own);
        rest = later;
        items.extend(now.iter().map(|own| {
            let tick = tick + u32::from(own.slot) * flight.slot_ticks();
            Item::Event(Event { tick, address: own.neuron, polarity: own.polarity })
        }));
        if sample.is_multiple_of(flight.keyframe_every.into()) {
            if scheme.info().has_first_value() {
                items.extend((0..).zip(&trials).map(|(channel, trial)| {
                    let value = trial.decoded.get(sample as usize).copied().unwrap_or_default();
                    Item::Keyframe(Keyframe::new(tick, channel * neurons, value as f32))
                }));
            } else {
                items.push(Item::Heartbeat { tick, address: 0 });
            }
        }
        if in_loop || sample + 1 == samples {
            let mut source = FromItems(items.drain(..));
            while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer)? {
                bytes += frame.len();
            }
        }
    }
    Ok((events.len(), bytes))
}
