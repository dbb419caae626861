//! Small cameras' frames as events, and the event formats of cameras, tools and boards.
#![doc = include_str!("../README.md")]
#![no_std]
#![cfg_attr(docsrs, feature(doc_cfg))]
#![forbid(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod bytes;
mod config;
pub mod format;
pub mod frame;

/// The code of the page on frames, for doctests alone.
#[cfg(doctest)]
pub mod pages {
    #[doc = include_str!("../../docs/frames.md")]
    pub struct Frames;
    #[doc = include_str!("../../docs/how-to/event-camera.md")]
    pub struct EventCamera;
}
