//! The recording's times and roll rates.

use spikewire::Tick;

/// A time stamp in µs, then six channels, four bytes each.
const RECORD: usize = 28;

/// Times, and roll rates in rad/s.
pub fn rates() -> impl Iterator<Item = (Tick, f32)> {
    let (records, _) = flight_data::HEXAROTOR.as_chunks::<RECORD>();
    records.iter().map(|record| {
        let (words, _) = record.as_chunks::<4>();
        (u32::from_le_bytes(words[0]).into(), f32::from_le_bytes(words[1]))
    })
}
