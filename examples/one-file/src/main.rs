//! Both ends of a link from one file: `flight.toml`, as `spikewire advise` wrote it for the recorded hexarotor, is bank,
//! transmitter and receiver here. The sensor's samples go in, frames go over, and values come out, each bit that of the
//! sender's decoder.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt::{self, Write};
use spikewire::link::{MAX_FRAME, Reader, Session};
use spikewire::{EventQueue, Overflow, Tick};

include!(concat!(env!("OUT_DIR"), "/flight.rs"));

static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);

fn run(out: &mut impl Write) -> fmt::Result {
    let mut bank = flight::BANK;
    let mut transmitter = flight::transmitter(Session::counted(1)); // the starts, counted in flash
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = flight::receiver();
    let mut events = EVENTS.consumer().ok_or(fmt::Error)?;
    let mut buffer = [0; MAX_FRAME];
    let (mut frames, mut bytes, mut exact) = (0, 0, 0);

    let records = flight_data::records(flight_data::HEXAROTOR).take(1000);
    for (number, record) in (0..).zip(records) {
        // In the interrupt:
        let tick = Tick::from_micros(u64::from(number) * u64::from(flight::PERIOD));
        bank.encode_into(tick, record.channels, &EVENTS);
        if number % flight::KEYFRAME_EVERY == 0 {
            bank.keyframe_into(tick, &EVENTS);
        }
        // In main, and at the other end:
        transmitter.observe(tick);
        while let Ok(Some(frame)) = transmitter.next_frame(&mut events, &mut buffer) {
            (frames, bytes) = (frames + 1, bytes + frame.len());
            let mut input = frame;
            while let Some(received) = reader.next_frame(&mut input) {
                receiver.apply(&received, |_, _, _| ());
            }
        }
        exact += (0..flight::CHANNELS).filter(|own| receiver.exact(*own as u16).is_some()).count();
    }
    writeln!(out, "{frames} frames, {bytes} bytes, {exact} exact values")?;
    for (channel, name) in (0..).zip(flight::NAMES) {
        writeln!(out, "{name} {:?}", receiver.exact(channel))?;
    }
    Ok(())
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
