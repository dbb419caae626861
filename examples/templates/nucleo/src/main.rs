//! A whole firmware without the crates of this repository but `spikewire`: an MPU6050 at 1 kHz on a Nucleo-F429ZI, with
//! stm32f4xx-hal. The timer's interrupt reads the sensor and encodes; main sends.

#![no_std]
#![no_main]

use core::cell::RefCell;
use cortex_m_rt::entry;
use critical_section::Mutex;
use panic_halt as _;
use rand_core::RngCore;
use spikewire::link::{MAX_FRAME, Session, Transmitter};
use spikewire::out::{Io06, SerialSink};
use spikewire::{Bank, EventQueue, Overflow, Tick, temporal::SendOnDelta};
use stm32f4xx_hal::{
    i2c::{DutyCycle, I2c, Mode},
    interrupt,
    pac::{self, I2C1, TIM2},
    prelude::*,
    rcc::Config,
    serial,
    timer::{CounterHz, Event, Flag},
};

type Code = SendOnDelta<i16, 16>; // up to 16 spikes a sample
/// One for each 6 °/s or 0.1 g: at ±2000 °/s and ±16 g the MPU6050 counts 16.4 and 2048.
static RATE: Code = Code::new(98);
static FORCE: Code = Code::new(205);
const SCHEMES: [&Code; 6] = [&FORCE, &FORCE, &FORCE, &RATE, &RATE, &RATE];

static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropOldest);
/// Setup that main made, until the interrupt takes it.
static SAMPLER: Mutex<RefCell<Option<Sampler>>> = Mutex::new(RefCell::new(None));

const MPU6050: u8 = 0x68;

struct Sampler {
    sensor: I2c<I2C1>,
    timer: CounterHz<TIM2>,
    bank: Bank<[&'static Code; 6], 6>,
    samples: u64,
}

impl Sampler {
    /// One sample of six channels. If the sensor does not answer, the far end is told that its values are old.
    fn sample(&mut self) {
        self.timer.clear_flags(Flag::Update);
        self.samples += 1;
        let now = Tick::from_micros(1_000 * self.samples);
        let mut bytes = [0; 14]; // from ACCEL_XOUT_H: acceleration, temperature, turn rate
        if self.sensor.write_read(MPU6050, &[0x3B], &mut bytes).is_err() {
            return self.bank.reset_into(now, &EVENTS);
        }
        let count = |at: usize| i16::from_be_bytes([bytes[at], bytes[at + 1]]);
        self.bank.encode_into(now, [0, 2, 4, 8, 10, 12].map(count), &EVENTS);
        if self.samples % 50 == 0 {
            self.bank.keyframe_into(now, &EVENTS); // 20 a second
        }
    }
}

#[interrupt]
fn TIM2() {
    // Taken once, so that the bus moves its bytes outside critical sections.
    static mut OWN: Option<Sampler> = None;
    if OWN.is_none() {
        *OWN = critical_section::with(|cs| SAMPLER.take(cs));
    }
    if let Some(sampler) = OWN {
        sampler.sample();
    }
}

#[entry]
fn main() -> ! {
    let part = pac::Peripherals::take().unwrap();
    let mut clocks = part.RCC.freeze(Config::hsi().sysclk(168.MHz()).require_pll48clk());
    let (gpio_b, gpio_d) = (part.GPIOB.split(&mut clocks), part.GPIOD.split(&mut clocks));

    let pins = (gpio_b.pb8, gpio_b.pb9);
    // Fast mode, two thirds of a period low: 1.67 µs, where the sensor asks for 1.3.
    let fast = Mode::fast(400.kHz(), DutyCycle::Ratio2to1);
    let mut sensor = I2c::new(part.I2C1, pins, fast, &mut clocks);
    // Awake, 1 kHz, ±2000 °/s, ±16 g.
    for setting in [[0x6B, 0x01], [0x1A, 0x01], [0x19, 0x00], [0x1B, 0x18], [0x1C, 0x18]] {
        sensor.write(MPU6050, &setting).unwrap();
    }

    let mut random = part.RNG.constrain(&mut clocks); // a session differs at each start
    let session = Session::random(random.next_u64());
    let bank = Bank::per_channel(SCHEMES);
    let link = Transmitter::for_bank(&bank, 1_000, session); // a sample every 1000 µs
    // The serial port that the ST-LINK shows as USB.
    let settings = serial::Config::default().baudrate(921_600.bps());
    let port = part.USART3.tx(gpio_d.pd8, settings, &mut clocks).unwrap();
    let mut link = SerialSink::<_, _, MAX_FRAME>::new(Io06(port), link);

    let mut timer = part.TIM2.counter_hz(&mut clocks);
    timer.start(1.kHz()).unwrap();
    timer.listen(Event::Update);
    let sampler = Sampler { sensor, timer, bank, samples: 0 };
    critical_section::with(|cs| SAMPLER.replace(cs, Some(sampler)));
    // SAFETY: main is in no critical section.
    unsafe { cortex_m::peripheral::NVIC::unmask(pac::Interrupt::TIM2) };

    let mut events = EVENTS.consumer().unwrap();
    loop {
        // Takes all that waits, and sends it as frames.
        link.send(&mut events).unwrap();
        cortex_m::asm::wfi();
    }
}
