//! Cells: intervals side by side on the line of values. Many codes send the number of a value's cell.

mod cuts;
mod partition;
mod search;

pub(super) use cuts::{Cuts, Side};
pub(super) use partition::Partition;
#[cfg(feature = "alloc")]
pub(super) use partition::number_by_search;
pub(super) use search::count_preceding;
