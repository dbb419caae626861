//! From the FIFO of an ICM-42688-P at 8 kHz to link frames over USB, on an STM32H743 with embassy and DMA.
//!
//! ```text
//! ICM-42688-P --INT1, a millisecond--> task: SPI1 by DMA, six step encoders --> queue --> main: frames --> USB serial
//! ```
//!
//! Wiring, clocks and memory: `examples/README.md`.

#![no_std]
#![no_main]

mod board;
mod memory;

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use board::{Board, DataReady, Imu, Usb};
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_time::{Delay, Duration, Instant, Timer, with_timeout};
use flight::{Counters, Sampler};
use icm42688p::{Fault, Icm42688p, PLAN, Pace, SCHEMES, Sender, Watch};
use panic_probe as _;
use spikewire::{Bank, Consumer, EventQueue, Overflow, Tick};

/// How long events gather for a frame.
const GATHER: Duration = Duration::from_millis(5);
/// A host that reads takes a frame within a few of USB's milliseconds.
const SEND_LIMIT: Duration = Duration::from_millis(20);

/// What the sampling task has for main. While no host reads, the oldest give way, and are counted.
static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropOldest);

/// Rises as long as the sampling task runs.
static ROUNDS: AtomicU32 = AtomicU32::new(0);

fn now() -> Tick {
    Tick::from_micros(Instant::now().as_micros())
}

defmt::timestamp!("{=u32:us}", now().micros());

#[embassy_executor::task]
async fn sample(imu: Imu, data_ready: DataReady) {
    let mut watch = Watch {
        imu: Icm42688p::new(imu, memory::dma_buffer()),
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

/// Sends what waits. A last packet of 64 bytes would tell the host that more follows: an empty one says that it does not.
async fn send(sender: &mut Sender, events: &mut Consumer<'_>, usb: &mut Usb) {
    let before = sender.bytes;
    sender.send(events, usb).await;
    if sender.bytes != before {
        // A port that is gone takes nothing, which the next frame counts.
        _ = usb.write_packet(&[]).await;
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let Board { imu, data_ready, mut usb, mut watchdog, session } = board::start(spawner);
    spawner.spawn(sample(imu, data_ready).expect("spawned once"));

    let mut sender = Sender::new(session);
    let mut events = EVENTS.consumer().expect("taken once");
    let (mut rounds, mut late) = (0, 0_u32);
    loop {
        Timer::after(GATHER).await;
        // While nobody has opened the port, the oldest events give way.
        let is_open = usb.dtr();
        let sending = with_timeout(SEND_LIMIT, send(&mut sender, &mut events, &mut usb));
        if is_open && sending.await.is_err() {
            late = late.wrapping_add(1);
            defmt::warn!("the host was too slow {} times", late);
        }
        // Main and the sampling task both feed the watchdog.
        let now = ROUNDS.load(Relaxed);
        if now != rounds {
            rounds = now;
            watchdog.pet();
        }
    }
}
