//! Hough spiker (HSA).

use spikewire::rate::{Hough, Scale, Shape, Taps};

use crate::prelude::*;

/// Hough spiker.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; the peak is a part of a channel's range.
const TAPS: usize = 15;
const PEAK: f64 = 0.1;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "hsa",
        type_name: "Hough",
        title: "HSA",
        words: "Hough spiker (HSA)",
        good_for: "a value that is never above the signal",
        is_drawn: true,
        colour: [0x5b, 0xa8, 0x5a],
        parameters: &[Parameter::filter("triang:15"), Parameter::SHIFT],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "hough",
        scheme: "rate::Hough<S, {0}>",
        shapes: &[&[TAPS]],
        made: &[
            Made {
                name: "init",
                words: "`taps`: of the filter; `shift`: what is taken off the samples, at most their minimum.",
                arguments: &[Argument::TAPS, Argument::SHIFT],
                value: "rate::Hough::new(rate::Taps::try_new(taps)?).try_with_shift(shift)",
                flies: None,
            },
            Made {
                name: "init_peak",
                words: "`shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `shift`: what is taken off the samples, at most their minimum.",
                arguments: &[
                    Argument::TRIANGULAR,
                    Argument::sample("peak", Flown::Fraction(PEAK)),
                    Argument::SHIFT,
                ],
                value: "rate::Hough::new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?).try_with_shift(shift)",
                flies: Some("hsa"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scale = Scale::Peak(channel.fraction(PEAK));
        let scheme = Hough::<_, TAPS>::new(Taps::try_shaped(Shape::Triangular, scale)?);
        let scheme = scheme.try_with_shift(channel.min)?;
        visitor.visit("hsa", Self::INFO.words, &scheme, Hough::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let taps = Taps::<_, 15>::try_triangular(signal.part(1.0))?;
        let scheme = Hough::new(taps).try_with_shift(signal.min)?;
        let taps = scheme.taps().as_array();
        visitor.rate("hsa-15", &scheme, &scheme, taps, signal.min, |signal, spikes| {
            transcribed(signal, taps, spikes);
        })
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["rate::Hough", "{length}", "new({taps}).with_shift({shift})"]);

    fn ram<S: Sample>(settings: &Settings) -> Result<usize> {
        let sizes = [state::<Hough<S, 8>>(), state::<Hough<S, 16>>()];
        Ok(lengthened(sizes, settings.length()?))
    }

    fn counted(settings: &Settings) -> Result<Counted> {
        Ok(Counted::at_most("hsa-15", settings.length()? as f64 / 15.0))
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let scheme =
            dynamic::Hough::try_new(settings.taps()?)?.try_with_shift(settings.signal("shift")?)?;
        let start = scheme.state();
        visitor.visit(scheme, start)
    }
}

/// Encodes by the paper's algorithm 3, on the shifted input.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &mut [S], filter: &[S], spikes: &mut [i8]) {
    for i in 0..input.len() {
        let mut count = 0;
        for j in 0..filter.len() {
            if i + j < input.len() && input[i + j] >= filter[j] {
                count += 1;
            }
        }
        spikes[i] = 0;
        if count == filter.len() {
            spikes[i] = 1;
            for j in 0..filter.len() {
                input[i + j] = S::narrow(input[i + j].into() - filter[j].into());
            }
        }
    }
}
