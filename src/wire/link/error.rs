//! Errors of reading and writing frames.

use core::fmt;

use super::frame::VERSION;

/// Why a frame was not read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LinkError {
    /// The bytes end within the frame.
    Truncated {
        /// How many bytes the frame has, or at least has as far as is known.
        needed: usize,
        /// How many bytes there are.
        found: usize,
    },
    /// The first byte is not the magic.
    NotAFrame {
        /// The first byte.
        found: u8,
    },
    /// The frame is of another version of the link.
    Version {
        /// The version.
        found: u8,
    },
    /// The header is wrong: a period of 0, an unknown sample type of keyframes, or more keyframes than the frame has
    /// room for.
    Header,
    /// The checksum does not match: the frame was damaged.
    Checksum {
        /// The checksum in the frame.
        found: u32,
        /// The checksum of its bytes.
        computed: u32,
    },
    /// The buffer or the frame has no room for this item: finish the frame and start the next.
    Full,
    /// A keyframe of another tick or sample type than the frame's, or after an event: finish the frame and
    /// start the next.
    KeyframeOrder,
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Truncated { needed, found } => {
                write!(f, "the frame has {needed} bytes, but {found} are here")
            }
            Self::NotAFrame { found } => write!(f, "a frame does not begin with {found:#04x}"),
            Self::Version { found } => {
                write!(
                    f,
                    "the frame is one of version {found} of the link, this end reads version {VERSION}"
                )
            }
            Self::Header => {
                write!(f, "the frame's header has a period of 0 or keyframes that cannot be")
            }
            Self::Checksum { found, computed } => {
                write!(
                    f,
                    "the frame's checksum is {found:#010x}, but its bytes give {computed:#010x}"
                )
            }
            Self::Full => write!(f, "the frame is full"),
            Self::KeyframeOrder => {
                write!(f, "keyframes of one tick and sample type come first in a frame")
            }
        }
    }
}

impl core::error::Error for LinkError {}
