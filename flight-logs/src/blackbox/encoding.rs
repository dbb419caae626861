//! Decodes the numbers packed into the frames of a Betaflight blackbox log. See "Blackbox Internals" in Betaflight's
//! documentation.

/// The bytes of a frame, and the index of the next byte to read.
pub(crate) struct Input<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
}

/// Reason that the bytes are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// The bytes end within the frame.
    End,
    /// The bytes violate the format of frames, or the frame does not fit the frames around it.
    Odd,
}

/// Encoding of one number of a frame, or of several neighbouring numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// A signed number of variable length, seven bits in each byte. The lowest bit is the sign (zigzag).
    Signed,
    /// An unsigned number of variable length, seven bits in each byte.
    Unsigned,
    /// A signed number. The frame holds the negative of the number, in 14-bit two's complement. The 14 bits are stored
    /// like an [`Unsigned`](Self::Unsigned) number.
    Negative14,
    /// Up to eight numbers. The first byte has one bit for each number. The numbers whose bit is 1 follow; the others
    /// are 0 and take no bytes. A single number is stored without the first byte.
    UpToEight,
    /// Three numbers, in one of four forms: of 2 bits each; of 4 bits each; of 6 bits each; or each with its own number
    /// of bytes, 1 to 4.
    Three,
    /// Four numbers, each of 0, 4, 8 or 16 bits.
    Four,
    /// The number 0, for which the frame has no bytes.
    Null,
    /// Three numbers, in one of four forms: of 2, 2 and 2 bits; of 5, 5 and 4 bits; of 8, 7 and 7 bits; or each with
    /// its own number of bytes, 1 to 4.
    ThreeVariable,
}

impl Encoding {
    /// Returns the encoding with this number in the log's header; `None` if the number is unknown.
    pub(crate) fn of(number: i64) -> Option<Self> {
        Some(match number {
            0 => Self::Signed,
            1 => Self::Unsigned,
            3 => Self::Negative14,
            6 => Self::UpToEight,
            7 => Self::Three,
            8 => Self::Four,
            9 => Self::Null,
            10 => Self::ThreeVariable,
            _ => return None,
        })
    }

    /// Returns the number of fields in one group: successive fields whose values this encoding packs together.
    /// `in_a_row` is the number of successive fields with this encoding.
    pub(crate) fn group(self, in_a_row: usize) -> usize {
        match self {
            Self::UpToEight => in_a_row.min(8),
            Self::Three | Self::ThreeVariable => 3,
            Self::Four => 4,
            _ => 1,
        }
    }
}

impl Input<'_> {
    pub(crate) fn byte(&mut self) -> Result<u8, Fault> {
        let byte = *self.bytes.get(self.at).ok_or(Fault::End)?;
        self.at += 1;
        Ok(byte)
    }

    /// Reads an unsigned number of variable length: seven bits in each byte, low bits first, at most five bytes.
    pub(crate) fn unsigned(&mut self) -> Result<u32, Fault> {
        let mut number = 0_u32;
        for index in 0..5 {
            let byte = self.byte()?;
            number |= u32::from(byte & 0x7f) << (7 * index);
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err(Fault::Odd)
    }

    /// Reads a signed number of variable length, zigzag-encoded: the codes 0, 1, 2, 3 stand for 0, -1, 1, -2.
    pub(crate) fn signed(&mut self) -> Result<i32, Fault> {
        let number = self.unsigned()?;
        Ok((number >> 1) as i32 ^ -((number & 1) as i32))
    }

    /// Reads one group of `count` numbers with this encoding. `version` is the log's data version. The result has eight
    /// items; the items after the group are 0.
    pub(crate) fn numbers(
        &mut self,
        encoding: Encoding,
        count: usize,
        version: i64,
    ) -> Result<[i32; 8], Fault> {
        let mut numbers = [0; 8];
        match encoding {
            Encoding::Signed => numbers[0] = self.signed()?,
            Encoding::Unsigned => numbers[0] = self.unsigned()? as i32,
            Encoding::Negative14 => numbers[0] = -extend(self.unsigned()?, 14),
            Encoding::Null => {}
            Encoding::UpToEight if count == 1 => numbers[0] = self.signed()?,
            Encoding::UpToEight => {
                let which = self.byte()?;
                for (index, number) in numbers.iter_mut().enumerate().take(count) {
                    if which >> index & 1 == 1 {
                        *number = self.signed()?;
                    }
                }
            }
            Encoding::Three | Encoding::ThreeVariable => {
                numbers[..3].copy_from_slice(&self.three(encoding == Encoding::ThreeVariable)?);
            }
            Encoding::Four if version < 2 => numbers[..4].copy_from_slice(&self.four_bytes()?),
            Encoding::Four => numbers[..4].copy_from_slice(&self.four_nibbles()?),
        }
        Ok(numbers)
    }

    fn three(&mut self, is_variable: bool) -> Result<[i32; 3], Fault> {
        let lead = u32::from(self.byte()?);
        let part = |byte: u32, shift: u32, bits: u32| extend(byte >> shift, bits);
        Ok(match (lead >> 6, is_variable) {
            (0, _) => [part(lead, 4, 2), part(lead, 2, 2), part(lead, 0, 2)],
            (1, false) => {
                let next = u32::from(self.byte()?);
                [part(lead, 0, 4), part(next, 4, 4), part(next, 0, 4)]
            }
            (2, false) => {
                [part(lead, 0, 6), part(self.byte()?.into(), 0, 6), part(self.byte()?.into(), 0, 6)]
            }
            // Numbers of 5, 5 and 4 bits.
            (1, true) => {
                let both = lead << 8 | u32::from(self.byte()?);
                [part(both, 9, 5), part(both, 4, 5), part(both, 0, 4)]
            }
            // Numbers of 8, 7 and 7 bits.
            (2, true) => {
                let two = lead << 8 | u32::from(self.byte()?);
                let three = two << 8 | u32::from(self.byte()?);
                [part(three, 14, 8), part(three, 7, 7), part(three, 0, 7)]
            }
            _ => {
                let mut numbers = [0; 3];
                for (index, number) in numbers.iter_mut().enumerate() {
                    let bytes = (lead >> (2 * index) & 3) + 1;
                    let mut read = 0;
                    for byte in 0..bytes {
                        read |= u32::from(self.byte()?) << (8 * byte);
                    }
                    *number = extend(read, 8 * bytes);
                }
                numbers
            }
        })
    }

    /// Reads four numbers in the packing of data version 1. The first byte gives the length of each number: 0, 4, 8 or
    /// 16 bits. A 4-bit number is the low half of a byte, and the number after it is the high half.
    fn four_bytes(&mut self) -> Result<[i32; 4], Fault> {
        let mut which = self.byte()?;
        let mut numbers = [0; 4];
        let mut index = 0;
        while index < 4 {
            match which & 3 {
                1 => {
                    let both = u32::from(self.byte()?);
                    numbers[index] = extend(both, 4);
                    index += 1;
                    which >>= 2;
                    if let Some(second) = numbers.get_mut(index) {
                        *second = extend(both >> 4, 4);
                    }
                }
                2 => numbers[index] = extend(self.byte()?.into(), 8),
                3 => {
                    let low = u32::from(self.byte()?);
                    numbers[index] = extend(u32::from(self.byte()?) << 8 | low, 16);
                }
                _ => {}
            }
            index += 1;
            which >>= 2;
        }
        Ok(numbers)
    }

    /// Reads four numbers in the packing of data version 2. The first byte gives the length of each number: 0, 1, 2 or
    /// 4 half bytes. The numbers follow without gaps. The high half of a byte comes before the low half.
    fn four_nibbles(&mut self) -> Result<[i32; 4], Fault> {
        let which = self.byte()?;
        let mut half: Option<u8> = None;
        let mut numbers = [0; 4];
        for (index, number) in numbers.iter_mut().enumerate() {
            let halves = match which >> (2 * index) & 3 {
                3 => 4,
                kind => kind,
            };
            let mut read = 0;
            for _ in 0..halves {
                let next = if let Some(low) = half.take() {
                    low
                } else {
                    let byte = self.byte()?;
                    half = Some(byte & 15);
                    byte >> 4
                };
                read = read << 4 | u32::from(next);
            }
            *number = if halves == 0 { 0 } else { extend(read, 4 * u32::from(halves)) };
        }
        Ok(numbers)
    }
}

/// Sign-extends the lowest `bits` bits of `number`.
fn extend(number: u32, bits: u32) -> i32 {
    let shift = 32 - bits;
    (number << shift) as i32 >> shift
}

#[cfg(test)]
mod tests {
    use super::{Encoding, Fault, Input};

    #[test]
    fn every_encoding_as_documented() {
        use Encoding::{Four, Negative14, Null, Signed, Three, ThreeVariable, Unsigned, UpToEight};
        // Encoding, numbers in the group, data version, bytes, expected numbers.
        type Case = (Encoding, usize, i64, &'static [u8], &'static [i32]);
        let cases: [Case; 17] = [
            (Signed, 1, 2, &[3], &[-2]),
            (Signed, 1, 2, &[0x80, 1], &[64]),
            (Unsigned, 1, 2, &[0xff, 0xff, 0xff, 0xff, 0x0f], &[-1]),
            (Negative14, 1, 2, &[5], &[-5]),
            (Null, 1, 2, &[], &[0]),
            (UpToEight, 3, 2, &[0b101, 2, 4], &[1, 0, 2]),
            (UpToEight, 1, 2, &[2], &[1]),
            (Three, 3, 2, &[0b00_01_11_10], &[1, -1, -2]),
            (Three, 3, 2, &[0b0100_0111, 0x8f], &[7, -8, -1]),
            (Three, 3, 2, &[0b1001_1111, 0x20, 1], &[31, -32, 1]),
            (Three, 3, 2, &[0b1110_0100, 0xff, 1, 1, 0, 0, 0x80], &[-1, 257, -8_388_608]),
            (ThreeVariable, 3, 2, &[0b0101_1111, 0x18], &[15, -15, -8]),
            (ThreeVariable, 3, 2, &[0b1011_1111, 0b1100_0000, 0b1111_1111], &[-1, 1, -1]),
            (Four, 4, 1, &[0b1110_0101, 0x2f, 0x80, 0x00, 0x01], &[-1, 2, -128, 256]),
            (Four, 4, 2, &[0b0000_0101, 0xf2], &[-1, 2, 0, 0]),
            (Four, 4, 2, &[0b1110_0100, 0x1f, 0xf0, 0x10, 0x00], &[0, 1, -1, 256]),
            (Four, 4, 2, &[0b0011_0000, 0x01, 0x00], &[0, 0, 256, 0]),
        ];
        for (encoding, count, version, bytes, expected) in cases {
            let mut input = Input { bytes, at: 0 };
            let numbers = input.numbers(encoding, count, version).unwrap();
            assert_eq!(&numbers[..expected.len()], expected, "{encoding:?} of {bytes:?}");
            assert_eq!(input.at, bytes.len(), "{encoding:?} of {bytes:?}");
            if let Some(short) = bytes.len().checked_sub(1) {
                let mut input = Input { bytes: &bytes[..short], at: 0 };
                assert_eq!(input.numbers(encoding, count, version), Err(Fault::End));
            }
        }
        assert_eq!(Input { bytes: &[0xff; 6], at: 0 }.unsigned(), Err(Fault::Odd));
    }
}
