//! Results of simulated flights with each code in the control loop. In the simulation, the rotors shake the sensor.
//! `cargo xtask write loop` measures the results, and `docs/loop.md` shows them.

use crate::flight::Filter;
use crate::scheme::Scheme;
use crate::unit::Inertial;
use catalogue::Unit;
use catalogue::run::{Asked, Value};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The results of the simulated flights, as JSON. `verdicts.json` is a symbolic link to the file of the same name in
/// `laptop/loop`, because a source package contains only files of its own directory.
const FIGURES: &str = include_str!("verdicts.json");

/// The parameters of the schemes in the simulated flights, as JSON. `banks.json` is a symbolic link to the file of the
/// same name in `laptop/loop`.
const FOUND: &str = include_str!("banks.json");

/// Parameters of send-on-delta with step numbers, on a grid through 0, as JSON. `numbered.json` is a symbolic link to the
/// file of the same name in `laptop/loop`.
const NUMBERED: &str = include_str!("numbered.json");

/// The results of flights with these parameters, some of which last a minute, as JSON. `minutes.json` is a symbolic link
/// to the file of the same name in `laptop/loop`.
const MINUTES: &str = include_str!("minutes.json");

/// The scheme of the bank in [`NUMBERED`] that flew in every loop, and the bank's name there.
const EVERY_LOOP: (&str, &str) = ("sod", "sod/numbered");

/// Smallest sample rate, in Hz, at which that bank is taken: the lowest one at which it flew with its filter is 500 Hz.
const FAST: f64 = 450.0;

/// Conditions in [`MINUTES`].
const HERE: &str = "here";
const TENTH: &str = "10 % lost";
const EVERYWHERE: &str = "everywhere";
const MINUTE: &str = "60 s on Betaflight's loop";
/// The reference drone and its controller, in [`MINUTES`].
const REFERENCE: &str = "RotorPy cascade 500";
/// The flights without a code, in [`MINUTES`].
const RAW: &str = "raw samples";

/// Largest attitude error with which a scheme counts as fit to fly, as a multiple of the error without a code.
/// Without a code, the controller reads the samples themselves.
const WITHIN: f64 = 1.2;

/// Shares of lost frames in the simulated flights, in percent, lowest first.
pub(crate) const LOSSES: [f64; 2] = [1.0, 10.0];

#[derive(Deserialize)]
struct Figures {
    banks: BTreeMap<String, Flown>,
}

/// Results of the simulated flights with a code, and the settings of these flights.
#[derive(Deserialize)]
pub(crate) struct Flown {
    /// Corner frequency of the low-pass before the code, in Hz; `None` without a low-pass.
    low_pass: Option<f32>,
    /// Time between keyframes, in ms; `None` if the code needs none.
    keyframe_ms: Option<f64>,
    /// Low bits of a step number that an event carried; 0 if it carried none.
    #[serde(default)]
    step_bits: u8,
    /// Flights of the reference drone and its controller, on a link that loses 1 % of the frames.
    here: Flights,
    /// Flights of the reference drone and its controller, on a link that loses 10 % of the frames.
    #[serde(rename = "every tenth frame lost")]
    tenth: Flights,
    /// Flights of several drones and controllers at several sample rates. A key names simulator, controller and rate.
    everywhere: BTreeMap<String, Flights>,
    /// Flights of a minute under Betaflight's controller; `None` if there were none.
    #[serde(skip)]
    minute: Option<Flights>,
    /// The conditions in which the drone was lost more often than without a code.
    #[serde(skip)]
    lost_in: Vec<String>,
}

#[derive(Deserialize)]
struct Flights {
    /// The manoeuvres in which the drone was lost, one entry for each lost flight.
    lost: Vec<String>,
    #[serde(rename = "flights")]
    count: usize,
    /// Mean attitude error in degrees; `None` if all flights were lost.
    error: Option<f64>,
}

/// Flights of one condition at one place, as [`MINUTES`] has them.
#[derive(Deserialize)]
struct Cell {
    /// The mean attitude error of each flight, in degrees; `None` if the drone was lost.
    errors: Vec<Option<f64>>,
}

/// Cells by condition and place.
type Cells = BTreeMap<String, BTreeMap<String, Cell>>;

impl Cell {
    fn lost(&self) -> usize {
        self.errors.iter().filter(|error| error.is_none()).count()
    }

    fn flights(&self) -> Flights {
        let errors: Vec<f64> = self.errors.iter().filter_map(|error| *error).collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        Flights {
            lost: vec![String::new(); self.lost()],
            count: self.errors.len(),
            error: (!errors.is_empty()).then_some((mean * 1e3).round() / 1e3),
        }
    }
}

/// What simulated flights on a bank came to, beside flights without a code.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Error {
    /// Mean attitude error of the flights with the code, in degrees.
    pub(crate) coded: f64,
    /// Mean attitude error of the flights without a code, in which the controller read the samples themselves.
    pub(crate) plain: f64,
    /// Number of flights with the code.
    pub(crate) flights: usize,
    /// Number of these flights in which the drone was lost.
    pub(crate) lost: usize,
}

static BANKS: LazyLock<BTreeMap<String, Flown>> = LazyLock::new(|| {
    serde_json::from_str::<Figures>(FIGURES).map(|figures| figures.banks).unwrap_or_default()
});

/// The flights of the bank that flew in every loop, and those without a code on the same links. `None` if a figure is
/// missing.
static FAST_BANK: LazyLock<Option<[Flown; 2]>> = LazyLock::new(|| {
    let settings: BTreeMap<String, Numbered> = serde_json::from_str(NUMBERED).ok()?;
    let cells: BTreeMap<String, Cells> = serde_json::from_str(MINUTES).ok()?;
    let numbered = settings.get(EVERY_LOOP.1)?;
    let raw = Numbered { low_pass: None, keyframe_ms: None, step_bits: 0 };
    let (own, plain) = (cells.get(EVERY_LOOP.1)?, cells.get(RAW)?);
    Some([numbered.flown(own, plain)?, raw.flown(plain, plain)?])
});

/// A bank of [`NUMBERED`].
#[derive(Deserialize)]
struct Numbered {
    low_pass: Option<f32>,
    keyframe_ms: Option<f64>,
    step_bits: u8,
}

impl Numbered {
    /// Returns the bank with its flights. `plain` are the flights without a code.
    fn flown(&self, cells: &Cells, plain: &Cells) -> Option<Flown> {
        let everywhere = cells.get(EVERYWHERE)?.iter();
        let mut lost_in = Vec::new();
        for (condition, places) in cells {
            let lost =
                |cells: &BTreeMap<String, Cell>| cells.values().map(Cell::lost).sum::<usize>();
            let count: usize = places.values().map(|cell| cell.errors.len()).sum();
            if lost(places) > plain.get(condition).map_or(0, lost) {
                lost_in.push(format!("{condition} ({} of {count})", lost(places)));
            }
        }
        Some(Flown {
            low_pass: self.low_pass,
            keyframe_ms: self.keyframe_ms,
            step_bits: self.step_bits,
            here: cells.get(HERE)?.get(REFERENCE)?.flights(),
            tenth: cells.get(TENTH)?.get(REFERENCE)?.flights(),
            everywhere: everywhere.map(|(place, cell)| (place.clone(), cell.flights())).collect(),
            minute: cells.get(MINUTE).and_then(|own| Some(own.values().next()?.flights())),
            lost_in,
        })
    }
}

/// The outcome of the simulated flights with a scheme, and the settings of these flights.
#[derive(Debug, Serialize)]
pub struct Verdict {
    /// The reason not to fly the scheme on a link that loses 1 % of the frames. `None` if the scheme is fit to fly.
    pub objection: Option<String>,
    /// Ratio of two attitude errors of the simulated drone: the error with the code, divided by the error without a
    /// code. The ratio is averaged over several drones and controllers. `None` if no drone has both errors.
    pub beside: Option<f64>,
    /// Corner frequency of the low-pass before the code, in Hz; `None` without a low-pass.
    pub low_pass: Option<f32>,
    /// Time between keyframes, in ms; `None` if the code needs none.
    pub keyframe_ms: Option<f64>,
    /// Parameters of the scheme for three groups of channels: turn rates (rad/s), sideways forces (m/s²), and the force
    /// along the thrust (m/s²).
    pub groups: Vec<serde_json::Value>,
}

/// The parameters of a scheme for each group of channels.
#[derive(Deserialize)]
struct Found {
    groups: Vec<serde_json::Value>,
}

static NUMBERED_PARAMETERS: LazyLock<BTreeMap<String, Found>> =
    LazyLock::new(|| serde_json::from_str(NUMBERED).unwrap_or_default());

static PARAMETERS: LazyLock<BTreeMap<String, Found>> =
    LazyLock::new(|| serde_json::from_str(FOUND).unwrap_or_default());

/// Returns the verdict on the scheme named `scheme`, if it was flown.
pub fn verdict(scheme: &str) -> Option<Verdict> {
    let own = flown(scheme, None)?;
    Some(Verdict {
        objection: objection(scheme, LOSSES[0], None),
        beside: without_a_code().and_then(|plain| own.beside(plain)),
        low_pass: own.low_pass,
        keyframe_ms: own.keyframe_ms,
        groups: PARAMETERS.get(scheme).map(|own| own.groups.clone()).unwrap_or_default(),
    })
}

/// Returns the parameters with which a scheme flew on this channel at this sample rate, in the unit of the log.
pub(crate) fn parameters(scheme: Scheme, channel: &Inertial, rate: Option<f64>) -> Option<Asked> {
    let found = if is_every_loop(scheme.name(), rate) {
        NUMBERED_PARAMETERS.get(EVERY_LOOP.1)?
    } else {
        PARAMETERS.get(scheme.name())?
    };
    let group = found.groups.get(channel.group)?;
    let mut asked = Asked::default();
    for (name, value) in group.as_object()? {
        let parameter = scheme.info().parameter(name)?;
        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let value = match parameter.read(&text).ok()? {
            Value::Number(number) if parameter.unit == Unit::Signal => {
                Value::Number(number * channel.per_si)
            }
            value => value,
        };
        asked.set(parameter.name, value);
    }
    Some(asked)
}

fn without_a_code() -> Option<&'static Flown> {
    BANKS.get("without a code")
}

/// Returns whether the bank that flew in every loop is the one of this scheme at this sample rate.
pub(crate) fn is_every_loop(scheme: &str, rate: Option<f64>) -> bool {
    scheme == EVERY_LOOP.0 && rate.is_some_and(|rate| rate >= FAST) && FAST_BANK.is_some()
}

/// Returns the results of the simulated flights with the scheme named `scheme`, with the bank that is taken at this sample
/// rate. Returns `None` if there are no such flights.
pub(crate) fn flown(scheme: &str, rate: Option<f64>) -> Option<&'static Flown> {
    if is_every_loop(scheme, rate) {
        return FAST_BANK.as_ref().map(|[own, _]| own);
    }
    BANKS.get(scheme)
}

/// Returns the flights without a code with which those of a scheme are compared.
fn plain(scheme: &str, rate: Option<f64>) -> Option<&'static Flown> {
    if is_every_loop(scheme, rate) {
        return FAST_BANK.as_ref().map(|[_, plain]| plain);
    }
    without_a_code()
}

/// Returns what the flights with a scheme came to, with `loss` percent of the frames lost.
pub(crate) fn error(scheme: &str, rate: Option<f64>, loss: f64) -> Option<Error> {
    let own = flown(scheme, rate)?.at(loss);
    let plain = plain(scheme, rate)?.at(loss);
    Some(Error { coded: own.error?, plain: plain.error?, flights: own.count, lost: own.lost.len() })
}

/// Returns what the flights of a minute came to, if the bank flew for so long.
pub(crate) fn minutes(scheme: &str, rate: Option<f64>) -> Option<Error> {
    let own = flown(scheme, rate)?.minute.as_ref()?;
    let plain = plain(scheme, rate)?.minute.as_ref()?;
    Some(Error { coded: own.error?, plain: plain.error?, flights: own.count, lost: own.lost.len() })
}

/// Returns the reason not to fly the scheme named `scheme` on a link that loses `loss` percent of the frames; `None` if
/// the scheme is fit to fly.
pub(crate) fn objection(scheme: &str, loss: f64, rate: Option<f64>) -> Option<String> {
    let Some(own) = flown(scheme, rate) else {
        return Some("was not flown with rotors that shake the sensor".to_owned());
    };
    let missing = |cells: &[&Flights]| {
        let crashed: usize = cells.iter().map(|own| own.lost.len()).sum();
        (crashed > 0).then(|| (crashed, cells.iter().map(|own| own.count).sum::<usize>()))
    };
    let all: Vec<&Flights> = own.everywhere.values().chain([&own.here]).collect();
    if let Some((crashed, of)) = missing(&all) {
        return Some(format!(
            "lost {crashed} of {of} flights with {} % of its frames lost",
            LOSSES[0]
        ));
    }
    if loss > LOSSES[0]
        && let Some((crashed, of)) = missing(&[&own.tenth])
    {
        return Some(format!(
            "lost {crashed} of {of} flights with {} % of its frames lost",
            LOSSES[1]
        ));
    }
    let far = own.beside(plain(scheme, rate)?)?;
    (far > WITHIN)
        .then(|| format!("flew loosely: it strayed {far:.2} times as far as without a code"))
}

impl Flown {
    /// Returns the low-pass filter that preceded the encoder in the simulated flights, if there was one.
    pub(crate) fn filter(&self) -> Option<Filter> {
        self.low_pass.map(|corner| Filter::LowPass { corner })
    }

    /// Returns the time between keyframes in the flights, in seconds.
    pub(crate) fn keyframes(&self) -> Option<f64> {
        self.keyframe_ms.map(|own| own * 1e-3)
    }

    /// Returns the low bits of a step number that an event carried in the flights.
    pub(crate) fn step_bits(&self) -> u8 {
        self.step_bits
    }

    /// Returns the conditions in which the drone was lost more often than without a code.
    pub(crate) fn lost_in(&self) -> &[String] {
        &self.lost_in
    }

    /// Returns the flights of the reference drone with `loss` percent of the frames lost.
    fn at(&self, loss: f64) -> &Flights {
        if loss > LOSSES[0] { &self.tenth } else { &self.here }
    }

    /// Returns the mean ratio of this code's attitude error to the attitude error of the code `other`. The mean is over
    /// those entries of `everywhere` in which both codes have an attitude error. Returns `None` if there is no such
    /// entry.
    fn beside(&self, other: &Self) -> Option<f64> {
        let ratios = self
            .everywhere
            .iter()
            .filter_map(|(place, own)| Some(own.error? / other.everywhere.get(place)?.error?));
        let ratios: Vec<f64> = ratios.collect();
        (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / ratios.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::{BANKS, FAST, LOSSES, error, flown, minutes, objection, parameters, verdict};
    use crate::scheme::Scheme;
    use crate::unit::Inertial;

    #[test]
    fn parameters_are_those_of_the_bank_in_the_unit_of_the_log() {
        let sod = Scheme::named("sod").unwrap();
        let of = |name| {
            let axis = Inertial::new(name, None, 1.0).unwrap();
            let asked = parameters(sod, &axis, None).unwrap();
            (asked.number("threshold").unwrap(), asked.get("spikes").cloned())
        };
        let (rad, spikes) = of("gyro_x");
        assert!((of("gyro_x_deg").0 / rad - 57.29578).abs() < 1e-4);
        assert_eq!(of("gyro_x_deg").1, spikes);
        assert!(of("accel_z").0 > of("accel_x").0);
    }

    #[test]
    fn a_scheme_without_objection_has_figures() {
        let flies = Scheme::all().filter(|own| objection(own.name(), LOSSES[0], None).is_none());
        let mut count = 0;
        for scheme in flies {
            let own = flown(scheme.name(), None).unwrap();
            let error = error(scheme.name(), None, LOSSES[1]).unwrap();
            assert!(
                error.plain > 1.0 && error.coded < 3.0 * error.plain,
                "{} {error:?}",
                scheme.name()
            );
            assert!(own.keyframes().is_some_and(|own| (0.001..2.0).contains(&own)));
            count += 1;
        }
        assert!(count > 0 && count < BANKS.len(), "{count} of {}", BANKS.len());
    }

    /// At 500 Hz and above, the bank is the one that flew in every loop, with the figures of its own flights.
    #[test]
    fn a_fast_loop_has_the_bank_that_flew_everywhere() {
        let rate = Some(500.0);
        let own = flown("sod", rate).unwrap();
        assert_eq!((own.low_pass, own.keyframe_ms, own.step_bits), (Some(200.0), Some(500.0), 4));
        assert_eq!(own.everywhere.len(), 18);
        assert!(LOSSES.iter().all(|loss| objection("sod", *loss, rate).is_none()));
        let here = error("sod", rate, LOSSES[0]).unwrap();
        assert_eq!((here.coded, here.plain, here.flights, here.lost), (5.676, 5.6, 20, 0));
        let minutes = minutes("sod", rate).unwrap();
        assert_eq!((minutes.flights, minutes.lost), (12, 0));
        assert!(
            minutes.plain < minutes.coded && minutes.coded < 1.2 * minutes.plain,
            "{minutes:?}"
        );
        let bursts = own.lost_in.iter().any(|words| words == "1 % in bursts of 50 ms (2 of 10)");
        assert!(bursts, "{:?}", own.lost_in);
        let sod = Scheme::named("sod").unwrap();
        let axis = Inertial::new("gyro_x", None, 1.0).unwrap();
        let threshold = |rate| parameters(sod, &axis, rate).unwrap().number("threshold").unwrap();
        assert!((threshold(rate) / threshold(None) - 2.0).abs() < 1e-9);
        assert_eq!(flown("sod", Some(FAST - 1.0)).unwrap().low_pass, Some(80.0));
        assert_eq!(flown("position", rate).unwrap().step_bits, 0);
    }

    #[test]
    fn each_flown_scheme_has_the_parameters_of_its_bank() {
        let own = verdict("sod").unwrap();
        assert_eq!((own.objection, own.low_pass, own.keyframe_ms), (None, Some(80.0), Some(200.0)));
        for scheme in Scheme::all().filter(|own| flown(own.name(), None).is_some()) {
            let own = verdict(scheme.name()).unwrap();
            assert_eq!(own.groups.len(), 3, "{}", scheme.name());
            for name in own.groups[0].as_object().unwrap().keys() {
                assert!(scheme.info().parameter(name).is_some(), "{} {name}", scheme.name());
            }
        }
        assert!(verdict("bernoulli").is_none());
    }

    #[test]
    fn a_scheme_not_flown_or_lost_is_objected_to() {
        let words = objection("bernoulli", 1.0, None).unwrap();
        assert!(words.contains("not flown") || words.contains("lost "), "{words}");
        for (name, own) in BANKS.iter().filter(|(_, own)| !own.here.lost.is_empty()) {
            assert!(
                objection(name, 1.0, None).unwrap().starts_with("lost "),
                "{name} {:?}",
                own.here.lost
            );
        }
    }
}
