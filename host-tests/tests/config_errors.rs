//! Bad input: every parameter that makes no sense is refused by name, with its value and what is
//! allowed.

use fixed::types::{I8F8, I16F16};
use rand_pcg::Pcg32;
use spikewire::population::{Position, Probabilistic, Slots};
use spikewire::rate::{Bsa, BsaToolbox, Criterion, Hough, Scale, Shape, Taps, ThresholdHough};
use spikewire::temporal::{AdaptiveStepForward, MovingWindow, StepForward, TemporalContrast};
use spikewire::{Calibration, ConfigError};

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// The smallest and the largest ratio of a multiplicative BSA.
const RATIOS: [f32; 2] = [1.0 / 16_384.0, 4.0 - 1.0 / 16_384.0];

/// What a constructor refused, and in which words. As text, since not a number equals nothing.
fn refusal<T>(result: Result<T, ConfigError>) -> (String, String) {
    let error = result.err().expect("it must be refused");
    (format!("{error:?}"), error.to_string())
}

fn not_positive(parameter: &'static str, value: f32) -> (String, String) {
    let error = ConfigError::NotPositive { parameter, value };
    (format!("{error:?}"), format!("{parameter} {value} must be above 0 and finite"))
}

fn negative(parameter: &'static str, value: f32) -> (String, String) {
    let error = ConfigError::Negative { parameter, value };
    (format!("{error:?}"), format!("{parameter} {value} must be 0 or more and finite"))
}

fn not_finite(parameter: &'static str, value: f32) -> (String, String) {
    let error = ConfigError::NotFinite { parameter, value };
    (format!("{error:?}"), format!("{parameter} {value} must be finite"))
}

fn out_of_range(parameter: &'static str, value: f32, [min, max]: [f32; 2]) -> (String, String) {
    let error = ConfigError::OutOfRange { parameter, value, min, max };
    (format!("{error:?}"), format!("{parameter} {value} must lie in {min}..={max}"))
}

fn not_rising(
    parameter: &'static str,
    index: usize,
    value: f32,
    previous: f32,
) -> (String, String) {
    let error = ConfigError::NotRising { parameter, index, value, previous };
    let text =
        format!("{parameter} must rise strictly, but number {index} is {value} after {previous}");
    (format!("{error:?}"), text)
}

#[test]
fn the_words_themselves() {
    let says = |result: Result<StepForward<f32>, ConfigError>| result.unwrap_err().to_string();
    assert_eq!(says(StepForward::try_new(0.0)), "threshold 0 must be above 0 and finite");
    assert_eq!(says(StepForward::try_new(-0.5)), "threshold -0.5 must be above 0 and finite");
    assert_eq!(says(StepForward::try_new(f32::NAN)), "threshold NaN must be above 0 and finite");
    let centres = Position::try_new([0.0_f32, 1.0, 0.5]);
    assert_eq!(
        centres.unwrap_err().to_string(),
        "centres must rise strictly, but number 2 is 0.5 after 1"
    );
    let taps = Taps::try_new([0_i16; 3]);
    assert_eq!(taps.unwrap_err().to_string(), "filter taps are all 0; at least one must not be");
    let calibration = Calibration::<f32>::new();
    assert_eq!(
        calibration.differences().unwrap_err().to_string(),
        "the calibration has seen 0 samples and needs at least 3"
    );
}

#[test]
fn thresholds_of_the_temporal_codes() {
    for value in [0.0, -0.0, -1.0, -1e-45, f32::MIN].into_iter().chain(BAD) {
        let expected = not_positive("threshold", value);
        assert_eq!(refusal(TemporalContrast::try_new(value)), expected);
        assert_eq!(refusal(StepForward::try_new(value)), expected);
        assert_eq!(refusal(MovingWindow::<_, 5>::try_new(value)), expected);
        let expected = not_positive("step", value);
        assert_eq!(refusal(TemporalContrast::new(1.0).try_with_step(value)), expected);
    }
    for value in [0, -1, i16::MIN] {
        assert_eq!(refusal(StepForward::try_new(value)), not_positive("threshold", value.into()));
        let fixed = I8F8::from_bits(value);
        let expected = not_positive("threshold", fixed.to_num());
        assert_eq!(refusal(TemporalContrast::try_new(fixed)), expected);
        assert_eq!(refusal(MovingWindow::<_, 5>::try_new(fixed)), expected);
    }
    for value in [1e-45, f32::MAX] {
        assert!(MovingWindow::<_, 5>::try_new(value).is_ok());
        assert!(TemporalContrast::new(value).try_with_step(value).is_ok());
    }
    assert!(StepForward::try_new(1e-45).is_ok() && StepForward::try_new(1e31).is_ok());
    let (parameter, value, min, max) = ("threshold", 1e32, 1e-45, 1e31);
    let expected = ConfigError::OutOfRange { parameter, value, min, max };
    assert_eq!(StepForward::try_new(value), Err(expected));
    assert!(StepForward::try_new(I16F16::DELTA).is_ok());
    // What doubles must fit the type.
    let (half, quarter) = (I8F8::from_num(64), I8F8::from_num(63.9));
    assert!(AdaptiveStepForward::try_new(half, 1).is_err());
    assert!(AdaptiveStepForward::try_new(quarter, 1).is_ok());
    assert!(AdaptiveStepForward::try_new(I16F16::from_num(16_384), 1).is_err());
    assert!(AdaptiveStepForward::try_new(I16F16::from_num(16_383), 1).is_ok());
}

#[test]
fn thresholds_of_the_rate_codes() {
    let taps = Taps::<f32, 3>::triangular(1.0);
    for value in [-1.0, -1e-45, f32::MIN].into_iter().chain(BAD) {
        let expected = negative("threshold", value);
        assert_eq!(refusal(ThresholdHough::try_new(taps, value)), expected);
        assert_eq!(refusal(Bsa::try_subtractive(taps, value)), expected);
        assert_eq!(refusal(Bsa::try_new(taps, Criterion::Subtractive(value))), expected);
    }
    for value in [0.0, -0.0, -1.0, 6.1e-5, 4.0, 3.999_95, f32::MAX].into_iter().chain(BAD) {
        let expected = out_of_range("threshold", value, RATIOS);
        assert_eq!(refusal(Bsa::try_multiplicative(taps, value)), expected);
        assert_eq!(refusal(Bsa::try_new(taps, Criterion::Multiplicative(value))), expected);
        assert_eq!(refusal(BsaToolbox::try_new(taps, value)), expected);
    }
    for value in RATIOS {
        assert!(
            Bsa::try_multiplicative(taps, value).is_ok()
                && BsaToolbox::try_new(taps, value).is_ok()
        );
    }
    assert!(ThresholdHough::try_new(taps, 0.0).is_ok() && Bsa::try_subtractive(taps, 0.0).is_ok());
    let taps = Taps::<i16, 3>::triangular(10);
    assert_eq!(refusal(Bsa::try_subtractive(taps, -1)), negative("threshold", -1.0));
    assert_eq!(refusal(ThresholdHough::try_new(taps, i16::MIN)), negative("threshold", -32_768.0));
}

#[test]
fn shifts() {
    let taps = Taps::<f32, 3>::triangular(1.0);
    for value in BAD {
        let expected = not_finite("shift", value);
        assert_eq!(refusal(Hough::new(taps).try_with_shift(value)), expected);
        assert_eq!(
            refusal(ThresholdHough::try_new(taps, 0.0).unwrap().try_with_shift(value)),
            expected
        );
        assert_eq!(
            refusal(Bsa::try_subtractive(taps, 0.0).unwrap().try_with_shift(value)),
            expected
        );
        assert_eq!(
            refusal(BsaToolbox::try_new(taps, 1.0).unwrap().try_with_shift(value)),
            expected
        );
    }
    for value in [1e31, -1e31] {
        assert!(Hough::new(taps).try_with_shift(value).is_ok());
        let beyond = out_of_range("shift", 10.0 * value, [-1e31, 1e31]);
        assert_eq!(refusal(Hough::new(taps).try_with_shift(10.0 * value)), beyond);
    }
}

#[test]
fn taps() {
    for value in BAD {
        assert_eq!(refusal(Taps::try_new([1.0, value])), not_finite("filter tap", value));
    }
    let all_zero = ConfigError::AllZero { parameter: "filter taps" };
    assert_eq!(Taps::try_new([0.0_f32, -0.0]), Err(all_zero));
    assert_eq!(Taps::try_new([I8F8::ZERO; 5]), Err(all_zero));
    // A tenth of the last place rounds to nothing.
    assert_eq!(Taps::<i16, 20>::try_shaped(Shape::Triangular, Scale::Sum(2)), Err(all_zero));

    let parameter = "sum of the filter taps' magnitudes";
    let most = [0.0, I16F16::MAX.to_num()];
    let sum = refusal(Taps::try_new([I16F16::MAX, I16F16::NEG_ONE]));
    assert_eq!(sum, out_of_range(parameter, 32_769.0, most));
    let sum = refusal(Taps::try_new([f32::MAX, f32::MIN]));
    assert_eq!(sum, out_of_range(parameter, f32::INFINITY, [0.0, 1e31]));
    assert!(Taps::try_new([1e31]).is_ok());
    // Sixteen bits widen, so that any taps will do.
    assert!(Taps::try_new([i16::MIN; 4096]).is_ok());

    for value in [0.0, -1.0].into_iter().chain(BAD) {
        let expected = not_positive("filter scale", value);
        assert_eq!(refusal(Taps::<_, 3>::try_shaped(Shape::Hann, Scale::Sum(value))), expected);
        assert_eq!(
            refusal(Taps::<_, 3>::try_shaped(Shape::Triangular, Scale::Peak(value))),
            expected
        );
        let shape = Shape::Gaussian { alpha: value.into() };
        let expected = not_positive("alpha", value);
        assert_eq!(refusal(Taps::<_, 3>::try_shaped(shape, Scale::Sum(1.0_f32))), expected);
    }
}

#[test]
fn centres() {
    for value in BAD {
        assert_eq!(refusal(Position::try_new([0.0, value, 1.0])), not_finite("centre", value));
        let expected = not_finite("min", value);
        assert_eq!(refusal(Position::<_, 5>::try_linear(value..=1.0)), expected);
        assert_eq!(refusal(Position::<_, 5>::try_gaussian_spaced(value..=1.0)), expected);
        let expected = not_finite("max", value);
        assert_eq!(refusal(Position::<_, 5>::try_linear(0.0..=value)), expected);
        assert_eq!(refusal(Position::<_, 5>::try_gaussian_spaced(0.0..=value)), expected);
    }
    for [min, max] in [[1.0, 1.0], [0.0, -0.0], [1.0, -1.0]] {
        let expected = not_rising("min and max", 1, max, min);
        assert_eq!(refusal(Position::<_, 5>::try_linear(min..=max)), expected);
        assert_eq!(refusal(Position::<_, 5>::try_gaussian_spaced(min..=max)), expected);
        assert_eq!(refusal(Slots::<_, 5, 10>::try_new(min..=max, 1.5)), expected);
        assert_eq!(refusal(Probabilistic::<_, Pcg32, 5, 16>::try_new(min..=max, 1.5)), expected);
    }
    assert_eq!(refusal(Position::try_new([0.0, 1.0, 1.0])), not_rising("centres", 2, 1.0, 1.0));
    assert_eq!(refusal(Position::try_new([2.0, -1.0, 5.0])), not_rising("centres", 1, -1.0, 2.0));
    assert_eq!(refusal(Position::try_new([-0.0, 0.0, 5.0])), not_rising("centres", 1, 0.0, -0.0));
    assert_eq!(refusal(Position::try_new([3, 4, 4_i16])), not_rising("centres", 2, 4.0, 4.0));
    // Too fine for the type: -0.25, 0.25, 0.75, 1.25 in whole counts.
    assert_eq!(refusal(Position::<i16, 4>::try_linear(0..=1)), not_rising("centres", 1, 0.0, 0.0));
    // Half a spacing beyond the largest float.
    let beyond = refusal(Position::<f32, 3>::try_linear(f32::MIN..=f32::MAX));
    assert_eq!(beyond, not_finite("centre", f32::NEG_INFINITY));
}

#[test]
fn fields_and_floors() {
    for value in [0.0, -1.5].into_iter().chain(BAD) {
        let expected = not_positive("beta", value);
        assert_eq!(refusal(Slots::<_, 5, 10>::try_new(0.0_f32..=1.0, value)), expected);
        let random = Probabilistic::<_, Pcg32, 5, 16>::try_new(0.0_f32..=1.0, value);
        assert_eq!(refusal(random), expected);
    }
    let slots = Slots::<f32, 5, 10>::new(0.0..=1.0, 1.5);
    for floor in [0, 11, u16::MAX] {
        let expected = out_of_range("floor", floor.into(), [1.0, 10.0]);
        assert_eq!(refusal(slots.try_with_floor(floor)), expected);
    }
    assert!(slots.try_with_floor(1).is_ok());
    assert!(slots.try_with_floor(10).is_ok());
}

#[test]
fn calibrations() {
    let mut calibration = Calibration::new();
    for seen in 0..3 {
        let expected = ConfigError::TooFewSamples { seen, needed: 3 };
        assert_eq!(TemporalContrast::from_calibration(&calibration, 1.0), Err(expected));
        assert_eq!(TemporalContrast::from_magnitudes(&calibration, 1.0), Err(expected));
        calibration.observe(4.0_f32);
    }
    // A signal that never moved has no threshold.
    let expected = not_positive("threshold", 0.0);
    assert_eq!(refusal(TemporalContrast::from_calibration(&calibration, 1.0)), expected);
    assert_eq!(refusal(TemporalContrast::from_magnitudes(&calibration, 1.0)), expected);
    for factor in BAD {
        let expected = not_finite("factor", factor);
        assert_eq!(refusal(TemporalContrast::from_calibration(&calibration, factor)), expected);
        assert_eq!(refusal(TemporalContrast::from_magnitudes(&calibration, factor)), expected);
    }
}
