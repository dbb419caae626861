//! GRF with sub-timesteps (Bohté): `n` slots a sample.
//!
//! `r[i] = exp(-(x-mu[i])²/(2σ²))`, `σ = (max-min)/(β(m-2))`; level = round half up of `n*r[i]`. Level
//! 0, or below the floor, is silent; level `k` fires in slot `n-k`. The decoder is the mean of the
//! centres weighted by the levels.
//!
//! The same by distances, as there is no exponential at run time: the level is at least `k` where
//! `r >= (k-0.5)/n`, so where `|x-mu[i]| <= σ sqrt(2 ln(n/(k-0.5)))`.

use super::{Real, even_centres, receptive_field_width};

/// The level of each neuron, by the exponential, in `f64`.
pub fn levels_exp(x: f64, min: f64, max: f64, m: usize, beta: f64, n: u16) -> Vec<u16> {
    let sigma = receptive_field_width(min, max, m, beta);
    even_centres(min, max, m)
        .iter()
        .map(|mu| {
            let response = (-(x - mu).powi(2) / (2.0 * sigma.powi(2))).exp();
            (f64::from(n) * response + 0.5).floor() as u16
        })
        .collect()
}

/// The radius of each level `1..=n`: `sigma * sqrt(2 ln(n/(k-0.5)))`.
pub fn distance_radii(sigma: f64, n: u16) -> Vec<f64> {
    (1..=n).map(|k| sigma * (2.0 * (f64::from(n) / (f64::from(k) - 0.5)).ln()).sqrt()).collect()
}

/// The level of each neuron: the number of radii that the distance to its centre does not exceed.
pub fn levels_by_distance<T: Real>(x: T, centres: &[T], radii: &[T]) -> Vec<u16> {
    centres
        .iter()
        .map(|&mu| {
            let distance = (x - mu).magnitude();
            radii.iter().filter(|&&radius| distance <= radius).count() as u16
        })
        .collect()
}

/// Level `k` fires in slot `n-k`; level 0, or below the floor, is silent.
pub fn slots_of_levels(levels: &[u16], n: u16, floor: u16) -> Vec<Option<u16>> {
    levels.iter().map(|&level| (level > 0 && level >= floor).then(|| n - level)).collect()
}

/// The mean of the centres, weighted by `n - slot`: products and their sum in index order, from 0;
/// the total of the levels as one number; one division. Where nothing fired, the previous value.
pub fn slots_decode<T: Real>(slots: &[Option<u16>], centres: &[T], n: u16, previous: T) -> T {
    let mut weighted = T::ZERO;
    let mut total = 0;
    for (slot, &mu) in slots.iter().zip(centres) {
        if let Some(slot) = slot {
            let level = usize::from(n - slot);
            weighted = weighted + mu * T::count(level);
            total += level;
        }
    }
    if total == 0 { previous } else { weighted / T::count(total) }
}

#[cfg(test)]
mod tests {
    use super::{distance_radii, levels_by_distance, levels_exp, slots_decode, slots_of_levels};
    use crate::reference::{even_centres, receptive_field_width};

    #[test]
    fn level_zero_and_levels_below_the_floor_are_silent() {
        let levels = [0, 1, 4, 5, 10];
        let expected = [None, Some(9), Some(6), Some(5), Some(0)];
        assert_eq!(slots_of_levels(&levels, 10, 0), expected);
        assert_eq!(slots_of_levels(&levels, 10, 1), expected);
        let expected = [None, None, None, Some(5), Some(0)];
        assert_eq!(slots_of_levels(&levels, 10, 5), expected);
    }

    #[test]
    fn radii_fall_with_the_level() {
        let radii = distance_radii(2.0, 4);
        let expected = [8.0, 8.0 / 3.0, 1.6, 8.0 / 7.0].map(|q: f64| 2.0 * (2.0 * q.ln()).sqrt());
        assert_eq!(radii, expected);
    }

    #[test]
    fn distances_give_the_levels_of_the_exponential() {
        // Off the boundaries both forms agree; on a fine grid none of these falls within rounding.
        let (min, max, m, beta, n) = (-3.0, 5.0, 15, 1.5, 10);
        let centres = even_centres(min, max, m);
        let radii = distance_radii(receptive_field_width(min, max, m, beta), n);
        for i in -5000..7000 {
            let x = f64::from(i) / 1000.0 + 0.000_123_4;
            let levels = levels_by_distance(x, &centres, &radii);
            assert_eq!(levels, levels_exp(x, min, max, m, beta, n), "{x}");
        }
    }

    #[test]
    fn decodes_to_the_weighted_mean_of_the_centres() {
        let centres = [-1.0_f32, 0.0, 2.0];
        // Levels 0, 4, 6 of 10: 12 / 10.
        let slots = [None, Some(6), Some(4)];
        assert_eq!(slots_decode(&slots, &centres, 10, 9.0), 1.2);
        assert_eq!(slots_decode(&[None; 3], &centres, 10, 9.0), 9.0);
        // In the middle of a symmetric population nothing is lost.
        let centres = even_centres(0.0, 1.0, 4);
        let slots = slots_of_levels(&levels_exp(0.5, 0.0, 1.0, 4, 1.5, 100), 100, 0);
        assert_eq!(slots_decode(&slots, &centres, 100, 9.0), 0.5);
    }
}
