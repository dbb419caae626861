//! Tables and pictures of the documentation: each is measured or drawn here, written into its page, and compared with
//! it.

pub mod bench;
pub mod bits;
pub mod chips;
pub mod demo;
pub mod drawing;
pub mod faults;
pub mod flash;
mod flown;
pub mod jumps;
pub mod markdown;
mod names;
mod picture;
pub mod schemes;
pub mod signal;
