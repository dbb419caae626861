//! How codes flew in a simulated drone: the table of `docs/loop.md`, which `cargo xtask write loop` measures.

use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The page with the table; a link, so that source packages have it.
const PAGE: &str = include_str!("loop.md");

/// The mean error in degrees from which a code flies loosely.
const LOOSE: f64 = 8.0;

/// The time from keyframe to keyframe in the flights with lost frames, in seconds.
pub(crate) const KEYFRAMES: f64 = 0.02;

/// Samples a second in those flights.
pub(crate) const RATE: f64 = 500.0;

/// How a code flew.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Flown {
    /// The verdict on its flights by itself, in the table's words.
    verdict: String,
    /// Its flights with keyframes, by the percent of frames lost.
    lossy: Vec<Lossy>,
}

/// The flights of a code with keyframes, and with so many frames lost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Lossy {
    /// Percent of the frames that were lost.
    frames: f64,
    /// The mean error in degrees, unless all flights were lost.
    error: Option<f64>,
    /// Percent of the flights that were lost.
    flights: f64,
}

static FLOWN: LazyLock<BTreeMap<&str, Flown>> = LazyLock::new(|| table(PAGE));

/// The name of the flights without a code.
const CONTROL: &str = "without a code";

/// Percents of lost frames that were flown, from the lowest.
pub(crate) const LOSSES: [f64; 3] = [0.0, 1.0, 10.0];

/// How the scheme of this name flew; `None` if it was not flown.
pub(crate) fn flown(scheme: &str) -> Option<&'static Flown> {
    FLOWN.get(scheme)
}

/// The mean error of the same drone without a code, in degrees.
pub(crate) fn without_a_code() -> Option<f64> {
    flown(CONTROL)?.at(0.0)?.error
}

impl Flown {
    /// Says why it does not fly well at this percent of lost frames, if so.
    pub(crate) fn objection(&self, loss: f64) -> Option<String> {
        if self.verdict != "yes" {
            return Some(match self.verdict.trim_matches('*') {
                "no" => "does not fly".to_owned(),
                "loosely" => "flies loosely".to_owned(),
                "on keyframes" => "flies on its keyframes alone".to_owned(),
                not => not
                    .strip_prefix("not: ")
                    .map_or(format!("flies {not}"), |what| format!("loses {what}")),
            });
        }
        let Lossy { frames, error, flights } = *self.at(loss)?;
        if flights > 0.0 {
            return Some(format!(
                "loses {flights} % of its flights if {frames} % of the frames are lost"
            ));
        }
        error.filter(|error| *error >= LOOSE).map(|error| {
            format!("flies loosely, with {error}° of error, if {frames} % of the frames are lost")
        })
    }

    /// The flights with at least so many percent of the frames lost.
    pub(crate) fn at(&self, loss: f64) -> Option<&Lossy> {
        self.lossy.iter().find(|own| own.frames >= loss)
    }
}

impl Lossy {
    /// The mean error in degrees, unless all flights were lost.
    pub(crate) fn error(&self) -> Option<f64> {
        self.error
    }
}

/// The rows of a page's table of codes.
fn table(page: &'static str) -> BTreeMap<&'static str, Flown> {
    let cells = |line: &'static str| line.split('|').map(str::trim).collect::<Vec<_>>();
    let mut lines = page.lines().filter(|line| line.starts_with("| "));
    let Some(head) = lines.by_ref().map(cells).find(|head| head.get(1) == Some(&"code")) else {
        return BTreeMap::new();
    };
    let column = |name: &str| head.iter().position(|own| *own == name);
    let lossy = ["keyframes: error, °", "1 %: error", "10 %: error"].map(column);
    let row = |cells: Vec<&'static str>| -> Option<(&'static str, Flown)> {
        let name = cells.get(1)?.trim_matches('`');
        let verdict = (*cells.get(column("flies?")?)?).to_owned();
        let number = |place: usize| cells.get(place)?.parse::<f64>().ok();
        let lossy = LOSSES.into_iter().zip(lossy).map(|(frames, error)| {
            let error = error?;
            Some(Lossy { frames, error: number(error), flights: number(error + 1)? })
        });
        Some((name, Flown { verdict, lossy: lossy.collect::<Option<_>>()? }))
    };
    lines.map(cells).filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::{Flown, LOSSES, Lossy, flown, without_a_code};
    use crate::scheme::Scheme;

    #[test]
    fn every_scheme_has_flown() {
        for scheme in Scheme::all() {
            let own = flown(scheme.name()).unwrap_or_else(|| panic!("{}", scheme.name()));
            assert!(without_a_code().is_some_and(|error| error > 1.0));
            assert_eq!(own.lossy.iter().map(|own| own.frames).collect::<Vec<_>>(), LOSSES);
        }
    }

    #[test]
    fn what_does_not_fly_is_told() {
        let row = |verdict: &str, flown: [(Option<f64>, f64); 3]| Flown {
            verdict: verdict.to_owned(),
            lossy: LOSSES
                .into_iter()
                .zip(flown)
                .map(|(frames, (error, flights))| Lossy { frames, error, flights })
                .collect(),
        };
        let good = (Some(5.5), 0.0);
        for (own, loss, words) in [
            (row("yes", [good; 3]), 10.0, None),
            (row("loosely", [good; 3]), 0.0, Some("flies loosely")),
            (row("**no**", [good; 3]), 0.0, Some("does not fly")),
            (row("on keyframes", [good; 3]), 0.0, Some("flies on its keyframes alone")),
            (row("not: steps of 30°", [good; 3]), 0.0, Some("loses steps of 30°")),
            (row("yes", [good, good, (Some(6.0), 10.0)]), 1.0, None),
            (
                row("yes", [good, good, (Some(6.0), 10.0)]),
                2.0,
                Some("loses 10 % of its flights if 10 % of the frames are lost"),
            ),
            (
                row("yes", [good, (Some(11.5), 0.0), (None, 100.0)]),
                1.0,
                Some("flies loosely, with 11.5° of error, if 1 % of the frames are lost"),
            ),
        ] {
            assert_eq!(own.objection(loss).as_deref(), words, "{own:?}");
        }
    }
}
