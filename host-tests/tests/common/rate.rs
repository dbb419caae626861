//! What the tests of the rate schemes share: taps, and signals that make them spike.

use super::Drawn;
use host_tests::compare::{Wire, signs_of};
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::rate::Taps;
use spikewire::{Output, Spike, Start};

/// Calls a generic check with several lengths of the filter: the first taps of a longer list. Some
/// sample types get all, the others few, as every length is compiled for itself.
macro_rules! all_lengths {
    ($check:ident, $sample:ty, $taps:expr, $($argument:expr),*) => {
        crate::common::rate::lengths!([1 2 3 8 15 24] $check, $sample, $taps, ($($argument),*))
    };
}
macro_rules! few_lengths {
    ($check:ident, $sample:ty, $taps:expr, $($argument:expr),*) => {
        crate::common::rate::lengths!([1 3 8] $check, $sample, $taps, ($($argument),*))
    };
}
macro_rules! lengths {
    ([$($length:literal)*] $check:ident, $sample:ty, $taps:expr, $arguments:tt) => {{
        $(crate::common::rate::length!($length, $check, $sample, $taps, $arguments);)*
    }};
}
macro_rules! length {
    ($length:literal, $check:ident, $sample:ty, $taps:expr, ($($argument:expr),*)) => {
        $check::<$sample, $length>(&crate::common::rate::first_taps($taps), $($argument),*);
    };
}

/// The test of a check with drawn recordings, filters and shifts in every sample type, which is `S`, and with
/// parameters of its own.
macro_rules! drawn_recordings {
    ($check:ident, $cases:literal $(, $own:ident: $strategy:expr)*) => {
        #[test]
        fn drawn_recordings() {
            drawn_recordings!(@ f32, all_lengths, $check, $cases $(, $own: $strategy)*);
            drawn_recordings!(@ fixed::types::I16F16, all_lengths, $check, $cases $(, $own: $strategy)*);
            drawn_recordings!(@ i16, all_lengths, $check, $cases $(, $own: $strategy)*);
            drawn_recordings!(@ fixed::types::I8F8, few_lengths, $check, $cases $(, $own: $strategy)*);
            drawn_recordings!(@ fixed::types::I1F15, few_lengths, $check, $cases $(, $own: $strategy)*);
            drawn_recordings!(@ fixed::types::I32F0, few_lengths, $check, $cases $(, $own: $strategy)*);
        }
    };
    (@ $sample:ty, $lengths:ident, $check:ident, $cases:literal $(, $own:ident: $strategy:expr)*) => {
        {
            type S = $sample;
            let recordings = crate::common::rate::recordings::<S>();
            let parameters = (recordings, $($strategy,)* <S as crate::common::Drawn>::shift());
            let cases = &crate::common::cases($cases);
            proptest!(cases, |(((x, taps), $($own,)* shift) in parameters)| {
                $lengths!($check, S, &taps, &x, $($own,)* shift);
            });
        }
    };
}
pub(crate) use {all_lengths, drawn_recordings, few_lengths, length, lengths};

/// The first taps of a list, of which at least one is not 0.
pub(crate) fn first_taps<S: Wire, const F: usize>(list: &[S]) -> Taps<S, F> {
    Taps::try_new(std::array::from_fn(|k| list[k])).unwrap()
}

/// 24 taps whose sum fits the type, the first of them not 0.
pub(crate) fn taps<S: Wire + Drawn>() -> BoxedStrategy<Vec<S>> {
    vec(S::tap(), 24).prop_filter("not 0 first", |taps| taps[0] != S::default()).boxed()
}

/// The spikes of a recording, those of the tail last.
pub(crate) fn spikes_of<P: Start<Code = Spike>>(scheme: &P, x: &[P::Sample]) -> Vec<i8> {
    let mut encoder = scheme.encoder();
    let mut spikes: Vec<_> = x.iter().filter_map(|&x| encoder.encode(x).code()).collect();
    spikes.extend(encoder.finish());
    signs_of(&spikes)
}

/// The least sample of a recording.
pub(crate) fn least<S: Wire>(x: &[S]) -> S {
    x.iter().copied().fold(x[0], |least, x| if x < least { x } else { least })
}

/// A triangle of 24 taps, ordinary for any signal of the flights.
pub(crate) fn triangle<S: Wire>(peak: f64) -> Vec<S> {
    (0..24).map(|k| S::nearest(peak * f64::from(12 - (k - 12_i32).abs() + 1) / 13.0)).collect()
}

/// A recording made of filters: spikes at random, each sample a little off at random.
pub(crate) fn made_of_filters<S: Wire>(taps: &[S], spikes: &[bool], errors: &[i8]) -> Vec<S> {
    let value = |i: usize| {
        let taps = taps.iter().enumerate().take(i + 1);
        taps.filter(|(j, _)| spikes[i - j]).map(|(_, tap)| tap.to_f64()).sum::<f64>()
    };
    let step = taps[0].to_f64().abs() / 64.0;
    let noisy = |i: usize| S::nearest(value(i) + f64::from(errors[i % errors.len()]) * step);
    (0..spikes.len()).map(noisy).collect()
}

/// Recordings, hostile ones and those made of the filter, with the filter's 24 taps.
pub(crate) fn recordings<S: Wire + Drawn>() -> BoxedStrategy<(Vec<S>, Vec<S>)> {
    let shaped = (taps::<S>(), vec(any::<bool>(), 0..90), vec(-3..=8_i8, 1..40), 1..25_usize)
        .prop_map(|(taps, spikes, noise, length)| {
            (made_of_filters(&taps[..length], &spikes, &noise), taps)
        });
    prop_oneof![(S::recordings(), taps::<S>()), shaped].boxed()
}

/// All pairs of two residuals within 8 bits, in the given taps' unit.
pub(crate) fn pairs_of_8_bits() -> impl Iterator<Item = [i16; 2]> {
    (-128..128).flat_map(|a| (-128..128).map(move |b| [a, b]))
}
