//! Six channels at 8 kHz from the FIFO of an ICM-42688-P to frames, as the boards do it, with every instruction counted.
//!
//! The flight is the recorded one, on straight lines between its samples, with a count of noise. What is counted: the
//! driver's read, with a bus that copies the bytes as a DMA would without the processor; the parsing; the sampler with its
//! encoders; the queue; the frames. What is not: the HAL's and the executor's work for an interrupt and two transfers a
//! millisecond. The frames are decoded at the end, and must give what the encoders hold.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod sensor;

use core::{
    cell::RefCell,
    fmt::{self, Write},
};

use board::stopwatch::instructions;
use embassy_futures::block_on;
use flight::{Alignment, CHANNELS, Imu as _, Pace, Sampler, Sender, encode};
use icm42688p::{Icm42688p, NEW_BUFFER, SAMPLE_RATE, WATERMARK};
use sensor::{Bus, PERIOD, Sensor};
use spikewire::{
    Bank, EventQueue, Overflow, Tick,
    link::{MAX_FRAME, Reader, Receiver, Session},
};

/// The hardest of the flight lies in them.
const SECONDS: u32 = 18;
/// From one round of main to the next, in bursts: 5 ms.
const GATHER: u32 = 5;

type Imu<'a> = Icm42688p<'a, Bus<'a>>;

static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);

fn run(out: &mut impl Write) -> fmt::Result {
    let mut bytes = NEW_BUFFER;
    let (mut sensor, fifo) = (Sensor::new(), RefCell::new([0; _]));
    let mut imu = Icm42688p::new(Bus(&fifo), &mut bytes);
    let mut sampler = Sampler::new(Bank::per_channel(Imu::SCHEMES), Imu::PLAN);
    sampler.started(Tick::from_micros(0));
    let mut pace = Pace::new(PERIOD);
    let mut sender = Sender::new::<Imu>(Session::counted(1));
    let mut events = EVENTS.consumer().ok_or(fmt::Error)?;
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, CHANNELS>::per_channel(Imu::SCHEMES);

    let mut now = Tick::from_micros(0);
    let (mut read_in_all, mut encoded_in_all, mut framed_in_all, mut worst) = (0, 0, 0, 0);
    let (mut sent, mut values) = (0, 0);
    for burst in 0..SECONDS * u32::from(SAMPLE_RATE) / WATERMARK as u32 {
        now += PERIOD * WATERMARK as u32;
        sensor.fill(&mut fifo.borrow_mut());
        let mut read = None;
        let reading = instructions(|| read = block_on(imu.read()).ok());
        let read = read.ok_or(fmt::Error)?;
        // As on a board whose sensor is turned.
        let encoding = instructions(|| {
            encode::<Imu>(&mut sampler, &mut pace, Alignment::Cw90, now, read, &EVENTS);
        });
        read_in_all += u64::from(reading);
        encoded_in_all += u64::from(encoding);
        worst = worst.max(reading + encoding);
        if burst % GATHER != 0 {
            continue;
        }
        let mut frames = true;
        while frames {
            let mut frame = None;
            framed_in_all += u64::from(instructions(|| frame = sender.next_frame(&mut events)));
            frames = frame.is_some();
            let mut bytes = frame.unwrap_or_default();
            sent += bytes.len();
            while let Some(received) = reader.next_frame(&mut bytes) {
                receiver.apply(&received, |_, _, _| values += 1);
            }
        }
    }

    let samples = u64::from(SECONDS) * u64::from(SAMPLE_RATE);
    let each = [
        ("the bus's copy into the driver", read_in_all),
        ("from FIFO to queue", encoded_in_all),
        ("from queue to frames", framed_in_all),
    ];
    for (what, total) in each {
        let (whole, tenth) = (total / samples, total % samples * 10 / samples);
        writeln!(out, "{what}: {whole}.{tenth} instructions a sample of six channels")?;
    }
    writeln!(out, "the worst burst of {WATERMARK}, copied and encoded: {worst}")?;
    let a_second = (read_in_all + encoded_in_all + framed_in_all) / u64::from(SECONDS);
    writeln!(out, "{a_second} instructions a second")?;
    let bytes = sent as u32 / SECONDS;
    writeln!(
        out,
        "{bytes} bytes and {} values a second, {} lost",
        values / SECONDS,
        EVENTS.lost()
    )?;

    let counters = sampler.counters();
    let is_whole = counters.samples == samples as u32 && counters.missed == 0 && EVENTS.lost() == 0;
    while sender.next_frame(&mut events).is_some_and(|mut bytes| {
        while let Some(received) = reader.next_frame(&mut bytes) {
            receiver.apply(&received, |_, _, _| ());
        }
        true
    }) {}
    let is_exact = (0..CHANNELS)
        .all(|channel| receiver.exact(channel as u16) == sampler.bank().keyframe(channel));
    if !is_whole || !is_exact {
        writeln!(out, "not whole: {counters:?}")?;
        return Err(fmt::Error);
    }
    Ok(())
}

#[cfg(target_os = "none")]
#[board::entry]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}

/// The host counts no instructions, but shows whether the values arrive.
#[cfg(not(target_os = "none"))]
fn main() {
    board::finish(run(&mut board::console()));
}
