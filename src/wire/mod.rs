//! Items as bytes: what makes batches of them for a sink, and the link.

mod batch;
#[cfg(feature = "link")]
mod bytes;
#[cfg(feature = "link")]
pub mod link;

pub use batch::Batch;
