//! The recording: a hexarotor taking off, flying and landing hard. `data/README.md` tells where it comes from.

use spikewire::Tick;

use crate::send::CHANNELS;

/// One record: time in microseconds as u32, then the channels as f32, all little endian.
const RECORD: usize = 4 + 4 * CHANNELS;

static RECORDS: &[u8] = flight_data::HEXAROTOR;

/// The sample of this number: six channels in rad/s and m/s².
pub fn sample(number: usize) -> Option<(Tick, [f32; CHANNELS])> {
    let (records, _) = RECORDS.as_chunks::<RECORD>();
    let (words, _) = records.get(number)?.as_chunks::<4>();
    let (time, values) = words.split_first()?;
    let mut sample = [0.0; CHANNELS];
    for (to, value) in sample.iter_mut().zip(values) {
        *to = f32::from_le_bytes(*value);
    }
    Some((u32::from_le_bytes(*time).into(), sample))
}
