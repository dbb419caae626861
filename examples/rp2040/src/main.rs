//! From the IMU's interrupt to link frames out of the UART, on an RP2040.
//!
//! ```text
//! BMI323 --INT1--> IO_IRQ_BANK0: SPI0, bank of step encoders --> queue --> main: frames --> UART0
//! ```
//!
//! A Cortex-M0+ has no floating-point unit: the encoders work in fixed point, in the sensor's units and without
//! rounding. Wiring and clocks: `examples/README.md`.

#![no_std]
#![no_main]

mod board;
mod imu;

use core::cell::RefCell;

use critical_section::Mutex;
use defmt_rtt as _;
use panic_probe as _;
use rp2040_hal::{gpio::Interrupt::EdgeHigh, pac, pac::interrupt};
use spikewire::{
    Bank, EventQueue, Overflow, Tick,
    link::{Coding, Transmitter},
    out::SerialSink,
};

const CHANNELS: usize = imu::SCHEMES.len();
/// Samples from one keyframe to the next: a second.
const KEYFRAME_EVERY: u16 = imu::SAMPLE_RATE;
/// How often the counters are logged, in µs.
const REPORT: u32 = 1_000_000;

/// What the interrupt has for main.
static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);
/// What the interrupt works with, once it is set up.
static SAMPLER: Mutex<RefCell<Option<Sampler>>> = Mutex::new(RefCell::new(None));

struct Sampler {
    data_ready: board::DataReady,
    imu: imu::Imu<board::ImuDevice>,
    clock: rp2040_hal::Timer,
    bank: Bank<imu::Schemes, CHANNELS>,
    samples_to_keyframe: u16,
    failed_reads: u32,
}

impl Sampler {
    /// Takes one sample: 20 µs on the bus, then six encoders.
    fn sample(&mut self) {
        let tick = Tick::from(self.clock.get_counter_low());
        self.data_ready.clear_interrupt(EdgeHigh);
        let Ok(sample) = imu::read(&mut self.imu) else {
            self.failed_reads += 1;
            return;
        };
        self.bank.encode_into(tick, sample, &EVENTS);

        self.samples_to_keyframe -= 1;
        if self.samples_to_keyframe == 0 {
            self.samples_to_keyframe = KEYFRAME_EVERY;
            self.bank.keyframe_into(tick, &EVENTS);
        }
    }
}

#[interrupt]
fn IO_IRQ_BANK0() {
    critical_section::with(|cs| {
        if let Some(sampler) = SAMPLER.borrow(cs).borrow_mut().as_mut() {
            sampler.sample();
        }
    });
}

#[rp2040_hal::entry]
fn main() -> ! {
    let board::Board { imu, data_ready, uart, mut clock, session } = board::start();
    let imu = imu::start(imu, &mut clock).expect("no BMI323 on SPI0");

    data_ready.set_interrupt_enabled(EdgeHigh, true);
    let sampler = Sampler {
        data_ready,
        imu,
        clock,
        bank: Bank::per_channel(imu::SCHEMES),
        samples_to_keyframe: KEYFRAME_EVERY,
        failed_reads: 0,
    };
    critical_section::with(|cs| SAMPLER.borrow(cs).replace(Some(sampler)));
    // SAFETY: main is in no critical section that this could break.
    unsafe { pac::NVIC::unmask(pac::Interrupt::IO_IRQ_BANK0) };

    // The sensor's clock is not ours: its samples come a few µs early or late.
    let coding = Coding::for_channels(CHANNELS as u16, imu::PERIOD_US).with_jitter_bits(4);
    let mut link = SerialSink::<_, _, 128>::new(uart, Transmitter::new(coding, session));
    let mut events = EVENTS.consumer().expect("taken once");
    let (mut bytes, mut last_report) = (0_u32, clock.get_counter_low());
    loop {
        match link.send(&mut events) {
            Ok(0) => cortex_m::asm::wfi(), // until the next sample
            Ok(count) => bytes = bytes.wrapping_add(count as u32),
            Err(_) => defmt::warn!("the UART failed; the frame is kept"),
        }

        if clock.get_counter_low().wrapping_sub(last_report) >= REPORT {
            last_report = last_report.wrapping_add(REPORT);
            let failed_reads = critical_section::with(|cs| {
                SAMPLER.borrow_ref(cs).as_ref().map_or(0, |sampler| sampler.failed_reads)
            });
            defmt::info!(
                "{} bytes sent; {} items lost, peak {}; {} reads failed",
                bytes,
                EVENTS.lost(),
                EVENTS.peak(),
                failed_reads,
            );
        }
    }
}
