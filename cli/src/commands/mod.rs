//! One file a command.

pub mod bench;
pub mod decode;
pub mod encode;
pub mod info;
pub mod plot;
pub mod score;
pub mod signal;
