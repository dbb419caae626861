//! Parameters for a goal: what is scored, where they are looked for, and how.

pub(crate) mod costs;
pub(crate) mod emit;
pub(crate) mod figures;
pub(crate) mod problem;
pub(crate) mod report;
pub(crate) mod search;
mod space;
pub(crate) mod stretch;

pub(crate) use costs::Costs;
pub(crate) use figures::Figures;
pub(crate) use problem::{Goal, Limits, Problem, Scored};
use space::Extent;
pub(crate) use stretch::Stretch;
