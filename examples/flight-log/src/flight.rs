//! The recording: a hexarotor taking off, flying and landing hard. `data/README.md` tells where it comes from.

/// Gyroscope x, y, z in rad/s, then accelerometer x, y, z in m/s².
pub const CHANNELS: usize = 6;

/// One record: time in microseconds as u32, then the channels as f32, all little endian.
const RECORD: usize = 4 + 4 * CHANNELS;

static RECORDS: &[u8] = include_bytes!("../../../data/hexarotor.f32le");

/// One channel's samples, in order.
pub fn channel(index: usize) -> impl Iterator<Item = f32> {
    let (records, _) = RECORDS.as_chunks::<RECORD>();
    records.iter().map(move |record| {
        let (words, _) = record.as_chunks::<4>();
        f32::from_le_bytes(words[1 + index]) // word 0 is the time
    })
}
