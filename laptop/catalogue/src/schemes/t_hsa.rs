//! Threshold Hough spiker (T-HSA).

use spikewire::rate::{Scale, Shape, Taps, ThresholdHough};

use crate::prelude::*;

/// Threshold Hough spiker.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; peak and threshold are parts of a channel's range.
const TAPS: usize = 15;
const PEAK: f64 = 0.1;
const THRESHOLD: f64 = 0.085;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "t-hsa",
        type_name: "ThresholdHough",
        title: "T-HSA",
        words: "threshold Hough spiker (T-HSA)",
        good_for: "the nearest reconstruction of the rate codes at the paper's settings",
        is_drawn: true,
        colour: [0x3f, 0xb6, 0xc4],
        parameters: &[
            Parameter::filter("triang:15"),
            Parameter::SHIFT,
            Parameter::threshold(
                "by how much the signal may fall short of the filter in all, 0 or more",
                0.85,
            )
            .searched(Search::OfFilter(0.0, 1.0))
            .of_encoder(),
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "threshold_hough",
        scheme: "rate::ThresholdHough<S, {0}>",
        shapes: &[&[TAPS]],
        made: &[
            Made {
                name: "init",
                words: "`taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is taken off the samples, at most their minimum.",
                arguments: &[Argument::TAPS, Argument::new("threshold", "S"), Argument::SHIFT],
                value: "rate::ThresholdHough::try_new(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift)",
                flies: None,
            },
            Made {
                name: "init_peak",
                words: "`shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may fall short of it in all; `shift`: what is taken off the samples, at most their minimum.",
                arguments: &[
                    Argument::TRIANGULAR,
                    Argument::sample("peak", Flown::Fraction(PEAK)),
                    Argument::sample("threshold", Flown::Fraction(THRESHOLD)),
                    Argument::SHIFT,
                ],
                value: "rate::ThresholdHough::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, threshold)?.try_with_shift(shift)",
                flies: Some("t-hsa"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scale = Scale::Peak(channel.fraction(PEAK));
        let taps = Taps::<_, TAPS>::try_shaped(Shape::Triangular, scale)?;
        let scheme = ThresholdHough::try_new(taps, channel.fraction(THRESHOLD))?;
        let scheme = scheme.try_with_shift(channel.min)?;
        visitor.visit("t-hsa", Self::INFO.words, &scheme, ThresholdHough::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(0.85);
        let taps = Taps::<_, 15>::try_triangular(signal.part(1.0))?;
        let scheme = ThresholdHough::try_new(taps, threshold)?.try_with_shift(signal.min)?;
        let taps = scheme.taps().as_array();
        visitor.rate("t-hsa-15", &scheme, &scheme, taps, signal.min, |signal, spikes| {
            transcribed(signal, taps, threshold, spikes);
        })
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["rate::ThresholdHough", "{length}", "new({taps}, {threshold}).with_shift({shift})"]);

    fn ram<S: Sample>(settings: &Settings) -> Result<usize> {
        let sizes = [state::<ThresholdHough<S, 8>>(), state::<ThresholdHough<S, 16>>()];
        Ok(lengthened(sizes, settings.length()?))
    }

    fn counted(settings: &Settings) -> Result<Counted> {
        Ok(Counted::at_most("t-hsa-15", settings.length()? as f64 / 15.0))
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let scheme =
            dynamic::ThresholdHough::try_new(settings.taps()?, settings.signal("threshold")?)?;
        let scheme = scheme.try_with_shift(settings.signal("shift")?)?;
        let start = scheme.state();
        visitor.visit(scheme, start)
    }
}

/// Encodes by the paper's algorithm 4, on the shifted input.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &mut [S], filter: &[S], threshold: S, spikes: &mut [i8]) {
    for i in 0..input.len() {
        let mut error = S::Wide::default();
        for j in 0..filter.len() {
            if i + j < input.len() && input[i + j] < filter[j] {
                error += filter[j].into() - input[i + j].into();
            }
        }
        spikes[i] = 0;
        if error <= threshold.into() {
            spikes[i] = 1;
            for j in 0..filter.len() {
                if i + j < input.len() {
                    input[i + j] = S::narrow(input[i + j].into() - filter[j].into());
                }
            }
        }
    }
}
