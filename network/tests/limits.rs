//! The ends of ranges: what is refused beyond them, where numbers are clamped, and that each is counted, in every layer.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use spikewire_network::{
    Cuba, Layer, Li, Lif, Network, State, Subtract, ToValue, ToValueHeld, ToValueLate, Weights,
};

/// The largest weight, bias, threshold and reset value in `f32`.
const LARGEST: f32 = 1e15;

/// The largest value of an input in `f32`.
const LARGEST_VALUE: f32 = 1e6;

#[test]
fn floats_reach_their_bound_and_no_further() {
    for end in [LARGEST, -LARGEST] {
        let beyond = if end > 0.0 { end.next_up() } else { end.next_down() };
        assert!(Weights::<f32, 1, 1>::try_new(&[[end]]).is_ok());
        let error = Weights::<f32, 1, 1>::try_new(&[[beyond]]).unwrap_err();
        assert_eq!((error.value, error.min, error.max), (beyond, -LARGEST, LARGEST));
        assert!(Lif::<f32, ToValue>::try_new(0.5, end).is_ok());
        assert_eq!(Lif::<f32, ToValue>::try_new(0.5, beyond).unwrap_err().max, LARGEST);
        let neuron = Lif::<f32, ToValue>::new(0.5, 1.0);
        assert!(neuron.try_with_bias(end).is_ok());
        assert_eq!(neuron.try_with_bias(beyond).unwrap_err().max, LARGEST);
        // A value at its own bound counts, and one beyond it is left out.
        let end = end.signum() * LARGEST_VALUE;
        let beyond = if end > 0.0 { end.next_up() } else { end.next_down() };
        let weights = Weights::<f32, 1, 1>::new(&[[1.0]]);
        let neurons = [Li::<f32>::new(0.0)];
        let layer = Layer::new(&weights, &neurons).of_values();
        let mut state = layer.state();
        layer.step(&mut state, &[end]);
        assert_eq!((state.values(), state.rejected()), (&[end][..], 0));
        layer.step(&mut state, &[beyond]);
        assert_eq!((state.values(), state.rejected()), (&[0.0][..], 1));
    }
    for decay in [0.0, 1.0] {
        assert!(Li::<f32>::try_new(decay).is_ok());
    }
    assert!(Li::<f32>::try_new(1.0_f32.next_up()).is_err());
    assert!(Cuba::<f32, _>::try_new(1.0_f32.next_up(), Li::<f32>::new(1.0)).is_err());
}

#[test]
fn integers_reach_their_bound_and_no_further() {
    const MOST: i32 = 1 << 27;
    for (end, beyond) in [(MOST, MOST + 1), (-MOST, -MOST - 1)] {
        assert!(Lif::<i32, ToValue>::try_integer(65_536, end).is_ok());
        assert!(Lif::<i32, ToValue>::try_integer(65_536, beyond).is_err());
        let neuron = Lif::<i32, ToValue>::integer(65_536, 1);
        assert!(neuron.try_with_bias(end).is_ok() && neuron.try_with_bias(beyond).is_err());
    }
    assert!(Li::<i32>::try_integer(65_536).is_ok() && Li::<i32>::try_integer(65_537).is_err());
}

/// Each rule checks the value to which it returns, or which it subtracts.
#[test]
fn a_reset_value_beyond_the_bound_panics() {
    let beyond = LARGEST.next_up();
    for with_reset in [
        |value| _ = Lif::<f32, ToValue>::new(0.5, 1.0).with_reset(value),
        |value| _ = Lif::<f32, ToValueLate>::new(0.5, 1.0).with_reset(value),
        |value| _ = Lif::<f32, ToValueHeld>::new(0.5, 1.0).with_reset(value),
        |value| _ = Lif::<f32, Subtract>::new(0.5, 1.0).with_reset(value),
    ] as [fn(f32); 4]
    {
        with_reset(LARGEST);
        assert!(std::panic::catch_unwind(|| with_reset(beyond)).is_err());
    }
}

/// Seventeen neurons are a block and one by itself, which are clamped by different code.
const OUT: usize = 17;
/// Most spikes of a step.
const MOST: [u16; 4096] = [0; 4096];

/// Returns the weights of one input, all alike, shifted as far as they can be.
const fn alike(weight: i8) -> Weights<i32, 1, OUT> {
    Weights::<i32, 1, OUT>::packed(&[[weight; OUT]], 10)
}

#[test]
fn potentials_and_currents_stop_at_both_ends() {
    for (weight, end) in [(127, (1 << 29) - 1), (-128, -(1 << 29))] {
        let weights = alike(weight);
        let once = i32::from(weight) * 4096 * 1024;
        let neurons = [Li::<i32>::integer(65_536); OUT];
        let layer = Layer::new(&weights, &neurons);
        let mut state = layer.state();
        layer.step(&mut state, &MOST);
        assert_eq!((state.values(), state.saturated()), (&[once; OUT][..], 0));
        layer.step(&mut state, &MOST);
        assert_eq!((state.values(), state.saturated()), (&[end; OUT][..], OUT as u32));

        // The potential takes a current that has grown beyond its range before that is clamped.
        let neurons = [Cuba::<i32, _>::integer(65_536, Li::<i32>::integer(0)); OUT];
        let layer = Layer::new(&weights, &neurons);
        let mut state = layer.state();
        layer.step(&mut state, &MOST);
        assert_eq!((*state.currents(), state.saturated()), ([once; OUT], 0));
        layer.step(&mut state, &MOST);
        assert_eq!((*state.currents(), state.values()), ([end; OUT], &[end; OUT][..]));
        assert_eq!(state.saturated(), 2 * OUT as u32);
    }
}

/// A chain counts what is clamped and what is left out in each of its layers, wherever they stand.
#[test]
fn a_chain_counts_in_every_layer() {
    // The input's layer is clamped, and never fires; the second fires by its bias at each step; the last is clamped.
    let (first, second, last) =
        (alike(-128), Weights::<i32, OUT, 2>::packed(&[[0; 2]; OUT], 0), [[127; 1]; 2]);
    let last = Weights::<i32, 2, 1>::packed(&last, 10);
    let quiet = [Lif::<i32, ToValue>::integer(65_536, 1 << 27); OUT];
    let firing = [Lif::<i32, ToValue>::integer(0, 0).with_bias(1); 2];
    let sums = [Li::<i32>::integer(65_536).with_bias(1 << 27)];
    let (quiet, firing, sums) =
        (Layer::new(&first, &quiet), Layer::new(&second, &firing), Layer::new(&last, &sums));

    let front = quiet.then(firing);
    let mut state = front.state();
    for _ in 0..2 {
        assert_eq!(front.step(&mut state, &MOST), [0, 1]);
    }
    assert_eq!((state.saturated(), state.next.saturated()), (OUT as u32, 0));

    let whole = quiet.then(firing).then(sums);
    let mut state = whole.state();
    for _ in 0..5 {
        whole.step(&mut state, &MOST);
    }
    // 2^27 and twice 127 · 2^10 a step pass 2^29 in the fourth.
    let (first, last) = (4 * OUT as u32, 2);
    assert_eq!((state.first.saturated(), state.next.saturated()), (first, last));
    assert_eq!((state.saturated(), state.values()), (first + last, &[(1 << 29) - 1][..]));

    whole.step(&mut state, &[0, 1, 2]);
    assert_eq!((state.rejected(), state.first.rejected()), (2, 2));
}
