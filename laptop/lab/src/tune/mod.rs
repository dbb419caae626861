//! Finds parameters with which a scheme meets a goal. The modules define the score of settings, the space in which
//! settings lie, and the search.

mod bounds;
mod chance;
pub mod costs;
pub mod emit;
pub mod figures;
mod guided;
mod kinds;
mod listed;
pub mod problem;
pub mod report;
mod request;
pub mod search;
mod space;
mod strategy;
pub mod stretch;
mod surrogate;

pub use bounds::Bound;
pub use costs::Costs;
pub use figures::Figures;
pub use kinds::RequestKind;
pub use problem::{Goal, Limits, Over, Problem, Scored, Tally};
pub use request::{Curve, TuneRequest, Tuned, tune};
use space::Extent;
pub use stretch::Stretch;
