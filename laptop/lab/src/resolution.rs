//! Checks whether a sample type can resolve a column's steps from sample to sample, and finds the sample types that
//! can.

use crate::brief::short;
use catalogue::run::SampleType;

/// Largest rounding error with which a sample type is fine enough for a column. Rounding the samples to the type
/// changes the steps from sample to sample. The rounding error is the mean change of a step, divided by the mean step.
const PART: f64 = 0.1;

/// Statistics of the steps from sample to sample in a column, and of the errors that rounding to a sample type causes
/// in these steps.
pub struct Resolution {
    sample: SampleType,
    previous: Option<f64>,
    steps: u64,
    /// Sum of the absolute sizes of the steps from sample to sample.
    moved: f64,
    /// Sum of the absolute errors that rounding to `sample` causes in the steps from sample to sample.
    off: f64,
    /// Sum of the absolute errors that rounding to `f32` causes in the steps from sample to sample.
    off_single: f64,
    min: f64,
    max: f64,
    are_whole: bool,
}

impl Resolution {
    /// Makes the record of a column that has no samples yet. `sample` is the sample type to check.
    pub fn new(sample: SampleType) -> Self {
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        Self {
            sample,
            previous: None,
            steps: 0,
            moved: 0.0,
            off: 0.0,
            off_single: 0.0,
            min,
            max,
            are_whole: true,
        }
    }

    /// Measures the steps from sample to sample in a whole column. Also measures the errors that rounding to the sample
    /// type causes in these steps.
    pub fn of(sample: SampleType, values: &[f64]) -> Self {
        let mut own = Self::new(sample);
        own.observe(values);
        own
    }

    /// Adds the next samples, which must be finite.
    pub fn observe(&mut self, values: &[f64]) {
        for &value in values {
            if let Some(previous) = self.previous.filter(|previous| *previous != value) {
                let step = value - previous;
                let off = |sample| (held(sample, value) - held(sample, previous) - step).abs();
                self.steps += 1;
                self.moved += step.abs();
                self.off += off(self.sample);
                self.off_single += off(SampleType::F32);
            }
            self.previous = Some(value);
            self.min = self.min.min(value);
            self.max = self.max.max(value);
            self.are_whole &= value.fract() == 0.0;
        }
    }

    /// Returns whether rounding to the sample type changes any step from one sample to the next.
    pub fn is_rounded(&self) -> bool {
        self.off > 0.0
    }

    /// Returns a sentence for the user if the sample type is too coarse for the differences between consecutive samples
    /// of the column. The sentence also names the sample types that are fine enough. Returns `None` if this sample
    /// type is fine enough.
    pub fn lost(&self) -> Option<String> {
        let Self { sample, steps, moved, off, .. } = self;
        (*off > PART * moved).then(|| {
            let each = |sum: f64| short(sum / *steps as f64);
            format!(
                "{sample} loses the column's own steps: they are {} on average, and off by {} in {sample}; {}",
                each(*moved),
                each(*off),
                self.holders()
            )
        })
    }

    /// Returns a text for the user that names other sample types, if they are fine enough for the column. If none is
    /// fine enough, the text says so. If `f32` would be fine enough after a constant is subtracted from all values, the
    /// text names that constant.
    pub fn holders(&self) -> String {
        let names: Vec<String> = [self.single(), self.fixed()]
            .into_iter()
            .flatten()
            .filter(|own| *own != self.sample)
            .map(|own| own.to_string())
            .collect();
        if !names.is_empty() {
            let verb = if names.len() == 1 { "holds" } else { "hold" };
            return format!("{} {verb} them", names.join(" and "));
        }
        let center = f64::midpoint(self.min, self.max).round();
        let largest = (self.max - center).max(center - self.min);
        if self.is_fine(largest * f64::from(f32::EPSILON)) {
            return format!(
                "no type does, but f32 holds them once {center} is taken from every value"
            );
        }
        "no type of 32 bits holds them".to_owned()
    }

    fn single(&self) -> Option<SampleType> {
        (self.off_single <= PART * self.moved).then_some(SampleType::F32)
    }

    /// Returns the fixed-point type with the fewest bits that can hold the column. All values must lie in the type's
    /// range, and its resolution must be fine enough for the steps from sample to sample. If the column consists of
    /// whole numbers, the type must hold them exactly.
    fn fixed(&self) -> Option<SampleType> {
        let holds = |own: &SampleType| {
            let (low, high) = own.range();
            low <= self.min && self.max <= high
        };
        let short = (0..16).rev().map(|fraction| SampleType::Fixed16 { fraction });
        let long = (0..32).rev().map(|fraction| SampleType::Fixed32 { fraction });
        let whole = [SampleType::Fixed16 { fraction: 0 }, SampleType::Fixed32 { fraction: 0 }];
        if self.are_whole {
            return whole.into_iter().find(holds);
        }
        let finest = [short.into_iter().find(holds), long.into_iter().find(holds)];
        finest.into_iter().flatten().find(|own| self.is_fine(own.step()))
    }

    /// Returns whether rounding to multiples of `step` hardly alters the column's changes from sample to sample. On
    /// average, rounding alters a change by a third of `step`. To be safe, the check assumes half of `step`.
    fn is_fine(&self, step: f64) -> bool {
        step / 2.0 * self.steps as f64 <= PART * self.moved
    }
}

/// Rounds a value to a sample type, and clamps it to the type's range.
pub(crate) fn held(sample: SampleType, value: f64) -> f64 {
    let (low, high) = sample.range();
    match sample.step() {
        0.0 => f64::from(value as f32),
        step => ((value / step + 0.5).floor() * step).clamp(low, high),
    }
}

#[cfg(test)]
mod tests {
    use super::Resolution;

    fn lost(sample: &str, value: impl Fn(f64) -> f64) -> String {
        let values: Vec<f64> = (0..2000).map(|sample| value(f64::from(sample))).collect();
        Resolution::of(sample.parse().unwrap(), &values).lost().unwrap_or_default()
    }

    #[test]
    fn lost_steps_are_reported_with_the_types_that_hold_them() {
        // Counts lose nothing in `i16`, and these decimals are too fine for `q8.8`.
        assert_eq!(lost("i16", |sample| (sample * 1.7).floor()), "");
        let fine = |sample: f64| (sample * 0.01).sin() * 0.1;
        assert!(
            lost("q8.8", fine).ends_with("; f32 and q1.15 hold them"),
            "{}",
            lost("q8.8", fine)
        );
        assert!(lost("q8.8", |sample| 100.0 * fine(sample)).is_empty());
    }

    /// If a sample type is too coarse for a column, `lost` suggests other types. Each of these types is fine enough,
    /// whatever the size of the column's values and steps.
    #[test]
    fn a_type_that_is_named_holds_the_steps() {
        for offset in [0.0, 3.7, 250.0, 4e4, 1e6, 3e8, 2e9, 7e12] {
            for step in [1e-6, 1e-3, 0.25, 1.0, 40.0, 3e4] {
                let value = |sample: f64| offset + (sample * 0.37).sin() * step;
                for sample in ["f32", "i16", "i32", "q8.8", "q16.16"] {
                    let words = lost(sample, value);
                    let Some((_, holders)) = words.rsplit_once("; ") else { continue };
                    let Some(names) = holders.strip_suffix(" them") else {
                        continue;
                    };
                    let names = names.trim_end_matches(" holds").trim_end_matches(" hold");
                    if names.starts_with("no type") {
                        continue;
                    }
                    for name in names.split(" and ") {
                        assert_ne!(name, sample);
                        assert_eq!(lost(name, value), "", "{offset} {step} {sample}: {words}");
                    }
                }
            }
        }
    }
}
