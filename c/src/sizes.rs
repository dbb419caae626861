//! The header's sizes, checked on each target as it is compiled. Written with the header.

use crate::codec::Codec;
use crate::describe::Layout;
use fixed::types::{I8F8, I16F16};
use spikewire::{Scheme, population, rate, temporal, timing};

const fn is<T>(size: usize, align: usize) -> bool {
    let own = Layout::of::<T>();
    own.size == size && own.align == align
}

/// Parameters, what an encoder and a decoder keep, and a code.
macro_rules! sized {
    ($($scheme:ty: $codec:tt $encoder:tt $decoder:tt $code:tt;)*) => {
        $(const _: () = assert!(
            is::<Codec<$scheme>> $codec
                && is::<<$scheme as Scheme>::EncoderState> $encoder
                && is::<<$scheme as Scheme>::DecoderState> $decoder
                && is::<<$scheme as Scheme>::Code> $code,
            "the header has another size: cargo xtask c-library --write"
        );)*
    };
}

sized! {
    temporal::TemporalContrast<f32>: (12, 4) (8, 4) (4, 4) (1, 1);
    temporal::TemporalContrast<i16>: (8, 4) (8, 4) (2, 2) (1, 1);
    temporal::TemporalContrast<I8F8>: (8, 4) (8, 4) (2, 2) (1, 1);
    temporal::TemporalContrast<I16F16>: (12, 4) (8, 4) (4, 4) (1, 1);
    temporal::AdaptiveContrast<f32>: (12, 4) (12, 4) (8, 4) (1, 1);
    temporal::AdaptiveContrast<i16>: (8, 4) (8, 4) (4, 2) (1, 1);
    temporal::AdaptiveContrast<I8F8>: (8, 4) (8, 4) (4, 2) (1, 1);
    temporal::AdaptiveContrast<I16F16>: (12, 4) (12, 4) (8, 4) (1, 1);
    temporal::MovingWindow<f32, 6>: (16, 4) (36, 4) (4, 4) (1, 1);
    temporal::MovingWindow<i16, 6>: (16, 4) (24, 4) (2, 2) (1, 1);
    temporal::MovingWindow<I8F8, 6>: (16, 4) (24, 4) (2, 2) (1, 1);
    temporal::MovingWindow<I16F16, 6>: (24, 8) (40, 8) (4, 4) (1, 1);
    temporal::StepForward<f32>: (8, 4) (8, 4) (4, 4) (1, 1);
    temporal::StepForward<i16>: (8, 4) (8, 4) (2, 2) (1, 1);
    temporal::StepForward<I8F8>: (8, 4) (8, 4) (2, 2) (1, 1);
    temporal::StepForward<I16F16>: (8, 4) (8, 4) (4, 4) (1, 1);
    temporal::SendOnDelta<f32, 4>: (12, 4) (8, 4) (4, 4) (1, 1);
    temporal::SendOnDelta<i16, 4>: (8, 4) (8, 4) (2, 2) (1, 1);
    temporal::SendOnDelta<I8F8, 4>: (8, 4) (8, 4) (2, 2) (1, 1);
    temporal::SendOnDelta<I16F16, 4>: (12, 4) (8, 4) (4, 4) (1, 1);
    temporal::AdaptiveStepForward<f32>: (12, 4) (12, 4) (8, 4) (1, 1);
    temporal::AdaptiveStepForward<i16>: (8, 4) (8, 4) (4, 2) (1, 1);
    temporal::AdaptiveStepForward<I8F8>: (8, 4) (8, 4) (4, 2) (1, 1);
    temporal::AdaptiveStepForward<I16F16>: (12, 4) (12, 4) (8, 4) (1, 1);
    rate::Bsa<f32, 24>: (216, 4) (104, 4) (100, 4) (1, 1);
    rate::Bsa<i16, 24>: (120, 4) (104, 4) (100, 4) (1, 1);
    rate::Bsa<I8F8, 24>: (120, 4) (104, 4) (100, 4) (1, 1);
    rate::Bsa<I16F16, 24>: (216, 4) (104, 4) (100, 4) (1, 1);
    rate::BsaToolbox<f32, 9>: (92, 4) (48, 4) (40, 4) (1, 1);
    rate::BsaToolbox<i16, 9>: (56, 4) (48, 4) (40, 4) (1, 1);
    rate::BsaToolbox<I8F8, 9>: (56, 4) (48, 4) (40, 4) (1, 1);
    rate::BsaToolbox<I16F16, 9>: (92, 4) (48, 4) (40, 4) (1, 1);
    rate::Hough<f32, 15>: (132, 4) (68, 4) (64, 4) (1, 1);
    rate::Hough<i16, 15>: (72, 4) (68, 4) (64, 4) (1, 1);
    rate::Hough<I8F8, 15>: (72, 4) (68, 4) (64, 4) (1, 1);
    rate::Hough<I16F16, 15>: (132, 4) (68, 4) (64, 4) (1, 1);
    rate::ThresholdHough<f32, 15>: (136, 4) (68, 4) (64, 4) (1, 1);
    rate::ThresholdHough<i16, 15>: (76, 4) (68, 4) (64, 4) (1, 1);
    rate::ThresholdHough<I8F8, 15>: (76, 4) (68, 4) (64, 4) (1, 1);
    rate::ThresholdHough<I16F16, 15>: (136, 4) (68, 4) (64, 4) (1, 1);
    rate::IntegrateAndFire<f32, 8>: (16, 4) (8, 4) (4, 4) (1, 1);
    rate::IntegrateAndFire<i16, 8>: (12, 4) (8, 4) (4, 4) (1, 1);
    rate::IntegrateAndFire<I8F8, 8>: (12, 4) (8, 4) (4, 4) (1, 1);
    rate::IntegrateAndFire<I16F16, 8>: (16, 4) (16, 8) (8, 8) (1, 1);
    rate::IntegrateAndFire<f32, 8>: (16, 4) (8, 4) (4, 4) (1, 1);
    rate::IntegrateAndFire<i16, 8>: (12, 4) (8, 4) (4, 4) (1, 1);
    rate::IntegrateAndFire<I8F8, 8>: (12, 4) (8, 4) (4, 4) (1, 1);
    rate::IntegrateAndFire<I16F16, 8>: (16, 4) (16, 8) (8, 8) (1, 1);
    rate::SigmaDelta<f32, rate::Average>: (16, 4) (8, 4) (8, 4) (1, 1);
    rate::SigmaDelta<i16, rate::Average>: (12, 4) (8, 4) (8, 4) (1, 1);
    rate::SigmaDelta<I8F8, rate::Average>: (12, 4) (8, 4) (8, 4) (1, 1);
    rate::SigmaDelta<I16F16, rate::Average>: (16, 4) (16, 8) (16, 8) (1, 1);
    rate::SigmaDelta<f32, rate::Window<2>>: (16, 4) (8, 4) (16, 4) (1, 1);
    rate::SigmaDelta<i16, rate::Window<2>>: (12, 4) (8, 4) (16, 4) (1, 1);
    rate::SigmaDelta<I8F8, rate::Window<2>>: (12, 4) (8, 4) (16, 4) (1, 1);
    rate::SigmaDelta<I16F16, rate::Window<2>>: (16, 4) (16, 8) (16, 4) (1, 1);
    rate::WeightedBurst<f32, rate::Average>: (20, 4) (12, 4) (8, 4) (1, 1);
    rate::WeightedBurst<i16, rate::Average>: (12, 4) (12, 4) (8, 4) (1, 1);
    rate::WeightedBurst<I8F8, rate::Average>: (12, 4) (12, 4) (8, 4) (1, 1);
    rate::WeightedBurst<I16F16, rate::Average>: (20, 4) (16, 8) (16, 8) (1, 1);
    population::Position<f32, 20>: (212, 4) (4, 4) (4, 4) (2, 2);
    population::Position<i16, 20>: (132, 4) (4, 4) (2, 2) (2, 2);
    population::Position<I8F8, 20>: (132, 4) (4, 4) (2, 2) (2, 2);
    population::Position<I16F16, 20>: (212, 4) (4, 4) (4, 4) (2, 2);
    population::Gaussian<f32, 20>: (212, 4) (4, 4) (4, 4) (2, 2);
    population::Gaussian<i16, 20>: (132, 4) (4, 4) (2, 2) (2, 2);
    population::Gaussian<I8F8, 20>: (132, 4) (4, 4) (2, 2) (2, 2);
    population::Gaussian<I16F16, 20>: (212, 4) (4, 4) (4, 4) (2, 2);
    population::Slots<f32, 15, 10>: (136, 4) (4, 4) (4, 4) (20, 4);
    population::Slots<i16, 15, 10>: (100, 4) (4, 4) (2, 2) (20, 4);
    population::Slots<I8F8, 15, 10>: (100, 4) (4, 4) (2, 2) (20, 4);
    population::Slots<I16F16, 15, 10>: (184, 8) (4, 4) (4, 4) (20, 4);
    population::Gaussian<f32, 20>: (212, 4) (4, 4) (4, 4) (2, 2);
    population::Gaussian<i16, 20>: (132, 4) (4, 4) (2, 2) (2, 2);
    population::Gaussian<I8F8, 20>: (132, 4) (4, 4) (2, 2) (2, 2);
    population::Gaussian<I16F16, 20>: (212, 4) (4, 4) (4, 4) (2, 2);
    population::NonLinearSlots<f32, 15, 10>: (228, 4) (4, 4) (4, 4) (32, 4);
    population::NonLinearSlots<i16, 15, 10>: (304, 8) (4, 4) (2, 2) (32, 4);
    population::NonLinearSlots<I8F8, 15, 10>: (304, 8) (4, 4) (2, 2) (32, 4);
    population::NonLinearSlots<I16F16, 15, 10>: (336, 8) (4, 4) (4, 4) (32, 4);
    population::RankOrder<f32, 15, 3>: (172, 4) (4, 4) (4, 4) (20, 4);
    population::RankOrder<i16, 15, 3>: (108, 4) (4, 4) (2, 2) (20, 4);
    population::RankOrder<I8F8, 15, 3>: (108, 4) (4, 4) (2, 2) (20, 4);
    population::RankOrder<I16F16, 15, 3>: (172, 4) (4, 4) (4, 4) (20, 4);
    timing::FirstSpike<f32, 16>: (188, 4) (4, 4) (4, 4) (2, 2);
    timing::FirstSpike<i16, 16>: (116, 4) (4, 4) (2, 2) (2, 2);
    timing::FirstSpike<I8F8, 16>: (116, 4) (4, 4) (2, 2) (2, 2);
    timing::FirstSpike<I16F16, 16>: (188, 4) (4, 4) (4, 4) (2, 2);
    timing::LatencyPhase<f32, 4, 32, 4>: (348, 4) (4, 4) (4, 4) (8, 2);
    timing::LatencyPhase<i16, 4, 32, 4>: (216, 4) (4, 4) (2, 2) (8, 2);
    timing::LatencyPhase<I8F8, 4, 32, 4>: (216, 4) (4, 4) (2, 2) (8, 2);
    timing::LatencyPhase<I16F16, 4, 32, 4>: (348, 4) (4, 4) (4, 4) (8, 2);
    timing::WeightedPhase<f32, 8>: (16, 4) (4, 4) (4, 4) (2, 2);
    timing::WeightedPhase<i16, 8>: (12, 4) (4, 4) (2, 2) (2, 2);
    timing::WeightedPhase<I8F8, 8>: (12, 4) (4, 4) (2, 2) (2, 2);
    timing::WeightedPhase<I16F16, 8>: (16, 4) (4, 4) (4, 4) (2, 2);
    timing::Burst<f32, 19>: (268, 4) (4, 4) (4, 4) (2, 1);
    timing::Burst<i16, 19>: (192, 4) (4, 4) (2, 2) (2, 1);
    timing::Burst<I8F8, 19>: (192, 4) (4, 4) (2, 2) (2, 1);
    timing::Burst<I16F16, 19>: (268, 4) (4, 4) (4, 4) (2, 1);
}
