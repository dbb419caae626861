//! The trait of pixel codes, and the count of thresholds that they share.

use core::num::NonZeroU8;

use super::band::FOUR;
use crate::config::within;
use spikewire::ConfigError;

/// How a pixel's samples become events: a base that follows the samples in steps.
///
/// For those who call it on rows of their own, as where the width is known at run time only: [`row`](Self::row) finds the
/// pixels that may have something to send, [`steps`](Self::steps) says how many events are due, and
/// [`follow`](Self::follow) moves the base by those that were sent. A [`FrameEncoder`](super::FrameEncoder) does this.
pub trait PixelCode: Copy {
    /// The base: the sample, or its logarithm.
    type Base: Copy + Into<u16> + TryFrom<u16>;
    /// What an encoder keeps of a pixel.
    type Pixel: Copy;

    /// A pixel before its first sample.
    const START: Self::Pixel;

    /// The most events that a pixel sends in a frame.
    fn most(&self) -> NonZeroU8;

    /// The base of a sample.
    fn base(&self, sample: u8) -> Self::Base;

    /// A pixel that has just sent this sample.
    fn begin(&self, sample: u8) -> Self::Pixel;

    /// The base of a pixel.
    fn base_of(&self, pixel: Self::Pixel) -> Self::Base;

    /// How many events are due, upwards if positive; up to [`most`](Self::most). The pixel stays as it is.
    fn steps(&self, pixel: Self::Pixel, sample: u8) -> i16;

    /// Ends a pixel's frame in which `steps` events were sent, upwards if positive.
    fn follow(&self, pixel: &mut Self::Pixel, steps: i16);

    /// A base after `steps` events, upwards if positive.
    fn moved(&self, base: Self::Base, steps: i16) -> Self::Base;

    /// The sample that a base stands for.
    fn value(&self, base: Self::Base) -> u8;

    /// Whether a pixel is quiet at a sample: no event is due, and [`follow`](Self::follow) would change nothing.
    #[inline]
    fn is_quiet(&self, pixel: Self::Pixel, sample: u8) -> bool {
        self.steps(pixel, sample) == 0
    }

    /// How many pixels at the start of a row are [quiet](Self::is_quiet), or up to three fewer.
    fn quiet(&self, pixels: &[Self::Pixel], samples: &[u8]) -> usize {
        let pairs = pixels.iter().zip(samples);
        pairs.take_while(|&(&pixel, &sample)| self.is_quiet(pixel, sample)).count()
    }

    /// Visits the pixels of a row that are not [quiet](Self::is_quiet), and some neighbours, by rising index, each with
    /// its sample. Stops at the end of the shorter slice.
    #[inline]
    fn row(
        &self,
        pixels: &mut [Self::Pixel],
        samples: &[u8],
        mut visit: impl FnMut(usize, &mut Self::Pixel, u8),
    ) {
        let mut at = 0_usize;
        while let (Some(left), Some(right)) = (pixels.get(at..), samples.get(at..)) {
            at = at.wrapping_add(self.quiet(left, right));
            let (left, right) = (pixels.get_mut(at..), samples.get(at..));
            let (Some([_, ..]), Some([_, ..])) = (&left, right) else { break };
            let pairs = left.unwrap_or_default().iter_mut().zip(right.unwrap_or_default());
            for (pixel, &sample) in pairs.take(FOUR) {
                visit(at, pixel, sample);
                at = at.wrapping_add(1);
            }
        }
    }
}

/// The most events of a pixel and frame.
pub(super) const fn most(most: u8) -> Result<NonZeroU8, ConfigError> {
    match (NonZeroU8::new(most), within("most events a pixel and frame", most as f64, 1.0, 255.0)) {
        (Some(most), Ok(())) => Ok(most),
        (_, Err(error)) => Err(error),
        (None, Ok(())) => Ok(NonZeroU8::MIN),
    }
}

/// How many whole thresholds lie strictly between base and sample, up to `most`; the thresholds are those upwards and
/// downwards.
#[inline]
pub(super) fn steps((base, sample): (u16, u16), (up, down): (u16, u16), most: NonZeroU8) -> i16 {
    if sample > base {
        count(sample.wrapping_sub(base), up, most)
    } else {
        count(base.wrapping_sub(sample), down, most).wrapping_neg()
    }
}

/// How many whole thresholds lie strictly within a distance, up to `most`. A function of its own, so that its loop
/// takes no registers from the row's.
#[inline(never)]
fn count(away: u16, threshold: u16, most: NonZeroU8) -> i16 {
    let mut left = away;
    let mut steps = 0;
    while left > threshold && steps < most.get() {
        left = left.wrapping_sub(threshold);
        steps += 1;
    }
    steps.into()
}
