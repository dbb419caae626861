//! What goes from the encoders to a link's keyframes.

use crate::Mark;

/// What the encoders of `N` channels held after one sample, at one moment: take it by
/// [`Bank::snapshot`](crate::Bank::snapshot) and hand it to
/// [`Transmitter::keyframe`](super::Transmitter::keyframe).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Snapshot<S, const N: usize> {
    /// The tick of the sample, in µs.
    pub tick: u32,
    /// Where the queue stood then.
    pub mark: Mark,
    /// What each channel's decoder should hold; `None` for a channel that has seen no sample.
    pub values: [Option<S>; N],
}
