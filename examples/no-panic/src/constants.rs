//! Every scheme, as a constant in flash.

use fixed::types::{I8F8, I16F16};
use spikewire::{
    population::{Position, Slots},
    rate::{Bsa, BsaToolbox, Hough, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

use crate::exercise;

macro_rules! constants {
    ($sample:ty, $zero:expr, $one:expr) => {{
        const ONE: $sample = $one;
        const TAPS: Taps<$sample, 9> = Taps::triangular(ONE);
        static CONTRAST: TemporalContrast<$sample> = TemporalContrast::new(ONE);
        static STEP_FORWARD: StepForward<$sample> = StepForward::new(ONE);
        static MOVING_WINDOW: MovingWindow<$sample, 6> = MovingWindow::new(ONE);
        static HOUGH: Hough<$sample, 9> = Hough::new(TAPS);
        static THRESHOLD_HOUGH: ThresholdHough<$sample, 9> = ThresholdHough::new(TAPS, ONE);
        static SUBTRACTIVE: Bsa<$sample, 9> = Bsa::subtractive(TAPS, ONE);
        static MULTIPLICATIVE: Bsa<$sample, 9> = Bsa::multiplicative(TAPS, 0.9);
        static TOOLBOX: BsaToolbox<$sample, 9> = BsaToolbox::new(TAPS, 1.15);
        static POSITION: Position<$sample, 5> = Position::linear($zero..=ONE);
        static SLOTS: Slots<$sample, 5, 10> = Slots::new($zero..=ONE, 1.5);

        exercise::scheme(&CONTRAST);
        exercise::scheme(&STEP_FORWARD);
        exercise::scheme(&MOVING_WINDOW);
        exercise::scheme(&HOUGH);
        exercise::scheme(&THRESHOLD_HOUGH);
        exercise::scheme(&SUBTRACTIVE);
        exercise::scheme(&MULTIPLICATIVE);
        exercise::scheme(&TOOLBOX);
        exercise::scheme(&POSITION);
        exercise::scheme(&SLOTS);
    }};
}

pub fn link() {
    constants!(f32, 0.0, 1.0);
    constants!(i16, 0, 100);
    constants!(I8F8, I8F8::ZERO, I8F8::ONE);
    constants!(I16F16, I16F16::ZERO, I16F16::ONE);
}
