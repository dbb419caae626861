//! Every scheme of the catalogue in its usual shapes. Written by `cargo xtask write c`.

use fixed::types::{I8F8, I16F16};
use spikewire::{Calibration, population, rate, temporal, timing};

crate::codecs! {
    for [f32: f32, i16: i16, q8_8: I8F8, q16_16: I16F16];
    /// Temporal contrast (TBR): changes, as an event camera sees them; drifts.
    temporal_contrast: temporal::TemporalContrast<S> {
        /// `threshold`: what the difference from the sample before must exceed; `step`: what the decoder adds for a spike; both above 0.
        made init(threshold: S, step: S) = temporal::TemporalContrast::try_new(threshold)?.try_with_step(step);
        /// The threshold is the mean of the differences' magnitudes and `factor` of their standard deviations, and the decoder's step.
        made init_calibrated(calibration: Calibration<S>, factor: f32) = temporal::TemporalContrast::from_magnitudes(&calibration, factor);
    }
    /// Adaptive temporal contrast: changes whose size differs much between rest and flight; drifts.
    adaptive_contrast: temporal::AdaptiveContrast<S> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 15.
        made init(threshold: S, doublings: u8) = temporal::AdaptiveContrast::try_new(threshold, doublings);
    }
    /// Moving window (MW): changes against a short past; drifts.
    moving_window_6: temporal::MovingWindow<S, 6> {
        /// `threshold`: what the distance from the window's mean must exceed, above 0.
        made init(threshold: S) = temporal::MovingWindow::try_new(threshold);
    }
    /// Step forward (SF): following a signal closely with few spikes, while it changes by a threshold a sample at most.
    step_forward: temporal::StepForward<S> {
        /// `threshold`: what the distance from the baseline must exceed, above 0.
        made init(threshold: S) = temporal::StepForward::try_new(threshold);
    }
    /// Send-on-delta: following a signal that jumps by several thresholds a sample.
    send_on_delta_4: temporal::SendOnDelta<S, 4> {
        /// `threshold`: of a spike, above 0.
        made init(threshold: S) = temporal::SendOnDelta::try_new(threshold);
    }
    /// Adaptive step forward: following a signal that jumps, with one spike a sample at most.
    adaptive_step_forward: temporal::AdaptiveStepForward<S> {
        /// `threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 30.
        made init(threshold: S, doublings: u8) = temporal::AdaptiveStepForward::try_new(threshold, doublings);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_24: rate::Bsa<S, 24> {
        /// `taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [S; 24], threshold: S, shift: S) = rate::Bsa::try_subtractive(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init_sum(shape: rate::Shape, sum: S, threshold: S, shift: S) = rate::Bsa::try_subtractive(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_factor(shape: rate::Shape, sum: S, factor: f32, shift: S) = rate::Bsa::try_multiplicative(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, factor)?.try_with_shift(shift);
    }
    /// Ben's spiker (BSA): a rate code of either sign of taps; with the toolbox's indices the paper's tables.
    bsa_toolbox_9: rate::BsaToolbox<S, 9> {
        /// `taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [S; 9], factor: f32, shift: S) = rate::BsaToolbox::try_new(rate::Taps::try_new(taps)?, factor)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: S, factor: f32, shift: S) = rate::BsaToolbox::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, factor)?.try_with_shift(shift);
    }
    /// Hough spiker (HSA): a value that is never above the signal.
    hough_15: rate::Hough<S, 15> {
        /// `taps`: of the filter; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [S; 15], shift: S) = rate::Hough::new(rate::Taps::try_new(taps)?).try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: S, shift: S) = rate::Hough::new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?).try_with_shift(shift);
    }
    /// Threshold Hough spiker (T-HSA): the nearest reconstruction of the rate codes at the paper's settings.
    threshold_hough_15: rate::ThresholdHough<S, 15> {
        /// `taps`: of the filter; `threshold`: by how much the signal may fall short of it in all, 0 or more; `shift`: what is taken off the samples, at most their minimum.
        made init(taps: [S; 15], threshold: S, shift: S) = rate::ThresholdHough::try_new(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift);
        /// `shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `threshold`: by how much the signal may fall short of it in all; `shift`: what is taken off the samples, at most their minimum.
        made init_peak(shape: rate::Shape, peak: S, threshold: S, shift: S) = rate::ThresholdHough::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, threshold)?.try_with_shift(shift);
    }
    /// Integrate and fire (IF): a mean, and an integral that never drifts: a gyroscope's angle.
    integrate_and_fire_8: rate::IntegrateAndFire<S, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: S, power: u8, reference: S) = rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference);
    }
    /// Leaky integrate and fire (LIF): a mean that forgets, silent for what stays small.
    leaky_integrate_and_fire_8: rate::IntegrateAndFire<S, 8> {
        /// `threshold`: what samples add up to at a spike, above 0; `power`: mean and leak are over 2^power samples, 1 to 15; `reference`: the value without spikes.
        made init(threshold: S, power: u8, reference: S) = Ok(rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference)?.leaky());
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta: rate::SigmaDelta<S, rate::Average> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: S, max: S, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Average::try_new(power)?);
    }
    /// Sigma-delta (regular rate): a mean from one neuron, the more exact the longer it is taken.
    sigma_delta_window_2: rate::SigmaDelta<S, rate::Window<2>> {
        /// `min`, `max`: the range, which must rise. `power`: the decoder's mean is over 2^power samples, at most 32 a word.
        made init(min: S, max: S, power: u8) = rate::SigmaDelta::try_new(min..=max, rate::Window::try_new(power)?);
    }
    /// Bursts of doubling weight: a mean from one neuron, where few spikes may tell little and many in a row much.
    weighted_burst: rate::WeightedBurst<S, rate::Average> {
        /// `min`, `max`: the range, which must rise. `weight`: of a burst's first spike; `doublings`: of the weight, 0 to 14; `power`: the decoder's average is over about 2^power samples, 1 to 15.
        made init(min: S, max: S, weight: S, doublings: u8, power: u8) = rate::WeightedBurst::try_new(min..=max, weight, doublings, rate::Average::try_new(power)?);
    }
    /// Position: a value, dense where it matters.
    position_20: population::Position<S, 20> {
        /// `centres`: of the neurons, rising.
        made init(centres: [S; 20]) = population::Position::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: S, max: S) = population::Position::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. The centres are dense in the middle.
        made init_gaussian(min: S, max: S) = population::Position::try_gaussian_spaced(min..=max);
    }
    /// Gaussian receptive fields (GRF): a value over an even range.
    gaussian_20: population::Gaussian<S, 20> {
        /// `min`, `max`: the range, which must rise.
        made init(min: S, max: S) = population::Gaussian::try_linear(min..=max);
    }
    /// GRF with sub-timesteps: a value finer than the neurons, by spike time.
    slots_15_10: population::Slots<S, 15, 10> {
        /// `min`, `max`: the range, which must rise. `beta`: the fields' width is their distance divided by it, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(min: S, max: S, beta: f32, floor: u16) = population::Slots::try_new(min..=max, beta)?.try_with_floor(floor);
    }
    /// Non-linear Gaussian receptive fields (GRF): a value, finer where it is most of the time.
    non_linear_gaussian_20: population::Gaussian<S, 20> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0.
        made init(centres: [S; 20], widths: [f32; 20]) = population::Gaussian::try_with_widths(centres, widths);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0.
        made init_companded(min: S, max: S, companding: f32) = population::Gaussian::try_companded(min..=max, companding);
    }
    /// Non-linear GRF with sub-timesteps: a value finer than the neurons, by spike time, and finest where it is most of the time.
    non_linear_slots_15_10: population::NonLinearSlots<S, 15, 10> {
        /// `centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init(centres: [S; 15], widths: [f32; 15], floor: u16) = population::NonLinearSlots::try_new(centres, widths)?.try_with_floor(floor);
        /// `min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0; `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are silent, 1 or more.
        made init_companded(min: S, max: S, companding: f32, beta: f32, floor: u16) = population::NonLinearSlots::try_companded(min..=max, companding, beta)?.try_with_floor(floor);
    }
    /// Rank order: a value finer than the neurons, by who fires first.
    rank_order_15_3: population::RankOrder<S, 15, 3> {
        /// `centres`: of the neurons, rising.
        made init(centres: [S; 15]) = population::RankOrder::try_new(centres);
        /// `min`, `max`: the range, which must rise. The centres are evenly spaced.
        made init_linear(min: S, max: S) = population::RankOrder::try_linear(min..=max);
    }
    /// Time to first spike: a value by one spike's time, the larger the earlier.
    first_spike_16: timing::FirstSpike<S, 16> {
        /// `min`, `max`: the range, which must rise. `edges`: the lower ends of the slots' values, rising; values below the first have no spike.
        made init(min: S, max: S, edges: [S; 16]) = timing::FirstSpike::try_new(min..=max, edges);
        /// `min`, `max`: the range, which must rise. All slots stand for as much of it.
        made init_linear(min: S, max: S) = timing::FirstSpike::try_linear(min..=max);
        /// `min`, `max`: the range, which must rise. `ratio`: of the largest value that has a spike to the smallest, above 1.
        made init_logarithmic(min: S, max: S, ratio: f32) = timing::FirstSpike::try_logarithmic(min..=max, ratio);
    }
    /// Latency-phase: channels that share one line, told apart by the phase of their spikes.
    latency_phase_4_32_4: timing::LatencyPhase<S, 4, 32, 4> {
        /// `min`, `max`: the range, which must rise. `spacing`: from one neuron's peaks to the next's, in slots.
        made init(min: S, max: S, spacing: u16) = timing::LatencyPhase::try_new(min..=max, spacing);
    }
    /// Weighted phase: a value in binary digits: the finest in few sub-timesteps.
    weighted_phase_8: timing::WeightedPhase<S, 8> {
        /// `min`, `max`: the range, which must rise.
        made init(min: S, max: S) = timing::WeightedPhase::try_new(min..=max);
    }
    /// Burst coding: a value by the count and the interval of its spikes.
    burst_19: timing::Burst<S, 19> {
        /// `min`, `max`: the range, which must rise. `spikes`: most of a sample, above 0; `shortest`, `longest`: their intervals in slots.
        made init(min: S, max: S, spikes: u8, shortest: u8, longest: u8) = timing::Burst::try_new(min..=max, spikes, shortest..=longest);
    }
}
