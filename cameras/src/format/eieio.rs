//! EIEIO, the format of `SpiNNaker` boards: the payload of a UDP datagram, up to 255 keys of 32 bits, little endian.
//!
//! ```
//! use spikewire_cameras::format::eieio;
//!
//! let mut bytes = [0; 16];
//! let length = eieio::encode(None, [0x0007_0105, 0x0007_0106], &mut bytes)?;
//! assert_eq!(bytes[..length], [2, 8, 5, 1, 7, 0, 6, 1, 7, 0]);
//!
//! let datagram = eieio::decode(&bytes[..length]).unwrap();
//! assert_eq!(datagram.timestamp, None);
//! assert!(datagram.keys().eq([0x0007_0105, 0x0007_0106]));
//! # Ok::<(), spikewire_cameras::format::FormatError>(())
//! ```

use super::FormatError;
use crate::bytes::Cursor;

const KEYS_32: u8 = 0x08;
const KEYS_32_TIMED: u8 = 0x38;
const MAX_KEYS: u8 = u8::MAX;

/// Writes a datagram and returns its length: `2 + 4 * keys`, and 4 more for a time stamp.
///
/// A neuron's key is the base key of its population plus the neuron. A time stamp, in the board's time steps, holds for
/// all keys.
///
/// # Errors
/// Returns an error if the keys do not fit the buffer, or are more than 255.
pub fn encode(
    timestamp: Option<u32>,
    keys: impl IntoIterator<Item = u32>,
    bytes: &mut [u8],
) -> Result<usize, FormatError> {
    const FULL: FormatError = FormatError::Full { written: 0 };
    let (head, rest) = bytes.split_first_chunk_mut::<2>().ok_or(FULL)?;
    let mut out = Cursor::new(rest);
    if let Some(timestamp) = timestamp {
        out.put(&timestamp.to_le_bytes()).ok_or(FULL)?;
    }
    let mut count = 0_u8;
    for key in keys {
        if count == MAX_KEYS {
            return Err(FULL);
        }
        out.put(&key.to_le_bytes()).ok_or(FULL)?;
        count += 1;
    }
    *head = [count, if timestamp.is_some() { KEYS_32_TIMED } else { KEYS_32 }];
    Ok(head.len() + out.written())
}

/// A datagram that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Datagram<'a> {
    /// The time of all keys, in the board's time steps, if it was given.
    pub timestamp: Option<u32>,
    keys: &'a [u8],
}

impl<'a> Datagram<'a> {
    /// The keys of the neurons that fired.
    pub fn keys(&self) -> impl Iterator<Item = u32> + use<'a> {
        self.keys
            .chunks_exact(4)
            .filter_map(|key| key.first_chunk().copied().map(u32::from_le_bytes))
    }
}

/// Reads a datagram; `None` if it is too short, or of another type than 32-bit keys with or without a time stamp.
pub fn decode(bytes: &[u8]) -> Option<Datagram<'_>> {
    let (&[count, kind], rest) = bytes.split_first_chunk()?;
    let (timestamp, rest) = match kind {
        KEYS_32 => (None, rest),
        KEYS_32_TIMED => {
            let (timestamp, rest) = rest.split_first_chunk()?;
            (Some(u32::from_le_bytes(*timestamp)), rest)
        }
        _ => return None,
    };
    let keys = rest.get(..4 * usize::from(count))?;
    Some(Datagram { timestamp, keys })
}
