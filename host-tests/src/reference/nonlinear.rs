//! Non-linear receptive fields: centres `mu` rising, widths `sigma` above 0.
//!
//! Winner: the least `|x-mu|/sigma`, so cells with the edges
//! `E[i] = (sigma[i+1]mu[i]+sigma[i]mu[i+1])/(sigma[i]+sigma[i+1])`, each of which belongs to the lower; refused
//! unless for all `i` and `j` not in `{i, i+1}` `|sigma[i+1]mu[i]+sigma[i]mu[i+1]-mu[j](sigma[i]+sigma[i+1])| >=
//! sigma[j](mu[i+1]-mu[i])`. Widths from the spacing: `sigma = (mu[i+1]-mu[i-1])/2β`, at the ends the one spacing/β.
//! Companded centres: `mid + sgn(t)(R/2)((1+A)^|t|-1)/A`, `t = 2i/(M-1)-1`.
//!
//! Slots: `rho_k = √(2 ln(n/(k-½)))`; the level is how many `k` in `1..=n` have `|x-mu| s <= rho_k`: in `f32` with `s =
//! 1/sigma` and `rho_k` rounded down; in integers `s = 2³²/sigma`, rounded half up, and `⌊2³² rho_k⌋`.

use super::Precise;

/// `2β sigma` of each field.
pub fn spacing_widths(centres: &[f64]) -> Vec<f64> {
    let last = centres.len() - 1;
    (0..=last)
        .map(|i| match i {
            0 => 2.0 * (centres[1] - centres[0]),
            i if i == last => 2.0 * (centres[last] - centres[last - 1]),
            i => centres[i + 1] - centres[i - 1],
        })
        .collect()
}

/// The edges between the winners' regions, exactly.
pub fn field_edges(centres: &[f64], widths: &[f64]) -> Vec<f64> {
    (0..centres.len() - 1)
        .map(|i| {
            let [low, high] = [widths[i], widths[i + 1]].map(Precise::from);
            let sum = low.clone() + high.clone();
            ((high * centres[i] + low * centres[i + 1]) / sum).to_f64()
        })
        .collect()
}

/// Whether no third field wins at an edge.
pub fn fields_are_regions(centres: &[f64], widths: &[f64]) -> bool {
    (0..centres.len() - 1).all(|i| {
        (0..centres.len()).filter(|&j| j != i && j != i + 1).all(|j| {
            let edge = widths[i + 1] * centres[i] + widths[i] * centres[i + 1];
            let distance = (edge - centres[j] * (widths[i] + widths[i + 1])).abs();
            distance >= widths[j] * (centres[i + 1] - centres[i])
        })
    })
}

/// The winner of a value: the number of edges below it.
pub fn strongest(x: f64, edges: &[f64]) -> usize {
    edges.iter().filter(|&&edge| x > edge).count()
}

/// Companded centres, exactly.
pub fn companded_centres(min: f64, max: f64, m: usize, companding: f64) -> Vec<f64> {
    (0..m)
        .map(|i| {
            let t = Precise::from(i.abs_diff(m - 1 - i) as f64) / (m - 1) as f64;
            let power = (Precise::from(1.0) + companding).pow(&t);
            let offset = (Precise::from(max) - min) * (power - 1.0) / companding;
            let offset = if 2 * i < m - 1 { -offset } else { offset };
            ((offset + min + max) / 2.0).to_f64()
        })
        .collect()
}

/// `rho_k` for `k` in `1..=n`.
pub fn level_radii(n: u16) -> Vec<f64> {
    (1..=n).map(|k| (2.0 * (f64::from(n) / (f64::from(k) - 0.5)).ln()).sqrt()).collect()
}

/// The largest `f32` not above.
fn floor_f32(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value { near.next_down() } else { near }
}

/// The level of each neuron in `f32`.
pub fn float_levels(x: f32, centres: &[f32], sigmas: &[f64], n: u16) -> Vec<u16> {
    let radii: Vec<f32> = level_radii(n).into_iter().map(floor_f32).collect();
    let neurons = centres.iter().zip(sigmas);
    neurons
        .map(|(mu, sigma)| {
            let distance = (x - mu).abs() * (1.0 / sigma) as f32;
            radii.iter().filter(|&&radius| distance <= radius).count() as u16
        })
        .collect()
}

/// The level of each neuron in integers, and widths in their unit.
pub fn integer_levels(x: i64, centres: &[i64], sigmas: &[f64], n: u16) -> Vec<u16> {
    let one = 2_f64.powi(32);
    let radii: Vec<i128> = level_radii(n).iter().map(|rho| (rho * one).floor() as i128).collect();
    let neurons = centres.iter().zip(sigmas);
    neurons
        .map(|(mu, sigma)| {
            let scale = (one / sigma + 0.5).floor() as i128;
            let distance = i128::from((x - mu).abs()).saturating_mul(scale);
            radii.iter().filter(|&&radius| distance <= radius).count() as u16
        })
        .collect()
}

/// The mean of whole centres weighted by the levels, rounded to the nearest, halves upwards.
pub fn integer_weighted_mean(levels: &[u16], centres: &[i64]) -> Option<i64> {
    let total: i64 = levels.iter().copied().map(i64::from).sum();
    let sum: i64 = levels.iter().zip(centres).map(|(&level, mu)| i64::from(level) * mu).sum();
    (total > 0).then(|| (2 * sum + total).div_euclid(2 * total))
}

#[cfg(test)]
mod tests {
    use super::{
        companded_centres, field_edges, fields_are_regions, integer_levels, integer_weighted_mean,
        spacing_widths, strongest,
    };

    #[test]
    fn the_printed_check_values() {
        let centres = [0.0, 10.0, 30.0, 70.0, 150.0];
        let widths = spacing_widths(&centres);
        assert_eq!(widths, [20.0, 30.0, 60.0, 120.0, 160.0]);
        let edges: Vec<f64> = field_edges(&centres, &widths).iter().map(|e| e.floor()).collect();
        assert_eq!(edges, [4.0, 16.0, 43.0, 104.0]);
        assert!(fields_are_regions(&centres, &widths));
        assert_eq!([4.0, 5.0, 200.0].map(|x| strongest(x, &edges)), [0, 1, 4]);
        let sigmas: Vec<f64> = widths.iter().map(|width| width / 3.0).collect();
        let levels = integer_levels(100, &[0, 10, 30, 70, 150], &sigmas, 10);
        assert_eq!(levels, [0, 0, 0, 8, 6]);
        assert_eq!(integer_weighted_mean(&levels, &[0, 10, 30, 70, 150]), Some(104));

        let centres = [0.0, 1.0, 2.0, 3.0, 1003.0];
        assert!(!fields_are_regions(&centres, &spacing_widths(&centres)));
        assert!(fields_are_regions(&centres, &[7.0; 5]));
    }

    #[test]
    fn companded_centres_reach_the_ends() {
        let centres = companded_centres(-1.0, 3.0, 5, 255.0);
        assert_eq!([centres[0], centres[2], centres[4]], [-1.0, 1.0, 3.0]);
        // 16 - 1 of 255.
        assert!((centres[3] - (1.0 + 2.0 * 15.0 / 255.0)).abs() < 1e-12);
    }
}
