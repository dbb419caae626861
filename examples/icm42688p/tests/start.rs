//! The driver's transfers, byte by byte.

use embassy_futures::block_on;
use embedded_hal_mock::eh1::{
    delay::NoopDelay,
    spi::{Mock, Transaction},
};
use flight::{Fault, Imu};
use icm42688p::{Icm42688p, NEW_BUFFER, PACKET, WATERMARK};

/// Address and value, from the data sheet DS-000347: the driver's table says what they mean.
const CONFIGURATION: [[u8; 2]; 12] = [
    [0x14, 0x03],
    [0x64, 0x60],
    [0x4C, 0x33],
    [0x4D, 0x51],
    [0x16, 0x40],
    [0x5F, 0x27],
    [0x60, 0x80],
    [0x61, 0x00],
    [0x65, 0x04],
    [0x4F, 0x03],
    [0x50, 0x03],
    [0x4E, 0x0F],
];

fn transfer(sent: &[u8], received: &[u8]) -> [Transaction<u8>; 3] {
    [
        Transaction::transaction_start(),
        Transaction::transfer_in_place(sent.to_vec(), received.to_vec()),
        Transaction::transaction_end(),
    ]
}

/// Bank 0, reset, identity, configuration, the same read back, an empty FIFO, and its status looked at.
fn start() -> Vec<[Vec<u8>; 2]> {
    let write = |bytes: [u8; 2]| [bytes.to_vec(), vec![0, 0]];
    let read = |[address, value]: [u8; 2]| [vec![0x80 | address, 0], vec![0, value]];
    [
        vec![write([0x76, 0]), write([0x11, 1]), read([0x75, 0x47])],
        CONFIGURATION.map(write).to_vec(),
        CONFIGURATION.map(read).to_vec(),
        vec![write([0x4B, 2]), read([0x2D, 0x02])],
    ]
    .concat()
}

fn expect(transfers: &[[Vec<u8>; 2]]) -> Vec<Transaction<u8>> {
    transfers.iter().flat_map(|[sent, received]| transfer(sent, received)).collect()
}

#[test]
fn starts_and_reads_back() {
    let mut bus = Mock::new(&expect(&start()));
    let mut bytes = NEW_BUFFER;
    let started = block_on(Icm42688p::new(&mut bus, &mut bytes).start(&mut NoopDelay));
    assert_eq!(started, Ok(()));
    bus.done();
}

#[test]
fn whoever_answers_otherwise_is_not_started() {
    for (at, [sent, received]) in start().into_iter().enumerate() {
        let is_read = sent[0] & 0x80 != 0;
        // Whatever the status was, it is looked at.
        if !is_read || sent[0] == 0xAD {
            continue;
        }
        for wrong in
            [0x00, 0xFF, received[1] ^ 0x01].into_iter().filter(|&byte| byte != received[1])
        {
            let mut transfers = start();
            transfers.truncate(at + 1);
            transfers[at][1][1] = wrong;
            let mut bus = Mock::new(&expect(&transfers));
            let mut bytes = NEW_BUFFER;
            let fault = match sent[0] {
                0xF5 => Fault::Identity(wrong.into()),
                address => {
                    let [address, wrote, read] =
                        [address & 0x7F, received[1], wrong].map(u16::from);
                    Fault::Register { address, wrote, read }
                }
            };
            let started = block_on(Icm42688p::new(&mut bus, &mut bytes).start(&mut NoopDelay));
            assert_eq!(started, Err(fault), "transfer {at}");
            bus.done();
        }
    }
}

/// What a read sends, and what comes back.
fn burst(status: u8, count: u16, packet: u8) -> [Vec<u8>; 2] {
    let mut sent = vec![0; 4 + WATERMARK * PACKET];
    sent[0] = 0xAD;
    let mut received = vec![0, status, (count >> 8) as u8, count as u8];
    for at in 0..WATERMARK as u8 {
        received.extend([packet; PACKET]);
        received[4 + PACKET * usize::from(at)] = 0x68;
    }
    [sent, received]
}

#[test]
fn a_burst_is_one_transfer_of_fixed_length() {
    // Status, bytes in the FIFO, then packets in it, those read, those left.
    let cases = [
        (0x04, 128, Ok((8, 8, 0))),
        (0x04, 144, Ok((9, 8, 1))),
        (0x00, 0, Ok((0, 0, 0))),
        (0x00, 32, Ok((2, 2, 0))),
        (0x04, 2047, Ok((127, 8, 119))),
        (0x06, 128, Err(Fault::Overrun)),
        (0x04, 2048, Err(Fault::Overrun)),
        (0xFF, 0xFFFF, Err(Fault::Overrun)),
    ];
    for (status, count, expected) in cases {
        let mut bus = Mock::new(&expect(&[burst(status, count, 0x11)]));
        let mut bytes = NEW_BUFFER;
        let mut imu = Icm42688p::new(&mut bus, &mut bytes);
        let read = block_on(imu.read());
        let read = read.map(|burst| (burst.held, burst.samples.len(), burst.left()));
        assert_eq!(read, expected, "{status:#x} {count}");
        bus.done();
    }
}
