//! Codes in C's memory: a spike is a byte that counts by its sign, every other code is kept as it is.

use core::mem::MaybeUninit;

use spikewire::{Code, Destination, Spike, population, temporal, timing};

/// The byte where a rate code waits for later samples. Its sign is a spike down, which no rate code decodes.
pub const WAITING: i8 = i8::MIN;

/// A code that C can have.
pub trait CCode: Code + 'static {
    /// C's room for it, as large as the code, which may hold anything.
    type Room;
    /// The code as C hands it over.
    type Given: Copy + Into<Self>;

    /// The code that was put into this room; `None` if the encoder waits.
    ///
    /// # Safety
    /// An output was put there.
    unsafe fn read(room: &Self::Room) -> Option<Self>;
}

impl CCode for Spike {
    type Room = SpikeRoom;
    type Given = SpikeByte;

    #[inline]
    unsafe fn read(room: &SpikeRoom) -> Option<Self> {
        // SAFETY: the caller's promise.
        let byte = unsafe { room.0.assume_init() };
        (byte != WAITING).then(|| SpikeByte(byte).into())
    }
}

/// Room for a spike.
#[repr(transparent)]
pub struct SpikeRoom(MaybeUninit<i8>);

impl Destination<Spike> for SpikeRoom {
    #[inline]
    fn write(&mut self, spike: Spike) {
        self.0.write(spike.sign());
    }
}

impl Destination<Option<Spike>> for SpikeRoom {
    #[inline]
    fn write(&mut self, spike: Option<Spike>) {
        self.0.write(spike.map_or(WAITING, Spike::sign));
    }
}

/// A spike from C.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct SpikeByte(i8);

impl From<SpikeByte> for Spike {
    #[inline]
    fn from(SpikeByte(byte): SpikeByte) -> Self {
        if byte == 0 {
            return Self::None;
        }
        // A match takes six instructions, in loops of five. SAFETY: it is -1 or 1.
        unsafe { core::mem::transmute::<i8, Self>((byte >> 7) | 1) }
    }
}

/// Codes that come at once, and of which C promises that they come from this library.
macro_rules! kept {
    ($($code:ty $(, $shape:ident)*;)*) => {
        $(impl<$(const $shape: usize),*> CCode for $code {
            type Room = MaybeUninit<Self>;
            type Given = Self;

            #[inline]
            unsafe fn read(room: &MaybeUninit<Self>) -> Option<Self> {
                // SAFETY: the caller's promise.
                Some(unsafe { room.assume_init() })
            }
        })*
    };
}

kept! {
    temporal::Steps<K>, K;
    Option<population::Neuron<M>>, M;
    population::SlotSpikes<M, N>, M, N;
    population::NeuronSlots<M, N>, M, N;
    Option<timing::Slot<N>>, N;
    timing::PhaseBits<K>, K;
    timing::BurstSpikes<N>, N;
    timing::PhaseSpikes<M, W, P>, M, W, P;
}
