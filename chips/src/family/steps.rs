//! Steps in which each neuron compares with its threshold once, as in training, and the chip's neurons after every event.

use embedded_hal::spi::SpiDevice;

use super::{AerPort, ChipError, Input, Outcome, Running};

/// The events that make a network's step on tinyODIN: data that belongs to a [`Network`](super::Network) in open loop, which
/// `spikewire network` writes. [`Running::step`] runs a step.
///
/// While a step's inputs come, potentials lie lower than they mean, so that no neuron reaches its threshold. Then a row of
/// weights raises a layer by its *rungs*, and its neurons compare. The layer's spikes go on to the next layer, which is
/// raised in turn. At last another row lets all neurons fall again. On their way leaks come: each moves a potential
/// towards the one that lies at 0 just then, so that leaks at several heights together move it by a share, as in
/// training. What a neuron that fired has got beyond 0 by then, leaks of its own take away.
///
/// ```
/// use embedded_hal::{delay::DelayNs, spi::SpiDevice};
/// use spikewire::{Bank, Polarity, Readout, Tick, population::Position, temporal::StepForward};
/// use spikewire_chips::{
///     AerPort, ChipError, Describe, Inputs, Spikes, Steps, StepsLayer, StepsState, TinyOdin, TinyOdinNetwork,
///     TinyOdinNeuron, neurons_from,
/// };
///
/// // As `spikewire network` writes them: rises and falls of one rate lead to three neurons, by rungs of 7.
/// static STEPS: Steps = Steps {
///     inputs: 2,
///     has_bias: false,
///     rows: 1,
///     layers: &[StepsLayer { neurons: 3, loops: false }],
///     rungs: 2,
///     leaks: &[&[0]],
///     lift: 2,
///     own_leaks: &[7, 7, 7],
/// };
/// const NEURON: TinyOdinNeuron = TinyOdinNeuron { threshold: 9, leak: 1, potential: -14, is_disabled: false };
/// static NETWORK: TinyOdinNetwork<5, 3, 3> = TinyOdinNetwork {
///     neurons: [NEURON; 3],
///     inputs: Inputs::Rows([[-5, 1, 5], [5, 1, -5], [7, 7, 7], [-7, -7, -7], [7, 7, 7]]),
///     recurrent: &[],
///     outputs: neurons_from::<0, 3>(),
/// };
/// static RATE: StepForward<f32> = StepForward::new(0.05);
/// static TURN: Position<f32, 3> = Position::new([-1.0, 0.0, 1.0]);
///
/// fn fly<D: SpiDevice, P: AerPort>(
///     chip: &mut TinyOdin<D, P>,
///     delay: &mut impl DelayNs,
///     rates: impl Iterator<Item = (Tick, f32)>,
///     mut command: impl FnMut(f32),
/// ) -> Result<(), ChipError<D::Error, P::Error>> {
///     let mut gated = chip.reset(delay)?;
///     gated.load(&NETWORK, |_| ())?;
///     let mut chip = gated.run(&NETWORK.registers())?;
///     let mut state = StepsState::REST;
///     let mut bank = Bank::<_, 1>::new(&RATE);
///     let mut readout = Readout::<_, 1>::new(&TURN);
///     for (now, rate) in rates {
///         let mut events = Spikes::<1>::new();
///         bank.encode(now, [rate], |event| events.push(event));
///         let inputs = events.as_slice().iter().map(|event| {
///             event.address * 2 + u16::from(event.polarity == Polarity::Down)
///         });
///         let mut spikes = Spikes::<3>::new();
///         chip.step(&STEPS, &mut state, inputs, NETWORK.answers(now, |event| spikes.push(event)))?;
///         let [value] = readout.decode(now, spikes.as_slice());
///         command(value);
///     }
///     Ok(())
/// }
/// ```
///
/// Rows of the network, each group of inputs or neurons in order: the inputs, the bias if there is one; for each layer
/// the neurons onto the next layer, if there is one, then the neurons onto themselves, if it loops; a row that raises for
/// each layer; the row that lets all fall; the row that lifts all, if [`lift`](Self::lift) is not 0. Neurons begin lower
/// by what the rungs raise them above 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps<'a> {
    /// Number of inputs.
    pub inputs: u16,
    /// Whether one more input, behind the others, belongs to every step.
    pub has_bias: bool,
    /// Rows of each input and each neuron that sends spikes. Their weights add up, so that rows are bits of a weight.
    pub rows: u16,
    /// The layers, from the input on. Their neurons are the chip's from 0 on.
    pub layers: &'a [StepsLayer],
    /// Events that raise a layer, and that let all neurons fall.
    pub rungs: u16,
    /// For each step, in turn: after how many events of the fall there is a leak of all neurons, in ascending order.
    pub leaks: &'a [&'a [u16]],
    /// Events that lift all neurons again after the fall, before the leaks of neurons that fired, and let them fall after
    /// these.
    pub lift: u16,
    /// The number of leaks that a neuron gets alone once it has fired, by neuron.
    pub own_leaks: &'a [u16],
}

/// A layer of a network that runs in [`Steps`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepsLayer {
    /// Number of neurons.
    pub neurons: u16,
    /// Whether its spikes lead back to it in the next step.
    pub loops: bool,
}

/// The memory of a network from one step to the next: 36 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepsState {
    /// The neurons that fired in the last step.
    fired: Fired,
    /// The place in [`Steps::leaks`].
    turn: u16,
}

impl StepsState {
    /// Before the first step.
    pub const REST: Self = Self { fired: Fired([0; 8]), turn: 0 };
}

/// A set of neurons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Fired([u32; 8]);

impl Fired {
    /// Adds a neuron; false if it was there.
    fn insert(&mut self, neuron: u8) -> bool {
        let Some(word) = self.0.get_mut(usize::from(neuron >> 5)) else { return false };
        let bit = 1 << (neuron & 31);
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }

    fn contains(&self, neuron: u16) -> bool {
        let word = self.0.get(usize::from(neuron >> 5)).copied().unwrap_or(0);
        word >> (neuron & 31) & 1 == 1
    }

    /// Those of a range, counted from its start.
    fn of(self, start: u16, count: u16) -> impl Iterator<Item = u16> {
        (0..count).filter(move |at| self.contains(start.saturating_add(*at)))
    }
}

impl Steps<'_> {
    /// The row that raises the first layer.
    #[must_use]
    pub fn first_rise(&self) -> u16 {
        let sources = self.inputs.saturating_add(self.has_bias.into());
        let last = self.layers.len().saturating_sub(1);
        let senders = (0..self.layers.len()).zip(self.layers).map(|(at, layer)| {
            let groups = u16::from(at < last).saturating_add(layer.loops.into());
            groups.saturating_mul(layer.neurons)
        });
        let sources = senders.fold(sources, u16::saturating_add);
        sources.saturating_mul(self.rows)
    }

    /// The number of rows in all.
    #[must_use]
    pub fn all_rows(&self) -> u16 {
        let gates = match (self.rungs, self.lift) {
            (0, _) => 0,
            (_, 0) => 1_u16.saturating_add(self.layers.len() as u16),
            _ => 2_u16.saturating_add(self.layers.len() as u16),
        };
        self.first_rise().saturating_add(gates)
    }
}

impl<I: Input, D: SpiDevice, P: AerPort> Running<'_, I, D, P> {
    /// Runs a step of a network: its inputs, by number, in any order. Passes each output's neuron to `on_output` at once,
    /// and neurons of other layers too: [`Describe::answers`](super::Describe::answers) leaves these out. No neuron fires
    /// twice in a step. Leaks come between steps only, so that a step cannot begin with the wrong one. Inputs that the
    /// network has not are left out and [counted](super::Counters::unmapped_events).
    ///
    /// **Time:** each event takes the chip 2 clocks for every neuron in use, and 6 more: those of inputs and spikes,
    /// [`rungs`](Steps::rungs) for each layer and once more for all, leaks. When the call returns the chip still works on
    /// the last one.
    ///
    /// # Errors
    /// Returns the errors of [`send`](Self::send). The step is then cut off, and the chip's potentials are those of no
    /// step: gate it, load the network again, and begin with [`StepsState::REST`].
    pub fn step(
        &mut self,
        steps: &Steps,
        state: &mut StepsState,
        inputs: impl IntoIterator<Item = u16>,
        on_output: impl FnMut(u8),
    ) -> Outcome<(), D, P> {
        let before = state.fired;
        let mut step = Step { running: self, rows: steps.rows, fired: Fired::default(), on_output };
        for input in inputs {
            if input < steps.inputs {
                step.source(0, input)?;
            } else {
                step.running.count_unmapped();
            }
        }
        if steps.has_bias {
            step.source(0, steps.inputs)?;
        }
        let (mut row, mut first) =
            (steps.inputs.saturating_add(steps.has_bias.into()).saturating_mul(steps.rows), 0_u16);
        let mut rise = steps.first_rise();
        let last = steps.layers.len().saturating_sub(1);
        for (at, layer) in (0..steps.layers.len()).zip(steps.layers) {
            let group = layer.neurons.saturating_mul(steps.rows);
            let onward = row;
            row = row.saturating_add(if at < last { group } else { 0 });
            if layer.loops {
                for neuron in before.of(first, layer.neurons) {
                    step.source(row, neuron)?;
                }
                row = row.saturating_add(group);
            }
            step.row(rise, steps.rungs)?;
            rise = rise.saturating_add(1);
            // The chip takes a word after its work on those before: by then all outputs have come.
            step.send(I::probe(I::PROBED))?;
            if at < last {
                for neuron in step.fired.of(first, layer.neurons) {
                    step.source(onward, neuron)?;
                }
            }
            first = first.saturating_add(layer.neurons);
        }
        // Behind those that raise.
        let (fall, lift) = (rise, rise.saturating_add(1));
        let turn = usize::from(state.turn);
        let mut leaks = steps.leaks.get(turn).copied().unwrap_or_default().iter().peekable();
        for fallen in 0..=steps.rungs {
            while leaks.next_if(|leak| **leak == fallen).is_some() {
                step.send(I::LEAK_ALL)?;
            }
            step.row(fall, u16::from(fallen < steps.rungs))?;
        }
        if step.fired != Fired::default() && steps.own_leaks.iter().any(|leaks| *leaks > 0) {
            step.row(lift, steps.lift)?;
            for (neuron, leaks) in (0..256_u16).zip(steps.own_leaks) {
                if step.fired.contains(neuron) {
                    for _ in 0..*leaks {
                        step.send(I::probe(neuron as u8))?;
                    }
                }
            }
            step.row(fall, steps.lift)?;
        }
        state.fired = step.fired;
        state.turn = state.turn.saturating_add(1);
        if usize::from(state.turn) >= steps.leaks.len() {
            state.turn = 0;
        }
        Ok(())
    }

    fn count_unmapped(&mut self) {
        let count = &mut self.chip.counters.unmapped_events;
        *count = count.saturating_add(1);
    }
}

/// A step under way.
struct Step<'r, 'c, I: Input, D, P, F> {
    running: &'r mut Running<'c, I, D, P>,
    rows: u16,
    fired: Fired,
    on_output: F,
}

impl<I: Input, D: SpiDevice, P: AerPort, F: FnMut(u8)> Step<'_, '_, I, D, P, F> {
    fn send(&mut self, input: I) -> Outcome<(), D, P> {
        let Self { running, fired, on_output, .. } = self;
        running.send(input, |neuron| {
            if fired.insert(neuron) {
                on_output(neuron);
            }
        })
    }

    /// Sends a row's spike so many times.
    fn row(&mut self, row: u16, times: u16) -> Outcome<(), D, P> {
        for _ in 0..times {
            let Ok(pre) = u8::try_from(row) else {
                let (value, max) = (row.into(), u8::MAX.into());
                return Err(ChipError::OutOfRange { what: "row", value, min: 0, max });
            };
            self.send(I::spike(pre))?;
        }
        Ok(())
    }

    /// Sends the spikes of all rows of an input or a neuron.
    fn source(&mut self, first: u16, number: u16) -> Outcome<(), D, P> {
        let first = first.saturating_add(number.saturating_mul(self.rows));
        for at in 0..self.rows {
            self.row(first.saturating_add(at), 1)?;
        }
        Ok(())
    }
}
