//! The checksum of a frame, CRC-32/ISO-HDLC, as a register that can go on from where another stood.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

static BYTES: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);
static NIBBLES: [u32; 16] = nibbles();

/// The register after each nibble, from 0 on.
#[expect(clippy::indexing_slicing, reason = "below 16 and 256")]
const fn nibbles() -> [u32; 16] {
    let [bytes] = BYTES.table();
    let mut nibbles = [0; 16];
    let mut nibble = 0;
    while nibble < 16 {
        // A byte whose low nibble is 0 comes to its high one after four shifts without a bit to divide.
        nibbles[nibble] = bytes[nibble << 4];
        nibble += 1;
    }
    nibbles
}

/// The register of a checksum after some bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Register(u32);

impl Register {
    /// Before the first byte.
    pub(super) const START: Self = Self(!0);

    /// The register after these bytes, too.
    #[inline(never)]
    pub(super) fn after(self, bytes: &[u8]) -> Self {
        // The linker leaves the other table out.
        if cfg!(feature = "link-small") { self.by_nibbles(bytes) } else { self.by_bytes(bytes) }
    }

    #[inline]
    fn by_bytes(self, bytes: &[u8]) -> Self {
        let [table] = BYTES.table();
        let mut register = self.0;
        for &byte in bytes {
            let index = byte ^ register as u8;
            // There are 256 entries.
            let entry = table.get(usize::from(index)).copied().unwrap_or_default();
            register = entry ^ register >> 8;
        }
        Self(register)
    }

    #[inline]
    fn by_nibbles(self, bytes: &[u8]) -> Self {
        fn step(register: u32) -> u32 {
            // There are 16 entries.
            let entry = NIBBLES.get((register & 0xF) as usize).copied().unwrap_or_default();
            entry ^ register >> 4
        }
        let mut register = self.0;
        for &byte in bytes {
            register = step(step(register ^ u32::from(byte)));
        }
        Self(register)
    }

    /// The checksum of the bytes so far.
    pub(super) const fn checksum(self) -> u32 {
        !self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_tables_give_the_checksum_of_zlib() {
        for register in [Register::by_bytes, Register::by_nibbles] {
            let start = register(Register::START, b"12345");
            assert_eq!(register(start, b"6789").checksum(), 0xCBF4_3926);
        }
        let all: [u8; 256] = core::array::from_fn(|byte| byte as u8);
        assert_eq!(Register::START.by_bytes(&all), Register::START.by_nibbles(&all));
    }
}
