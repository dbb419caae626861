//! Counts of all in a stream that is no event.

use catalogue::run::{Spell, Worded, quoted};
use spikewire::link::Withheld;
use std::fmt;

/// Counts of a reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Bytes that belonged to nothing.
    pub skipped: u64,
    /// Whether the end was cut.
    pub is_cut: bool,
    /// Ticks of more than 32 bits.
    pub long_ticks: u64,
    /// The counts of a link; `None` for other formats.
    pub link: Option<LinkTally>,
}

/// Counts of a link's reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkTally {
    /// Frames that arrived whole.
    pub frames: u64,
    /// Frames that never arrived.
    pub lost: u64,
    /// Number of places at which frames are missing.
    pub gaps: u64,
    /// Checksums that did not match.
    pub bad_checksums: u64,
    /// Frames that came twice.
    pub repeated: u64,
    /// Frames before which the sender lost events.
    pub after_loss: u64,
    /// The number of times that the sender began.
    pub restarts: u64,
    /// Keyframes.
    pub keyframes: u64,
    /// Frames whose events cannot be.
    pub impossible: u64,
    /// Events and keyframes of an address without a decoder.
    pub outside: u64,
    /// Keyframes of another sample type.
    pub misfits: u64,
    /// Keyframes for a scheme that has none.
    pub unused_keyframes: u64,
    /// The comparison of keyframes with the values just before them.
    pub held: Held,
    /// The reason that no value is exact, if frames are decoded.
    pub withheld: Option<Withheld>,
}

/// Keyframes of a code whose decoder should hold them already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Held {
    /// Number of keyframes that followed an exact value.
    pub compared: u64,
    /// Number of those that differed from it.
    pub contradicted: u64,
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.word(f, quoted)
    }
}

impl Worded for Tally {
    fn word(&self, f: &mut fmt::Formatter<'_>, spell: Spell) -> fmt::Result {
        if let Some(link) = self.link {
            writeln!(
                f,
                "{} frames: {} lost in {} gaps, {} bad checksums, {} repeated; {} restarts, {} keyframes",
                link.frames,
                link.lost,
                link.gaps,
                link.bad_checksums,
                link.repeated,
                link.restarts,
                link.keyframes
            )?;
            let rare = [
                (link.after_loss, "frames before which the sender lost events"),
                (link.impossible, "frames with events that cannot be"),
                (link.outside, "events and keyframes at addresses without a decoder"),
                (link.misfits, "keyframes of another sample type"),
            ];
            for (count, what) in rare.into_iter().filter(|(count, _)| *count > 0) {
                writeln!(f, "{count} {what}")?;
            }
            let (unused, scheme) = (link.unused_keyframes, spell("scheme"));
            if unused > 0 {
                let what = "keyframes, which this scheme does not have";
                writeln!(f, "{unused} {what}: is {scheme} the sender's?")?;
            }
            if let Some(why) = link.withheld {
                writeln!(f, "no value is exact: {why}")?;
            }
            let Held { compared, contradicted } = link.held;
            if contradicted > 0 {
                writeln!(
                    f,
                    "{contradicted} of {compared} keyframes contradict the values before them: \
                     are {scheme}, {} and {} the sender's?",
                    spell("threshold"),
                    spell("sample")
                )?;
            }
        }
        writeln!(f, "{} bytes skipped", self.skipped)?;
        if self.long_ticks > 0 {
            writeln!(f, "{} ticks kept their low 32 bits", self.long_ticks)?;
        }
        if self.is_cut {
            writeln!(f, "the end is cut within an event")?;
        }
        Ok(())
    }
}
