//! Sigma-delta, the regular rate code.

use spikewire::Spike;
use spikewire::rate::{Average, SigmaDelta, Window};

use crate::prelude::*;

/// Sigma-delta.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const POWER: u8 = 4;
const WINDOW_POWER: u8 = 6;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "sigma-delta",
        type_name: "SigmaDelta",
        title: "Sigma-delta",
        words: "sigma-delta (regular rate)",
        good_for: "a mean from one neuron, the more exact the longer it is taken",
        colour: [0x6d, 0x6a, 0xb5],
        parameters: &[Parameter::MIN, Parameter::MAX, Parameter::MEAN, Parameter::POWER],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[
        InC {
            name: "sigma_delta",
            scheme: "rate::SigmaDelta<S, rate::Average>",
            shapes: &[&[]],
            made: &[Made {
                name: "init",
                words: "`min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15.",
                arguments: &[
                    Argument::MIN,
                    Argument::MAX,
                    Argument::number("power", "u8", POWER as f64),
                ],
                value: "rate::SigmaDelta::try_new(min..=max, rate::Average::try_new(power)?)",
                flies: Some("sigma-delta"),
            }],
        },
        InC {
            name: "sigma_delta_window",
            scheme: "rate::SigmaDelta<S, rate::Window<{0}>>",
            shapes: &[&[2]],
            made: &[Made {
                name: "init",
                words: "`min`, `max`: the range, which must rise. `power`: the decoder's mean is over 2^power samples, at most 32 a word.",
                arguments: &[
                    Argument::MIN,
                    Argument::MAX,
                    Argument::number("power", "u8", WINDOW_POWER as f64),
                ],
                value: "rate::SigmaDelta::try_new(min..=max, rate::Window::try_new(power)?)",
                flies: Some("sigma-delta-window"),
            }],
        },
    ];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (range, average) = (channel.min..=channel.max, const { Average::new(POWER) });
        let scheme = SigmaDelta::try_new(range.clone(), average)?;
        let start = SigmaDelta::<V::Sample, Average>::START;
        visitor.visit("sigma-delta", Self::INFO.words, &scheme, start)?;
        let scheme = SigmaDelta::try_new(range, const { Window::<2>::new(WINDOW_POWER) })?;
        let start = SigmaDelta::<V::Sample, Window<2>>::START;
        visitor.visit("sigma-delta-window", "sigma-delta over a window", &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (min, max) = (signal.min, signal.max);
        visitor.coded(
            "sigma-delta",
            &SigmaDelta::try_new(min..=max, Average::new(4))?,
            Spike::sign,
            spike_of,
            |signal, spikes| transcribed(signal, min, max, spikes),
            |spikes, values| {
                let range = max.into() - min.into();
                plain::average_decode(spikes, min, max, (range, 0), 4, values);
            },
        )?;
        visitor.coded(
            "sigma-delta-window-16",
            &SigmaDelta::try_new(min..=max, Window::<1>::new(4))?,
            Spike::sign,
            spike_of,
            |signal, spikes| transcribed(signal, min, max, spikes),
            |spikes, values| plain::window_decode(spikes, min, max, 4, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["rate::SigmaDelta", "{averaging}", "new({range}, {mean})"]);

    costs!(SigmaDelta<S, Average>, "sigma-delta");

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let range = settings.range()?;
        if settings.takes_window()? {
            let scheme = SigmaDelta::<S, _>::try_new(range, settings.window()?)?;
            return visitor.visit(scheme, SigmaDelta::<S, Window<128>>::START);
        }
        let scheme = SigmaDelta::<S, _>::try_new(range, settings.average()?)?;
        visitor.visit(scheme, SigmaDelta::<S, Average>::START)
    }
}

/// Encodes by the definition.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], min: S, max: S, spikes: &mut [i8]) {
    let range = max.into() - min.into();
    let mut sum = S::Wide::default();
    for i in 0..input.len() {
        sum += plain::above_min(input[i], min, max);
        spikes[i] = 0;
        if sum >= range {
            spikes[i] = 1;
            sum -= range;
        }
    }
}
