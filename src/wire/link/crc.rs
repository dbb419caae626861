//! The checksum of a frame, CRC-32/ISO-HDLC, as a register that can go on from where another stood.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The register of a checksum after some bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Register(u32);

impl Register {
    /// Before the first byte.
    pub(super) const START: Self = Self(!0);

    /// The register after these bytes, too.
    #[inline(never)]
    pub(super) fn after(self, bytes: &[u8]) -> Self {
        let [table] = CRC.table();
        let mut register = self.0;
        for &byte in bytes {
            let index = byte ^ register as u8;
            // There are 256 entries.
            let entry = table.get(usize::from(index)).copied().unwrap_or_default();
            register = entry ^ register >> 8;
        }
        Self(register)
    }

    /// The checksum of the bytes so far.
    pub(super) const fn checksum(self) -> u32 {
        !self.0
    }
}
