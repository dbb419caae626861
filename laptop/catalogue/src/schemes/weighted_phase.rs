//! Weighted phase.

use spikewire::timing::{PhaseBits, WeightedPhase};

use crate::prelude::*;

/// Weighted phase.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const DIGITS: usize = 8;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "weighted-phase",
        type_name: "WeightedPhase",
        title: "Phase",
        words: "weighted phase",
        good_for: "a value in binary digits: the finest in few sub-timesteps",
        colour: [0x8d, 0x99, 0xae],
        parameters: &[
            Parameter::count("slots", "digits a sample, 2 to 16")
                .with_default("8")
                .searched(Search::Whole(2, 12)),
            Parameter::MIN,
            Parameter::MAX,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "weighted_phase",
        scheme: "timing::WeightedPhase<S, {0}>",
        shapes: &[&[DIGITS]],
        made: &[Made {
            name: "init",
            words: "`min`, `max`: the range, which must rise.",
            arguments: &[Argument::MIN, Argument::MAX],
            value: "timing::WeightedPhase::try_new(min..=max)",
            flies: Some("weighted-phase"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = WeightedPhase::<_, DIGITS>::try_new(channel.min..=channel.max)?;
        visitor.visit(
            "weighted-phase",
            Self::INFO.words,
            &scheme,
            WeightedPhase::<V::Sample, DIGITS>::START,
        )
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (min, max) = (signal.min, signal.max);
        let scheme = WeightedPhase::<_, 8>::try_new(min..=max)?;
        visitor.coded(
            "weighted-phase-8",
            &scheme,
            |bits| bits.digits() as i8,
            |digits| PhaseBits::new(digits as u16),
            |signal, digits| transcribed(signal, min, max, digits),
            |digits, values| transcribed_decoder(digits, min, max, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> = Some(["timing::WeightedPhase", "{slots}", "new({range})"]);

    costs!(WeightedPhase<S, 8>, "weighted-phase-8", |settings| settings.count("slots", 2..=16)? as f64 / 8.0);

    fn shape(settings: &Settings) -> Result<Shape> {
        Ok(Shape { neurons: 1, slots: settings.count("slots", 2..=16)? })
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let slots = Self::shape(settings)?.slots as u8;
        // A code computes all digits that it has room for: those of half of them cost half.
        if slots <= 8 {
            let scheme = WeightedPhase::<S, 8>::try_new(settings.range()?)?;
            return visitor.visit(scheme.try_with_slots(slots)?, WeightedPhase::<S, 8>::START);
        }
        let scheme = dynamic::WeightedPhase::<S>::try_new(settings.range()?)?;
        visitor.visit(scheme.try_with_slots(slots)?, dynamic::WeightedPhase::<S>::START)
    }
}

/// Encodes a position in the range by doubling it for each digit.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], min: S, max: S, digits: &mut [i8]) {
    let range: S::Wide = max.into() - min.into();
    for i in 0..input.len() {
        let mut rest = input[i].into() - min.into();
        let mut code = 0_u8;
        for _ in 0..8 {
            rest += rest;
            code <<= 1;
            if input[i] >= max {
                code |= 1;
            } else if rest >= range {
                rest -= range;
                code |= 1;
            }
        }
        digits[i] = code as i8;
    }
}

/// Decodes to the middle of the values with these digits.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(digits: &[i8], min: S, max: S, values: &mut [S]) {
    let range: S::Wide = max.into() - min.into();
    let unit = S::wide(S::MEAN); // of the last place; 0 in floating point
    for i in 0..digits.len() {
        let code = i16::from(digits[i] as u8);
        let above = if unit > S::Wide::default() {
            let start = |code| (range * S::count(code) + unit * S::count(255)) / S::count(256);
            let last = if code == 255 { range } else { start(code + 1) - unit };
            // Halves, rounded down.
            start(code) + (last - start(code)) / S::count(2)
        } else {
            range * S::count(2 * code + 1) / S::count(512)
        };
        values[i] = S::narrow(min.into() + above);
    }
}
