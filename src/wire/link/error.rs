//! What can be wrong with a frame.

use core::fmt;

/// Why a frame was not read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LinkError {
    /// The bytes end within the frame.
    Truncated {
        /// How many the frame has, as far as its bytes tell.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// The first byte is not the magic.
    NotAFrame {
        /// What it is.
        found: u8,
    },
    /// Another version of the link.
    Version {
        /// Which.
        found: u8,
    },
    /// A period of 0, keyframes of no sample type, or more of them than the frame has room for.
    Header,
    /// The checksum does not match: the frame was damaged.
    Checksum {
        /// What the frame says.
        found: u32,
        /// What its bytes give.
        computed: u32,
    },
    /// The buffer or the frame has no room for this: finish the frame and start the next.
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
            Self::Version { found } => write!(f, "version {found} of the link is not known"),
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
