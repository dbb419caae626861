//! Networks of every neuron, rule and input, in both kinds of numbers.

use core::hint::black_box;
use spikewire_network::{
    Cuba, Full, Layer, Li, Lif, Network, Neuron, NoReset, Number, OneToOne, Reset, Spikes, State,
    Subtract, SubtractLate, SubtractNoDelay, ToValue, ToValueHeld, ToValueLate, Weights,
};

use crate::exercise::{event, hide, tick};

/// Nineteen neurons: a block of 16 and three, or two of 8.
const N: usize = 19;

pub fn link() {
    rule::<ToValue>();
    rule::<ToValueLate>();
    rule::<ToValueHeld>();
    rule::<Subtract>();
    rule::<SubtractLate>();
    rule::<SubtractNoDelay>();
    rule::<NoReset>();
    let mut inputs = black_box(Spikes::<4>::new());
    inputs.push_event(event());
    inputs.push_signed(event());
    inputs.clear();
    inputs.push(black_box(2));
    hide((inputs.lost(), inputs.as_slice().len()));
}

fn rule<R: Reset>() {
    // Built of what the compiler does not know, by the constructors that return errors.
    let rows = black_box([[1.0; N]; N]);
    if let (Ok(lif), Ok(li), Ok(weights)) = (
        Lif::<f32, R>::try_new(black_box(0.5), black_box(1.0)),
        Li::<f32>::try_new(black_box(0.5)),
        Weights::<f32, N, N>::try_new(&rows),
    ) {
        network(&weights, lif.at_threshold(), &const { Weights::<f32, 1, N>::new(&[[1.0; N]]) });
        network(&weights, li, &const { Weights::<f32, 1, N>::new(&[[1.0; N]]) });
        if let (Ok(lif), Ok(li)) =
            (Cuba::<f32, _>::try_new(0.5, lif), Cuba::<f32, _>::try_new(0.5, li))
        {
            let own = const { Weights::<f32, 1, N>::new(&[[1.0; N]]) };
            network(&weights, lif, &own);
            network(&weights, lif.from_old_current(), &own);
            network(&weights, li, &const { Weights::<f32, 1, N>::new(&[[1.0; N]]) });
        }
    }
    if let (Ok(lif), Ok(li)) =
        (Lif::<i32, R>::try_integer(black_box(9), 8), Li::<i32>::try_integer(black_box(9)))
    {
        let weights = black_box(const { Weights::<i32, N, N>::packed(&[[1; N]; N], 4) });
        let own = const { Weights::<i32, 1, N>::packed(&[[1; N]], 4) };
        network(&weights, lif.at_threshold(), &own);
        network(&weights, li, &own);
        if let (Ok(lif), Ok(li)) =
            (Cuba::<i32, _>::try_integer(9, lif), Cuba::<i32, _>::try_integer(9, li))
        {
            network(&weights, lif, &own);
            network(&weights, li, &own);
        }
    }
}

fn network<T: Neuron>(weights: &Weights<T::Value, N, N>, neuron: T, own: &Weights<T::Value, 1, N>)
where
    <T::Value as Number>::Value: From<u8>,
{
    let neurons = black_box([neuron; N]);
    let layer = black_box(Layer::new(weights, &neurons));
    let network = layer.then(layer.recurrent(Full(weights))).then(layer.recurrent(OneToOne(own)));
    let mut state = black_box(network.state());
    let input = black_box([3_u16; 7]);
    hide(network.step(&mut state, input.get(..black_box(5)).unwrap_or_default()).len());
    state.events(tick(), black_box(60_000)).for_each(hide);
    hide((state.rejected(), state.saturated(), state.values().len()));
    let values = layer.of_values();
    let mut state = black_box(values.state());
    hide(values.step(&mut state, &black_box([1.into(); N])).len());
    hide((state.rejected(), state.currents().len()));
}
