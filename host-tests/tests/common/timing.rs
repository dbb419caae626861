//! What the tests of the timing codes share: samples as the reference has them, and one comparison for all.

use std::collections::HashMap;

use fixed::types::{I1F15, I8F8, I16F16, I32F0};
use host_tests::compare::{Repeatable, Wire, assert_same_values, decode, encode, whole};
use host_tests::reference::{Exact, Line, Spikes};
use spikewire::{Code, NeuronSpike, Output, Polarity, Sample, Start};

/// A sample type, and the line of values that the reference reads it on.
pub(crate) trait Lined: Wire {
    type Line: Line;
    fn line(self) -> Self::Line;
    fn on(line: Self::Line) -> Self;
}

impl Lined for f32 {
    type Line = f32;
    fn line(self) -> f32 {
        self
    }
    fn on(line: f32) -> f32 {
        line
    }
}

macro_rules! lined {
    ($($sample:ty)*) => {$(
        impl Lined for $sample {
            type Line = i64;
            fn line(self) -> i64 {
                whole(self)
            }
            fn on(line: i64) -> Self {
                Self::from_bits32(i32::try_from(line).unwrap().cast_unsigned())
            }
        }
    )*};
}
lined!(i16 I8F8 I1F15 I16F16 I32F0);

/// The spikes of a code.
pub(crate) fn spikes_of(code: &impl Code) -> Spikes {
    code.firings().map(|firing| (firing.neuron, firing.slot)).collect()
}

/// The code of spikes.
pub(crate) fn code_of<C: Code>(spikes: &[(u16, u16)]) -> C {
    let firing =
        |&(neuron, slot): &(u16, u16)| NeuronSpike { neuron, slot, polarity: Polarity::Up };
    C::assemble(spikes.iter().map(firing))
}

/// Encoder and decoder against the reference, which gives the spikes of a finite sample, and the value that these are
/// decoded as. A sample that is not finite is decoded as the `silence`, or as the value before.
pub(crate) fn check<P>(
    scheme: &P,
    x: &[P::Sample],
    silence: Option<P::Sample>,
    spikes: impl Fn(<P::Sample as Lined>::Line) -> Spikes,
    value_of: impl Fn(<P::Sample as Lined>::Line) -> <P::Sample as Lined>::Line,
) where
    P: Repeatable + Start<Sample: Lined>,
{
    let run = encode(scheme, x);
    assert!(run.tail.is_empty());
    let mut rejected = 0;
    let mut decoder = scheme.decoder();
    let mut value = decoder.held().expect("it holds a value");
    let mut values = Vec::new();
    let codes = run.codes();
    let mut known = HashMap::new();
    for (&x, code) in x.iter().zip(&codes) {
        let line = if x.real().into().is_finite() { Some(x.line()) } else { None };
        let spikes = line.map_or(vec![], &spikes);
        let middle = line.map(|line| {
            *known.entry(spikes.clone()).or_insert_with(|| P::Sample::on(value_of(line)))
        });
        rejected += u32::from(line.is_none());
        assert_eq!(spikes_of(code), spikes, "{x:?}");
        assert_eq!(code_of::<P::Code>(&spikes), *code, "{x:?}");
        value = middle.or(silence).unwrap_or(value);
        values.push(value.real());
    }
    assert_eq!(run.rejected, rejected);
    assert_same_values(&decode(&decoder, &codes), &values);
    if let Some(&last) = x.last().filter(|x| x.real().into().is_finite()) {
        decoder.resync(last);
        assert_eq!(decoder.held().map(Wire::real).map(Into::into), Some(last.real().into()));
    }
    decoder.reset();
    assert_same_values(&decode(&decoder, &codes), &values);
}

/// Asserts that no value within the range is decoded farther off than its bound.
pub(crate) fn assert_law<P>(
    scheme: &P,
    x: impl Iterator<Item = P::Sample>,
    [min, max]: [P::Sample; 2],
    bound: impl Fn(f64) -> f64,
) where
    P: Start<Sample: Lined>,
{
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    for x in x.filter(|&x| x >= min && x <= max) {
        let value = decoder.decode(encoder.encode(x).code().expect("a code for each sample"));
        let (Exact(exact), Exact(ours)) = (x.line().into(), value.line().into());
        let off = (exact - ours).abs();
        assert!(off <= bound(exact), "{x:?} is decoded as {value:?}, off by {off}");
    }
}

/// Samples close to each of these lines, in `f32`.
pub(crate) fn beside(edges: impl Iterator<Item = f64>) -> Vec<f32> {
    edges.map(|edge| edge as f32).flat_map(|x| [x.next_down(), x, x.next_up()]).collect()
}
