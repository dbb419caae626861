//! Every scheme of the catalogue in its usual shapes. Written by `cargo xtask write c`.

use fixed::types::{I8F8, I16F16};
use spikewire::{Calibration, population, rate, temporal, timing};

crate::codecs! {
    /// Temporal contrast (TBR): changes, as an event camera sees them; drifts.
    temporal_contrast_f32: temporal::TemporalContrast<f32> {
        /// `threshold`: what the difference from the sample before must exceed; `step`: what the decoder adds for a spike; both above 0.
        made init(threshold: f32, step: f32) = temporal::TemporalContrast::try_new(threshold)?.try_with_step(step);
        /// The threshold is the mean of the differences' magnitudes and `factor` of their standard deviations, and the decoder's step.
        made init_calibrated(calibration: Calibration<f32>, factor: f32) = temporal::TemporalContrast::from_magnitudes(&calibration, factor);
    }
    /// Temporal contrast (TBR): changes, as an event camera sees them; drifts.
    temporal_contrast_i16: temporal::TemporalContrast<i16> {
        /// `threshold`: what the difference from the sample before must exceed; `step`: what the decoder adds for a spike; both above 0.
        made init(threshold: i16, step: i16) = temporal::TemporalContrast::try_new(threshold)?.try_with_step(step);
        /// The threshold is the mean of the differences' magnitudes and `factor` of their standard deviations, and the decoder's step.
        made init_calibrated(calibration: Calibration<i16>, factor: f32) = temporal::TemporalContrast::from_magnitudes(&calibration, factor);
    }
    /// Temporal contrast (TBR): changes, as an event camera sees them; drifts.
    temporal_contrast_q8_8: temporal::TemporalContrast<I8F8> {
        /// `threshold`: what the difference from the sample before must exceed; `step`: what the decoder adds for a spike; both above 0.
        made init(threshold: I8F8, step: I8F8) = temporal::TemporalContrast::try_new(threshold)?.try_with_step(step);
        /// The threshold is the mean of the differences' magnitudes and `factor` of their standard deviations, and the decoder's step.
        made init_calibrated(calibration: Calibration<I8F8>, factor: f32) = temporal::TemporalContrast::from_magnitudes(&calibration, factor);
    }
    /// Temporal contrast (TBR): changes, as an event camera sees them; drifts.
    temporal_contrast_q16_16: temporal::TemporalContrast<I16F16> {
        /// `threshold`: what the difference from the sample before must exceed; `step`: what the decoder adds for a spike; both above 0.
        made init(threshold: I16F16, step: I16F16) = temporal::TemporalContrast::try_new(threshold)?.try_with_step(step);
        /// The threshold is the mean of the differences' magnitudes and `factor` of their standard deviations, and the decoder's step.
        made init_calibrated(calibration: Calibration<I16F16>, factor: f32) = temporal::TemporalContrast::from_magnitudes(&calibration, factor);
    }
    /// Adaptive temporal contrast: changes whose size differs much between rest and flight; drifts.
    adaptive_contrast_f32: temporal::AdaptiveContrast<f32> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 15.
        made init(threshold: f32, doublings: u8) = temporal::AdaptiveContrast::try_new(threshold, doublings);
    }
    /// Adaptive temporal contrast: changes whose size differs much between rest and flight; drifts.
    adaptive_contrast_i16: temporal::AdaptiveContrast<i16> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 15.
        made init(threshold: i16, doublings: u8) = temporal::AdaptiveContrast::try_new(threshold, doublings);
    }
    /// Adaptive temporal contrast: changes whose size differs much between rest and flight; drifts.
    adaptive_contrast_q8_8: temporal::AdaptiveContrast<I8F8> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 15.
        made init(threshold: I8F8, doublings: u8) = temporal::AdaptiveContrast::try_new(threshold, doublings);
    }
    /// Adaptive temporal contrast: changes whose size differs much between rest and flight; drifts.
    adaptive_contrast_q16_16: temporal::AdaptiveContrast<I16F16> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 15.
        made init(threshold: I16F16, doublings: u8) = temporal::AdaptiveContrast::try_new(threshold, doublings);
    }
    /// Moving window (MW): changes against a short past; drifts.
    moving_window_6_f32: temporal::MovingWindow<f32, 6> {
        /// `threshold`: what the distance from the window's mean must exceed, above 0.
        made init(threshold: f32) = temporal::MovingWindow::try_new(threshold);
    }
    /// Moving window (MW): changes against a short past; drifts.
    moving_window_6_i16: temporal::MovingWindow<i16, 6> {
        /// `threshold`: what the distance from the window's mean must exceed, above 0.
        made init(threshold: i16) = temporal::MovingWindow::try_new(threshold);
    }
    /// Moving window (MW): changes against a short past; drifts.
    moving_window_6_q8_8: temporal::MovingWindow<I8F8, 6> {
        /// `threshold`: what the distance from the window's mean must exceed, above 0.
        made init(threshold: I8F8) = temporal::MovingWindow::try_new(threshold);
    }
    /// Moving window (MW): changes against a short past; drifts.
    moving_window_6_q16_16: temporal::MovingWindow<I16F16, 6> {
        /// `threshold`: what the distance from the window's mean must exceed, above 0.
        made init(threshold: I16F16) = temporal::MovingWindow::try_new(threshold);
    }
    /// Step forward (SF): following a signal closely with few spikes, while it changes by a threshold a sample at most.
    step_forward_f32: temporal::StepForward<f32> {
        /// `threshold`: what the distance from the baseline must exceed, above 0.
        made init(threshold: f32) = temporal::StepForward::try_new(threshold);
    }
    /// Step forward (SF): following a signal closely with few spikes, while it changes by a threshold a sample at most.
    step_forward_i16: temporal::StepForward<i16> {
        /// `threshold`: what the distance from the baseline must exceed, above 0.
        made init(threshold: i16) = temporal::StepForward::try_new(threshold);
    }
    /// Step forward (SF): following a signal closely with few spikes, while it changes by a threshold a sample at most.
    step_forward_q8_8: temporal::StepForward<I8F8> {
        /// `threshold`: what the distance from the baseline must exceed, above 0.
        made init(threshold: I8F8) = temporal::StepForward::try_new(threshold);
    }
    /// Step forward (SF): following a signal closely with few spikes, while it changes by a threshold a sample at most.
    step_forward_q16_16: temporal::StepForward<I16F16> {
        /// `threshold`: what the distance from the baseline must exceed, above 0.
        made init(threshold: I16F16) = temporal::StepForward::try_new(threshold);
    }
    /// Send-on-delta: following a signal that jumps by several thresholds a sample.
    send_on_delta_4_f32: temporal::SendOnDelta<f32, 4> {
        /// `threshold`: of a spike, above 0.
        made init(threshold: f32) = temporal::SendOnDelta::try_new(threshold);
    }
    /// Send-on-delta: following a signal that jumps by several thresholds a sample.
    send_on_delta_4_i16: temporal::SendOnDelta<i16, 4> {
        /// `threshold`: of a spike, above 0.
        made init(threshold: i16) = temporal::SendOnDelta::try_new(threshold);
    }
    /// Send-on-delta: following a signal that jumps by several thresholds a sample.
    send_on_delta_4_q8_8: temporal::SendOnDelta<I8F8, 4> {
        /// `threshold`: of a spike, above 0.
        made init(threshold: I8F8) = temporal::SendOnDelta::try_new(threshold);
    }
    /// Send-on-delta: following a signal that jumps by several thresholds a sample.
    send_on_delta_4_q16_16: temporal::SendOnDelta<I16F16, 4> {
        /// `threshold`: of a spike, above 0.
        made init(threshold: I16F16) = temporal::SendOnDelta::try_new(threshold);
    }
    /// Adaptive step forward: following a signal that jumps, with one spike a sample at most.
    adaptive_step_forward_f32: temporal::AdaptiveStepForward<f32> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 30.
        made init(threshold: f32, doublings: u8) = temporal::AdaptiveStepForward::try_new(threshold, doublings);
    }
    /// Adaptive step forward: following a signal that jumps, with one spike a sample at most.
    adaptive_step_forward_i16: temporal::AdaptiveStepForward<i16> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 30.
        made init(threshold: i16, doublings: u8) = temporal::AdaptiveStepForward::try_new(threshold, doublings);
    }
    /// Adaptive step forward: following a signal that jumps, with one spike a sample at most.
    adaptive_step_forward_q8_8: temporal::AdaptiveStepForward<I8F8> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 30.
        made init(threshold: I8F8, doublings: u8) = temporal::AdaptiveStepForward::try_new(threshold, doublings);
    }
    /// Adaptive step forward: following a signal that jumps, with one spike a sample at most.
    adaptive_step_forward_q16_16: temporal::AdaptiveStepForward<I16F16> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 30.
        made init(threshold: I16F16, doublings: u8) = temporal::AdaptiveStepForward::try_new(threshold, doublings);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_24_f32: rate::Bsa<f32, 24> {
        /// `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [f32; 24], threshold: f32, shift: f32) = rate::Bsa::try_subtractive(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init_sum(shape: rate::Shape, sum: f32, threshold: f32, shift: f32) = rate::Bsa::try_subtractive(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_factor(shape: rate::Shape, sum: f32, factor: f32, shift: f32) = rate::Bsa::try_multiplicative(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, factor)?.try_with_shift(shift);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_24_i16: rate::Bsa<i16, 24> {
        /// `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [i16; 24], threshold: i16, shift: i16) = rate::Bsa::try_subtractive(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init_sum(shape: rate::Shape, sum: i16, threshold: i16, shift: i16) = rate::Bsa::try_subtractive(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_factor(shape: rate::Shape, sum: i16, factor: f32, shift: i16) = rate::Bsa::try_multiplicative(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, factor)?.try_with_shift(shift);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_24_q8_8: rate::Bsa<I8F8, 24> {
        /// `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [I8F8; 24], threshold: I8F8, shift: I8F8) = rate::Bsa::try_subtractive(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init_sum(shape: rate::Shape, sum: I8F8, threshold: I8F8, shift: I8F8) = rate::Bsa::try_subtractive(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_factor(shape: rate::Shape, sum: I8F8, factor: f32, shift: I8F8) = rate::Bsa::try_multiplicative(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, factor)?.try_with_shift(shift);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_24_q16_16: rate::Bsa<I16F16, 24> {
        /// `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [I16F16; 24], threshold: I16F16, shift: I16F16) = rate::Bsa::try_subtractive(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init_sum(shape: rate::Shape, sum: I16F16, threshold: I16F16, shift: I16F16) = rate::Bsa::try_subtractive(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_factor(shape: rate::Shape, sum: I16F16, factor: f32, shift: I16F16) = rate::Bsa::try_multiplicative(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, factor)?.try_with_shift(shift);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_toolbox_9_f32: rate::BsaToolbox<f32, 9> {
        /// `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [f32; 9], factor: f32, shift: f32) = rate::BsaToolbox::try_new(rate::Taps::try_new(taps)?, factor)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: f32, factor: f32, shift: f32) = rate::BsaToolbox::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, factor)?.try_with_shift(shift);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_toolbox_9_i16: rate::BsaToolbox<i16, 9> {
        /// `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [i16; 9], factor: f32, shift: i16) = rate::BsaToolbox::try_new(rate::Taps::try_new(taps)?, factor)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: i16, factor: f32, shift: i16) = rate::BsaToolbox::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, factor)?.try_with_shift(shift);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_toolbox_9_q8_8: rate::BsaToolbox<I8F8, 9> {
        /// `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [I8F8; 9], factor: f32, shift: I8F8) = rate::BsaToolbox::try_new(rate::Taps::try_new(taps)?, factor)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: I8F8, factor: f32, shift: I8F8) = rate::BsaToolbox::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, factor)?.try_with_shift(shift);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_toolbox_9_q16_16: rate::BsaToolbox<I16F16, 9> {
        /// `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [I16F16; 9], factor: f32, shift: I16F16) = rate::BsaToolbox::try_new(rate::Taps::try_new(taps)?, factor)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: I16F16, factor: f32, shift: I16F16) = rate::BsaToolbox::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, factor)?.try_with_shift(shift);
    }
    /// Hough spiker (HSA): a value that is never above the signal.
    hough_15_f32: rate::Hough<f32, 15> {
        /// `taps`: of the filter; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [f32; 15], shift: f32) = rate::Hough::new(rate::Taps::try_new(taps)?).try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: f32, shift: f32) = rate::Hough::new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?).try_with_shift(shift);
    }
    /// Hough spiker (HSA): a value that is never above the signal.
    hough_15_i16: rate::Hough<i16, 15> {
        /// `taps`: of the filter; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [i16; 15], shift: i16) = rate::Hough::new(rate::Taps::try_new(taps)?).try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: i16, shift: i16) = rate::Hough::new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?).try_with_shift(shift);
    }
    /// Hough spiker (HSA): a value that is never above the signal.
    hough_15_q8_8: rate::Hough<I8F8, 15> {
        /// `taps`: of the filter; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [I8F8; 15], shift: I8F8) = rate::Hough::new(rate::Taps::try_new(taps)?).try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: I8F8, shift: I8F8) = rate::Hough::new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?).try_with_shift(shift);
    }
    /// Hough spiker (HSA): a value that is never above the signal.
    hough_15_q16_16: rate::Hough<I16F16, 15> {
        /// `taps`: of the filter; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [I16F16; 15], shift: I16F16) = rate::Hough::new(rate::Taps::try_new(taps)?).try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: I16F16, shift: I16F16) = rate::Hough::new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?).try_with_shift(shift);
    }
    /// Threshold Hough spiker (T-HSA): the nearest reconstruction of the rate codes at the paper's settings.
    threshold_hough_15_f32: rate::ThresholdHough<f32, 15> {
        /// `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [f32; 15], threshold: f32, shift: f32) = rate::ThresholdHough::try_new(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may fall short of it in all; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: f32, threshold: f32, shift: f32) = rate::ThresholdHough::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, threshold)?.try_with_shift(shift);
    }
    /// Threshold Hough spiker (T-HSA): the nearest reconstruction of the rate codes at the paper's settings.
    threshold_hough_15_i16: rate::ThresholdHough<i16, 15> {
        /// `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [i16; 15], threshold: i16, shift: i16) = rate::ThresholdHough::try_new(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may fall short of it in all; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: i16, threshold: i16, shift: i16) = rate::ThresholdHough::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, threshold)?.try_with_shift(shift);
    }
    /// Threshold Hough spiker (T-HSA): the nearest reconstruction of the rate codes at the paper's settings.
    threshold_hough_15_q8_8: rate::ThresholdHough<I8F8, 15> {
        /// `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [I8F8; 15], threshold: I8F8, shift: I8F8) = rate::ThresholdHough::try_new(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may fall short of it in all; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: I8F8, threshold: I8F8, shift: I8F8) = rate::ThresholdHough::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, threshold)?.try_with_shift(shift);
    }
    /// Threshold Hough spiker (T-HSA): the nearest reconstruction of the rate codes at the paper's settings.
    threshold_hough_15_q16_16: rate::ThresholdHough<I16F16, 15> {
        /// `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [I16F16; 15], threshold: I16F16, shift: I16F16) = rate::ThresholdHough::try_new(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may fall short of it in all; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: I16F16, threshold: I16F16, shift: I16F16) = rate::ThresholdHough::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, threshold)?.try_with_shift(shift);
    }
    /// Integrate and fire (IF): a mean, and an integral that never drifts: a gyroscope's angle.
    integrate_and_fire_8_f32: rate::IntegrateAndFire<f32, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: f32, power: u8, reference: f32) = rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference);
    }
    /// Integrate and fire (IF): a mean, and an integral that never drifts: a gyroscope's angle.
    integrate_and_fire_8_i16: rate::IntegrateAndFire<i16, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: i16, power: u8, reference: i16) = rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference);
    }
    /// Integrate and fire (IF): a mean, and an integral that never drifts: a gyroscope's angle.
    integrate_and_fire_8_q8_8: rate::IntegrateAndFire<I8F8, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: I8F8, power: u8, reference: I8F8) = rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference);
    }
    /// Integrate and fire (IF): a mean, and an integral that never drifts: a gyroscope's angle.
    integrate_and_fire_8_q16_16: rate::IntegrateAndFire<I16F16, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: I16F16, power: u8, reference: I16F16) = rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference);
    }
    /// Leaky integrate and fire (LIF): a mean that forgets, silent for what stays small.
    leaky_integrate_and_fire_8_f32: rate::IntegrateAndFire<f32, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: mean and leak are over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: f32, power: u8, reference: f32) = Ok(rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference)?.leaky());
    }
    /// Leaky integrate and fire (LIF): a mean that forgets, silent for what stays small.
    leaky_integrate_and_fire_8_i16: rate::IntegrateAndFire<i16, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: mean and leak are over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: i16, power: u8, reference: i16) = Ok(rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference)?.leaky());
    }
    /// Leaky integrate and fire (LIF): a mean that forgets, silent for what stays small.
    leaky_integrate_and_fire_8_q8_8: rate::IntegrateAndFire<I8F8, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: mean and leak are over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: I8F8, power: u8, reference: I8F8) = Ok(rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference)?.leaky());
    }
    /// Leaky integrate and fire (LIF): a mean that forgets, silent for what stays small.
    leaky_integrate_and_fire_8_q16_16: rate::IntegrateAndFire<I16F16, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: mean and leak are over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: I16F16, power: u8, reference: I16F16) = Ok(rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference)?.leaky());
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_f32: rate::SigmaDelta<f32, rate::Average> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: f32, max: f32, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Average::try_new(power)?);
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_i16: rate::SigmaDelta<i16, rate::Average> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: i16, max: i16, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Average::try_new(power)?);
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_q8_8: rate::SigmaDelta<I8F8, rate::Average> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: I8F8, max: I8F8, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Average::try_new(power)?);
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_q16_16: rate::SigmaDelta<I16F16, rate::Average> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: I16F16, max: I16F16, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Average::try_new(power)?);
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_window_2_f32: rate::SigmaDelta<f32, rate::Window<2>> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's mean is over 2^power samples, at most 32 a word.
        made init(min: f32, max: f32, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Window::try_new(power)?);
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_window_2_i16: rate::SigmaDelta<i16, rate::Window<2>> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's mean is over 2^power samples, at most 32 a word.
        made init(min: i16, max: i16, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Window::try_new(power)?);
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_window_2_q8_8: rate::SigmaDelta<I8F8, rate::Window<2>> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's mean is over 2^power samples, at most 32 a word.
        made init(min: I8F8, max: I8F8, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Window::try_new(power)?);
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_window_2_q16_16: rate::SigmaDelta<I16F16, rate::Window<2>> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's mean is over 2^power samples, at most 32 a word.
        made init(min: I16F16, max: I16F16, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Window::try_new(power)?);
    }
    /// Bursts of doubling weight: a mean from one neuron, where few spikes may tell little and many in a row much.
    weighted_burst_f32: rate::WeightedBurst<f32, rate::Average> {
        /// `min`, `max`: the range, which must rise. `weight`: of a burst's first spike; `doublings`: of the weight, 0 to 14; `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: f32, max: f32, weight: f32, doublings: u8, power: u8) = rate::WeightedBurst::try_new(min..=max, weight, doublings, rate::Average::try_new(power)?);
    }
    /// Bursts of doubling weight: a mean from one neuron, where few spikes may tell little and many in a row much.
    weighted_burst_i16: rate::WeightedBurst<i16, rate::Average> {
        /// `min`, `max`: the range, which must rise. `weight`: of a burst's first spike; `doublings`: of the weight, 0 to 14; `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: i16, max: i16, weight: i16, doublings: u8, power: u8) = rate::WeightedBurst::try_new(min..=max, weight, doublings, rate::Average::try_new(power)?);
    }
    /// Bursts of doubling weight: a mean from one neuron, where few spikes may tell little and many in a row much.
    weighted_burst_q8_8: rate::WeightedBurst<I8F8, rate::Average> {
        /// `min`, `max`: the range, which must rise. `weight`: of a burst's first spike; `doublings`: of the weight, 0 to 14; `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: I8F8, max: I8F8, weight: I8F8, doublings: u8, power: u8) = rate::WeightedBurst::try_new(min..=max, weight, doublings, rate::Average::try_new(power)?);
    }
    /// Bursts of doubling weight: a mean from one neuron, where few spikes may tell little and many in a row much.
    weighted_burst_q16_16: rate::WeightedBurst<I16F16, rate::Average> {
        /// `min`, `max`: the range, which must rise. `weight`: of a burst's first spike; `doublings`: of the weight, 0 to 14; `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: I16F16, max: I16F16, weight: I16F16, doublings: u8, power: u8) = rate::WeightedBurst::try_new(min..=max, weight, doublings, rate::Average::try_new(power)?);
    }
    /// Position: a value, dense where it matters.
    position_20_f32: population::Position<f32, 20> {
        /// `centres`: of the neurons, rising.
        made init(centres: [f32; 20]) = population::Position::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: f32, max: f32) = population::Position::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. The centres are dense in the middle.
        made init_gaussian(min: f32, max: f32) = population::Position::try_gaussian_spaced(min..=max);
    }
    /// Position: a value, dense where it matters.
    position_20_i16: population::Position<i16, 20> {
        /// `centres`: of the neurons, rising.
        made init(centres: [i16; 20]) = population::Position::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: i16, max: i16) = population::Position::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. The centres are dense in the middle.
        made init_gaussian(min: i16, max: i16) = population::Position::try_gaussian_spaced(min..=max);
    }
    /// Position: a value, dense where it matters.
    position_20_q8_8: population::Position<I8F8, 20> {
        /// `centres`: of the neurons, rising.
        made init(centres: [I8F8; 20]) = population::Position::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: I8F8, max: I8F8) = population::Position::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. The centres are dense in the middle.
        made init_gaussian(min: I8F8, max: I8F8) = population::Position::try_gaussian_spaced(min..=max);
    }
    /// Position: a value, dense where it matters.
    position_20_q16_16: population::Position<I16F16, 20> {
        /// `centres`: of the neurons, rising.
        made init(centres: [I16F16; 20]) = population::Position::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: I16F16, max: I16F16) = population::Position::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. The centres are dense in the middle.
        made init_gaussian(min: I16F16, max: I16F16) = population::Position::try_gaussian_spaced(min..=max);
    }
    /// Gaussian receptive fields (GRF): a value over an even range.
    gaussian_20_f32: population::Gaussian<f32, 20> {
        /// `min`, `max`: the range, which must rise.
        made init(min: f32, max: f32) = population::Gaussian::try_linear(min..=max);
    }
    /// Gaussian receptive fields (GRF): a value over an even range.
    gaussian_20_i16: population::Gaussian<i16, 20> {
        /// `min`, `max`: the range, which must rise.
        made init(min: i16, max: i16) = population::Gaussian::try_linear(min..=max);
    }
    /// Gaussian receptive fields (GRF): a value over an even range.
    gaussian_20_q8_8: population::Gaussian<I8F8, 20> {
        /// `min`, `max`: the range, which must rise.
        made init(min: I8F8, max: I8F8) = population::Gaussian::try_linear(min..=max);
    }
    /// Gaussian receptive fields (GRF): a value over an even range.
    gaussian_20_q16_16: population::Gaussian<I16F16, 20> {
        /// `min`, `max`: the range, which must rise.
        made init(min: I16F16, max: I16F16) = population::Gaussian::try_linear(min..=max);
    }
    /// GRF with sub-timesteps: a value finer than the neurons, by spike time.
    slots_15_10_f32: population::Slots<f32, 15, 10> {
        /// `min`, `max`: the range, which must rise. `beta`: the fields' width is their distance divided by it, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(min: f32, max: f32, beta: f32, floor: u16) = population::Slots::try_new(min..=max, beta)?.try_with_floor(floor);
    }
    /// GRF with sub-timesteps: a value finer than the neurons, by spike time.
    slots_15_10_i16: population::Slots<i16, 15, 10> {
        /// `min`, `max`: the range, which must rise. `beta`: the fields' width is their distance divided by it, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(min: i16, max: i16, beta: f32, floor: u16) = population::Slots::try_new(min..=max, beta)?.try_with_floor(floor);
    }
    /// GRF with sub-timesteps: a value finer than the neurons, by spike time.
    slots_15_10_q8_8: population::Slots<I8F8, 15, 10> {
        /// `min`, `max`: the range, which must rise. `beta`: the fields' width is their distance divided by it, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(min: I8F8, max: I8F8, beta: f32, floor: u16) = population::Slots::try_new(min..=max, beta)?.try_with_floor(floor);
    }
    /// GRF with sub-timesteps: a value finer than the neurons, by spike time.
    slots_15_10_q16_16: population::Slots<I16F16, 15, 10> {
        /// `min`, `max`: the range, which must rise. `beta`: the fields' width is their distance divided by it, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(min: I16F16, max: I16F16, beta: f32, floor: u16) = population::Slots::try_new(min..=max, beta)?.try_with_floor(floor);
    }
    /// Non-linear Gaussian receptive fields (GRF): a value, finer where it is most of the time.
    non_linear_gaussian_20_f32: population::Gaussian<f32, 20> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0.
        made init(centres: [f32; 20], widths: [f32; 20]) = population::Gaussian::try_with_widths(centres, widths);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0.
        made init_companded(min: f32, max: f32, companding: f32) = population::Gaussian::try_companded(min..=max, companding);
    }
    /// Non-linear Gaussian receptive fields (GRF): a value, finer where it is most of the time.
    non_linear_gaussian_20_i16: population::Gaussian<i16, 20> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0.
        made init(centres: [i16; 20], widths: [f32; 20]) = population::Gaussian::try_with_widths(centres, widths);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0.
        made init_companded(min: i16, max: i16, companding: f32) = population::Gaussian::try_companded(min..=max, companding);
    }
    /// Non-linear Gaussian receptive fields (GRF): a value, finer where it is most of the time.
    non_linear_gaussian_20_q8_8: population::Gaussian<I8F8, 20> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0.
        made init(centres: [I8F8; 20], widths: [f32; 20]) = population::Gaussian::try_with_widths(centres, widths);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0.
        made init_companded(min: I8F8, max: I8F8, companding: f32) = population::Gaussian::try_companded(min..=max, companding);
    }
    /// Non-linear Gaussian receptive fields (GRF): a value, finer where it is most of the time.
    non_linear_gaussian_20_q16_16: population::Gaussian<I16F16, 20> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0.
        made init(centres: [I16F16; 20], widths: [f32; 20]) = population::Gaussian::try_with_widths(centres, widths);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0.
        made init_companded(min: I16F16, max: I16F16, companding: f32) = population::Gaussian::try_companded(min..=max, companding);
    }
    /// Non-linear GRF with sub-timesteps: a value finer than the neurons, by spike time, and finest where it is most of the time.
    non_linear_slots_15_10_f32: population::NonLinearSlots<f32, 15, 10> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(centres: [f32; 15], widths: [f32; 15], floor: u16) = population::NonLinearSlots::try_new(centres, widths)?.try_with_floor(floor);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0; `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init_companded(min: f32, max: f32, companding: f32, beta: f32, floor: u16) = population::NonLinearSlots::try_companded(min..=max, companding, beta)?.try_with_floor(floor);
    }
    /// Non-linear GRF with sub-timesteps: a value finer than the neurons, by spike time, and finest where it is most of the time.
    non_linear_slots_15_10_i16: population::NonLinearSlots<i16, 15, 10> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(centres: [i16; 15], widths: [f32; 15], floor: u16) = population::NonLinearSlots::try_new(centres, widths)?.try_with_floor(floor);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0; `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init_companded(min: i16, max: i16, companding: f32, beta: f32, floor: u16) = population::NonLinearSlots::try_companded(min..=max, companding, beta)?.try_with_floor(floor);
    }
    /// Non-linear GRF with sub-timesteps: a value finer than the neurons, by spike time, and finest where it is most of the time.
    non_linear_slots_15_10_q8_8: population::NonLinearSlots<I8F8, 15, 10> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(centres: [I8F8; 15], widths: [f32; 15], floor: u16) = population::NonLinearSlots::try_new(centres, widths)?.try_with_floor(floor);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0; `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init_companded(min: I8F8, max: I8F8, companding: f32, beta: f32, floor: u16) = population::NonLinearSlots::try_companded(min..=max, companding, beta)?.try_with_floor(floor);
    }
    /// Non-linear GRF with sub-timesteps: a value finer than the neurons, by spike time, and finest where it is most of the time.
    non_linear_slots_15_10_q16_16: population::NonLinearSlots<I16F16, 15, 10> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(centres: [I16F16; 15], widths: [f32; 15], floor: u16) = population::NonLinearSlots::try_new(centres, widths)?.try_with_floor(floor);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0; `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init_companded(min: I16F16, max: I16F16, companding: f32, beta: f32, floor: u16) = population::NonLinearSlots::try_companded(min..=max, companding, beta)?.try_with_floor(floor);
    }
    /// Rank order: a value finer than the neurons, by who fires first.
    rank_order_15_3_f32: population::RankOrder<f32, 15, 3> {
        /// `centres`: of the neurons, rising.
        made init(centres: [f32; 15]) = population::RankOrder::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: f32, max: f32) = population::RankOrder::try_linear(min..=max);
    }
    /// Rank order: a value finer than the neurons, by who fires first.
    rank_order_15_3_i16: population::RankOrder<i16, 15, 3> {
        /// `centres`: of the neurons, rising.
        made init(centres: [i16; 15]) = population::RankOrder::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: i16, max: i16) = population::RankOrder::try_linear(min..=max);
    }
    /// Rank order: a value finer than the neurons, by who fires first.
    rank_order_15_3_q8_8: population::RankOrder<I8F8, 15, 3> {
        /// `centres`: of the neurons, rising.
        made init(centres: [I8F8; 15]) = population::RankOrder::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: I8F8, max: I8F8) = population::RankOrder::try_linear(min..=max);
    }
    /// Rank order: a value finer than the neurons, by who fires first.
    rank_order_15_3_q16_16: population::RankOrder<I16F16, 15, 3> {
        /// `centres`: of the neurons, rising.
        made init(centres: [I16F16; 15]) = population::RankOrder::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: I16F16, max: I16F16) = population::RankOrder::try_linear(min..=max);
    }
    /// Time to first spike: a value by one spike's time, the larger the earlier.
    first_spike_16_f32: timing::FirstSpike<f32, 16> {
        /// `min`, `max`: the range, which must rise. `edges`: the lower ends of the slots' values, rising; values below the first have no spike.
        made init(min: f32, max: f32, edges: [f32; 16]) = timing::FirstSpike::try_new(min..=max, edges);
        /// `min`, `max`: the range, which must rise. All slots stand for as much of it.
        made init_linear(min: f32, max: f32) = timing::FirstSpike::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. `ratio`: of the largest value that has a spike to the smallest, above 1.
        made init_logarithmic(min: f32, max: f32, ratio: f32) = timing::FirstSpike::try_logarithmic(min..=max, ratio);
    }
    /// Time to first spike: a value by one spike's time, the larger the earlier.
    first_spike_16_i16: timing::FirstSpike<i16, 16> {
        /// `min`, `max`: the range, which must rise. `edges`: the lower ends of the slots' values, rising; values below the first have no spike.
        made init(min: i16, max: i16, edges: [i16; 16]) = timing::FirstSpike::try_new(min..=max, edges);
        /// `min`, `max`: the range, which must rise. All slots stand for as much of it.
        made init_linear(min: i16, max: i16) = timing::FirstSpike::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. `ratio`: of the largest value that has a spike to the smallest, above 1.
        made init_logarithmic(min: i16, max: i16, ratio: f32) = timing::FirstSpike::try_logarithmic(min..=max, ratio);
    }
    /// Time to first spike: a value by one spike's time, the larger the earlier.
    first_spike_16_q8_8: timing::FirstSpike<I8F8, 16> {
        /// `min`, `max`: the range, which must rise. `edges`: the lower ends of the slots' values, rising; values below the first have no spike.
        made init(min: I8F8, max: I8F8, edges: [I8F8; 16]) = timing::FirstSpike::try_new(min..=max, edges);
        /// `min`, `max`: the range, which must rise. All slots stand for as much of it.
        made init_linear(min: I8F8, max: I8F8) = timing::FirstSpike::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. `ratio`: of the largest value that has a spike to the smallest, above 1.
        made init_logarithmic(min: I8F8, max: I8F8, ratio: f32) = timing::FirstSpike::try_logarithmic(min..=max, ratio);
    }
    /// Time to first spike: a value by one spike's time, the larger the earlier.
    first_spike_16_q16_16: timing::FirstSpike<I16F16, 16> {
        /// `min`, `max`: the range, which must rise. `edges`: the lower ends of the slots' values, rising; values below the first have no spike.
        made init(min: I16F16, max: I16F16, edges: [I16F16; 16]) = timing::FirstSpike::try_new(min..=max, edges);
        /// `min`, `max`: the range, which must rise. All slots stand for as much of it.
        made init_linear(min: I16F16, max: I16F16) = timing::FirstSpike::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. `ratio`: of the largest value that has a spike to the smallest, above 1.
        made init_logarithmic(min: I16F16, max: I16F16, ratio: f32) = timing::FirstSpike::try_logarithmic(min..=max, ratio);
    }
    /// Latency-phase: channels that share one line, told apart by the phase of their spikes.
    latency_phase_4_32_4_f32: timing::LatencyPhase<f32, 4, 32, 4> {
        /// `min`, `max`: the range, which must rise. `spacing`: from one neuron's peaks to the next's, in slots.
        made init(min: f32, max: f32, spacing: u16) = timing::LatencyPhase::try_new(min..=max, spacing);
    }
    /// Latency-phase: channels that share one line, told apart by the phase of their spikes.
    latency_phase_4_32_4_i16: timing::LatencyPhase<i16, 4, 32, 4> {
        /// `min`, `max`: the range, which must rise. `spacing`: from one neuron's peaks to the next's, in slots.
        made init(min: i16, max: i16, spacing: u16) = timing::LatencyPhase::try_new(min..=max, spacing);
    }
    /// Latency-phase: channels that share one line, told apart by the phase of their spikes.
    latency_phase_4_32_4_q8_8: timing::LatencyPhase<I8F8, 4, 32, 4> {
        /// `min`, `max`: the range, which must rise. `spacing`: from one neuron's peaks to the next's, in slots.
        made init(min: I8F8, max: I8F8, spacing: u16) = timing::LatencyPhase::try_new(min..=max, spacing);
    }
    /// Latency-phase: channels that share one line, told apart by the phase of their spikes.
    latency_phase_4_32_4_q16_16: timing::LatencyPhase<I16F16, 4, 32, 4> {
        /// `min`, `max`: the range, which must rise. `spacing`: from one neuron's peaks to the next's, in slots.
        made init(min: I16F16, max: I16F16, spacing: u16) = timing::LatencyPhase::try_new(min..=max, spacing);
    }
    /// Weighted phase: a value in binary digits: the finest in few sub-timesteps.
    weighted_phase_8_f32: timing::WeightedPhase<f32, 8> {
        /// `min`, `max`: the range, which must rise.
        made init(min: f32, max: f32) = timing::WeightedPhase::try_new(min..=max);
    }
    /// Weighted phase: a value in binary digits: the finest in few sub-timesteps.
    weighted_phase_8_i16: timing::WeightedPhase<i16, 8> {
        /// `min`, `max`: the range, which must rise.
        made init(min: i16, max: i16) = timing::WeightedPhase::try_new(min..=max);
    }
    /// Weighted phase: a value in binary digits: the finest in few sub-timesteps.
    weighted_phase_8_q8_8: timing::WeightedPhase<I8F8, 8> {
        /// `min`, `max`: the range, which must rise.
        made init(min: I8F8, max: I8F8) = timing::WeightedPhase::try_new(min..=max);
    }
    /// Weighted phase: a value in binary digits: the finest in few sub-timesteps.
    weighted_phase_8_q16_16: timing::WeightedPhase<I16F16, 8> {
        /// `min`, `max`: the range, which must rise.
        made init(min: I16F16, max: I16F16) = timing::WeightedPhase::try_new(min..=max);
    }
    /// Burst coding: a value by the count and the interval of its spikes.
    burst_19_f32: timing::Burst<f32, 19> {
        /// `min`, `max`: the range, which must rise. `spikes`: most of a sample, above 0; `shortest`, `longest`: their intervals in slots.
        made init(min: f32, max: f32, spikes: u8, shortest: u8, longest: u8) = timing::Burst::try_new(min..=max, spikes, shortest..=longest);
    }
    /// Burst coding: a value by the count and the interval of its spikes.
    burst_19_i16: timing::Burst<i16, 19> {
        /// `min`, `max`: the range, which must rise. `spikes`: most of a sample, above 0; `shortest`, `longest`: their intervals in slots.
        made init(min: i16, max: i16, spikes: u8, shortest: u8, longest: u8) = timing::Burst::try_new(min..=max, spikes, shortest..=longest);
    }
    /// Burst coding: a value by the count and the interval of its spikes.
    burst_19_q8_8: timing::Burst<I8F8, 19> {
        /// `min`, `max`: the range, which must rise. `spikes`: most of a sample, above 0; `shortest`, `longest`: their intervals in slots.
        made init(min: I8F8, max: I8F8, spikes: u8, shortest: u8, longest: u8) = timing::Burst::try_new(min..=max, spikes, shortest..=longest);
    }
    /// Burst coding: a value by the count and the interval of its spikes.
    burst_19_q16_16: timing::Burst<I16F16, 19> {
        /// `min`, `max`: the range, which must rise. `spikes`: most of a sample, above 0; `shortest`, `longest`: their intervals in slots.
        made init(min: I16F16, max: I16F16, spikes: u8, shortest: u8, longest: u8) = timing::Burst::try_new(min..=max, spikes, shortest..=longest);
    }
}
