//! From the FIFO of an ICM-42688-P at 8 kHz to link frames out of the UART, on an RP2350 with embassy and DMA.
//!
//! ```text
//! ICM-42688-P --INT1, a millisecond--> task: SPI0 by DMA, six step encoders --> queue --> main: frames --> UART0
//! ```
//!
//! Wiring and clocks: `examples/README.md`.

#![no_std]
#![no_main]

mod board;

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use board::{Board, Imu};
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_rp::gpio::Input;
use embassy_time::{Delay, Duration, Instant, Timer};
use flight::{Counters, Sampler};
use icm42688p::{Fault, Icm42688p, NEW_BUFFER, PLAN, Pace, SCHEMES, Sender, Watch};
use panic_probe as _;
use spikewire::{Bank, EventQueue, Overflow, Tick};

/// How long events gather for a frame.
const GATHER: Duration = Duration::from_millis(5);

/// What the sampling task has for main.
static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropOldest);

/// Rises as long as the sampling task runs.
static ROUNDS: AtomicU32 = AtomicU32::new(0);

fn now() -> Tick {
    Tick::from_micros(Instant::now().as_micros())
}

defmt::timestamp!("{=u32:us}", now().micros());

#[embassy_executor::task]
async fn sample(imu: Imu, data_ready: Input<'static>) {
    let mut bytes = NEW_BUFFER;
    let mut watch = Watch {
        imu: Icm42688p::new(imu, &mut bytes),
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
    let mut rounds = 0;
    loop {
        Timer::after(GATHER).await;
        sender.send(&mut events, &mut uart).await;
        // Main and the sampling task both feed the watchdog.
        let now = ROUNDS.load(Relaxed);
        if now != rounds {
            rounds = now;
            watchdog.feed(board::WATCHDOG);
        }
    }
}
