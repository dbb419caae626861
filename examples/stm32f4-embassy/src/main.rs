//! From the IMU's interrupt to link frames, on an STM32F405 with embassy; all bytes move by DMA.
//!
//! ```text
//! IMU --data-ready--> task: bus, bank of encoders --> queue --> main: frames --> bridge or companion
//! ```
//!
//! Wiring and clocks: `examples/README.md`.

#![no_std]
#![no_main]

#[cfg_attr(not(feature = "crazyflie"), path = "board/bare.rs")]
#[cfg_attr(feature = "crazyflie", path = "board/crazyflie.rs")]
mod board;
mod clock;
mod edge;
#[cfg(feature = "crazyflie")]
mod uart;

use core::{
    cell::Cell,
    sync::atomic::{AtomicU32, Ordering::Relaxed},
};

use critical_section::Mutex;
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_stm32::{exti::ExtiInput, mode::Async};
use embassy_time::{Duration, Instant, TimeoutError, Timer, with_timeout};
use flight::{Counters, Sampler, code::SCHEMES};
use panic_probe as _;
use spikewire::{
    Bank, EventQueue, Overflow,
    link::{Coding, Transmitter},
};

use crate::edge::now;

const CHANNELS: usize = SCHEMES.len();
/// How long events gather for a frame.
const GATHER: Duration = Duration::from_millis(5);
/// A full frame takes 1.7 ms at the bridge's 1.3125 MHz, and 3 ms out of a UART at 921 600 baud.
const SEND_LIMIT: Duration = Duration::from_millis(4);
const REPORT_EVERY: Duration = Duration::from_secs(1);
/// A start takes 3 ms (BMI323) or 0.1 s (BMI088).
const START_LIMIT: Duration = Duration::from_millis(300);
/// How long to wait before a sensor that did not start is tried again, and how often main wakes without items.
const AGAIN: Duration = Duration::from_millis(100);
/// Fed while both tasks go on.
const WATCHDOG_US: u32 = 1_000_000;

/// What the sampling task has for main.
static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);
/// What happened to the samples.
static COUNTERS: Mutex<Cell<Option<Counters>>> = Mutex::new(Cell::new(None));
/// The sampling task's rounds.
static ROUNDS: AtomicU32 = AtomicU32::new(0);

/// Starts the sensor whenever it has to be, waits for a sample, reads it, encodes it.
#[embassy_executor::task]
async fn sample(mut imu: board::Imu, mut data_ready: ExtiInput<'static, Async>) {
    let mut sampler = Sampler::new(Bank::per_channel(SCHEMES), board::PLAN);
    let patience = Duration::from_micros(board::PLAN.patience.into());
    let read_limit = Duration::from_micros(board::PLAN.period.into());
    loop {
        ROUNDS.fetch_add(1, Relaxed);
        critical_section::with(|cs| COUNTERS.borrow(cs).set(Some(sampler.counters())));
        if let Some(why) = sampler.look(now(), &EVENTS) {
            defmt::warn!("the sensor is to be started: {}", why);
            match with_timeout(START_LIMIT, imu.start()).await {
                Ok(Ok(())) => sampler.started(now()),
                failed => {
                    defmt::error!("it does not start: {}", defmt::Debug2Format(&failed));
                    sampler.failed_to_start(now(), &EVENTS);
                    Timer::after(AGAIN).await;
                }
            }
        }
        if with_timeout(patience, data_ready.wait_for_rising_edge()).await.is_ok() {
            let edge = edge::last();
            let read = with_timeout(read_limit, imu.read()).await;
            sampler.take(edge, read.map_err(|_| ()).and_then(|read| read.map_err(|_| ())), &EVENTS);
        }
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board::Board { imu, data_ready, link, mut watchdog, session } = board::start();
    spawner.spawn(sample(imu, data_ready).expect("spawned once"));

    // The sensor's clock is not ours: its samples come a few µs early or late.
    let coding = Coding::for_channels(CHANNELS as u16, board::PLAN.period).with_jitter_bits(4);
    let mut link = link.link(Transmitter::new(coding, session));

    let (mut bytes, mut failures, mut late) = (0_u32, 0_u32, 0_u32);
    let (mut before, mut rounds) = (Counters::default(), 0);
    let mut events = EVENTS.consumer().expect("taken once");
    let mut next_report = Instant::now() + REPORT_EVERY;
    let mut is_all_sent = true;
    loop {
        let done = ROUNDS.load(Relaxed);
        if core::mem::replace(&mut rounds, done) != done {
            watchdog.pet();
        }
        if is_all_sent {
            // The report and the watchdog come without items too.
            let _ = with_timeout(AGAIN, events.wait()).await;
        }
        Timer::after(GATHER).await;
        // A frame that was not sent, for whatever reason, is kept for the next time, and sent whole. Of one that was
        // too late the bridge sees the beginning, and then all of it.
        let sent = with_timeout(SEND_LIMIT, link.send(&mut events)).await;
        is_all_sent = matches!(sent, Ok(Ok(0)));
        match sent {
            Ok(Ok(count)) => bytes = bytes.wrapping_add(count as u32),
            Ok(Err(_)) => failures = failures.wrapping_add(1),
            Err(TimeoutError) => late = late.wrapping_add(1),
        }
        if Instant::now() >= next_report {
            next_report += REPORT_EVERY;
            let counters = critical_section::with(|cs| COUNTERS.borrow(cs).get());
            let counters = counters.unwrap_or_default();
            defmt::info!(
                "{}; {} bytes sent, {} times not, {} times too late; {} items lost, peak {}",
                counters.since(&before),
                bytes,
                failures,
                late,
                EVENTS.lost(),
                EVENTS.peak(),
            );
            before = counters;
        }
    }
}
