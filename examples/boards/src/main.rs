//! From an IMU's data-ready edge to link frames out of a serial port, on a board that `board.rs` describes.
//!
//! ```text
//! sensor --data-ready--> task: bus by DMA, six encoders --> queue --> main: frames --> serial port
//! ```
//!
//! `part.rs` has the microcontroller's clocks and watchdog, `board.rs` the board's pins; all else is the same everywhere.

#![no_std]
#![no_main]

#[cfg_attr(feature = "crazyflie", path = "board/crazyflie.rs")]
#[cfg_attr(feature = "matek-h743", path = "board/matek_h743.rs")]
#[cfg_attr(feature = "nrf52840-dk", path = "board/nrf52840_dk.rs")]
#[cfg_attr(feature = "pico", path = "board/pico.rs")]
#[cfg_attr(any(feature = "pico-8khz", feature = "pico2"), path = "board/pico_8khz.rs")]
#[cfg_attr(feature = "speedybee-f405", path = "board/speedybee_f405.rs")]
mod board;
#[cfg_attr(any(feature = "crazyflie", feature = "speedybee-f405"), path = "part/stm32f405.rs")]
#[cfg_attr(feature = "matek-h743", path = "part/stm32h743.rs")]
#[cfg_attr(feature = "nrf52840-dk", path = "part/nrf52840.rs")]
#[cfg_attr(any(feature = "pico", feature = "pico-8khz", feature = "pico2"), path = "part/rp.rs")]
mod part;

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_time::{Delay, Duration, Timer, with_timeout};
use flight::{Counters, Fault, Rounds, Sender, Watch};
use panic_probe as _;
use spikewire::{EventQueue, Overflow, link::Session};

/// How long events gather for a frame.
const GATHER: Duration = Duration::from_millis(5);
/// Some full frames at 921 600 baud; a frame that is not through by then is broken off, which is a gap to the far end.
const SEND_LIMIT: Duration = Duration::from_millis(20);
/// Longer than the sensor takes to start, with a pause to the next try.
const WATCHDOG: Duration = Duration::from_millis(500);

/// Events from the sampling task to main. While the port is behind, the oldest give way, and are counted.
static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropOldest);
/// Signs of life of the sampling task.
static ROUNDS: Rounds = Rounds::new();

defmt::timestamp!("{=u32:us}", part::now().micros());

/// What a board brings.
struct Board {
    imu: board::Imu,
    data_ready: board::DataReady,
    port: board::Port,
    /// Another at each start.
    session: Session,
}

/// The reason of the last reset.
#[derive(defmt::Format)]
enum Reset {
    Watchdog,
    Software,
    PowerOrPin,
}

#[embassy_executor::task]
async fn sample(imu: board::Imu, data_ready: board::DataReady) {
    let mut watch =
        Watch::new(imu, data_ready, Delay, part::now, board::ALIGNMENT, report, &ROUNDS);
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
    // Before the clocks: a crystal that does not start ends in a reset.
    let mut watchdog = part::Watchdog::start(WATCHDOG);
    let Board { imu, data_ready, mut port, session } = board::start();
    defmt::info!("reset by {}", watchdog.reset());
    spawner.spawn(sample(imu, data_ready).expect("spawned once"));

    let mut sender = Sender::new::<board::Imu>(session);
    let mut events = EVENTS.consumer().expect("taken once");
    let (mut seen, mut late) = (0, 0_u32);
    loop {
        Timer::after(GATHER).await;
        if with_timeout(SEND_LIMIT, sender.send(&mut events, &mut port)).await.is_err() {
            late = late.wrapping_add(1);
            defmt::warn!("the port was behind {} times", late);
        }
        // Main and the sampling task both feed the watchdog.
        if ROUNDS.went_on(&mut seen) {
            watchdog.feed();
        }
    }
}
