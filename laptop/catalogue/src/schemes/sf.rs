//! Step forward (SF).

use spikewire::temporal::StepForward;

use crate::prelude::*;

/// Step forward.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; a threshold is a part of a channel's range.
const THRESHOLD: f64 = 0.02;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "sf",
        type_name: "StepForward",
        title: "SF",
        words: "step forward (SF)",
        good_for: "following a signal closely with few spikes, while it changes by a threshold a sample at most",
        is_signed: true,
        steps: StepErrors::Held,
        climbs_by: Some("threshold"),
        is_drawn: true,
        colour: [0xe9, 0xc4, 0x3a],
        parameters: &[
            Parameter::threshold(
                "the step, above 0: what the distance from the baseline must exceed",
                0.5,
            ),
            Parameter::START,
        ],
    };

    const IN_C: &'static [InC] = &[InC {
        name: "step_forward",
        scheme: "temporal::StepForward<S>",
        shapes: &[&[]],
        made: &[Made {
            name: "init",
            words: "`threshold`: what the distance from the baseline must exceed, above 0.",
            arguments: &[Argument::sample("threshold", Flown::Fraction(THRESHOLD))],
            value: "temporal::StepForward::try_new(threshold)",
            flies: Some("sf"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = StepForward::try_new(channel.fraction(THRESHOLD))?;
        visitor.visit("sf", Self::INFO.words, &scheme, StepForward::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(0.5);
        let scheme = StepForward::try_new(threshold)?;
        visitor.steps("sf", &scheme, threshold, |signal, spikes| {
            transcribed(signal, threshold, spikes);
        })
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> = Some(["temporal::StepForward", "", "new({threshold})"]);

    costs!(StepForward<S>, "sf");

    /// Lists the outcomes one by one. Each spike depends on those before it, so every outcome takes a run, which also
    /// finds the next higher threshold at which spikes differ. If thresholds lie too close to list all, about `most`
    /// runs are spread over the range.
    fn outcomes(
        _: &Settings,
        pieces: &[Piece],
        (low, high): (f64, f64),
        most: usize,
    ) -> Option<Outcomes> {
        let ratio = (high / low).powf(1.0 / most.max(1) as f64);
        let mut found = Outcomes { list: Vec::new(), is_complete: true };
        let masks: Vec<(&[f64], Vec<bool>)> =
            pieces.iter().map(|own| (own.values, own.mask())).collect();
        let mut threshold = low;
        while threshold < high && threshold > 0.0 {
            let (outcome, next) = outcome(&masks, threshold);
            found.list.push(outcome);
            found.is_complete &= next >= threshold * ratio;
            threshold = next.max(threshold * ratio);
        }
        Some(found)
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        visitor
            .visit_steps(StepForward::try_new(settings.signal("threshold")?)?, StepForward::START)
    }
}

/// Returns the outcome of step forward just above a threshold, and the next threshold at which its spikes differ. Each
/// sample of a piece comes with whether it is scored.
#[cfg(feature = "run")]
fn outcome(pieces: &[(&[f64], Vec<bool>)], threshold: f64) -> (Outcome, f64) {
    let (mut parabola, mut spikes, mut next) = (Parabola::default(), 0, f64::INFINITY);
    for (values, mask) in pieces {
        let first = values.first().copied().unwrap_or_default();
        let mut count = 0.0;
        for (value, is_scored) in values.iter().map(|value| value - first).zip(mask) {
            // Upwards while `value > (count + 1) * threshold`, downwards while `value < (count - 1) * threshold`.
            let (up, down) = (count + 1.0, count - 1.0);
            for multiple in [up, down] {
                let change = value / multiple;
                if change > threshold && change < next {
                    next = change;
                }
            }
            // Just above a threshold at which the two sides are equal, the one that grows with it is the greater.
            if (value > up * threshold && value / up != threshold)
                || (up < 0.0 && value / up == threshold)
            {
                (count, spikes) = (up, spikes + usize::from(*is_scored));
            } else if (value < down * threshold && value / down != threshold)
                || (down > 0.0 && value / down == threshold)
            {
                (count, spikes) = (down, spikes + usize::from(*is_scored));
            }
            if *is_scored {
                parabola.observe(value, count);
            }
        }
    }
    let (low, high) = if next.is_finite() {
        (above(threshold, next), below(threshold, next))
    } else {
        (threshold, threshold)
    };
    let step = parabola.lowest().unwrap_or(low).clamp(low, high);
    let squares = parabola.squares(step);
    (Outcome { threshold: step, step, spikes, squares, apart: squares }, next)
}

/// Encodes by the paper's algorithm 7.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], threshold: S, spikes: &mut [i8]) {
    let threshold = threshold.into();
    let mut base = input[0].into();
    for i in 1..input.len() {
        if input[i].into() > base + threshold {
            spikes[i] = 1;
            base += threshold;
        } else if input[i].into() < base - threshold {
            spikes[i] = -1;
            base -= threshold;
        } else {
            spikes[i] = 0;
        }
    }
}

#[cfg(all(test, feature = "run"))]
mod tests {
    use super::outcome;
    use proptest::prelude::*;

    proptest! {
        /// The values are integers, so that samples lie exactly at a threshold.
        #[test]
        fn outcomes_are_those_of_the_law(
            values in prop::collection::vec((-9_i8..9, any::<bool>()), 2..40)
        ) {
            let mask: Vec<bool> = values.iter().map(|own| own.1).collect();
            let values: Vec<f64> = values.iter().map(|own| f64::from(own.0)).collect();
            let pieces = [(&values[..], mask)];
            let mut threshold = 0.1;
            while threshold < 20.0 {
                let (own, next) = outcome(&pieces, threshold);
                let (mut count, mut spikes, mut squares) = (0.0, 0, 0.0);
                for (value, is_scored) in values.iter().zip(&pieces[0].1) {
                    let (value, one) = (value - values[0], usize::from(*is_scored));
                    if value > (count + 1.0) * own.threshold {
                        (count, spikes) = (count + 1.0, spikes + one);
                    } else if value < (count - 1.0) * own.threshold {
                        (count, spikes) = (count - 1.0, spikes + one);
                    }
                    squares += one as f64 * (value - count * own.threshold).powi(2);
                }
                prop_assert_eq!(own.spikes, spikes);
                prop_assert!((own.squares - squares).abs() < 1e-6, "{:?}, but {}", own, squares);
                threshold = next;
            }
        }
    }
}
