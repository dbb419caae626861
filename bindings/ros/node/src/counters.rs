//! Counts of what is not as it should be.

use std::collections::BTreeMap;
use std::fmt;

/// Counts by name.
#[derive(Default)]
pub(crate) struct Counters {
    counts: BTreeMap<&'static str, u64>,
    /// At which count each is told next.
    next: BTreeMap<&'static str, u64>,
    warnings: Vec<String>,
}

impl Counters {
    /// Counts `by` more. The first, the tenth, the hundredth and so on becomes a warning, so that logs stay readable.
    pub(crate) fn add(&mut self, what: &'static str, by: u64, detail: &str) {
        let count = self.counts.entry(what).or_default();
        *count += by;
        let next = self.next.entry(what).or_insert(1);
        if *count >= *next {
            *next = 10_u64.saturating_pow(count.ilog10() + 1);
            let detail = if detail.is_empty() { String::new() } else { format!(" ({detail})") };
            self.warnings.push(format!("{what}: {count}{detail}"));
        }
    }

    /// Counts one more of what is rare, and makes each a warning.
    pub(crate) fn add_rare(&mut self, what: &'static str, detail: &str) {
        self.next.remove(what);
        self.add(what, 1, detail);
    }

    /// Returns the warnings since the last call.
    pub(crate) fn warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// Returns all counts by name; none is 0.
    pub(crate) fn counts(&self) -> &BTreeMap<&'static str, u64> {
        &self.counts
    }
}

impl fmt::Display for Counters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.counts.is_empty() {
            return f.write_str("nothing lost, nothing refused");
        }
        let counts: Vec<String> =
            self.counts.iter().map(|(name, count)| format!("{count} {name}")).collect();
        f.write_str(&counts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::Counters;

    #[test]
    fn counts_are_told_sparsely() {
        let mut counters = Counters::default();
        for number in 0..150 {
            counters.add("gaps", 1, &format!("number {number}"));
        }
        counters.add("lost", 30, "");
        counters.add_rare("refused", "a");
        counters.add_rare("refused", "b");
        let told =
            ["gaps: 1 (number 0)", "gaps: 10 (number 9)", "gaps: 100 (number 99)", "lost: 30"];
        let rare = ["refused: 1 (a)", "refused: 2 (b)"];
        assert_eq!(counters.warnings(), [&told[..], &rare].concat());
        assert_eq!(counters.to_string(), "150 gaps, 30 lost, 2 refused");
    }
}
