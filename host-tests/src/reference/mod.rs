//! The coding schemes, written down once more and plainly: whole recordings in, vectors out.
//!
//! This is the law that the crate is compared with, bit for bit, and it shares no code with it.
//! Every function is generic over [`Real`], so that one text serves twice: in `f32` for the
//! crate's `f32` path, and in `f64` for its fixed-point path (whose samples, thresholds and taps
//! are exact in `f64`, as are all their sums).
//!
//! In `f32` the order of the operations is part of the law: each one rounds once, in the order
//! written here, and none are fused.
//!
//! Signed spikes are `i8`: +1, 0 or -1. Samples are finite; [`split_finite`] sorts out the others.

mod ben;
mod calibration;
mod centres;
mod contrast;
mod filter;
mod finite;
mod histogram;
mod hough;
mod line;
mod moving_window;
mod nonlinear;
mod position;
mod precise;
mod probabilistic;
mod rank_order;
mod rate;
mod rate_decoder;
mod real;
mod recursive;
mod slots;
mod step_decoder;
mod step_forward;
mod threshold_hough;
mod timing;

pub use ben::{ben_multiplicative, ben_subtractive, ben_toolbox};
pub use calibration::{Calibration, Moments, calibrate};
pub use centres::{even_centres, gaussian_centres, receptive_field_width};
pub use contrast::temporal_contrast;
pub use filter::{doubles, gaussian, hann, scaled_to_peak, scaled_to_sum, triangular};
pub use finite::{Finite, split_finite};
pub use histogram::{even_cell, histogram, quantile_centres};
pub use hough::hough;
pub use line::{Exact, Line, edge, even, points};
pub use moving_window::moving_window;
pub use nonlinear::{
    companded_centres, field_edges, fields_are_regions, float_levels, integer_levels,
    integer_weighted_mean, level_radii, spacing_widths, strongest,
};
pub use position::{nearest, nearest_even};
pub use precise::Precise;
pub use probabilistic::probabilistic_from_levels;
pub use rank_order::{nearest_first, rank_order_value};
pub use rate_decoder::rate_decode;
pub use real::{Real, clamped, rounded};
pub use recursive::{
    Kind, coefficients, delay_at_rest, direct_form, filter_floats, filter_integers, textbook,
};
pub use slots::{distance_radii, levels_by_distance, levels_exp, slots_decode, slots_of_levels};
pub use step_decoder::{step_decode, step_decode_from_first, step_decode_within};
pub use step_forward::step_forward;
pub use threshold_hough::threshold_hough;
pub use timing::{
    Bursts, Cell, Oscillation, Spikes, first_spike_above, first_spike_linear, latency_phase,
    latency_phase_decode, log_thresholds, weighted_phase,
};
