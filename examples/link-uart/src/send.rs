//! The board: the timer's interrupt samples and encodes, main sends.

use crate::{digest::Digest, flight, uart::Uart};
use core::{
    cell::{Cell, RefCell},
    fmt,
};
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use critical_section::Mutex;
use spikewire::{
    Bank, Decoder, Scheme,
    link::{Coding, MAX_FRAME, Snapshot, Transmitter},
    sink::{EventQueue, Overflow, SerialSink},
    temporal::{StepDecoder, StepForward, StepForwardEncoder},
};

/// Gyroscope x, y, z, then accelerometer x, y, z.
pub const CHANNELS: usize = 6;
/// A spike for every 0.1 rad/s.
const RATE: StepForward<f32> = StepForward::<f32>::checked(0.1);
/// A spike for every 0.5 m/s².
const ACCELERATION: StepForward<f32> = StepForward::<f32>::checked(0.5);
const SCHEMES: [StepForward<f32>; CHANNELS] =
    [RATE, RATE, RATE, ACCELERATION, ACCELERATION, ACCELERATION];

/// Samples from one keyframe to the next: a second of the recording.
const KEYFRAME_EVERY: usize = 200;
/// The recording's, in µs; its ticks come up to 32 µs early or late.
const PERIOD: u16 = 5_000;
/// From one sample to the next: some 1000 a second at QEMU's 168 MHz.
const TIMER_RELOAD: u32 = 168_000;

static EVENTS: EventQueue<64> = EventQueue::new(Overflow::DropOldest);
static KEYFRAME: Mutex<Cell<Option<Snapshot<f32, CHANNELS>>>> = Mutex::new(Cell::new(None));
static SAMPLER: Mutex<RefCell<Option<Sampler>>> = Mutex::new(RefCell::new(None));

struct Sampler {
    next: usize,
    is_done: bool,
    bank: Bank<StepForwardEncoder<f32>, CHANNELS>,
    /// The board's own, beside the link.
    decoders: [StepDecoder<f32>; CHANNELS],
    decoded: Digest,
}

impl Sampler {
    fn sample(&mut self) {
        let Some((tick, sample)) = flight::sample(self.next) else {
            self.is_done = true;
            return;
        };
        let Self { bank, decoders, decoded, .. } = self;
        bank.encode(tick, sample, |event| {
            let _ = EVENTS.push(event); // what does not fit is counted in the queue
            if let Some(decoder) = decoders.get_mut(usize::from(event.address)) {
                let value = decoder.decode(event.polarity.into());
                decoded.add(event.address, event.tick, value);
            }
        });
        if self.next == 0 {
            // The baselines are the first sample.
            for (decoder, first) in decoders.iter_mut().zip(sample) {
                decoder.resync(first);
            }
        }
        if self.next.is_multiple_of(KEYFRAME_EVERY) {
            let snapshot = bank.snapshot(tick, EVENTS.mark());
            critical_section::with(|cs| KEYFRAME.borrow(cs).set(Some(snapshot)));
        }
        self.next += 1;
    }
}

#[exception]
fn SysTick() {
    critical_section::with(|cs| {
        if let Some(sampler) = SAMPLER.borrow_ref_mut(cs).as_mut() {
            sampler.sample();
        }
    });
}

pub fn run(out: &mut impl fmt::Write) -> fmt::Result {
    let sampler = Sampler {
        next: 0,
        is_done: false,
        bank: Bank::from_schemes(SCHEMES),
        decoders: SCHEMES.map(Scheme::decoder),
        decoded: Digest::new(),
    };
    critical_section::with(|cs| SAMPLER.replace(cs, Some(sampler)));
    let mut timer = cortex_m::Peripherals::take().ok_or(fmt::Error)?.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(TIMER_RELOAD - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();

    let coding = Coding::for_channels(CHANNELS as u16, PERIOD).with_jitter_bits(5);
    let transmitter = Transmitter::<f32, CHANNELS>::new(coding);
    let mut link = SerialSink::<_, _, MAX_FRAME>::new(Uart::new(), transmitter);
    let mut bytes = 0;
    loop {
        let is_done = critical_section::with(|cs| {
            SAMPLER.borrow_ref(cs).as_ref().is_none_or(|sampler| sampler.is_done)
        });
        if let Some(snapshot) = critical_section::with(|cs| KEYFRAME.borrow(cs).take()) {
            link.batch().keyframe(snapshot);
        }
        match link.send(&EVENTS).map_err(|_| fmt::Error)? {
            0 if is_done => break,
            0 => cortex_m::asm::wfi(),
            count => bytes += count,
        }
    }

    let sampler = critical_section::with(|cs| SAMPLER.take(cs)).ok_or(fmt::Error)?;
    writeln!(out, "{}", sampler.decoded)?;
    writeln!(out, "{bytes} bytes, {} events lost, peak {}", EVENTS.lost(), EVENTS.peak())
}
