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
    /// Flights of the reference drone and its controller, on a link that loses 1 % of the frames.
    here: Flights,
    /// Flights of the reference drone and its controller, on a link that loses 10 % of the frames.
    #[serde(rename = "every tenth frame lost")]
    tenth: Flights,
    /// Flights of several drones and controllers at several sample rates. A key names simulator, controller and rate.
    everywhere: BTreeMap<String, Flights>,
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

/// The mean attitude errors of a simulated drone, in degrees.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Error {
    /// Error of the flights with the code.
    pub(crate) coded: f64,
    /// Error of the flights without a code, in which the controller read the samples themselves.
    pub(crate) plain: f64,
}

static BANKS: LazyLock<BTreeMap<String, Flown>> = LazyLock::new(|| {
    serde_json::from_str::<Figures>(FIGURES).map(|figures| figures.banks).unwrap_or_default()
});

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

static PARAMETERS: LazyLock<BTreeMap<String, Found>> =
    LazyLock::new(|| serde_json::from_str(FOUND).unwrap_or_default());

/// Returns the verdict on the scheme named `scheme`, if it was flown.
pub fn verdict(scheme: &str) -> Option<Verdict> {
    let own = flown(scheme)?;
    Some(Verdict {
        objection: objection(scheme, LOSSES[0]),
        beside: without_a_code().and_then(|plain| own.beside(plain)),
        low_pass: own.low_pass,
        keyframe_ms: own.keyframe_ms,
        groups: PARAMETERS.get(scheme).map(|own| own.groups.clone()).unwrap_or_default(),
    })
}

/// Returns the parameters with which a scheme flew on this channel, in the unit of the log.
pub(crate) fn parameters(scheme: Scheme, channel: &Inertial) -> Option<Asked> {
    let group = PARAMETERS.get(scheme.name())?.groups.get(channel.group)?;
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

/// Returns the results of the simulated flights with the scheme named `scheme`. Returns `None` if there are no such
/// flights.
pub(crate) fn flown(scheme: &str) -> Option<&'static Flown> {
    BANKS.get(scheme)
}

/// Returns the reason not to fly the scheme named `scheme` on a link that loses `loss` percent of the frames; `None` if
/// the scheme is fit to fly.
pub(crate) fn objection(scheme: &str, loss: f64) -> Option<String> {
    let Some(own) = flown(scheme) else {
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
    let far = own.beside(without_a_code()?)?;
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

    /// Returns the mean errors of the flights with `loss` percent of the frames lost.
    pub(crate) fn error(&self, loss: f64) -> Option<Error> {
        let at = |own: &Self| {
            if loss > LOSSES[0] { own.tenth.error } else { own.here.error }
        };
        Some(Error { coded: at(self)?, plain: at(without_a_code()?)? })
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
    use super::{BANKS, LOSSES, flown, objection, parameters, verdict, without_a_code};
    use crate::scheme::Scheme;
    use crate::unit::Inertial;

    #[test]
    fn parameters_are_those_of_the_bank_in_the_unit_of_the_log() {
        let sod = Scheme::named("sod").unwrap();
        let of = |name| {
            let asked = parameters(sod, &Inertial::new(name, None, 1.0).unwrap()).unwrap();
            (asked.number("threshold").unwrap(), asked.get("spikes").cloned())
        };
        let (rad, spikes) = of("gyro_x");
        assert!((of("gyro_x_deg").0 / rad - 57.29578).abs() < 1e-4);
        assert_eq!(of("gyro_x_deg").1, spikes);
        assert!(of("accel_z").0 > of("accel_x").0);
    }

    #[test]
    fn a_scheme_without_objection_has_figures() {
        assert!(without_a_code().is_some());
        let flies = Scheme::all().filter(|own| objection(own.name(), LOSSES[0]).is_none());
        let mut count = 0;
        for scheme in flies {
            let own = flown(scheme.name()).unwrap();
            let error = own.error(LOSSES[1]).unwrap();
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

    #[test]
    fn each_flown_scheme_has_the_parameters_of_its_bank() {
        let own = verdict("sod").unwrap();
        assert_eq!((own.objection, own.low_pass, own.keyframe_ms), (None, Some(80.0), Some(200.0)));
        for scheme in Scheme::all().filter(|own| flown(own.name()).is_some()) {
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
        let words = objection("bernoulli", 1.0).unwrap();
        assert!(words.contains("not flown") || words.contains("lost "), "{words}");
        for (name, own) in BANKS.iter().filter(|(_, own)| !own.here.lost.is_empty()) {
            assert!(
                objection(name, 1.0).unwrap().starts_with("lost "),
                "{name} {:?}",
                own.here.lost
            );
        }
    }
}
