//! The code of the channels, on the recorded flight.

use flight::code::{Jumps, MOST, threshold};
use spikewire::{Scheme, temporal::SendOnDelta};

/// The table's code in °/s and g, which the sensors have in counts.
static RATES: SendOnDelta<f32, MOST> = SendOnDelta::new(6.0);
static ACCELERATIONS: SendOnDelta<f32, MOST> = SendOnDelta::new(0.1);

const RATE: u32 = 800;
const STANDARD_GRAVITY: f32 = 9.80665;

/// A channel of the flight in °/s or g, along straight lines between its samples.
fn flown(channel: usize) -> Vec<f32> {
    let unit = if channel < 3 { 180.0 / std::f32::consts::PI } else { 1.0 / STANDARD_GRAVITY };
    let rows: Vec<_> = flight_data::records(flight_data::HEXAROTOR).collect();
    let time = |row: usize| f64::from(rows[row].micros);
    let value = |row: usize| rows[row].channels[channel] * unit;
    let mut row = 0;
    (0..)
        .map(|sample| f64::from(sample) * 1e6 / f64::from(RATE))
        .take_while(|&now| now <= time(rows.len() - 1))
        .map(|now| {
            while time(row + 1) < now {
                row += 1;
            }
            let part = (now - time(row)) / (time(row + 1) - time(row));
            value(row) + part as f32 * (value(row + 1) - value(row))
        })
        .collect()
}

/// Spikes of each sample, the error, and after how many samples it was above the threshold.
struct Followed {
    spikes: Vec<u32>,
    rmse: f32,
    behind: usize,
}

fn follow<const K: usize>(scheme: &SendOnDelta<f32, K>, signal: &[f32]) -> Followed {
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    decoder.resync(signal[0]);
    let (mut spikes, mut squares, mut behind) = (Vec::new(), 0.0, 0);
    for &sample in signal {
        let steps = encoder.encode(sample);
        let error = (decoder.decode(steps) - sample).abs();
        spikes.push(u32::from(steps.count().unsigned_abs()));
        squares += error * error;
        behind += usize::from(error > scheme.threshold() * 1.001);
    }
    Followed { spikes, rmse: (squares / signal.len() as f32).sqrt(), behind }
}

#[test]
fn no_sample_of_the_flight_outruns_the_code() {
    let mut together = Vec::new();
    for channel in 0..6 {
        let scheme = if channel < 3 { &RATES } else { &ACCELERATIONS };
        let signal = flown(channel);
        let followed = follow(scheme, &signal);
        assert_eq!(followed.behind, 0, "channel {channel}");
        assert!(followed.rmse < scheme.threshold(), "channel {channel}: {}", followed.rmse);
        assert!(followed.spikes.iter().all(|&spikes| spikes < MOST as u32), "channel {channel}");
        together.resize(signal.len(), 0);
        together.iter_mut().zip(followed.spikes).for_each(|(all, spikes)| *all += spikes);
    }
    let most =
        |samples: usize| together.windows(samples).map(|some| some.iter().sum::<u32>()).max();
    // What main finds in the queue of 256 when it comes every 5 ms.
    assert!(most(4).is_some_and(|events| events < 256), "{:?}", most(4));
    let (mean, most) = (together.iter().sum::<u32>() * RATE / together.len() as u32, most(1));
    assert_eq!((mean, most), (713, Some(43)), "as the module's table has it");
}

#[test]
fn step_forward_would_be_outrun() {
    let one = |threshold| SendOnDelta::<f32, 1>::new(threshold);
    let behind =
        |channel| follow(&one(if channel < 3 { 6.0 } else { 0.05 }), &flown(channel)).behind;
    assert_eq!((0..6).map(behind).sum::<usize>(), 5294);
}

/// 1 g at 200 Hz, whose slope is 2π · 200 g/s, at any phase.
#[test]
fn vibration_of_one_g_at_200_hz_is_followed() {
    for phase in 0..16 {
        let wave = |sample: u32| {
            let turns = f64::from(sample) * 200.0 / f64::from(RATE) + f64::from(phase) / 16.0;
            (turns * std::f64::consts::TAU).sin() as f32
        };
        let signal: Vec<f32> = (0..RATE).map(wave).collect();
        assert_eq!(follow(&ACCELERATIONS, &signal).behind, 0, "{phase}");
    }
}

#[test]
fn thresholds_in_counts_are_the_nearest_to_those_of_the_table() {
    let counts = |scheme: Jumps| scheme.threshold();
    assert_eq!((counts(threshold(6.0, 2000.0)), counts(threshold(0.1, 16.0))), (98, 205));
    assert_eq!(counts(threshold(0.1, 24.0)), 137);
}
