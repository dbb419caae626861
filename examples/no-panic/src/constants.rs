//! Every scheme, as a constant in flash.

use fixed::types::{I8F8, I16F16};
use spikewire::{
    population::{Centres, Position, ReceptiveFields, Slots},
    rate::{Ben, BenToolbox, Hough, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

use crate::exercise;

macro_rules! constants {
    ($sample:ty, $zero:expr, $one:expr) => {{
        const ONE: $sample = $one;
        static TAPS: Taps<$sample, 9> = Taps::<$sample, _>::triangular(ONE);
        static CENTRES: Centres<$sample, 5> = Centres::<$sample, _>::linear($zero, ONE);
        static FIELDS: ReceptiveFields<$sample, 5, 10> =
            ReceptiveFields::<$sample, _, _>::checked($zero, ONE, 1.5);

        exercise::scheme(const { TemporalContrast::<$sample>::checked(ONE) });
        exercise::scheme(const { StepForward::<$sample>::checked(ONE) });
        exercise::scheme(const { MovingWindow::<$sample, 6>::checked(ONE) });
        exercise::scheme(const { Hough::new(&TAPS) });
        exercise::scheme(const { ThresholdHough::<$sample, _>::checked(&TAPS, ONE) });
        exercise::scheme(const { Ben::<$sample, _>::checked_subtractive(&TAPS, ONE) });
        exercise::scheme(const { Ben::<$sample, _>::checked_multiplicative(&TAPS, 0.9) });
        exercise::scheme(const { BenToolbox::<$sample, _>::checked(&TAPS, 1.15) });
        exercise::scheme(const { Position::new(&CENTRES) });
        exercise::scheme(const { Slots::new(&FIELDS) });
    }};
}

pub fn link() {
    constants!(f32, 0.0, 1.0);
    constants!(i16, 0, 100);
    constants!(I8F8, I8F8::ZERO, I8F8::ONE);
    constants!(I16F16, I16F16::ZERO, I16F16::ONE);
}
