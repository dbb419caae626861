//! The line between sender and far end, and what it does to frames.

use rand_core::Rng;
use rand_pcg::Pcg32;
use spikewire::link::MAX_FRAME;

/// What goes wrong in a spell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    Lost,
    Doubled,
    Late,
    Cut,
    Flipped,
    Hang,
    SenderOut,
    FarEndOut,
    TickWrap,
    NotFinite,
    Gap,
}

/// Each fault, and what the program's line says of it.
pub const FAULTS: [(Fault, &str); 11] = [
    (Fault::Lost, "a third of the frames lost"),
    (Fault::Doubled, "a third of the frames sent twice"),
    (Fault::Late, "a third of the frames overtaken by the next"),
    (Fault::Cut, "a third of the frames cut off"),
    (Fault::Flipped, "bits flipped, 1 in 1000"),
    (Fault::Hang, "main hangs, the queue overflows"),
    (Fault::SenderOut, "brown-outs of the sender"),
    (Fault::FarEndOut, "brown-outs of the far end"),
    (Fault::TickWrap, "ticks wrap"),
    (Fault::NotFinite, "samples that are not finite"),
    (Fault::Gap, "no samples"),
];

/// A serial line, one way.
pub struct Line {
    late: Frame,
    /// Frames or bits that it has harmed.
    pub harmed: u32,
}

/// A frame and its length.
struct Frame([u8; MAX_FRAME], usize);

impl Frame {
    fn bytes(&self) -> &[u8] {
        &self.0[..self.1]
    }
}

impl Line {
    pub const fn new() -> Self {
        Self { late: Frame([0; MAX_FRAME], 0), harmed: 0 }
    }

    /// Whether all that was sent has arrived, or never will.
    pub const fn is_empty(&self) -> bool {
        self.late.1 == 0
    }

    /// Brings what is left of a frame, cut anywhere, to the far end.
    pub fn carry<E>(
        &mut self,
        frame: &[u8],
        fault: Option<Fault>,
        random: &mut Pcg32,
        mut hear: impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let draws = matches!(fault, Some(Fault::Lost | Fault::Doubled | Fault::Late | Fault::Cut));
        let hits = draws && random.next_u32().is_multiple_of(3);
        self.harmed += u32::from(hits);
        match fault {
            Some(Fault::Lost) if hits => {}
            Some(Fault::Doubled) if hits => {
                hear(frame)?;
                hear(frame)?;
            }
            Some(Fault::Late) if hits && self.is_empty() => {
                self.late.0[..frame.len()].copy_from_slice(frame);
                self.late.1 = frame.len();
                return Ok(());
            }
            Some(Fault::Cut) if hits => hear(&frame[..random.next_u32() as usize % frame.len()])?,
            Some(Fault::Flipped) => {
                let mut bytes = [0; MAX_FRAME];
                let bytes = &mut bytes[..frame.len()];
                bytes.copy_from_slice(frame);
                for bit in 0..8 * bytes.len() {
                    if random.next_u32().is_multiple_of(1_000) {
                        bytes[bit / 8] ^= 1 << (bit % 8);
                        self.harmed += 1;
                    }
                }
                hear(bytes)?;
            }
            _ => {
                let (one, other) = frame.split_at(frame.len() / 2);
                hear(one)?;
                hear(other)?;
            }
        }
        self.release(hear)
    }

    /// Brings a frame that was held back.
    pub fn release<E>(&mut self, mut hear: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E> {
        if self.is_empty() {
            return Ok(());
        }
        hear(self.late.bytes())?;
        self.late.1 = 0;
        Ok(())
    }
}
