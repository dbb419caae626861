//! Programs that the rooms above build and run: on this machine, on emulated boards, in environments of Python.

pub mod boards;
pub mod host;
pub mod image;
pub mod published;
pub mod python;
pub mod qemu;
pub mod size;
