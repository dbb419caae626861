//! From the IMU's interrupt to tinyODIN, on an STM32F405 with RTIC.
//!
//! ```text
//! BMI323 --INT1--> EXTI3: SPI1, bank of step encoders --> queue --> idle: AER port --> tinyODIN
//! ```
//!
//! Wiring and clocks: `examples/README.md`.

#![no_std]
#![no_main]

mod imu;
mod network;
mod port;

use core::sync::atomic::AtomicU32;
use defmt_rtt as _;
use panic_probe as _;
use rtic_time::Monotonic;
use spikewire::{EventQueue, Overflow, Tick};
use stm32f4xx_hal::{pac, timer::MonoTimerUs};

/// What the interrupt has for idle. A chip that falls behind is better fed with what is new.
static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);

/// Samples that the sensor did not give.
static FAILED_READS: AtomicU32 = AtomicU32::new(0);

/// Microseconds since the start.
type Clock = MonoTimerUs<pac::TIM5>;

fn now() -> Tick {
    Tick::from_micros(Clock::now().duration_since_epoch().to_micros())
}

defmt::timestamp!("{=u32:us}", now().micros());

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use core::{num::NonZeroU32, sync::atomic::Ordering::Relaxed};
    use embedded_hal::{delay::DelayNs, spi::MODE_0};
    use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};
    use spikewire::{
        Bank,
        chip::{Describe as _, Input as _, TinyOdin, TinyOdinInput},
    };
    use stm32f4xx_hal::{
        gpio::{Edge, Input, Output, PA3, PA4, PB12, Speed},
        pac::{SPI1, SPI2},
        prelude::*,
        rcc::Config,
        spi::Spi,
        time::Hertz,
        timer::{MonoTimerExt, SysDelay},
    };

    use crate::{
        EVENTS, FAILED_READS,
        imu::{self, Imu},
        network::{self, NETWORK},
        now,
        port::Port,
    };

    // Neither asks for pauses within a transaction.
    type ImuDevice = ExclusiveDevice<Spi<SPI1>, PA4<Output>, NoDelay>;
    type ChipDevice = ExclusiveDevice<Spi<SPI2>, PB12<Output>, NoDelay>;

    /// SPI1's 84 MHz by 16. Of the powers of two the HAL takes the nearest, which for the sensor's limit
    /// of 10 MHz is 10.5.
    const IMU_CLOCK: Hertz = Hertz::kHz(5_250);
    /// SPI2's 42 MHz by 64: SCK may have a quarter of the chip's clock.
    const CHIP_CLOCK: Hertz = Hertz::Hz(656_250);
    /// How often a wait looks at the chip's pins: as often as the chip may have clocks to work, and a look
    /// takes longer than a clock from 10 MHz on. Well below a millisecond.
    const POLLS: u32 = TinyOdinInput::MAX_CLOCKS;
    /// The time step of the chip's neurons, in µs: so often they leak.
    const TIME_STEP: NonZeroU32 = NonZeroU32::new(1_000).unwrap();
    /// How often the counters are logged, in µs.
    const REPORT: i32 = 1_000_000;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        data_ready: PA3<Input>,
        imu: Imu<ImuDevice>,
        bank: Bank<imu::Schemes, { imu::SCHEMES.len() }>,
        chip: TinyOdin<ChipDevice, Port>,
        delay: SysDelay,
    }

    #[init]
    fn init(mut cx: init::Context) -> (Shared, Local) {
        // The crystal of most flight controllers; 168 MHz is the part's limit.
        let clocks = Config::hse(8.MHz()).sysclk(168.MHz());
        let mut rcc = cx.device.RCC.freeze(clocks);
        let mut delay = cx.core.SYST.delay(&rcc.clocks);
        cx.device.TIM5.monotonic_us(&mut cx.core.NVIC, &mut rcc);

        let a = cx.device.GPIOA.split(&mut rcc);
        let b = cx.device.GPIOB.split(&mut rcc);
        let c = cx.device.GPIOC.split(&mut rcc);

        let pins = (Some(a.pa5), Some(a.pa6), Some(a.pa7));
        let bus = Spi::new(cx.device.SPI1, pins, MODE_0, IMU_CLOCK, &mut rcc);
        let device = ExclusiveDevice::new_no_delay(bus, a.pa4.into_push_pull_output()).unwrap();
        let imu = imu::start(device, &mut delay).expect("no BMI323 on SPI1");

        // tinyODIN knows no chip select: PB12 stays unconnected, the bus is the chip's alone.
        let pins = (Some(b.pb13), Some(b.pb14), Some(b.pb15));
        let bus = Spi::new(cx.device.SPI2, pins, MODE_0, CHIP_CLOCK, &mut rcc);
        let device = ExclusiveDevice::new_no_delay(bus, b.pb12.into_push_pull_output()).unwrap();
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
        let chip = TinyOdin::new(device, port, POLLS).with_time_step(TIME_STEP);

        let mut data_ready = a.pa3.into_pull_down_input();
        data_ready.make_interrupt_source(&mut cx.device.SYSCFG.constrain(&mut rcc));
        data_ready.trigger_on_edge(&mut cx.device.EXTI, Edge::Rising);
        data_ready.enable_interrupt(&mut cx.device.EXTI);

        let bank = Bank::per_channel(imu::SCHEMES);
        (Shared {}, Local { data_ready, imu, bank, chip, delay })
    }

    /// A sample is ready: 22 µs on the bus, then six encoders. Never waits for the chip.
    #[task(binds = EXTI3, priority = 2, local = [data_ready, imu, bank])]
    fn sample(cx: sample::Context) {
        let tick = now();
        cx.local.data_ready.clear_interrupt_pending_bit();
        match imu::read(cx.local.imu) {
            Ok(sample) => cx.local.bank.encode_into(tick, sample, &EVENTS),
            Err(_) => _ = FAILED_READS.fetch_add(1, Relaxed),
        }
    }

    /// Feeds the chip, serves its outputs, and logs what was lost on the way.
    #[idle(local = [chip, delay])]
    fn idle(cx: idle::Context) -> ! {
        let (chip, delay) = (cx.local.chip, cx.local.delay);
        let (mut sent, mut fired, mut failures) = (0_u32, [0_u32; network::NEURONS], 0_u32);
        let mut last_report = now();
        let mut events = EVENTS.consumer().expect("taken once");

        while let Err(error) = network::start(chip, delay) {
            defmt::error!("tinyODIN is not set up: {}", defmt::Debug2Format(&error));
            delay.delay_ms(500);
        }
        loop {
            let fed = chip.running().and_then(|mut chip| {
                let mut on_output = NETWORK.answers(now(), |output| {
                    if let Some(count) = fired.get_mut(usize::from(output.address)) {
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
                    failures = failures.wrapping_add(1);
                    defmt::warn!("tinyODIN: {}; starting it again", defmt::Debug2Format(&error));
                    // The event that it did not take is held and comes first.
                    if network::start(chip, delay).is_err() {
                        delay.delay_ms(10);
                    }
                }
            }

            if now().since(last_report) >= REPORT {
                last_report = last_report.shifted(REPORT);
                defmt::info!(
                    "{} events sent, {} lost, peak {}; {} reads and {} handshakes failed; {}; fired {}",
                    sent,
                    EVENTS.lost(),
                    EVENTS.peak(),
                    FAILED_READS.load(Relaxed),
                    failures,
                    chip.counters(),
                    fired,
                );
            }
        }
    }
}
