//! From the FIFO of an ICM-42688-P at 8 kHz to link frames out of a UART, on a flight controller that people fly.
//!
//! ```text
//! ICM-42688-P --INT1, a millisecond--> task: SPI1 by DMA, six step encoders --> queue --> main: frames --> UART6
//! ```
//!
//! Wiring and clocks: `examples/README.md`.

#![no_std]
#![no_main]

mod board;
mod clock;

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use board::{Board, DataReady, Imu};
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_time::{Delay, Duration, Instant, Timer, with_timeout};
use flight::{Counters, Sampler};
use icm42688p::{Fault, Icm42688p, NEW_BUFFER, PLAN, Pace, SCHEMES, Sender, Watch};
use panic_probe as _;
use spikewire::{Bank, EventQueue, Overflow, Tick};

/// How long events gather for a frame.
const GATHER: Duration = Duration::from_millis(5);
/// Ten full frames at 2 Mbaud; what is left then is sent the next time.
const SEND_LIMIT: Duration = Duration::from_millis(15);

/// What the sampling task has for main. While the UART is behind, the oldest give way, and are counted.
static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropOldest);

/// Rises as long as the sampling task runs.
static ROUNDS: AtomicU32 = AtomicU32::new(0);

fn now() -> Tick {
    Tick::from_micros(Instant::now().as_micros())
}

defmt::timestamp!("{=u32:us}", now().micros());

#[embassy_executor::task]
async fn sample(imu: Imu, data_ready: DataReady) {
    let mut buffer = NEW_BUFFER;
    let mut watch = Watch {
        imu: Icm42688p::new(imu, &mut buffer),
        data_ready,
        delay: Delay,
        now,
        sampler: Sampler::new(Bank::per_channel(SCHEMES), PLAN),
        pace: Pace::new(),
        report,
        rounds: &ROUNDS,
    };
    watch.run(&EVENTS).await
}

fn report(counters: Counters, fault: Option<Fault>) {
    match fault {
        Some(fault) => defmt::warn!("{}; {}", fault, counters),
        None => defmt::info!("{}; {} lost, peak {}", counters, EVENTS.lost(), EVENTS.peak()),
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let Board { imu, data_ready, mut uart, mut watchdog, session } = board::start();
    spawner.spawn(sample(imu, data_ready).expect("spawned once"));

    let mut sender = Sender::new(session);
    let mut events = EVENTS.consumer().expect("taken once");
    let (mut rounds, mut late) = (0, 0_u32);
    loop {
        Timer::after(GATHER).await;
        // A frame that is broken off is a gap to the far end, which is exact again after the next keyframe.
        if with_timeout(SEND_LIMIT, sender.send(&mut events, &mut uart)).await.is_err() {
            late = late.wrapping_add(1);
            defmt::warn!("the UART was behind {} times", late);
        }
        // Main and the sampling task both feed the watchdog.
        let done = ROUNDS.load(Relaxed);
        if core::mem::replace(&mut rounds, done) != done {
            watchdog.pet();
        }
    }
}
