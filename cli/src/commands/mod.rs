//! One file a command.

pub mod bench;
pub mod decode;
pub mod encode;
pub mod signal;
