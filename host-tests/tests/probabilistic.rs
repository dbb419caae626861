//! GRF with probabilistic spiking: a neuron of level `k` of `N` fires if the top bits of a draw, a
//! number below `N`, are below `k`. One draw a neuron of level 1 or more, by rising index.

use std::convert::Infallible;

use crate::common::fields::Fields;
use crate::common::{between, drawn_recordings, flights, hostile_recordings, ranges};
use fixed::types::{I1F15, I8F8};
use host_tests::compare::{assert_same_values, decode, finite, run};
use host_tests::reference::probabilistic_from_levels;
use proptest::prelude::*;
use rand_core::{Rng, SeedableRng, TryRng};
use rand_pcg::Pcg32;
use spikewire::Scheme;
use spikewire::population::{FiredNeurons, Probabilistic};

/// A generator that says what it is told, over and over.
#[derive(Clone)]
struct Script<'a> {
    draws: &'a [u32],
    drawn: usize,
}

impl<'a> Script<'a> {
    fn new(draws: &'a [u32]) -> Self {
        Self { draws, drawn: 0 }
    }
}

impl TryRng for Script<'_> {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        let draw = self.draws[self.drawn % self.draws.len()];
        self.drawn += 1;
        Ok(draw)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        unreachable!("only single words are drawn")
    }

    fn try_fill_bytes(&mut self, _: &mut [u8]) -> Result<(), Infallible> {
        unreachable!("only single words are drawn")
    }
}

/// Encoder and decoder against the reference, both with the same generator.
fn check<S: Fields, G: Rng + Clone, const M: usize, const N: usize>(
    fields: (S, S, f32),
    generator: &G,
    x: &[S],
) {
    let (min, max, beta) = fields;
    let Ok(scheme) = Probabilistic::<S, G, M, N>::try_new(min..=max, beta) else {
        return; // too coarse for the type
    };
    let run = run(&scheme.encoder(generator.clone()), x);
    assert!(run.tail.is_empty());
    assert_eq!(run.rejected as usize, finite(x).rejected.len());

    let mut generator = generator.clone();
    let mut value = scheme.centres()[M / 2];
    let mut values = Vec::new();
    for (&x, neurons) in x.iter().zip(&run.outputs) {
        let mut fired = vec![false; M];
        if x.real().into().is_finite() {
            let levels = x.levels(min, max, M, beta, N as u16);
            fired = probabilistic_from_levels(&levels, N as u16, || generator.next_u32());
        }
        let ours: Vec<_> = (0..M as u16).map(|i| neurons.iter().any(|j| i == j)).collect();
        assert_eq!(ours, fired, "{x:?} in {min:?}..{max:?}");
        let levels: Vec<_> = fired.into_iter().map(u16::from).collect();
        value = S::weighted_mean(&levels, min, max, 2).unwrap_or(value);
        values.push(value.real());
    }
    let mut decoder = scheme.decoder();
    assert_same_values(&decode(&decoder, &run.outputs), &values);
    decoder.resync(max);
    assert_eq!(decoder.held(), Some(max));
    assert_eq!(decoder.decode(FiredNeurons::EMPTY), max);
    decoder.reset();
    assert_same_values(&decode(&decoder, &run.outputs), &values);
}

fn check_all<S: Fields>(min: S, max: S, beta: f32, seed: u64, x: &[S]) {
    let generator = Pcg32::seed_from_u64(seed);
    check::<S, _, 3, 2>((min, max, beta), &generator, x);
    check::<S, _, 4, 256>((min, max, beta), &generator, x);
    check::<S, _, 15, 16>((min, max, beta), &generator, x);
}

#[test]
fn cases_by_hand() {
    // Centres -0.5, 0.5, 1.5, 2.5, 3.5; the levels of 1.5 are 1, 16 * 0.325, 16: 0, 5, 16, 5, 0.
    let scheme = Probabilistic::<f32, _, 5, 16>::try_new(0.0..=3.0, 1.5).unwrap();
    let word = |top: u32| top << 28 | 0x0fff_ffff;
    let table: [(_, _, &[u32], &[u16], _); 5] = [
        ("below the level", 1.5, &[word(4), word(15), word(4)], &[1, 2, 3], 3),
        ("not below it", 1.5, &[word(5), word(0), word(5)], &[2], 3),
        ("by rising index", 1.5, &[word(0), word(0), word(15)], &[1, 2], 3),
        ("far outside nothing is drawn", 99.0, &[0], &[], 0),
        ("not a number draws nothing", f32::NAN, &[0], &[], 0),
    ];
    for (name, x, draws, expected, drawn) in table {
        let mut script = Script::new(draws);
        let neurons = scheme.encoder(&mut script).encode(x);
        assert!(neurons.iter().eq(expected.iter().copied()), "{name}: {neurons:?}");
        assert_eq!(script.drawn, drawn, "{name}");
    }
}

#[test]
fn the_decoder_gives_the_mean_of_the_centres() {
    let scheme = Probabilistic::<i16, _, 5, 16>::try_new(0..=300, 1.5).unwrap();
    // Centres -50, 50, 150, 250, 350.
    let mut script = Script::new(&[0]);
    let neurons = scheme.encoder(&mut script).encode(100);
    assert!(neurons.iter().eq([0, 1, 2, 3]));
    let mut decoder = scheme.decoder();
    assert_eq!(decoder.decode(FiredNeurons::EMPTY), 150);
    assert_eq!(decoder.decode(neurons), 100);
    assert_eq!(decoder.decode(FiredNeurons::EMPTY), 100);
}

/// `restart` forgets the count; the generator goes on.
#[test]
fn restart() {
    let scheme = Probabilistic::<f32, _, 5, 16>::try_new(0.0..=3.0, 1.5).unwrap();
    let mut script = Script::new(&[0]);
    let mut encoder = scheme.encoder(&mut script);
    encoder.encode(1.5);
    encoder.encode(f32::INFINITY);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (1, None));
    encoder.restart();
    assert_eq!(encoder.rejected(), 0);
    encoder.encode(1.5);
    assert_eq!(script.drawn, 6);
}

flights!(S: Fields, |x, unit| {
    let [min, max] = [-4.0, 4.0].map(|end| S::from_f64(end * unit));
    check_all(min, max, 1.5, 9, &x);
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        check_all(0.0_f32, 1.0, 1.5, 1, &x);
        check_all(-1e-40_f32, 1e-40, 1.5, 2, &x);
        check_all(-1e37_f32, 1e38, 0.7, 3, &x);
    }
}

drawn_recordings!(S: Fields, 64, (x in S::recordings(), [min, max] in ranges::<S>(), beta in between(0.3, 4.0), seed in any::<u64>()) => {
    check_all(min, max, beta, seed, &x);
});

/// All inputs, with a script that comes by every number a draw can be, and its neighbours.
#[test]
fn all_65536_inputs() {
    let script: Vec<_> =
        (0..16_u32).flat_map(|top| [top << 28, (top << 28) | 0x0fff_ffff]).collect();
    let script = Script::new(&script);
    let counts: Vec<_> = (i16::MIN..=i16::MAX).collect();
    check::<_, _, 5, 16>((-20_000_i16, 25_001, 1.5), &script, &counts);
    let bits: Vec<_> = counts.iter().copied().map(I8F8::from_bits).collect();
    let range = (I8F8::from_num(-9), I8F8::from_num(9.1), 1.5);
    check::<_, _, 4, 16>(range, &script, &bits);
    let bits: Vec<_> = counts.iter().copied().map(I1F15::from_bits).collect();
    let range = (I1F15::from_num(-0.5), I1F15::from_num(0.7), 2.5);
    check::<_, _, 3, 2>(range, &script, &bits);
}
