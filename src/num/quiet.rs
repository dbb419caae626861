//! The quiet test of several channels at once: whether each sample lies within its channel's band.

use super::arithmetic::{Arithmetic, for_each_integer};

/// Samples that are compared with both bounds of a band by one subtraction and one comparison of unsigned words. It takes
/// no FPU, whose registers an interrupt would have to save.
pub(crate) trait Quiet: Copy {
    /// A word of a band. A band is two words: its beginning and its width.
    type Word: Copy + Send + Sync;

    /// Both words of the empty band.
    const NONE: Self::Word;

    /// The band of samples at most a threshold from a baseline. It may leave out the outermost of them.
    fn band(base: Self, threshold: Self) -> [Self::Word; 2];

    /// Whether the sample lies within the band; false for a NaN, and for an infinity unless a bound overflowed to it.
    fn is_within(self, band: [Self::Word; 2]) -> bool;

    /// Whether every sample lies within its band.
    #[inline]
    fn are_within<const N: usize>(samples: &[Self; N], bands: &Bands<Self, N>) -> bool {
        samples.iter().zip(&bands.0).all(|(sample, &band)| sample.is_within(band))
    }

    /// Returns the indices of the two words of a channel's band in [`Bands`] of `channels` channels.
    #[inline]
    fn words_of(channel: usize, _channels: usize) -> [[usize; 2]; 2] {
        [[channel, 0], [channel, 1]]
    }
}

/// A band for each channel, on the boundary of a word.
#[derive(Clone, Copy)]
#[repr(align(4))]
pub(crate) struct Bands<S: Quiet, const N: usize>([[S::Word; 2]; N]);

impl<S: Quiet, const N: usize> Bands<S, N> {
    pub(crate) const NONE: Self = Self([[S::NONE; 2]; N]);

    /// Whether a channel's sample lies within its band.
    #[inline]
    pub(crate) fn holds(&self, channel: usize, sample: S) -> bool {
        let word = |[at, word]: [usize; 2]| self.0.get(at)?.get(word).copied();
        let [start, width] = S::words_of(channel, N).map(word);
        start.zip(width).is_some_and(|(start, width)| sample.is_within([start, width]))
    }

    /// Sets a channel's band to the samples near a baseline, or to none.
    #[inline]
    pub(crate) fn set(&mut self, channel: usize, near: Option<(S, S)>) {
        let band = near.map_or([S::NONE; 2], |(base, threshold)| S::band(base, threshold));
        for ([at, word], value) in S::words_of(channel, N).into_iter().zip(band) {
            if let Some(word) = self.0.get_mut(at).and_then(|words| words.get_mut(word)) {
                *word = value;
            }
        }
    }
}

/// A word that orders floats, a NaN before or after all others.
#[inline]
fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    bits ^ (bits.cast_signed() >> 31).cast_unsigned() >> 1
}

/// The band from one word to another.
#[inline]
fn between(lower: u32, upper: u32) -> [u32; 2] {
    [lower, upper.wrapping_sub(lower).saturating_add(1)]
}

impl Quiet for f32 {
    type Word = u32;

    const NONE: u32 = 0;

    #[inline]
    fn band(base: f32, threshold: f32) -> [u32; 2] {
        let [lower, upper] = Self::bounds(base, threshold);
        between(ordered(lower), ordered(upper))
    }

    #[inline]
    fn is_within(self, [start, width]: [u32; 2]) -> bool {
        ordered(self).wrapping_sub(start) < width
    }
}

/// The top bit of a half, and those of both halves of a word.
const TOP: u16 = 1 << 15;
const TOPS: u32 = 0x8000_8000;

macro_rules! integer {
    // In place of its width a band has what is left of that to 2¹⁵.
    ([$($generics:tt)*] $sample:ty, i16, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Quiet for $sample {
            type Word = u16;

            const NONE: u16 = TOP;

            #[inline]
            fn band(base: Self, threshold: Self) -> [u16; 2] {
                let bounds = Self::bounds(base.bound(), threshold);
                let [lower, upper] =
                    bounds.map(|bound| bound.clamp(i16::MIN.into(), i16::MAX.into()));
                let width = upper.wrapping_sub(lower).wrapping_add(1).min(TOP.into());
                [lower as u16 ^ TOP, TOP.wrapping_sub(width as u16)]
            }

            #[inline]
            fn is_within(self, [start, rest]: [u16; 2]) -> bool {
                let above = ($to_bits(self).cast_unsigned() ^ TOP).wrapping_sub(start);
                (above | above.wrapping_add(rest)) < TOP
            }

            /// Two channels share a word. A half that borrows from the other one, or carries into it, has a top bit
            /// by which it lies outside.
            #[inline]
            fn are_within<const N: usize>(samples: &[Self; N], bands: &Bands<Self, N>) -> bool {
                let word = |[low, high]: [u16; 2]| u32::from(low) | u32::from(high) << 16;
                let (pairs, last) = samples.as_chunks::<2>();
                let (bands, last_band) = bands.0.as_chunks::<2>();
                pairs.iter().zip(bands).all(|(&pair, &[starts, rests])| {
                    let pair = word(pair.map(|sample| $to_bits(sample).cast_unsigned()));
                    let above = (pair ^ TOPS).wrapping_sub(word(starts));
                    (above | above.wrapping_add(word(rests))) & TOPS == 0
                }) && last.iter().zip(last_band).all(|(sample, &band)| sample.is_within(band))
            }

            /// The beginnings of two bands share a word, and so do what is left of them.
            #[inline]
            fn words_of(channel: usize, channels: usize) -> [[usize; 2]; 2] {
                let (even, half) = (channel & !1, channel & 1);
                if even.wrapping_add(1) < channels {
                    [[even, half], [even.wrapping_add(1), half]]
                } else {
                    [[channel, 0], [channel, 1]]
                }
            }
        }
    };
    ([$($generics:tt)*] $sample:ty, i32, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Quiet for $sample {
            type Word = u32;

            const NONE: u32 = 0;

            #[inline]
            fn band(base: Self, threshold: Self) -> [u32; 2] {
                let [lower, upper] = Self::bounds(base.bound(), threshold);
                between(lower.cast_unsigned(), upper.cast_unsigned())
            }

            #[inline]
            fn is_within(self, [start, width]: [u32; 2]) -> bool {
                $to_bits(self).cast_unsigned().wrapping_sub(start) < width
            }
        }
    };
}
for_each_integer!(integer);
