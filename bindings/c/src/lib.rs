//! spikewire for firmware in C and C++.
//!
//! The caller owns all storage; the header tells its sizes. Nothing here allocates, keeps a global or can panic: the
//! panic handler names a function that does not exist, so that a path to a panic does not link.
//!
//! This is the one room with unsafe code. It does three things: it checks pointers and makes references of them
//! ([`pointer`]), it reads storage that a call before has filled ([`codec`], `Kept`), and it exports functions by name.
//! What C promises stands at the top of `spikewire.h`; each use of `unsafe` names the promise that it rests on.

#![cfg_attr(target_os = "none", no_std)]
// C sees storage of a size, not what is in it.
#![allow(improper_ctypes_definitions)]

#[cfg(all(feature = "header", not(target_os = "none")))]
pub mod header;

pub mod argument;
mod calibration;
pub mod code;
pub mod codec;
#[cfg(feature = "codecs")]
mod codecs;
mod critical;
mod define;
mod describe;
pub mod event;
pub mod flight;
mod kept;
mod link;
#[cfg(target_os = "none")]
mod panic;
mod pointer;
mod queue;
#[cfg(all(target_os = "none", feature = "codecs"))]
mod sizes;
mod status;

pub use describe::{Constructor, Description, Layout};
pub use event::Stamp;
pub use flight::Flight;
pub use kept::Kept;
pub use queue::Queue;
pub use status::{Error, Status};

/// What the library declares, for the header.
#[cfg(feature = "codecs")]
pub use codecs::CODECS;

pub use spikewire::{population, rate, temporal, timing};
