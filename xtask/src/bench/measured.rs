//! All that one run has counted.

use super::{events::Event, figures::Row};

/// The figures, and the compiler that they are of.
#[derive(Default)]
pub struct Measured {
    pub rows: Vec<Row>,
    pub events: Vec<Event>,
    pub rustc: String,
}
