//! Adaptive step forward over a link that loses frames: what the receiver calls exact is what a decoder beside the
//! encoder holds, though samples without spikes change the step and no event tells of them.

use crate::common::flight_channels;
use proptest::prelude::*;
use spikewire::link::{Coding, MAX_FRAME, Reader, Receiver, Session, Transmitter};
use spikewire::temporal::AdaptiveStepForward;
use spikewire::{Bank, EventQueue, Overflow, Scheme, Tick};

const PERIOD: u16 = 1_000;
const CHANNELS: usize = 6;

static GYRO: AdaptiveStepForward<f32> = AdaptiveStepForward::new(0.11, 4);

/// How many values were exact, of how many.
fn fly(
    flight: &[Vec<f32>],
    is_lost: impl Fn(usize) -> bool,
    jitter: impl Fn(usize) -> u32,
) -> [usize; 2] {
    let events = EventQueue::<64>::new(Overflow::DropOldest);
    let mut consumer = events.consumer().unwrap();
    let mut bank = Bank::<_, CHANNELS>::new(&GYRO);
    let mut beside = [(); CHANNELS].map(|()| GYRO.decoder());
    let mut encoders = [(); CHANNELS].map(|()| GYRO.encoder());
    let mut link =
        Transmitter::new(Coding::for_channels(CHANNELS as u16, PERIOD), Session::counted(7));
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, CHANNELS>::new(&GYRO);
    let [mut exact, mut all, mut is_missing] = [0, 0, 0];
    let samples_at = |i: usize| -> [f32; CHANNELS] { std::array::from_fn(|n| flight[n][i]) };
    for i in 0..flight[0].len() {
        let tick = Tick::from(i as u32 * u32::from(PERIOD) + jitter(i));
        let samples = samples_at(i);
        bank.encode_into(tick, samples, &events);
        for channel in 0..CHANNELS {
            if i == 0 {
                beside[channel].resync(samples[channel]);
            }
            beside[channel].decode(encoders[channel].encode(samples[channel]));
        }
        if i % 50 == 0 {
            bank.keyframe_into(tick, &events);
        }
        let mut buffer = [0; MAX_FRAME];
        while let Some(mut bytes) = link.next_frame(&mut consumer, &mut buffer).unwrap() {
            if is_lost(i) {
                is_missing = 1;
                continue;
            }
            while let Some(received) = reader.next_frame(&mut bytes) {
                receiver.apply(&received, |_, _, _| ());
                is_missing = 0;
            }
        }
        if is_missing == 0 {
            receiver.advance(tick + u32::from(PERIOD), |_, _, _| ());
            for (channel, beside) in beside.iter().enumerate() {
                all += 1;
                if let Some(value) = receiver.exact(channel as u16) {
                    exact += 1;
                    assert_eq!(Some(value), beside.held(), "channel {channel} at {i}");
                }
            }
        }
    }
    assert_eq!(receiver.misfits() + receiver.outside(), 0);
    [exact, all]
}

#[test]
fn without_a_loss_all_is_exact() {
    for flight in flight_channels().chunks(CHANNELS) {
        let [exact, all] = fly(flight, |_| false, |_| 0);
        // A channel that is not at rest at the first keyframe waits for another.
        assert!(exact * 100 > all * 99, "{exact} of {all}");
        assert_eq!(fly(flight, |_| false, |i| (i as u32 * 7919) % 400), [exact, all]);
    }
}

proptest! {
    #![proptest_config(crate::common::cases(32))]

    #[test]
    fn what_is_called_exact_is_so_whatever_is_lost(seed: u64, part in 1..20_u64) {
        let flight = &flight_channels()[..CHANNELS];
        let drawn = |i: usize| (seed ^ i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        let [exact, all] = fly(flight, |i| drawn(i) % 100 < part, |i| (drawn(i) % 300) as u32);
        prop_assert!(exact * 10 > all, "{} of {}", exact, all);
    }
}
