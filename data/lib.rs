//! Two recorded flights as bytes, made from the tables beside this file when it is built.
//!
//! 28 bytes a sample and nothing else: the time in µs as `u32`, then turn rates (rad/s) and specific forces (m/s²)
//! about and along x, y and z as `f32`, all little endian. `README.md` tells where the flights come from.

#![no_std]

/// A hexarotor that takes off, flies and lands hard: 3627 samples, 101 556 bytes.
pub static HEXAROTOR: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/hexarotor.f32le"));

/// A VTOL aircraft at rest: 1298 samples, 36 344 bytes.
pub static VTOL_AT_REST: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/vtol_at_rest.f32le"));

/// A sample of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// Time since the recording's first sample, in µs.
    pub micros: u32,
    /// Turn rates about x, y and z in rad/s, then specific forces along them in m/s².
    pub channels: [f32; 6],
}

impl Record {
    /// Number of bytes.
    pub const SIZE: usize = 28;

    /// Reads a record.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::SIZE]) -> Self {
        let (words, _) = bytes.as_chunks::<4>();
        let channels = core::array::from_fn(|channel| f32::from_le_bytes(words[1 + channel]));
        Self { micros: u32::from_le_bytes(words[0]), channels }
    }
}

/// The records of a recording, in order.
pub fn records(recording: &[u8]) -> impl ExactSizeIterator<Item = Record> + Clone + '_ {
    recording.as_chunks().0.iter().map(Record::from_bytes)
}

/// One channel of a recording, in order, and nothing of the others: in a small flash each reader counts.
///
/// # Panics
/// `index` is not below 6.
#[must_use]
pub fn channel(recording: &[u8], index: usize) -> impl ExactSizeIterator<Item = f32> + Clone + '_ {
    let (records, _) = recording.as_chunks::<{ Record::SIZE }>();
    records.iter().map(move |record| {
        let (words, _) = record.as_chunks::<4>();
        f32::from_le_bytes(words[1 + index])
    })
}

/// The record of this number, from 0 on.
#[must_use]
pub fn record(recording: &[u8], number: usize) -> Option<Record> {
    recording.as_chunks().0.get(number).map(Record::from_bytes)
}
