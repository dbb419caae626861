//! From the IMU's interrupt to link frames over SPI, on an STM32F405 with embassy; all bytes move by DMA.
//!
//! ```text
//! BMI323 --INT1--> task: SPI1, bank of step encoders --> queue --> main: frames --> SPI2 --> bridge
//! ```
//!
//! Wiring and clocks: `examples/README.md`.

#![no_std]
#![no_main]

mod board;
mod imu;

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_stm32::{exti::ExtiInput, mode::Async};
use embassy_time::{Delay, Duration, Instant, TimeoutError, Timer, with_timeout};
use panic_probe as _;
use spikewire::{
    Bank, EventQueue, Overflow, Tick,
    link::{Coding, MAX_FRAME, Transmitter},
    out::AsyncSpiSink,
};

const CHANNELS: usize = imu::SCHEMES.len();
/// Samples from one keyframe to the next: a second.
const KEYFRAME_EVERY: u16 = imu::SAMPLE_RATE;
/// How long events gather for a frame.
const GATHER: Duration = Duration::from_millis(5);
/// A full frame takes 1.7 ms at the bridge's 1.3125 MHz.
const SEND_LIMIT: Duration = Duration::from_millis(4);
const REPORT_EVERY: Duration = Duration::from_secs(1);

/// What the sampling task has for main.
static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);

fn now() -> Tick {
    Tick::from_micros(Instant::now().as_micros())
}

defmt::timestamp!("{=u32:us}", now().micros());

/// Waits for a sample, reads it, encodes it.
#[embassy_executor::task]
async fn sample(mut imu: imu::Imu<board::SpiDevice>, mut data_ready: ExtiInput<'static, Async>) {
    let mut bank = Bank::per_channel(imu::SCHEMES);
    loop {
        for _ in 0..KEYFRAME_EVERY {
            data_ready.wait_for_rising_edge().await;
            let tick = now();
            match imu::read(&mut imu).await {
                Ok(sample) => bank.encode_into(tick, sample, &EVENTS),
                Err(_) => defmt::warn!("a sample could not be read"),
            }
        }
        // No sample has come since the last one, so now is as good a tick as its own.
        bank.keyframe_into(now(), &EVENTS);
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board::Board { imu, data_ready, bridge, bridge_ready, session } = board::start();
    let imu = imu::start(imu, &mut Delay).await.expect("no BMI323 on SPI1");
    spawner.spawn(sample(imu, data_ready).expect("spawned once"));

    // The sensor's clock is not ours: its samples come a few µs early or late.
    let coding = Coding::for_channels(CHANNELS as u16, imu::PERIOD_US).with_jitter_bits(4);
    let transmitter = Transmitter::new(coding, session);
    let mut link =
        AsyncSpiSink::<_, _, MAX_FRAME, _>::with_ready(bridge, transmitter, bridge_ready);

    let (mut bytes, mut failures, mut late) = (0_u32, 0_u32, 0_u32);
    let mut events = EVENTS.consumer().expect("taken once");
    let mut next_report = Instant::now() + REPORT_EVERY;
    let mut is_all_sent = true;
    loop {
        if is_all_sent {
            // The report comes without items too.
            let _ = with_timeout(REPORT_EVERY, events.wait()).await;
        }
        Timer::after(GATHER).await;
        // A frame that was not sent, for whatever reason, is kept for the next time. One that was too late
        // leaves chip select low until then: the bridge sees its beginning and then all of it in one
        // piece, in which the link's reader finds the frame.
        let sent = with_timeout(SEND_LIMIT, link.send(&mut events)).await;
        is_all_sent = matches!(sent, Ok(Ok(0)));
        match sent {
            Ok(Ok(count)) => bytes = bytes.wrapping_add(count as u32),
            Ok(Err(_)) => failures = failures.wrapping_add(1),
            Err(TimeoutError) => late = late.wrapping_add(1),
        }
        if Instant::now() >= next_report {
            next_report += REPORT_EVERY;
            defmt::info!(
                "{} bytes sent, {} times not, {} times too late; {} items lost, peak {}",
                bytes,
                failures,
                late,
                EVENTS.lost(),
                EVENTS.peak(),
            );
        }
    }
}
