//! One file a command.

pub mod decode;
pub mod encode;
