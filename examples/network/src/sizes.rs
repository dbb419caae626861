//! The networks, in both kinds of numbers.

use crate::weights::{bytes, choose, floats};
use board::stopwatch::{instructions, keep};
use core::{fmt, hint::black_box};
use spikewire_network::{Full, Layer, Li, Lif, Network, Spikes, State, ToValue, Weights};

/// Steps of a measurement.
const STEPS: u32 = 100;

#[inline(never)]
fn step<N: Network<Input = [u16]>>(network: &N, state: &mut N::State, input: &[u16]) {
    keep(network.step(state, input));
}

/// Measures a network of `inputs` and `hidden` neurons at three shares. `network` makes it of the neurons' biases, of which
/// the large ones fire and the others do not, and takes a step.
pub fn measure<const HIDDEN: usize>(
    out: &mut impl fmt::Write,
    name: &str,
    inputs: usize,
    bytes: usize,
    mut take: impl FnMut(&[bool; HIDDEN], &[u16]) -> (u32, usize),
) -> fmt::Result {
    for percent in [5, 10, 30, 100] {
        let (mut seed, mut total, mut most) = (2022, 0, 0);
        let of = |count: usize| (count * percent + 50) / 100;
        for _ in 0..STEPS {
            let (mut input, mut fires) = (Spikes::<16>::new(), [false; HIDDEN]);
            choose(&mut seed, of(inputs), inputs, |number| input.push(number as u16));
            choose(&mut seed, of(HIDDEN), HIDDEN, |number| fires[number] = true);
            let (count, fired) = take(black_box(&fires), input.as_slice());
            assert!(fired == of(HIDDEN), "others fired than were chosen");
            total += count;
            most = most.max(count);
        }
        writeln!(out, "{name},{percent},{},{most},{bytes}", total / STEPS)?;
    }
    Ok(())
}

macro_rules! networks {
    ($name:literal, $weights:ident, $number:ty, $new:ident, $share:expr, $threshold:expr, $bias:expr) => {
        use super::*;

        static A_IN: Weights<$number, 12, 100> = $weights!(1);
        static A_OUT: Weights<$number, 100, 4> = $weights!(2);
        pub static D_IN: Weights<$number, 16, 256> = $weights!(3);
        pub static D_BACK: Weights<$number, 256, 256> = $weights!(4);
        pub static D_OUT: Weights<$number, 256, 4> = $weights!(5);
        static OUTPUTS: [Li<$number>; 4] = [Li::$new($share); 4];
        const NEURON: Lif<$number, ToValue> = Lif::$new($share, $threshold);

        pub fn a(out: &mut impl fmt::Write) -> fmt::Result {
            let output = Layer::new(&A_OUT, &OUTPUTS);
            let mut state = Layer::new(&A_IN, &[NEURON; 100]).then(output).state();
            let bytes = size_of_val(&state);
            let mut neurons = [NEURON; 100];
            measure(out, concat!("A,", $name), 12, bytes, |fires: &[bool; 100], input| {
                for (neuron, &fires) in neurons.iter_mut().zip(fires) {
                    *neuron = NEURON.with_bias(if fires { $bias } else { -$bias });
                }
                let network = Layer::new(&A_IN, &neurons).then(output);
                let count = instructions(|| step(&network, &mut state, input));
                (count, state.first.spikes().len())
            })
        }

        pub fn d(out: &mut impl fmt::Write) -> fmt::Result {
            use spikewire_network::Cuba;
            let mut neurons = [Cuba::<$number, _>::$new($share, NEURON); 256];
            let output = Layer::new(&D_OUT, &OUTPUTS);
            let hidden = Layer::new(&D_IN, &neurons).recurrent(Full(&D_BACK));
            let mut state = hidden.then(output).state();
            let bytes = size_of_val(&state);
            measure(out, concat!("D,", $name), 16, bytes, |fires: &[bool; 256], input| {
                for (neuron, &fires) in neurons.iter_mut().zip(fires) {
                    *neuron = neuron.with_bias(if fires { $bias } else { -$bias });
                }
                let hidden = Layer::new(&D_IN, &neurons).recurrent(Full(&D_BACK));
                let network = hidden.then(output);
                let count = instructions(|| step(&network, &mut state, input));
                (count, state.first.spikes().len())
            })
        }
    };
}

macro_rules! of_floats {
    ($seed:literal) => {
        Weights::new(&floats($seed))
    };
}

macro_rules! of_bytes {
    ($seed:literal) => {
        Weights::packed(&bytes($seed), 4)
    };
}

pub mod float {
    networks!("f32", of_floats, f32, new, 0.25, 1.0, 10_000.0);

    use spikewire_network::{Cuba, CubaLif};

    static B_IN: Weights<f32, 6, 150> = of_floats!(6);
    static B_NEXT: Weights<f32, 150, 150> = of_floats!(7);
    static B_BACK: Weights<f32, 150, 150> = of_floats!(8);
    static B_OUT: Weights<f32, 150, 2> = of_floats!(9);
    static C_IN: Weights<f32, 8, 130> = of_floats!(10);
    static C_BACK: Weights<f32, 130, 130> = of_floats!(11);
    static C_OUT: Weights<f32, 130, 3> = of_floats!(12);
    const CUBA: CubaLif<f32, ToValue> = Cuba::<f32, _>::new(0.25, NEURON);
    const SUM: Li<f32> = Li::<f32>::new(0.0);

    /// The same of a network that takes values.
    #[inline(never)]
    fn step_values<N: Network>(network: &N, state: &mut N::State, input: &N::Input) {
        keep(network.step(state, input));
    }

    fn choose<const COUNT: usize>(neurons: &mut [CubaLif<f32, ToValue>; COUNT], fires: &[bool]) {
        for (neuron, &fires) in neurons.iter_mut().zip(fires) {
            *neuron = CUBA.with_bias(if fires { 10_000.0 } else { -10_000.0 });
        }
    }

    /// The estimator of Stroobants et al. (2025): both layers fire alike.
    pub fn b(out: &mut impl fmt::Write) -> fmt::Result {
        let mut neurons = [CUBA; 150];
        let last = Layer::new(&B_OUT, &[SUM; 2]);
        let next = Layer::new(&B_NEXT, &neurons).recurrent(Full(&B_BACK));
        let mut state = Layer::new(&B_IN, &neurons).of_values().then(next).then(last).state();
        let bytes = size_of_val(&state);
        measure(out, "B,f32", 6, bytes, |fires: &[bool; 150], _| {
            choose(&mut neurons, fires);
            let next = Layer::new(&B_NEXT, &neurons).recurrent(Full(&B_BACK));
            let network = Layer::new(&B_IN, &neurons).of_values().then(next).then(last);
            let values = black_box([0.5; 6]);
            let count = instructions(|| step_values(&network, &mut state, &values));
            (count, state.first.next.spikes().len())
        })
    }

    /// Its controller.
    pub fn c(out: &mut impl fmt::Write) -> fmt::Result {
        let mut neurons = [CUBA; 130];
        let last = Layer::new(&C_OUT, &[SUM; 3]);
        let first = Layer::new(&C_IN, &neurons).of_values().recurrent(Full(&C_BACK));
        let mut state = first.then(last).state();
        let bytes = size_of_val(&state);
        measure(out, "C,f32", 8, bytes, |fires: &[bool; 130], _| {
            choose(&mut neurons, fires);
            let first = Layer::new(&C_IN, &neurons).of_values().recurrent(Full(&C_BACK));
            let network = first.then(last);
            let values = black_box([0.5; 8]);
            let count = instructions(|| step_values(&network, &mut state, &values));
            (count, state.first.spikes().len())
        })
    }
}

pub mod integer {
    networks!("i8", of_bytes, i32, integer, 16_384, 1_000, 1 << 24);
}
