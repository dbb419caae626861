//! Programs that other modules build and run: on this machine, on emulated boards, and in Python environments.

pub mod boards;
pub mod host;
pub mod image;
pub mod published;
pub mod python;
pub mod qemu;
pub mod size;
