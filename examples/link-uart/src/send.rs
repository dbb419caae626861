//! The board: the timer's interrupt samples and encodes, main sends.

use board::{digest::Digest, usart::Usart1};
use core::{cell::RefCell, fmt};
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use critical_section::Mutex;
use spikewire::{
    Bank, Decoder, EventQueue, Overflow, Scheme,
    link::{Coding, MAX_FRAME, Session, Transmitter},
    out::SerialSink,
    temporal::StepForward,
};

/// Gyroscope x, y, z, then accelerometer x, y, z.
pub const CHANNELS: usize = 6;
/// A spike for every 0.1 rad/s.
static RATE: StepForward<f32> = StepForward::new(0.1);
/// A spike for every 0.5 m/s².
static ACCELERATION: StepForward<f32> = StepForward::new(0.5);
const SCHEMES: Schemes = [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];
type Schemes = [&'static StepForward<f32>; CHANNELS];

/// Samples from one keyframe to the next: 50 ms of the recording, as the far end's silence counts on.
const KEYFRAME_EVERY: usize = 10;
/// The recording's, in µs; its ticks come up to 32 µs early or late.
const PERIOD: u32 = 5_000;
/// From one sample to the next: some 1000 a second at QEMU's 168 MHz.
const TIMER_RELOAD: u32 = 168_000;
/// The board starts once; one that may start again counts its starts.
const SESSION: Session = Session::counted(0);

static EVENTS: EventQueue<64> = EventQueue::new(Overflow::DropOldest);
static SAMPLER: Mutex<RefCell<Sampler>> = Mutex::new(RefCell::new(Sampler::new()));

struct Sampler {
    next: usize,
    is_done: bool,
    bank: Bank<Schemes, CHANNELS>,
    /// The board's own, beside the link; from the first sample on.
    decoders: Option<[Decoder<'static, StepForward<f32>>; CHANNELS]>,
    values: u32,
    decoded: Digest,
}

impl Sampler {
    const fn new() -> Self {
        Self {
            next: 0,
            is_done: false,
            bank: Bank::per_channel(SCHEMES),
            decoders: None,
            values: 0,
            decoded: Digest::new(),
        }
    }

    fn sample(&mut self) {
        let Some(record) = flight_data::record(flight_data::HEXAROTOR, self.next) else {
            self.is_done = true;
            return;
        };
        let (tick, sample) = (record.micros.into(), record.channels);
        let Self { bank, decoders, values, decoded, .. } = self;
        let decoders = decoders.get_or_insert_with(|| decoders_at(sample));
        bank.encode(tick, sample, |event| {
            let _ = EVENTS.push(event); // what does not fit is counted in the queue
            if let Some(decoder) = decoders.get_mut(usize::from(event.address)) {
                let value = decoder.decode(event.polarity.into());
                *values += 1;
                decoded.add([event.address.into(), event.tick.micros(), value.to_bits()]);
            }
        });
        if self.next.is_multiple_of(KEYFRAME_EVERY) {
            bank.keyframe_into(tick, &EVENTS);
        }
        self.next += 1;
    }
}

/// Decoders that hold the first sample, from which the encoders start.
fn decoders_at(first: [f32; CHANNELS]) -> [Decoder<'static, StepForward<f32>>; CHANNELS] {
    let mut decoders = SCHEMES.map(Scheme::decoder);
    for (decoder, first) in decoders.iter_mut().zip(first) {
        decoder.resync(first);
    }
    decoders
}

#[exception]
fn SysTick() {
    critical_section::with(|cs| SAMPLER.borrow_ref_mut(cs).sample());
}

pub fn run(out: &mut impl fmt::Write) -> fmt::Result {
    let mut events = EVENTS.consumer().ok_or(fmt::Error)?;
    let mut timer = cortex_m::Peripherals::take().ok_or(fmt::Error)?.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(TIMER_RELOAD - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();

    let coding = Coding::for_channels(CHANNELS as u16, PERIOD).with_jitter_bits(5);
    let transmitter = Transmitter::new(coding, SESSION);
    let mut link = SerialSink::<_, _, MAX_FRAME>::new(Usart1::new(), transmitter);
    let mut bytes = 0;
    loop {
        let is_done = critical_section::with(|cs| SAMPLER.borrow_ref(cs).is_done);
        match link.send(&mut events).map_err(|_| fmt::Error)? {
            0 if is_done => break,
            0 => cortex_m::asm::wfi(),
            count => bytes += count,
        }
    }

    critical_section::with(|cs| {
        let Sampler { values, decoded, .. } = &*SAMPLER.borrow_ref(cs);
        writeln!(out, "{values} values {decoded}")
    })?;
    writeln!(out, "{bytes} bytes, {} events lost, peak {}", EVENTS.lost(), EVENTS.peak())
}
