//! Everything that one run has counted.

use super::{events::Event, figures::Row};

/// The figures, and the compiler that built the programs.
#[derive(Default)]
pub struct Measured {
    pub rows: Vec<Row>,
    pub events: Vec<Event>,
    pub rustc: String,
}

impl Measured {
    /// Sorts the rows of two programs for one sample type together: by core, sample type and signal, in the order in
    /// which these first occur.
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
