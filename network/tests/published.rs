//! Runs the same sixteen inputs through one neuron of every kind, and compares it with the frameworks: decay 1/2, gain
//! 1, threshold 4, from rest. All numbers are exact in binary.

#![expect(clippy::indexing_slicing, reason = "a test may panic")]

use spikewire_network::{
    Cuba, CubaLif, Forward, Full, Layer, Lif, Network, Neuron, NoReset, Recurrence, Reset, State,
    Subtract, SubtractLate, SubtractNoDelay, ToValue, ToValueHeld, ToValueLate, Values, Weights,
};

const INPUT: [f32; 16] =
    [3.0, 3.0, 0.0, 4.0, 1.0, 5.0, 2.0, 0.0, 0.0, 6.0, 6.0, -4.0, 2.0, 7.0, 1.0, 8.0];

static ONE: Weights<f32, 1, 1> = Weights::new(&[[1.0]]);
static BACK: Weights<f32, 1, 1> = Weights::new(&[[-3.0]]);

/// Returns the spikes of all steps, and the potentials.
fn run<N: Neuron<Value = f32>, R: Recurrence<f32, 1>>(
    neuron: N,
    recurrence: R,
    input: &[f32],
) -> (String, Vec<f32>) {
    let neurons = [neuron];
    let layer = Layer::new(&ONE, &neurons).of_values().recurrent(recurrence);
    let mut state = layer.state();
    let step = |&value: &f32| {
        let fired = layer.step(&mut state, &[value]) == [0];
        (if fired { '1' } else { '0' }, state.values()[0])
    };
    input.iter().map(step).unzip()
}

/// Asserts these spikes, and these first potentials.
fn expect(
    (spikes, potentials): (String, Vec<f32>),
    spikes_expected: &str,
    potentials_begin: &[f32],
) {
    assert_eq!(spikes, spikes_expected);
    assert_eq!(potentials[..potentials_begin.len()], *potentials_begin);
}

fn lif<R: Reset>() -> Lif<f32, R> {
    Lif::<f32, R>::new(0.5, 4.0)
}

fn cuba<R: Reset>() -> CubaLif<f32, R> {
    CubaLif::<f32, R>::new(0.5, lif())
}

#[test]
fn snntorch_and_norse_reset_to_zero_at_once() {
    let expected = [3.0, 0., 0., 4., 3., 0., 2., 1., 0.5, 0., 0., -4., 0., 0., 1., 0.];
    expect(run(lif::<ToValue>(), Forward, &INPUT), "0100010001100101", &expected);
}

#[test]
fn spikingjelly_fires_at_its_threshold() {
    let neuron = lif::<ToValue>().at_threshold();
    let expected = [3., 0., 0., 0., 1., 0., 2., 1., 0.5, 0., 0., -4., 0., 0., 1., 0.];
    expect(run(neuron, Forward, &INPUT), "0101010001100101", &expected);
}

#[test]
fn zero_a_step_late() {
    let expected = [3., 4.5, 0., 4., 3., 6.5, 2., 1., 0.5, 6.25, 6., -4., 0., 7., 1., 8.5];
    expect(run(lif::<ToValueLate>(), Forward, &INPUT), "0100010001100101", &expected);
}

#[test]
fn held_through_the_next_step() {
    let expected = [3., 4.5, 0., 4., 3., 6.5, 0., 0., 0., 6., 0., -4., 0., 7., 0., 8.];
    expect(run(lif::<ToValueHeld>(), Forward, &INPUT), "0100010001000101", &expected);
}

#[test]
fn a_spike_may_leave_the_potential() {
    let expected = [3., 4.5, 2.25, 5.125, 3.5625, 6.78125];
    expect(run(lif::<NoReset>(), Forward, &INPUT), "0101011001100111", &expected);
}

#[test]
fn snntorch_subtracts_a_step_late() {
    let (spikes, potentials) = run(lif::<SubtractLate>(), Forward, &INPUT);
    assert_eq!(potentials[14..], [0.316_955_57, 8.158_478]);
    let expected = [3., 4.5, -1.75, 3.125, 2.5625, 6.28125, 1.140_625];
    expect((spikes, potentials), "0100010001100101", &expected);
}

#[test]
fn spikingjelly_resets_softly() {
    let neuron = lif::<Subtract>().at_threshold();
    let expected = [3., 0.5, 0.25, 0.125, 1.0625, 1.53125, 2.765_625, 1.382_812_5];
    expect(run(neuron, Forward, &INPUT), "0101010001100101", &expected);
}

#[test]
fn a_perfect_integrator() {
    let neuron = Lif::<_, ToValue>::new(1.0, 4.0).at_threshold();
    let expected = [3., 0., 0., 0., 1., 0., 2., 2., 2., 0., 0., -4., -2., 0., 1., 0.];
    expect(run(neuron, Forward, &INPUT), "0101010001100101", &expected);
}

#[test]
fn recurrent_neurons_take_the_spike_of_the_step_before() {
    let expected = [3., 0., -3., 2.5, 2.25, 0., -1., -0.5, -0.25, 0., 3., -2.5, 0.75, 0., -2., 0.];
    expect(run(lif::<ToValue>(), Full(&BACK), &INPUT), "0100010001000101", &expected);
    let expected = [3., 4.5, -4.75, 1.625, 1.8125, 5.90625, -2.046_875];
    expect(run(lif::<SubtractLate>(), Full(&BACK), &INPUT), "0100010001000101", &expected);
    // To itself alone, of one neuron, is the same.
    let one = spikewire_network::OneToOne(&BACK);
    expect(run(lif::<SubtractLate>(), one, &INPUT), "0100010001000101", &expected);
}

#[test]
fn neurons_with_a_current() {
    let expected = [3., 0., 2.25, 0., 3.5625, 0., 0., 2.695_312_5];
    expect(run(cuba::<ToValue>(), Forward, &INPUT), "0101011001100111", &expected);
    let expected = [3., 6., 1.25, 5.75, 2.4375, 8., 5.390_625];
    expect(run(cuba::<SubtractLate>(), Forward, &INPUT), "0101011001100111", &expected);
    let expected = [3., 2., 3.25, 2.75, 0.9375, 3.25, 3.015_625];
    expect(run(cuba::<SubtractNoDelay>(), Forward, &INPUT), "0101111101100111", &expected);
}

#[test]
fn the_current_of_a_neuron_is_read() {
    let neurons = [cuba::<ToValue>()];
    let layer = Layer::new(&ONE, &neurons).of_values();
    let mut state = layer.state();
    let mut current = |value: &f32| {
        layer.step(&mut state, &[*value]);
        state.currents()[0]
    };
    let currents: Vec<f32> = INPUT[..6].iter().map(&mut current).collect();
    assert_eq!(currents, [3., 4.5, 2.25, 5.125, 3.5625, 6.78125]);
}

/// Norse's `LIFCell` adds the input to a current that decays after the potential has used it, so that it is the form's
/// current before its decay. The potential takes half of it, which is included in the weight.
#[test]
fn norse_lif_cell() {
    static HALF: Weights<f32, 1, 1> = Weights::new(&[[0.5]]);
    let neurons = [cuba::<ToValue>()];
    let layer = Layer::<_, 1, 1>::new(&HALF, &neurons).of_values();
    let mut state = layer.state();
    let step = |value: &f32| {
        let fired = layer.step(&mut state, &[*value]) == [0];
        (fired, (state.values()[0], state.currents()[0]))
    };
    let (fired, potentials): (Vec<bool>, Vec<(f32, f32)>) = INPUT.iter().map(step).unzip();
    let fired: String = fired.iter().map(|&fired| if fired { '1' } else { '0' }).collect();
    assert_eq!(fired, "0000010001100101");
    // Norse's current is twice this one, as the weight is halved, and has decayed to a half already.
    let of_norse: Vec<f32> = potentials.iter().map(|(_, current)| current * 2.0 * 0.5).collect();
    assert_eq!(of_norse[..3], [1.5, 2.25, 1.125]);
    let potentials: Vec<f32> = potentials.iter().map(|&(v, _)| v).collect();
    assert_eq!(potentials[..6], [1.5, 3., 2.625, 3.875, 3.71875, 0.]);
}

/// NIR's reference program uses the current of the step before, which equals an input that is a step late.
#[test]
fn nirs_reference() {
    let late: Vec<f32> = [0.0].into_iter().chain(INPUT).take(16).collect();
    let expected = [0., 3., 2., 3.25, 2.75, 0.9375, 3.25, 3.015_625];
    expect(run(cuba::<Subtract>(), Forward, &late), "0010111110111011", &expected);
    let old = cuba::<Subtract>().from_old_current();
    expect(run(old, Forward, &INPUT), "0010111110111011", &expected);
}

/// The types are written out, as a program that generates a module has to do.
#[test]
fn types_say_what_a_layer_is() {
    static NEURONS: [CubaLif<f32, Subtract>; 1] =
        [Cuba::<f32, _>::new(0.5, Lif::<f32, Subtract>::new(0.5, 4.0))];
    const LAYER: Layer<'static, CubaLif<f32, Subtract>, 1, 1, Values> =
        Layer::new(&ONE, &NEURONS).of_values();
    assert_eq!(LAYER.step(&mut LAYER.state(), &[5.0]), [0]);
}
