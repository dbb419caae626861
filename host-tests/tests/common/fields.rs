//! What the tests of receptive fields share: the reference in each sample type.

use fixed::types::{I1F15, I8F8, I16F16, I32F0};
use host_tests::compare::{Wire, whole};
use host_tests::reference::{
    distance_radii, even_centres, levels_by_distance, levels_exp, receptive_field_width, rounded,
    slots_decode,
};
use spikewire::Sample;

/// A sample type's receptive fields.
pub(crate) trait Fields: Wire {
    /// The level of each of `m` neurons: in `f32` by rounded distances, in integers by the
    /// exponential.
    fn levels(self, min: Self, max: Self, m: usize, beta: f32, n: u16) -> Vec<u16>;

    /// The mean of the centres weighted by levels, if there is any level.
    fn weighted_mean(levels: &[u16], min: Self, max: Self, n: u16) -> Option<Self>;
}

/// Levels as the slots in which they fire.
fn slots(levels: &[u16], n: u16) -> Vec<Option<u16>> {
    levels.iter().map(|&level| (level > 0).then(|| n - level)).collect()
}

impl Fields for f32 {
    fn levels(self, min: f32, max: f32, m: usize, beta: f32, n: u16) -> Vec<u16> {
        let (min, max, beta) = (min.into(), max.into(), beta.into());
        let centres: Vec<f32> = rounded(&even_centres(min, max, m));
        let sigma = receptive_field_width(min, max, m, beta);
        levels_by_distance(self, &centres, &rounded(&distance_radii(sigma, n)))
    }

    fn weighted_mean(levels: &[u16], min: f32, max: f32, n: u16) -> Option<f32> {
        let centres: Vec<f32> = rounded(&even_centres(min.into(), max.into(), levels.len()));
        let fired = levels.iter().any(|&level| level > 0);
        fired.then(|| slots_decode(&slots(levels, n), &centres, n, 0.0))
    }
}

/// The exact mean in units of the last place, halves upwards. The reference's own mean is in `f64`,
/// whose rounding could decide a half: it serves to check this one.
fn exact_mean(levels: &[u16], min: i128, max: i128, n: u16) -> Option<i128> {
    let total: i128 = levels.iter().map(|&level| i128::from(level)).sum();
    let weighted: i128 = (0..).zip(levels).map(|(i, &level)| (2 * i - 1) * i128::from(level)).sum();
    let parts = 2 * (levels.len() as i128 - 2) * total;
    let sum = min * parts + (max - min) * weighted;
    let mean = (total > 0).then(|| (2 * sum + parts).div_euclid(2 * parts))?;
    let centres = even_centres(min as f64, max as f64, levels.len());
    let approximate = slots_decode(&slots(levels, n), &centres, n, 0.0);
    assert!((mean as f64 - approximate).abs() < 0.5 + 1e-3, "{mean} for {approximate}");
    Some(mean)
}

macro_rules! fields {
    ($($sample:ty)*) => {$(
        impl Fields for $sample {
            fn levels(self, min: Self, max: Self, m: usize, beta: f32, n: u16) -> Vec<u16> {
                levels_exp(self.real(), min.real(), max.real(), m, beta.into(), n)
            }

            fn weighted_mean(levels: &[u16], min: Self, max: Self, n: u16) -> Option<Self> {
                let mean = exact_mean(levels, whole(min).into(), whole(max).into(), n)?;
                let [least, most] = [<$sample>::MIN, <$sample>::MAX].map(|end| whole(end).into());
                Some(Self::from_bits32(mean.clamp(least, most) as u32))
            }
        }
    )*};
}
fields!(i16 I8F8 I1F15 I16F16 I32F0);
