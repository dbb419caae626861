//! What a signal would tell, and settings could tell instead.

use std::fmt;

use super::words::{Spell, Worded, joined, quoted};

/// The settings that would make a calibration over the whole signal unnecessary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Needs {
    /// All of these.
    All(Vec<&'static str>),
    /// This one, as a list of numbers.
    AsList(&'static str),
    /// Those that the paper's settings stand in for.
    Paper,
}

impl Worded for Needs {
    fn word(&self, f: &mut fmt::Formatter<'_>, spell: Spell) -> fmt::Result {
        match self {
            Self::All(names) => f.write_str(&joined(names, spell, " and ")),
            Self::AsList(name) => write!(f, "{} as a list", spell(name)),
            Self::Paper => write!(f, "parameters in the place of {}", spell("paper")),
        }
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.word(f, quoted)
    }
}
