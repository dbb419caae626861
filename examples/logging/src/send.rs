//! The board: what a flight controller would log, and more.

use core::fmt;
use defmt::{error, info, warn};
use defmt_semihosting as _;
use fixed::{FixedI32, types::extra::U16};
use spikewire::{
    Bank, Encoder, Event, Polarity, Scheme, Spike,
    link::{Coding, FrameView, Framer, Gap},
    population::{Centres, Gaussian},
    sink::{EventQueue, Overflow},
    temporal::{StepForward, TemporalContrast},
};

type Fixed = FixedI32<U16>;

static EVENTS: EventQueue<2> = EventQueue::new(Overflow::Refuse);
static CENTRES: Centres<i16, 3> = Centres::<i16, _>::linear(-100, 100);

pub fn run() -> fmt::Result {
    let gyro = StepForward::<Fixed>::checked(Fixed::lit("0.25"));
    info!("scheme {}", gyro);
    info!("in f32 {}", StepForward::<f32>::checked(0.25));
    let mut encoder = gyro.encoder();
    encoder.encode(Fixed::ZERO);
    let spikes = [1, 0, -1].map(|sample| encoder.encode(Fixed::from_num(sample)));
    info!("spikes {}", spikes);
    info!("neuron {}", Gaussian::new(&CENTRES).encoder().encode(90));
    let mut bank = Bank::<_, 3>::new(gyro);
    bank.encode(1_000, [Fixed::ZERO; 3], |_| ());
    bank.encode(2_000, [Fixed::ONE, Fixed::ZERO, -Fixed::ONE], |event| {
        info!("{}", event);
    });

    for tick in 1..=3 {
        let event = Event { tick, address: 7, polarity: Polarity::Down };
        if let Err(refused) = EVENTS.push(event) {
            warn!("{}; {} waiting, {} refused", refused, EVENTS.len(), EVENTS.refused());
        }
    }
    if let Err(wrong) = StepForward::<f32>::new(-0.5) {
        error!("{}", wrong);
    }
    if let Err(wrong) = TemporalContrast::<i16>::new(0) {
        error!("{}", wrong);
    }

    let mut framer = Framer::new(Coding::for_channels(6, 1_000));
    let mut buffer = [0; 64];
    let frame = framer.start(2_000, &mut buffer).map_err(|_| fmt::Error)?.finish();
    for bytes in [&frame[..5], &frame[1..]] {
        if let Err(wrong) = FrameView::new(bytes) {
            error!("{}", wrong);
        }
    }
    warn!("{}, after {}", Gap { lost_frames: 3 }, Spike::None);
    Ok(())
}
