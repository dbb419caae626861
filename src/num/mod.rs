//! Numbers: the sample types, their arithmetic, and the curves from which tables are made.
//!
//! The arithmetic traits are private to the crate. `Sample` has them as its supertraits, so that only the
//! crate can implement it, and only the crate can call them.

mod arithmetic;
mod binary;
mod convert;
pub(crate) mod curve;
mod distance;
mod double_double;
mod even_bins;
mod field;
mod kind;
mod nearer;
mod quiet;
mod recursive;
mod residual;
mod sample;
mod shortfall;
mod stored;
mod sums;
mod tally;
mod total;
mod vectors;
mod window_sum;

pub(crate) use arithmetic::Arithmetic;
pub(crate) use binary::{Binary, LACKS_DIVISION};
pub(crate) use convert::{
    below_from_f64, floor_from_f64, from_f64, largest_step, one, to_f64, units, word,
};
pub(crate) use distance::{Distance, Spaced, bin_of, even_bins, near, reach, top};
pub(crate) use double_double::DoubleDouble;
pub(crate) use even_bins::EvenBins;
pub(crate) use field::{Field, scale, widths, within_widths};
pub use kind::SampleKind;
pub(crate) use nearer::{Bound, Nearer};
pub(crate) use quiet::{Bands, Quiet};
pub(crate) use recursive::{Recursive, Section, coefficient};
pub(crate) use residual::{Rated, Ratio, Residual};
pub use sample::Sample;
pub(crate) use shortfall::Shortfall;
pub(crate) use stored::Stored;
pub(crate) use sums::{Summed, Sums};
pub(crate) use tally::Tally;
pub(crate) use total::{Total, Totalled};
pub(crate) use vectors::{HAS_VECTORS, groups, groups_mut};
pub(crate) use window_sum::{Difference, Windowed, fast_margin, margin};
