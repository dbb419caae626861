//! Temporal contrast (TBR).

use spikewire::temporal::TemporalContrast;

use crate::prelude::*;

/// Temporal contrast.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const FACTOR: f32 = 0.5;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "tbr",
        type_name: "TemporalContrast",
        title: "TBR",
        words: "temporal contrast (TBR)",
        good_for: "changes, as an event camera sees them; drifts",
        is_signed: true,
        steps: StepErrors::Drifting,
        is_drawn: true,
        colour: [0x3b, 0x6f, 0xb6],
        parameters: &[
            Parameter::new(
                "threshold",
                Kind::Number,
                Unit::Signal,
                "what the difference from the sample before must exceed, above 0",
            )
            .with_example("0.1")
            .searched(Search::Log(1e-5, 0.5)),
            Parameter::new(
                "factor",
                Kind::Number,
                Unit::None,
                "in the place of a threshold: the differences' mean and this many of their standard deviations",
            )
            .with_paper(Paper::Text("0.5"))
            .with_example("0.5")
            .unrecorded(),
            Parameter::new(
                "magnitudes",
                Kind::Flag,
                Unit::None,
                "with a factor: mean and deviation of the differences' magnitudes",
            )
            .unrecorded(),
            Parameter::new(
                "step",
                Kind::Text,
                Unit::Signal,
                "what the decoder adds for a spike, as a number or in thresholds, `2x`",
            )
            .with_default("1x")
            .with_paper(Paper::Text("2x"))
            .searched(Search::Thresholds(0.1, 20.0)),
            Parameter::START,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "temporal_contrast",
        scheme: "temporal::TemporalContrast<S>",
        shapes: &[&[]],
        made: &[
            Made {
                name: "init",
                words: "`threshold`: what the difference from the sample before must exceed; `step`: what the decoder adds for a spike; both above 0.",
                arguments: &[Argument::new("threshold", "S"), Argument::new("step", "S")],
                value: "temporal::TemporalContrast::try_new(threshold)?.try_with_step(step)",
                flies: None,
            },
            Made {
                name: "init_calibrated",
                words: "The threshold is the mean of the differences' magnitudes and `factor` of their standard deviations, and the decoder's step.",
                arguments: &[
                    Argument {
                        name: "calibration",
                        kind: "Calibration<S>",
                        flown: Flown::Calibration,
                    },
                    Argument::number("factor", "f32", FACTOR as f64),
                ],
                value: "temporal::TemporalContrast::from_magnitudes(&calibration, factor)",
                flies: Some("tbr"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = TemporalContrast::from_magnitudes(&channel.calibration, FACTOR)?;
        visitor.visit("tbr", Self::INFO.words, &scheme, TemporalContrast::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = TemporalContrast::from_magnitudes(&signal.calibration, 0.5)?;
        let threshold = scheme.threshold();
        visitor.steps("tbr", &scheme, scheme.step(), |signal, spikes| {
            transcribed(signal, threshold, spikes);
        })
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["temporal::TemporalContrast", "", "new({threshold}).with_step({step})"]);

    /// Makes settings; the threshold is given, or is a number of standard deviations of the signal's differences.
    fn resolve(asked: &Resolve) -> Result<Settings> {
        let threshold = match (asked.user("threshold"), asked.value("factor")?) {
            (Some(_), _) if asked.user("factor").is_some() => {
                let kind = ErrorKind::NotBoth { scheme: &Self::INFO, other: "threshold" };
                return Err(Error::of(Given::named("factor"), kind));
            }
            (Some(_), _) if asked.user("magnitudes").is_some() => {
                let kind = ErrorKind::GoesWith { other: "factor" };
                return Err(Error::of(Given::named("magnitudes"), kind));
            }
            (Some(_), _) => asked.number("threshold")?,
            (None, None) => return Err(asked.needs(&["factor", "threshold"])),
            (None, Some(factor)) => {
                let of_magnitudes = asked.user("magnitudes").is_some();
                let wrong = |kind| Error::of(Given::new("factor", &factor), kind);
                let calibrated = asked.known.calibrated;
                let factor = asked.number("factor")?;
                let threshold = calibrated.and_then(|own| own.threshold(factor, of_magnitudes));
                threshold.ok_or_else(|| wrong(ErrorKind::NotCalibrated))?.map_err(|error| {
                    wrong(ErrorKind::NoThreshold { error, takes_magnitudes: of_magnitudes })
                })?
            }
        };
        let step = asked.needed("step")?;
        let times = step.word().and_then(|word| word.strip_suffix('x')?.trim().parse::<f64>().ok());
        let times = times.filter(|times| times.is_finite());
        let step = match (times, step.number()) {
            (Some(times), _) => times * threshold,
            (None, Some(step)) => step,
            (None, None) => {
                let kind = ErrorKind::NeitherNumberNorThresholds;
                return Err(Error::of(Given::new("step", step), kind));
            }
        };
        let mut settings = Settings::default();
        settings.set("threshold", threshold);
        settings.set("step", step);
        asked.settle("start", &mut settings)?;
        Ok(settings)
    }

    fn needs_signal(asked: &Asked) -> Option<Needs> {
        asked.get("threshold").is_none().then(|| Needs::All(vec!["threshold"]))
    }

    costs!(TemporalContrast<S>, "tbr");

    fn outcomes(_: &Settings, pieces: &[Piece], _: (f64, f64), _: usize) -> Option<Outcomes> {
        let distances = |piece: &Piece| {
            let steps = piece.values.windows(2).map(|pair| pair[1] - pair[0]);
            [0.0].into_iter().chain(steps).collect()
        };
        let distances: Vec<Vec<f64>> = pieces.iter().map(distances).collect();
        Some(outcomes(pieces, &distances, true))
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let scheme = TemporalContrast::try_new(settings.signal("threshold")?)?;
        let scheme = scheme.try_with_step(settings.signal("step")?)?;
        visitor.visit_steps(scheme, TemporalContrast::START)
    }
}

/// Encodes by the paper's algorithm 6.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], threshold: S, spikes: &mut [i8]) {
    let threshold = threshold.into();
    for i in 1..input.len() {
        let difference = input[i].into() - input[i - 1].into();
        spikes[i] = if difference > threshold {
            1
        } else if difference < S::Wide::default() - threshold {
            -1
        } else {
            0
        };
    }
}
