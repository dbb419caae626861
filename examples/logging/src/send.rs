//! The board: what a flight controller would log, and more.

use core::fmt;
use defmt::{error, info, warn};
use defmt_semihosting as _;
use fixed::{FixedI32, types::extra::U16};
use spikewire::{
    Bank, Event, EventQueue, Overflow, Polarity, Scheme, Spike, Tick,
    link::{Coding, FrameView, Framer, Gap, Session},
    population::Gaussian,
    temporal::{StepForward, TemporalContrast},
};

type Fixed = FixedI32<U16>;

static EVENTS: EventQueue<2> = EventQueue::new(Overflow::Refuse);
static GYRO: StepForward<Fixed> = StepForward::new(Fixed::lit("0.25"));
static NEURONS: Gaussian<i16, 3> = Gaussian::linear(-100..=100);

pub fn run() -> fmt::Result {
    info!("scheme {}", GYRO);
    info!("in f32 {}", const { StepForward::<f32>::new(0.25) });
    let mut encoder = GYRO.encoder();
    encoder.encode(Fixed::ZERO);
    let spikes = [1, 0, -1].map(|sample| encoder.encode(Fixed::from_num(sample)));
    info!("spikes {}", spikes);
    info!("neuron {}", NEURONS.encoder().encode(90));
    let mut bank = Bank::<_, 3>::new(&GYRO);
    let [first, second] = [1_000, 2_000].map(Tick::from_micros);
    bank.encode(first, [Fixed::ZERO; 3], |_| ());
    bank.encode(second, [Fixed::ONE, Fixed::ZERO, -Fixed::ONE], |event| {
        info!("{}", event);
    });

    for tick in [1, 2, 3] {
        let event = Event { tick: Tick::from_micros(tick), address: 7, polarity: Polarity::Down };
        if let Err(refused) = EVENTS.push(event) {
            warn!("{}; {} waiting, {} refused", refused, EVENTS.len(), EVENTS.refused());
        }
    }
    if let Err(wrong) = StepForward::<f32>::try_new(-0.5) {
        error!("{}", wrong);
    }
    if let Err(wrong) = TemporalContrast::<i16>::try_new(0) {
        error!("{}", wrong);
    }

    let mut framer = Framer::new(Coding::for_channels(6, 1_000), Session::counted(1));
    let mut buffer = [0; 64];
    let frame = framer.start(second, &mut buffer).map_err(|_| fmt::Error)?.finish();
    for bytes in [&frame[..5], &frame[1..]] {
        if let Err(wrong) = FrameView::new(bytes) {
            error!("{}", wrong);
        }
    }
    warn!("{}, after {}", Gap { lost_frames: 3 }, Spike::None);
    Ok(())
}
