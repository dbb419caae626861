//! Items as bytes: the link, and the event formats of cameras, tools and boards.

mod batch;
mod bytes;
pub mod format;
#[cfg(feature = "link")]
pub mod link;

pub use batch::{Batch, Formatted};
