//! Two recorded flights as bytes, made from the tables beside this file when it is built.
//!
//! 28 bytes a sample and nothing else: the time in µs as `u32`, then turn rates (rad/s) and specific forces (m/s²)
//! about and along x, y and z as `f32`, all little endian. `README.md` tells where the flights come from.

#![no_std]

/// A hexarotor that takes off, flies and lands hard: 3627 samples, 101 556 bytes.
pub static HEXAROTOR: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/hexarotor.f32le"));

/// A VTOL aircraft at rest: 1298 samples, 36 344 bytes.
pub static VTOL_AT_REST: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/vtol_at_rest.f32le"));
