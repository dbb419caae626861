//! The settings without which the whole signal must be calibrated on.

use std::fmt;

use super::words::{Spell, Worded, joined, quoted};

/// The settings that would have to be given so that the whole signal need not be calibrated on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Needs {
    /// All of these.
    All(Vec<&'static str>),
    /// This one, given as a list of numbers.
    AsList(&'static str),
    /// All those that the paper's values replace.
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
