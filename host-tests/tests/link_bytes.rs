//! How many bytes a spike takes on the flight log, against other ways to send it.

use host_tests::flight;
use spikewire::format::{Edvs, EdvsTime, EventFormat, EventStream, Evt2};
use spikewire::link::{Coding, MAX_FRAME, Session, Transmitter};
use spikewire::temporal::StepForward;
use spikewire::{Bank, Event, FromEvents};

/// Gyroscope in rad/s, accelerometer in m/s².
fn spikes(gyro: f32, accel: f32) -> Vec<Event> {
    let [gyro, accel] = &[gyro, accel].map(StepForward::<f32>::new);
    let mut bank = Bank::per_channel([gyro, gyro, gyro, accel, accel, accel]);
    let mut events = Vec::new();
    for sample in flight::hexarotor() {
        bank.encode(sample.time_us.into(), sample.channels(), |event| events.push(event));
    }
    events
}

/// The bytes of all frames, where one is closed when the next event lies this far behind its first.
fn link(events: &[Event], coding: Coding, delay: u32) -> usize {
    let mut transmitter = Transmitter::new(coding, Session::counted(0));
    let mut bytes = 0;
    for batch in events.chunk_by(|a, b| a.tick.micros() / delay == b.tick.micros() / delay) {
        let mut source = FromEvents(batch.iter().copied());
        let mut buffer = [0; MAX_FRAME];
        while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
            bytes += frame.len();
        }
    }
    bytes
}

fn format(events: &[Event], mut format: impl EventFormat) -> usize {
    let mut buffer = vec![0; 1 << 18]; // Event Stream writes a byte for every 254 µs
    events.iter().map(|&event| format.encode(event, &mut buffer).unwrap()).sum()
}

#[test]
fn the_link_takes_about_a_byte_a_spike() {
    println!(
        "bytes a spike on the flight log: thresholds, spikes, full frames, frames of 100 ms and of \
         20 ms; raw; Event Stream; EVT2; eDVS E1"
    );
    for (gyro, accel) in [(0.02, 0.1), (0.05, 0.25), (0.1, 0.5), (0.2, 1.0)] {
        let events = spikes(gyro, accel);
        let each = |bytes: usize| bytes as f64 / events.len() as f64;
        let coding = Coding::for_channels(6, 5_038);
        let [full, slow, fast] =
            [u32::MAX, 100_000, 20_000].map(|d| each(link(&events, coding, d)));
        let es = each(format(&events, EventStream::encoder()));
        let evt2 = each(format(&events, Evt2::encoder()));
        let edvs = each(format(&events, Edvs::new(EdvsTime::Delta).encoder()));
        println!(
            "{gyro:4} rad/s {accel:4} m/s² {:6}   {full:.2} {slow:.2} {fast:.2}   7   {es:.2}   \
             {evt2:.2}   {edvs:.2}",
            events.len()
        );
        assert!(full < 1.0 && slow < 1.7, "{full} {slow}");
        assert!(full < es && full < evt2 && full < edvs);
    }
}

/// The same flight as a sensor at 1 kHz would have seen it, between its samples on straight lines, with
/// ticks from a timer.
#[test]
fn at_a_kilohertz_too() {
    let log = flight::hexarotor();
    for (gyro, accel) in [(0.02, 0.1), (0.05, 0.25)] {
        let [gyro, accel] = &[gyro, accel].map(StepForward::<f32>::new);
        let mut bank = Bank::per_channel([gyro, gyro, gyro, accel, accel, accel]);
        let mut events = Vec::new();
        let mut next = 0;
        for pair in log.windows(2) {
            let (from, to) = (&pair[0], &pair[1]);
            while next < to.time_us {
                let part = (next - from.time_us) as f32 / (to.time_us - from.time_us) as f32;
                let (a, b) = (from.channels(), to.channels());
                let samples = core::array::from_fn(|c| a[c] + part * (b[c] - a[c]));
                bank.encode(next.into(), samples, |event| events.push(event));
                next += 1_000;
            }
        }
        let coding = Coding::for_channels(6, 1_000);
        let each = |delay| link(&events, coding, delay) as f64 / events.len() as f64;
        let [full, fast] = [u32::MAX, 20_000].map(each);
        println!(
            "1 kHz: {} spikes, full frames {full:.2}, of 20 ms {fast:.2} bytes a spike",
            events.len()
        );
        assert!(full < 1.1, "{full}");
    }
}
