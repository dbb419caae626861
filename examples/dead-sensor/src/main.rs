//! A flight whose sensor dies in every way that it can, and comes back: the examples' own bodies between a simulated
//! sensor, whose samples are the recorded flight's, and the far end of a link. A line for what happens, and for each half
//! second what was counted, and how many channels the far end knows exactly.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt;

use bmi323_driver::Bmi323;
use embedded_hal::delay::DelayNs;
use flight::{
    Sampler,
    bmi323::{self, SAMPLE_RATE, in_units},
    code::{MOST, SCHEMES, Schemes},
    simulated::{Sensor, Trouble},
};
use flight_data::HEXAROTOR;
use spikewire::{
    Bank, EventQueue, Overflow, Tick,
    link::{Coding, MAX_FRAME, Reader, Receiver, Transmitter},
};

const PERIOD_US: u32 = 1_000_000 / SAMPLE_RATE as u32;
const CHANNELS: usize = SCHEMES.len();
/// Four seconds.
const SAMPLES: u32 = 4 * SAMPLE_RATE as u32;
/// A start that failed is tried again so many samples later.
const AGAIN: u32 = 80;

static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);

/// What befalls the sensor before this sample.
fn fate(sample: u32, sensor: &mut Sensor) -> Option<&'static str> {
    let next = sensor.accesses();
    let (trouble, what) = match sample {
        0 => (Trouble::Absent { level: 0xFF }, "no sensor"),
        200 => (Trouble::None, "the sensor has its supply"),
        900 => {
            sensor.brown_out();
            (Trouble::None, "a brown-out")
        }
        1300 => (Trouble::Fails { access: next }, "a read fails"),
        1500 => {
            sensor.brown_out();
            (Trouble::Absent { level: 0x00 }, "its wire breaks")
        }
        1700 => (Trouble::None, "the wire is back"),
        2600 => {
            sensor.brown_out();
            (Trouble::Deaf { access: next + 6 }, "a brown-out, and a write that it does not hear")
        }
        _ => return None,
    };
    sensor.set(trouble);
    Some(what)
}

/// Samples in which the sensor says the same, and whose edges nobody sees.
const STUCK: core::ops::Range<u32> = 2000..2100;
const UNSEEN: core::ops::Range<u32> = 1100..1103;

/// The flight's counts, a row a sample, from its middle on; the last bit is noise.
fn counts(sample: u32) -> [i16; 6] {
    let sample = if STUCK.contains(&sample) { STUCK.start } else { sample };
    let (rows, _) = HEXAROTOR.as_chunks::<28>();
    let Some(row) = rows.get(sample as usize) else { return [0; 6] };
    let (fields, _) = row.as_chunks::<4>();
    let mut counts = [0; 6];
    for (channel, (count, field)) in counts.iter_mut().zip(fields.iter().skip(1)).enumerate() {
        let to_counts = if channel < 3 { 57.295_78 * 32_768.0 / 2000.0 } else { 32_768.0 / 156.9 };
        *count = (f32::from_le_bytes(*field) * to_counts) as i16 ^ (sample & 1) as i16;
    }
    counts
}

/// Time does not pass while it waits.
struct NoWait;

impl DelayNs for NoWait {
    fn delay_ns(&mut self, _: u32) {}
}

/// Link and receiver.
struct FarEnd {
    transmitter: Transmitter,
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<Schemes, CHANNELS, { CHANNELS * MOST }>,
    breaks: u32,
}

impl FarEnd {
    fn hear(&mut self) -> fmt::Result {
        let mut events = EVENTS.consumer().ok_or(fmt::Error)?;
        let mut frame = [0; MAX_FRAME];
        while let Some(mut bytes) =
            self.transmitter.next_frame(&mut events, &mut frame).map_err(|_| fmt::Error)?
        {
            while let Some(received) = self.reader.next_frame(&mut bytes) {
                self.breaks += u32::from(received.is_after_break());
                self.receiver.apply(&received, |_, _, _| ());
            }
        }
        Ok(())
    }

    fn exact(&self) -> usize {
        (0..CHANNELS).filter(|&channel| self.receiver.exact(channel as u16).is_some()).count()
    }
}

fn run(out: &mut impl fmt::Write) -> fmt::Result {
    let mut sensor = Sensor::default();
    let mut sampler = Sampler::new(Bank::per_channel(SCHEMES), bmi323::plan(MOST as u8));
    let coding = Coding::for_channels(CHANNELS as u16, PERIOD_US as u16);
    let mut far = FarEnd {
        transmitter: Transmitter::new(coding, 1),
        reader: Reader::new(),
        receiver: Receiver::per_channel(SCHEMES),
        breaks: 0,
    };
    let (mut next_start, mut before) = (0, sampler.counters());
    for sample in 0..SAMPLES {
        let now = Tick::from_micros((sample * PERIOD_US).into());
        if let Some(what) = fate(sample, &mut sensor) {
            writeln!(out, "{sample}: {what}")?;
        }
        // The interrupt.
        if sensor.sample(counts(sample)) && !UNSEEN.contains(&sample) {
            let read = bmi323::read(&mut Bmi323::new_spi(&mut sensor));
            sampler.take(now, read.map(in_units), &EVENTS);
        }
        // Main.
        let why = sampler.look(now, &EVENTS).filter(|_| sample >= next_start);
        if let Some(why) = why {
            match bmi323::start(&mut Bmi323::new_spi(&mut sensor), &mut NoWait) {
                Ok(()) => {
                    sampler.started(now);
                    writeln!(out, "{sample}: {why:?}, started")?;
                }
                Err(error) => {
                    sampler.failed_to_start(now, &EVENTS);
                    next_start = sample + AGAIN;
                    writeln!(out, "{sample}: {why:?}, {error:?}")?;
                }
            }
        }
        far.hear()?;
        if (sample + 1) % (u32::from(SAMPLE_RATE) / 2) == 0 {
            let counters = sampler.counters();
            writeln!(out, "{sample}: {:?}", counters.since(&before))?;
            before = counters;
            let (breaks, exact, lost) = (far.breaks, far.exact(), EVENTS.lost());
            writeln!(out, "{sample}: far end: {breaks} breaks, {exact} exact; {lost} lost")?;
        }
    }
    // What it holds is what the bank holds, to the bit.
    for channel in 0..CHANNELS {
        let held = sampler.bank().keyframe(channel).map(f32::to_bits);
        let is_same = held == far.receiver.exact(channel as u16).map(f32::to_bits);
        writeln!(out, "channel {channel}: {}", if is_same { "the same" } else { "DIFFERS" })?;
    }
    Ok(())
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
