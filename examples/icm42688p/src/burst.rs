//! The packets of the FIFO.

use flight::Sample;

/// Number of bytes of a packet: header, accelerations, rates, temperature, time.
pub const PACKET: usize = 16;

/// Number of packets from one interrupt to the next, and in a burst: a millisecond.
pub const WATERMARK: usize = 8;

/// The header of a packet with both sensors in 16 bits; its low bits tell of a time stamp and of changed rates.
const HEADER: u8 = 0x60;
const HEADER_MASK: u8 = 0xF0;

/// A channel that the sensor has no sample of.
const NONE: i16 = i16::MIN;

/// The samples of packets, oldest first. `None` is a packet without all six channels, as there are some after the start.
#[inline]
pub(crate) fn samples(packets: &[[u8; PACKET]]) -> impl ExactSizeIterator<Item = Option<Sample>> {
    packets.iter().map(parse)
}

#[inline]
fn parse(packet: &[u8; PACKET]) -> Option<Sample> {
    let [header, ax1, ax0, ay1, ay0, az1, az0, rx1, rx0, ry1, ry0, rz1, rz0, ..] = *packet;
    let sample = [[rx1, rx0], [ry1, ry0], [rz1, rz0], [ax1, ax0], [ay1, ay0], [az1, az0]]
        .map(i16::from_be_bytes);
    (header & HEADER_MASK == HEADER && !sample.contains(&NONE)).then_some(sample)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: [u8; PACKET] = [0x68, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 255, 254, 0, 0, 0];

    #[test]
    fn rates_come_first_big_endian() {
        let sample = [0x0708, 0x090A, -2, 0x0102, 0x0304, 0x0506];
        assert_eq!(parse(&WHOLE), Some(sample));
    }

    #[test]
    fn every_other_header_is_no_sample() {
        for header in 0..=255 {
            let packet = [&[header], &WHOLE[1..]].concat().try_into().unwrap();
            assert_eq!(parse(&packet).is_some(), header >> 4 == 6, "{header:#04x}");
        }
    }

    #[test]
    fn one_missing_channel_is_no_sample() {
        for channel in 0..6 {
            let mut packet = WHOLE;
            packet[1 + 2 * channel..][..2].copy_from_slice(&[0x80, 0]);
            assert_eq!(parse(&packet), None, "channel {channel}");
        }
    }
}
