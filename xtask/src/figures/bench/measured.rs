//! Everything that one run has counted.

use super::{events::Event, figures::Row};
use serde::{Deserialize, Serialize};

/// The compilers that built the programs, as they name themselves: Rust's, and that of plain C.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Compilers {
    pub rustc: String,
    pub gcc: String,
}

/// The figures, and what built the programs.
#[derive(Default)]
pub struct Measured {
    pub rows: Vec<Row>,
    pub events: Vec<Event>,
    pub compilers: Compilers,
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
