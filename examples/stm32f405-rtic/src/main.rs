//! From the IMU's interrupt to tinyODIN, on an STM32F405 with RTIC.
//!
//! ```text
//! BMI323 --INT1--> EXTI3: SPI1, bank of encoders --> queue --> idle: AER port --> tinyODIN
//! ```
//!
//! Wiring and clocks: `examples/README.md`.

#![no_std]
#![no_main]

mod network;
mod port;
mod time;

use defmt_rtt as _;
use panic_probe as _;
use spikewire::{EventQueue, Overflow};

/// What the interrupt has for idle. A chip that falls behind is better fed with what is new.
static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use bmi323_driver::{Bmi323, SpiTransport};
    use core::num::NonZeroU32;
    use embedded_hal::spi::MODE_0;
    use flight::{
        Counters, Device, Sampler, Timing,
        bmi323::{self, in_units},
        clock::{Stm32F405, exact_spi},
        code::{MOST, SCHEMES, Schemes},
    };
    use spikewire::{
        Bank, Tick,
        chip::{Describe as _, Input as _, TinyOdin, TinyOdinInput},
    };
    use stm32f4xx_hal::{
        gpio::{Edge, Input, Output, PA3, PA4, PB12, Speed},
        pac::{SPI1, SPI2},
        prelude::*,
        rcc::Config,
        spi::Spi,
        timer::MonoTimerExt,
        watchdog::IndependentWatchdog,
    };

    use crate::{
        EVENTS,
        network::{self, NETWORK},
        port::Port,
        time::{Spin, now},
    };

    type ImuDevice = Device<Spi<SPI1>, PA4<Output>, Spin>;
    type ChipDevice = Device<Spi<SPI2>, PB12<Output>, Spin>;

    /// The crystal of most flight controllers. Another one is another constant here, and one that the part cannot take
    /// fails the build.
    const CLOCK: Stm32F405 = Stm32F405::at_168_mhz(8_000_000);
    /// SPI1's 84 MHz by 16. Of the powers of two the HAL takes the nearest, which for the sensor's limit
    /// of 10 MHz is 10.5.
    const IMU_HZ: u32 = exact_spi(84_000_000, 5_250_000);
    /// SPI2's 42 MHz by 64: SCK may have a quarter of the chip's clock.
    const CHIP_HZ: u32 = exact_spi(42_000_000, 656_250);
    const IMU_TIMING: Timing = bmi323::TIMING.at(IMU_HZ);
    /// The chip has no chip select: its time is what parts two transfers.
    const CHIP_TIMING: Timing = Timing { guard: 800, pause: 800 }.at(CHIP_HZ);
    /// How often a wait looks at the chip's pins: as often as the chip may have clocks to work, and a look
    /// takes longer than a clock from 10 MHz on. Well below a millisecond.
    const POLLS: u32 = TinyOdinInput::MAX_CLOCKS;
    /// The time step of the chip's neurons, in µs: so often they leak.
    const TIME_STEP: NonZeroU32 = NonZeroU32::new(1_000).unwrap();
    /// How often the counters are logged, in µs.
    const REPORT: i32 = 1_000_000;
    /// How long to wait, in µs, before a sensor or a chip that did not start is tried again.
    const AGAIN: i32 = 100_000;
    /// A start of sensor and chip take a few ms each, and idle is else never away for so long.
    const WATCHDOG_MS: u32 = 500;

    /// The sensor, and who judges its samples.
    pub struct Sensor {
        imu: Bmi323<SpiTransport<ImuDevice>>,
        sampler: Sampler<Schemes, { SCHEMES.len() }>,
    }

    #[shared]
    struct Shared {
        sensor: Sensor,
    }

    #[local]
    struct Local {
        data_ready: PA3<Input>,
        chip: TinyOdin<ChipDevice, Port>,
        watchdog: IndependentWatchdog,
    }

    #[init]
    fn init(mut cx: init::Context) -> (Shared, Local) {
        // First of all: a crystal that does not start, or a fault, then ends in a reset, and the log says so.
        let mut watchdog = IndependentWatchdog::new(cx.device.IWDG);
        watchdog.stop_on_debug(&cx.device.DBGMCU, true);
        watchdog.start(WATCHDOG_MS.millis());
        let reset = cx.device.RCC.csr().read();
        cx.device.RCC.csr().modify(|_, w| w.rmvf().set_bit());

        // Pins next, so that outputs are safe whatever the clocks do. The HAL leaves them at low speed, where SPI loses the
        // last bit of a byte (STM32F405's errata, "corrupted last bit of data and/or CRC").
        let mut rcc = cx.device.RCC.constrain();
        let a = cx.device.GPIOA.split(&mut rcc);
        let b = cx.device.GPIOB.split(&mut rcc);
        let c = cx.device.GPIOC.split(&mut rcc);
        let port = Port {
            input: [
                c.pc0.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc1.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc2.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc3.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc4.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc5.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc6.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc7.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc8.into_push_pull_output().speed(Speed::High).erase_number(),
                c.pc9.into_push_pull_output().speed(Speed::High).erase_number(),
            ]
            .outport(),
            input_request: c.pc10.into_push_pull_output(),
            input_acknowledge: c.pc11.into_pull_down_input(),
            output: [
                b.pb0.into_pull_down_input().erase_number(),
                b.pb1.into_pull_down_input().erase_number(),
                b.pb2.into_pull_down_input().erase_number(),
                b.pb3.into_pull_down_input().erase_number(),
                b.pb4.into_pull_down_input().erase_number(),
                b.pb5.into_pull_down_input().erase_number(),
                b.pb6.into_pull_down_input().erase_number(),
                b.pb7.into_pull_down_input().erase_number(),
            ],
            output_request: b.pb8.into_pull_down_input(),
            output_acknowledge: b.pb9.into_push_pull_output(),
            reset: c.pc12.into_push_pull_output(),
        };
        let imu_pins = (
            a.pa5.into_alternate().speed(Speed::VeryHigh),
            a.pa6.into_alternate(),
            a.pa7.into_alternate().speed(Speed::VeryHigh),
        );
        let chip_pins = (
            b.pb13.into_alternate().speed(Speed::VeryHigh),
            b.pb14.into_alternate(),
            b.pb15.into_alternate().speed(Speed::VeryHigh),
        );
        let imu_select = a.pa4.into_push_pull_output().speed(Speed::VeryHigh);
        let chip_select = b.pb12.into_push_pull_output();

        let clocks = Config::hse(CLOCK.crystal.Hz()).sysclk(CLOCK.sysclk().Hz());
        let mut rcc = rcc.freeze(clocks);
        cx.device.TIM5.monotonic_us(&mut cx.core.NVIC, &mut rcc);
        defmt::info!(
            "reset by: watchdog {}, software {}, power {}, brown-out {}, pin {}",
            reset.wdgrstf().bit(),
            reset.sftrstf().bit(),
            reset.porrstf().bit(),
            reset.borrstf().bit(),
            reset.padrstf().bit(),
        );

        let (sck, miso, mosi) = imu_pins;
        let pins = (Some(sck), Some(miso), Some(mosi));
        let bus = Spi::new(cx.device.SPI1, pins, MODE_0, IMU_HZ.Hz(), &mut rcc);
        let Ok(device) = Device::new(bus, imu_select, Spin, IMU_TIMING);
        let sampler = Sampler::new(Bank::per_channel(SCHEMES), bmi323::plan(MOST as u8));
        let sensor = Sensor { imu: Bmi323::new_spi(device), sampler };

        // tinyODIN knows no chip select: PB12 stays unconnected, the bus is the chip's alone.
        let (sck, miso, mosi) = chip_pins;
        let pins = (Some(sck), Some(miso), Some(mosi));
        let bus = Spi::new(cx.device.SPI2, pins, MODE_0, CHIP_HZ.Hz(), &mut rcc);
        let Ok(device) = Device::new(bus, chip_select, Spin, CHIP_TIMING);
        let chip = TinyOdin::new(device, port, POLLS).with_time_step(TIME_STEP);

        let mut data_ready = a.pa3.into_pull_down_input();
        data_ready.make_interrupt_source(&mut cx.device.SYSCFG.constrain(&mut rcc));
        data_ready.trigger_on_edge(&mut cx.device.EXTI, Edge::Rising);
        data_ready.enable_interrupt(&mut cx.device.EXTI);

        (Shared { sensor }, Local { data_ready, chip, watchdog })
    }

    /// A sample is ready: 24 µs on the bus, then six encoders. Never waits for the chip.
    #[task(binds = EXTI3, priority = 2, local = [data_ready], shared = [sensor])]
    fn sample(mut cx: sample::Context) {
        let edge = now();
        cx.local.data_ready.clear_interrupt_pending_bit();
        cx.shared.sensor.lock(|Sensor { imu, sampler }| {
            sampler.take(edge, bmi323::read(imu).map(in_units), &EVENTS);
        });
    }

    /// Looks after the sensor, feeds the chip, serves its outputs, and logs what was lost on the way.
    #[idle(local = [chip, watchdog], shared = [sensor])]
    fn idle(mut cx: idle::Context) -> ! {
        let (chip, watchdog) = (cx.local.chip, cx.local.watchdog);
        let (mut sent, mut fired, mut failures) = (0_u32, [0_u32; network::NEURONS], 0_u32);
        let mut is_set_up = false;
        let (mut next_sensor, mut next_chip, mut next_report) = (now(), now(), now());
        let mut before = Counters::default();
        let mut events = EVENTS.consumer().expect("taken once");

        loop {
            watchdog.feed();
            // While it is dead no events come: the chip's neurons leak, and fall silent.
            let is_alive = cx.shared.sensor.lock(|sensor| look_after(sensor, &mut next_sensor));

            if !is_set_up && is_over(next_chip) {
                match network::start(chip, &mut Spin) {
                    Ok(()) => is_set_up = true,
                    Err(error) => {
                        failures = failures.wrapping_add(1);
                        next_chip = now().shifted(AGAIN);
                        defmt::error!("tinyODIN: {}; once more", defmt::Debug2Format(&error));
                    }
                }
            }
            if is_set_up {
                let fed = chip.running().and_then(|mut chip| {
                    let mut on_output = NETWORK.answers(now(), |output| {
                        // What acts on the network's answers acts on these alone: none is of a dead sensor.
                        if let (true, Some(count)) =
                            (is_alive, fired.get_mut(usize::from(output.address)))
                        {
                            *count += 1;
                        }
                    });
                    let count = chip.feed(events.waiting(), network::input, &mut on_output)?;
                    chip.advance(now(), &mut on_output)?;
                    chip.poll(&mut on_output).map(|()| count)
                });
                match fed {
                    Ok(count) => sent = sent.wrapping_add(count),
                    Err(error) => {
                        // The event that it did not take is held and comes first.
                        failures = failures.wrapping_add(1);
                        is_set_up = false;
                        defmt::warn!("tinyODIN: {}; once more", defmt::Debug2Format(&error));
                    }
                }
            }

            if is_over(next_report) {
                next_report = next_report.shifted(REPORT);
                let counters = cx.shared.sensor.lock(|sensor| sensor.sampler.counters());
                let second = counters.since(&before);
                before = counters;
                defmt::info!(
                    "{}; {} events sent, {} lost, peak {}; {} failures of the chip; {}; fired {}",
                    second,
                    sent,
                    EVENTS.lost(),
                    EVENTS.peak(),
                    failures,
                    chip.counters(),
                    fired,
                );
            }
        }
    }

    /// Starts the sensor, where it has to be. Whether it lives.
    fn look_after(Sensor { imu, sampler }: &mut Sensor, next: &mut Tick) -> bool {
        let Some(why) = sampler.look(now(), &EVENTS) else { return true };
        if is_over(*next) {
            defmt::warn!("the sensor is to be started: {}", why);
            match bmi323::start(imu, &mut Spin) {
                Ok(()) => sampler.started(now()),
                Err(error) => {
                    defmt::error!("it does not start: {}", defmt::Debug2Format(&error));
                    sampler.failed_to_start(now(), &EVENTS);
                    *next = now().shifted(AGAIN);
                }
            }
        }
        false
    }

    fn is_over(time: Tick) -> bool {
        now().since(time) >= 0
    }
}
