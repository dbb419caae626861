//! Why a receiver calls no value exact.

use core::fmt;

use crate::Fingerprint;

/// Why a channel of a [`Receiver`](super::Receiver) has no exact value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Withheld {
    /// The channel waits for its next keyframe.
    Keyframe,
    /// The channel waits for this many more samples without a loss.
    Samples(usize),
    /// The channel waits for the next sample with a spike.
    Spike,
    /// The code has sub-timesteps, and no [heartbeat](crate::Item::Heartbeat) has come since the start or the last loss:
    /// the sender must call [`keyframe_into`](crate::Bank::keyframe_into).
    Heartbeat,
    /// The code has sub-timesteps, whose length is unknown: see
    /// [`with_slot_ticks`](super::Receiver::with_slot_ticks).
    SlotTicks,
    /// The sub-timesteps of a sample are longer than the shortest period of a clock within the tolerance, by more than half of
    /// one: a number is not the sender's, or they leave no room for a clock that runs fast.
    Slots {
        /// How many sub-timesteps a sample has.
        slots: u32,
        /// The length of one, in µs.
        slot_ticks: u32,
        /// The shortest period, in µs: the link's, less the clock's tolerance.
        period: u32,
    },
    /// The samples' clock is not known well enough, after as long as it was since the last event or heartbeat, to count
    /// samples or tell sub-timesteps apart: the sender must call [`keyframe_into`](crate::Bank::keyframe_into) more often, or
    /// the receiver be told of a better clock, by [`with_clock_tolerance`](super::Receiver::with_clock_tolerance).
    Clock,
    /// The code is never exact after a start or a loss: the error fades.
    Always,
    /// The sender has other schemes, parameters, channels or [labels](super::Receiver::with_label) than the receiver. No
    /// value is exact until a sender with the receiver's own starts.
    Description {
        /// The fingerprint of the receiver.
        own: Fingerprint,
        /// The fingerprint of the sender.
        sender: Fingerprint,
    },
    /// A keyframe had another value than the exact one before it, though nothing was lost: two banks have the same
    /// addresses, the sender lost items without telling, or it has no fingerprint and other schemes. No value is exact until
    /// a sender starts or, if it has the receiver's own fingerprint, until 256 keyframes agree for each that did not.
    Contradicted,
}

impl fmt::Display for Withheld {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Keyframe => write!(f, "no keyframe since the start or the last loss"),
            Self::Samples(samples) => write!(f, "{samples} more samples without a loss are needed"),
            Self::Spike => write!(f, "no spike in a whole sample since the start or the last loss"),
            Self::Heartbeat => {
                write!(
                    f,
                    "no heartbeat since the start or the last loss, which tells sub-timesteps apart"
                )
            }
            Self::SlotTicks => write!(f, "the length of the sub-timesteps is not given"),
            Self::Slots { slots, slot_ticks, period } => write!(
                f,
                "{slots} sub-timesteps of {slot_ticks} µs are longer than a period of {period} µs, the shortest that the clock's tolerance allows"
            ),
            Self::Clock => write!(
                f,
                "events and heartbeats are too far apart to count samples or sub-timesteps, with a clock known this well"
            ),
            Self::Always => write!(f, "the error of this code fades, and is never 0"),
            Self::Description { own, sender } => write!(
                f,
                "the sender's schemes have the fingerprint {sender}, the receiver's {own}: they differ in code, parameters, sample type, order or label"
            ),
            Self::Contradicted => {
                write!(
                    f,
                    "a keyframe contradicts the value before it: the sender has other parameters, or banks that share addresses"
                )
            }
        }
    }
}
