//! `SynSense` Xylo: in each time step the chip takes spike counts of 16 channels, packed into two registers.

use super::ChipError;

/// Access to the chip's registers. You implement this trait, because the protocol of the chip's bus is not
/// public.
pub trait Registers {
    /// Error type of the bus that accesses the registers.
    type Error;

    /// Writes a register.
    ///
    /// # Errors
    /// Returns an error if the bus failed.
    fn write(&mut self, address: u16, value: u32) -> Result<(), Self::Error>;

    /// Reads a register.
    ///
    /// # Errors
    /// Returns an error if the bus failed.
    fn read(&mut self, address: u16) -> Result<u32, Self::Error>;
}

/// Packs the counts of 16 channels into two register values, channel `k` into nibble `k`. Counts above 15 become 15.
///
/// ```
/// use spikewire_chips::pack_counts;
///
/// let mut counts = [0; 16];
/// (counts[0], counts[7], counts[8], counts[15]) = (1, 2, 3, 200);
/// assert_eq!(pack_counts(counts), [0x2000_0001, 0xF000_0003]);
/// ```
pub fn pack_counts(counts: [u8; 16]) -> [u32; 2] {
    let nibbles = counts.into_iter().rev();
    let packed = nibbles.fold(0_u64, |packed, count| packed << 4 | u64::from(count.min(15)));
    [packed as u32, (packed >> 32) as u32]
}

/// One of the two banks of input registers. The chip reads the two banks in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum InputBank {
    /// The bank whose registers begin at [`XyloMap::input`].
    First,
    /// The bank whose registers begin two registers after [`XyloMap::input`].
    Second,
}

/// The register addresses and masks of a chip of the Xylo family.
///
/// The maps in this crate were checked against two sources of the vendor's library `rockpool`, and against no chip:
/// `syns65302/reg.py` for Audio 3, `syns61201/xa2_devkit_utils.py` for A2. Both sources poll for the end of a time step
/// as [`step`](Xylo::step) does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct XyloMap {
    /// First register of the first input bank; the second bank begins two registers later.
    pub input: u16,
    /// Register that triggers a time step; write-only.
    pub control: u16,
    /// Value that triggers a time step when it is written to [`control`](Self::control). No other value may be written
    /// there. (Bit 0 of the register resets the chip.)
    pub trigger: u32,
    /// Register that shows whether the time step is done.
    pub status: u16,
    /// Mask of the bit in `status` that is set when the step is done.
    pub done: u32,
    /// Register with the outputs that fired.
    pub outputs: u16,
    /// Mask of the bits of `outputs` in use: bit `i` is output `i`.
    pub output_bits: u32,
    /// Register address and mask of the bit that shows which input bank the next time step reads. The bit is 1 for the
    /// second bank. `None` if the public sources do not give this bit.
    pub next_bank: Option<(u16, u32)>,
}

impl XyloMap {
    /// Xylo Audio 3: 32 outputs.
    pub const AUDIO_3: Self = Self {
        input: 0x149,
        control: 0x10,
        trigger: 1 << 4,
        status: 0x153,
        done: 1,
        outputs: 0x152,
        output_bits: u32::MAX,
        next_bank: Some((0x171, 1 << 16)),
    };

    /// Xylo Audio A2: 8 outputs. Ask the vendor for `trigger`, the value that triggers a time step. The vendor's open
    /// library `rockpool` does not contain this value: it leaves the trigger to the library `samna`, whose source is
    /// not public.
    pub const fn a2(trigger: u32) -> Self {
        Self {
            input: 0x11,
            control: 0x0E,
            trigger,
            status: 0x15,
            done: 1 << 16,
            outputs: 0x15,
            output_bits: 0xFF,
            next_bank: None,
        }
    }
}

/// Xylo Audio 3 and A2 in manual mode: set the counts, run a time step, and get the outputs that fired.
///
/// Count the events of a time step with [`Bins<16>`](spikewire::Bins). Set the limit of the bins to 15, so that they
/// report events beyond this limit as saturated.
///
/// - **Banks:** a step reads one of two banks of counts. [`set_next_input`](Self::set_next_input) asks the chip which
///   bank the next step reads, and writes the counts to that bank.
/// - **Order:** set the counts, then run the step. While the chip runs a step, the driver accepts no counts. A call of
///   [`step`](Self::step) then waits for the end of this step, and does not trigger a second one.
/// - **Counts stay** in the chip. A step without new counts uses the old counts of the bank that it reads. To prevent
///   this, [clear](Self::clear_input) the counts, as the vendor's programs do.
/// - **Faults:** the chip does not confirm writes, and the public sources do not say which registers can be read back.
///   Therefore the [`Registers`] that you supply must report every write that fails. If the write of counts is lost,
///   the chip keeps the old counts. If the trigger is lost, the chip keeps the outputs of the previous step.
///
/// Checked against the vendor's sources alone, never against a chip.
///
/// Source: register names and layouts of synsense/rockpool.
#[derive(Debug)]
pub struct Xylo<R> {
    registers: R,
    map: XyloMap,
    polls: u32,
    is_under_way: bool,
}

impl<R: Registers> Xylo<R> {
    /// Makes a driver for the chip with the registers of `map`. [`step`](Self::step) reads the status up to `polls`
    /// times.
    pub const fn new(registers: R, map: XyloMap, polls: u32) -> Self {
        Self { registers, map, polls, is_under_way: false }
    }

    /// Writes the spike counts of the 16 channels in a time step to one of the two banks of input registers.
    ///
    /// # Errors
    /// Returns an error if the bus failed; then set the counts again. Returns [`Unfinished`](ChipError::Unfinished) if
    /// the chip runs a step; nothing was written then.
    pub fn set_input(
        &mut self,
        bank: InputBank,
        counts: [u8; 16],
    ) -> Result<(), ChipError<R::Error>> {
        let first = match bank {
            InputBank::First => self.map.input,
            InputBank::Second => self.map.input.wrapping_add(2),
        };
        if self.is_under_way {
            return Err(ChipError::Unfinished);
        }
        let [low, high] = pack_counts(counts);
        self.registers.write(first, low).map_err(ChipError::Bus)?;
        self.registers.write(first.wrapping_add(1), high).map_err(ChipError::Bus)
    }

    /// Asks the chip which bank the next time step reads. Returns `None` if [`XyloMap::next_bank`] is `None`.
    ///
    /// # Errors
    /// Returns an error if the bus failed, and [`Unfinished`](ChipError::Unfinished) if the chip runs a step.
    pub fn next_bank(&mut self) -> Result<Option<InputBank>, ChipError<R::Error>> {
        if self.is_under_way {
            return Err(ChipError::Unfinished);
        }
        let Some((register, mask)) = self.map.next_bank else { return Ok(None) };
        let is_second = self.registers.read(register).map_err(ChipError::Bus)? & mask != 0;
        Ok(Some(if is_second { InputBank::Second } else { InputBank::First }))
    }

    /// Writes the spike counts that the next time step reads. Writes them to the bank that this step will read, or to
    /// both banks if [`XyloMap::next_bank`] is `None`.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    pub fn set_next_input(&mut self, counts: [u8; 16]) -> Result<(), ChipError<R::Error>> {
        if let Some(bank) = self.next_bank()? {
            return self.set_input(bank, counts);
        }
        self.set_input(InputBank::First, counts)?;
        self.set_input(InputBank::Second, counts)
    }

    /// Sets the spike counts of all channels to 0, in both banks of input registers.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    pub fn clear_input(&mut self) -> Result<(), ChipError<R::Error>> {
        self.set_input(InputBank::First, [0; 16])?;
        self.set_input(InputBank::Second, [0; 16])
    }

    /// Runs a time step and returns the outputs that fired: bit `i` is output `i`.
    ///
    /// # Errors
    /// Returns [`Unfinished`](ChipError::Unfinished) if the step is not done yet: call `step` again to go on waiting.
    /// Returns [`Bus`](ChipError::Bus) if the bus failed: call `step` again. If the bus failed after the trigger,
    /// nothing is lost. If the bus failed at the trigger, the step may have begun, and the next call triggers a second
    /// one.
    pub fn step(&mut self) -> Result<u32, ChipError<R::Error>> {
        let XyloMap { control, trigger, status, done, outputs, output_bits, .. } = self.map;
        if !self.is_under_way {
            self.registers.write(control, trigger).map_err(ChipError::Bus)?;
            self.is_under_way = true;
        }
        for _ in 0..self.polls {
            if self.registers.read(status).map_err(ChipError::Bus)? & done != 0 {
                let fired = self.registers.read(outputs).map_err(ChipError::Bus)?;
                self.is_under_way = false;
                return Ok(fired & output_bits);
            }
        }
        Err(ChipError::Unfinished)
    }

    /// Consumes the driver and returns the access to the registers.
    pub fn release(self) -> R {
        self.registers
    }
}
