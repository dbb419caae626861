//! All that one run has counted.

use super::{events::Event, figures::Row};

/// The figures, and the compiler that they are of.
#[derive(Default)]
pub struct Measured {
    pub rows: Vec<Row>,
    pub events: Vec<Event>,
    pub rustc: String,
}

impl Measured {
    /// Puts the rows of two programs for one sample type together: by core, sample type and signal, as first seen.
    pub fn group(&mut self) {
        let of = |row: &Row| (row.core, row.sample.clone(), row.signal.clone());
        let mut groups = Vec::new();
        for group in self.rows.iter().map(of) {
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        self.rows.sort_by_key(|row| groups.iter().position(|group| *group == of(row)));
    }
}
