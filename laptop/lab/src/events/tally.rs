//! Counts of everything in a stream that is not an event.

use super::EventsKind;
use catalogue::run::{Spell, Worded, quoted};
use spikewire::link::Withheld;
use spikewire_cameras::format::Evt21Order;
use std::fmt;

/// Counts of everything in a stream that is not an event, kept by the stream's reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Number of bytes that belong to no item.
    pub skipped: u64,
    /// Whether the stream ends in the middle of an item.
    pub is_cut: bool,
    /// Number of ticks of more than 32 bits.
    pub long_ticks: u64,
    /// Number of events in rows of a camera from 32 on, in a stream whose pixels stand for addresses.
    pub far_rows: u64,
    /// The order of the bytes in a word of EVT 2.1, if the stream does not say it and its words showed it.
    pub found_order: Option<Evt21Order>,
    /// Counts kept by the reader of link frames; `None` for other formats.
    pub link: Option<LinkTally>,
}

/// Counts kept by a reader of link frames (packets from a sender): received frames, losses, faults and contents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkTally {
    /// Number of frames that arrived whole.
    pub frames: u64,
    /// Number of frames that never arrived.
    pub lost: u64,
    /// Number of gaps in the sequence of frames. A gap stands for one or more lost frames.
    pub gaps: u64,
    /// Number of frames whose checksum did not match.
    pub bad_checksums: u64,
    /// Number of frames that arrived twice.
    pub repeated: u64,
    /// Number of frames that came after later ones, or from a sender before the present one. They are left out.
    pub late: u64,
    /// Number of frames in which the sender reports that it lost events before the frame.
    pub after_loss: u64,
    /// Number of times that the sender started or restarted. The start before the first received frame counts only if
    /// that frame is the first one after the start.
    pub restarts: u64,
    /// Number of keyframes received.
    pub keyframes: u64,
    /// Number of frames with events that no sender can emit.
    pub impossible: u64,
    /// Number of events and keyframes whose address has no decoder.
    pub outside: u64,
    /// Number of keyframes whose sample type is not the decoder's.
    pub misfits: u64,
    /// Number of keyframes received although the scheme uses none.
    pub unused_keyframes: u64,
    /// Comparison of the keyframes with the values decoded just before each keyframe.
    pub held: Held,
    /// The reason that no decoded value is exact (known to equal the sender's value). `None` if at least one value is
    /// exact, or if no values are decoded.
    pub withheld: Option<Withheld>,
}

/// Comparison of keyframes with the values that the decoders held just before. In some codes, a keyframe repeats the
/// value that the decoder already holds. A difference then shows a fault. Keyframes of other codes are not compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Held {
    /// Number of keyframes that were compared. A keyframe is compared if the decoder's value before the keyframe was
    /// exact (known to equal the sender's value).
    pub compared: u64,
    /// Number of compared keyframes that differed from the decoder's value.
    pub contradicted: u64,
}

impl LinkTally {
    /// Returns whether frames seem to come from two senders in turn: the reader then follows one of them.
    ///
    /// A full frame of the other sender is left out as late. A short frame of it has a bad checksum, which covers the
    /// frame before. On a noisy line, too, checksums are bad, but then the frames are missing later.
    pub fn has_two_senders(&self) -> bool {
        let others = self.late + self.bad_checksums.saturating_sub(2 * self.lost);
        self.late > 0 && others >= 16 && others * 8 > self.frames
    }
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
                (
                    link.late,
                    "frames came late, after later ones or another sender's, and were left out",
                ),
                (link.after_loss, "frames before which the sender lost events"),
                (link.impossible, "frames with events that cannot be"),
                (link.outside, "events and keyframes at addresses without a decoder"),
                (link.misfits, "keyframes of another sample type"),
            ];
            for (count, what) in rare.into_iter().filter(|(count, _)| *count > 0) {
                writeln!(f, "{count} {what}")?;
            }
            if link.has_two_senders() {
                writeln!(
                    f,
                    "are there two senders on the line? Frames of two sessions came in turn"
                )?;
            }
            let (unused, scheme) = (link.unused_keyframes, spell("scheme"));
            // The fingerprint tells what these only suggest.
            let is_other = matches!(link.withheld, Some(Withheld::Description { .. }));
            if unused > 0 && !is_other {
                let what = "keyframes, which this scheme does not have";
                writeln!(f, "{unused} {what}: is {scheme} the sender's?")?;
            }
            if let Some(why) = link.withheld {
                writeln!(f, "no value is exact: {why}")?;
            }
            let Held { compared, contradicted } = link.held;
            if contradicted > 0 && !is_other {
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
        if self.far_rows > 0 {
            EventsKind::FarRows { events: self.far_rows }.word_about(f, spell, None)?;
            writeln!(f)?;
        }
        if let Some(order) = self.found_order {
            let (name, other) = match order {
                Evt21Order::Little => ("little", 1),
                Evt21Order::Halves => ("legacy", 0),
            };
            writeln!(
                f,
                "the header does not say the order of the bytes, and by the words it is `{name}`; \
                 `evt21,legacy={other}` reads the other one"
            )?;
        }
        if self.is_cut {
            writeln!(f, "the end is cut within an event")?;
        }
        Ok(())
    }
}
