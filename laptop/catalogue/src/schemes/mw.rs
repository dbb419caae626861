//! Moving window (MW).

use spikewire::temporal::MovingWindow;

use crate::prelude::*;

/// Moving window.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; a threshold is a part of a channel's range.
const THRESHOLD: f64 = 0.02;
const SAMPLES: usize = 6;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "mw",
        type_name: "MovingWindow",
        title: "MW",
        words: "moving window (MW)",
        good_for: "changes against a short past; drifts",
        is_signed: true,
        steps: StepErrors::Drifting,
        is_drawn: true,
        colour: [0xe0, 0x85, 0x3a],
        parameters: &[
            Parameter::threshold("what the distance from the mean must exceed, above 0; the decoder's step", 0.25),
            Parameter::new(
                "window",
                Kind::Count,
                Unit::Samples,
                "samples of the running mean less one, as the paper counts: `5` takes 6; 0 to 16383",
            )
            .with_example("5")
            .of_encoder()
            .with_paper(Paper::Text("5"))
            .searched(Search::Whole(0, 127)),
            Parameter::START,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "moving_window",
        scheme: "temporal::MovingWindow<S, {0}>",
        shapes: &[&[SAMPLES]],
        made: &[Made {
            name: "init",
            words: "`threshold`: what the distance from the window's mean must exceed, above 0.",
            arguments: &[Argument::sample("threshold", Flown::Fraction(THRESHOLD))],
            value: "temporal::MovingWindow::try_new(threshold)",
            flies: Some("mw"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = MovingWindow::<_, SAMPLES>::try_new(channel.fraction(THRESHOLD))?;
        visitor.visit("mw", Self::INFO.words, &scheme, MovingWindow::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        window::<V, 6>("mw-5", signal, visitor)?;
        window::<V, 64>("mw-63", signal, visitor)
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    fn looks_back(asked: &Asked) -> usize {
        let window = asked.number("window").unwrap_or_default();
        (window as usize).min(dynamic::WIDEST - 1) + 1
    }

    fn ram<S: Sample>(settings: &Settings) -> Result<usize> {
        let sizes = [state::<MovingWindow<S, 8>>(), state::<MovingWindow<S, 16>>()];
        Ok(lengthened(sizes, settings.count("window", 0..=dynamic::WIDEST - 1)? + 1))
    }

    /// Returns the codec that stands for any window: a longer one takes no more work, as its sum is carried along.
    fn counted(_: &Settings) -> Result<Counted> {
        Ok(Counted::at_most("mw-5", 1.0))
    }

    fn outcomes(
        settings: &Settings,
        pieces: &[Piece],
        _: (f64, f64),
        _: usize,
    ) -> Option<Outcomes> {
        let samples = settings.count("window", 0..=dynamic::WIDEST - 1).ok()? + 1;
        let distances = |Piece { values, .. }: &Piece| -> Vec<f64> {
            // The first samples stand before themselves.
            let past = &values[..samples.min(values.len())];
            let mut sum: f64 = past.iter().sum();
            let leaving = past.iter().chain(values.iter());
            let distance = |(value, leaves): (&f64, &f64)| {
                let distance = value - sum / past.len() as f64;
                sum += value - leaves;
                distance
            };
            values.iter().zip(leaving).map(distance).collect()
        };
        let distances: Vec<Vec<f64>> = pieces.iter().map(distances).collect();
        Some(outcomes(pieces, &distances, false))
    }

    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let samples = settings.count("window", 0..=dynamic::WIDEST - 1)? + 1;
        let threshold = rust.signal(settings, "threshold")?;
        rust.constant("temporal::MovingWindow", &format!("{samples}"), &format!("new({threshold})"))
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let samples = settings.count("window", 0..=dynamic::WIDEST - 1)? + 1;
        let scheme = dynamic::MovingWindow::try_new(settings.signal("threshold")?, samples)?;
        let start = scheme.state();
        visitor.visit_steps(scheme, start)
    }
}

#[inline(never)] // its window leaves the stack before the next one comes
fn window<V: Count, const N: usize>(
    name: &'static str,
    signal: &Scaled<V::Sample>,
    visitor: &mut V,
) -> Result<(), V::Error> {
    let threshold = signal.part(0.25);
    let scheme = MovingWindow::<_, N>::try_new(threshold)?;
    visitor.steps(name, &scheme, threshold, |signal, spikes| {
        transcribed(signal, N, threshold, spikes);
    })
}

/// Encodes by the paper's algorithm 8, from its second loop on. Both sides are multiplied by the number of samples
/// averaged, as the mean of integers need not be an integer.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], averaged: usize, threshold: S, spikes: &mut [i8]) {
    let count = S::wide(averaged as f64);
    let margin = threshold.into() * count;
    for i in averaged..input.len() {
        let mut sum = S::Wide::default();
        for j in i - averaged..i {
            sum += input[j].into();
        }
        spikes[i] = if input[i].into() * count > sum + margin {
            1
        } else if input[i].into() * count < sum - margin {
            -1
        } else {
            0
        };
    }
}
