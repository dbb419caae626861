//! Time steps in which each neuron of tinyODIN compares its potential with its threshold once, as networks do in
//! training. (Otherwise the chip compares after every event.)

use embedded_hal::spi::SpiDevice;

use super::load::Loaded;
use super::{AerPort, ChipError, Describe, Input, Outcome, Running};
use crate::error::in_range;

/// A description of the time steps of a network on tinyODIN. In each step, each neuron compares its potential with its
/// threshold once, as in training. [`Running::step`] runs a step. A `Steps` belongs to a [`Network`](super::Network)
/// whose loop is open; the command `spikewire network` writes both.
///
/// While the inputs of a step arrive, all potentials are offset downwards, so that no neuron reaches its threshold.
/// Then events on an extra row of weights raise the potentials of the first layer. Each event raises them by one
/// *rung*. After the last of these events the offset is gone, and the neurons above their thresholds have fired. Their
/// spikes go to the next layer, whose potentials are raised in turn. Finally, events on a second extra row lower the
/// potentials of all neurons again.
///
/// Leaks are sent between the events that lower the potentials. Each leak moves a potential towards 0, by a fixed
/// amount. The offset changes between the leaks, so that together they reduce a potential by a share of its value, as
/// in training. A neuron that fired may end above its reset value. Further leaks, which only this neuron receives,
/// remove the excess.
///
/// ```
/// use embedded_hal::{delay::DelayNs, spi::SpiDevice};
/// use spikewire::{Bank, Polarity, Readout, Tick, population::Position, temporal::StepForward};
/// use spikewire_chips::{
///     AerPort, ChipError, Describe, Inputs, Spikes, Steps, StepsLayer, StepsState, TinyOdin, TinyOdinNetwork,
///     TinyOdinNeuron, neurons_from,
/// };
///
/// // Two inputs (rises and falls of a rate) and three neurons. A rung raises each potential by 7.
/// // `spikewire network` writes such constants.
/// static STEPS: Steps = Steps {
///     inputs: 2,
///     has_bias: false,
///     rows: &[1],
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
/// The rows of synapses of the network are, in this order:
///
/// 1. the inputs, and the bias if the network has one;
/// 2. for each layer, its neurons onto the next layer (except for the last layer), and onto the layer itself if the
///    layer is recurrent;
/// 3. for each layer, a row that raises its potentials;
/// 4. a row that lowers all neurons;
/// 5. a row that raises all neurons, if [`lift`](Self::lift) is not 0.
///
/// The initial potentials in the network must already be offset downwards.
///
/// The layers together may have up to [`Input::PROBED`] neurons (254 on tinyODIN, 255 on ODIN): neuron `PROBED` must be
/// free, because an event for it alone shows that a layer is done.
///
/// # Witness
/// A short reset pulse of the chip within a step, for example in a dip of the supply, drops the event at work. The pins
/// may not show it: [`Running::step`] then returns `Ok`, and potentials are wrong from then on. A network may therefore
/// have one neuron after those of the layers, the *witness*. Its weights are 0 in the rows of inputs and neurons. Its
/// weights in the rows that raise the layers have the sum `r`. Its weight is `-r` in the row that lowers all neurons,
/// and `r` in the row that raises all of them. It has no leak, and starts so low that it never fires. Each step then
/// returns it to its first potential, unless one of these events was dropped. [`Running::check_witness`] compares it.
/// It notices no dropped event of an input or a neuron, and no dropped leak.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps<'a> {
    /// Number of inputs. The bias (see [`has_bias`](Self::has_bias)) does not count.
    pub inputs: u16,
    /// Whether the network has a bias: one more input, numbered after the others, that fires in every step.
    pub has_bias: bool,
    /// Numbers of events that one spike sends: one number for each row of synapses of an input or neuron. All inputs,
    /// and all neurons whose spikes act on neurons, have the same number of rows. A spike acts with the sum of the
    /// weights in its rows, each times the number of events for that row. With `&[8, 1]`, two rows of 4-bit weights
    /// give weights from -72 to 63.
    pub rows: &'a [u16],
    /// The layers, from the input to the output. Their neurons are the chip's neurons from 0 on, in the same order.
    pub layers: &'a [StepsLayer],
    /// Number of events that raise the potentials of each layer in a step. Each event raises a potential by one *rung*:
    /// the neuron's weight in the row that raises its layer. At the end of the step, the same number of events lowers
    /// the potentials of all neurons, each by one rung.
    pub rungs: u16,
    /// Leaks that act on all neurons: one list for each step. After the last list, the next step takes the first list
    /// again. The driver sends these leaks at the end of the step, among the [`rungs`](Self::rungs) events that lower
    /// the potentials. A list has one entry for each leak: the number of these events, 0 to `rungs`, that the driver
    /// has sent before the leak. The entries are in ascending order; other lists are refused.
    pub leaks: &'a [&'a [u16]],
    /// Number of events that raise the potentials of all neurons before the leaks of [`own_leaks`](Self::own_leaks).
    /// After these leaks, the same number of events lowers the potentials again. With 0, these leaks are sent without
    /// raising the potentials. At most [`rungs`](Self::rungs): more events could make a neuron fire.
    pub lift: u16,
    /// For each neuron, the number of leaks that only this neuron receives after it has fired. Neurons beyond the end of
    /// the list receive none.
    pub own_leaks: &'a [u16],
}

/// A layer of a network that [`Steps`] describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepsLayer {
    /// Number of neurons in the layer.
    pub neurons: u16,
    /// Whether the layer is recurrent: its spikes act on its own neurons in the next step.
    pub loops: bool,
}

/// The state that [`Running::step`] keeps from one step to the next: 36 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepsState {
    /// The neurons that fired in the last step.
    fired: Fired,
    /// Index in [`Steps::leaks`] of the list for the next step.
    turn: u16,
}

impl StepsState {
    /// The state before the first step: no neuron has fired.
    pub const REST: Self = Self { fired: Fired([0; 8]), turn: 0 };
}

/// A set of neurons, one bit for each of the chip's neurons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Fired([u32; 8]);

impl Fired {
    /// Adds a neuron to the set. Returns false if the set already contained the neuron.
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

    /// Returns the neurons of the set that lie in `start..start + count`, each as its offset from `start`.
    fn of(self, start: u16, count: u16) -> impl Iterator<Item = u16> {
        (0..count).filter(move |at| self.contains(start.saturating_add(*at)))
    }
}

impl Steps<'_> {
    /// Returns the number of the row of synapses that raises the potentials of the first layer. The rows that raise the
    /// other layers follow.
    #[must_use]
    pub fn first_rise(&self) -> u16 {
        let sources = self.inputs.saturating_add(self.has_bias.into());
        let last = self.layers.len().saturating_sub(1);
        let senders = (0..self.layers.len()).zip(self.layers).map(|(at, layer)| {
            let groups = u16::from(at < last).saturating_add(layer.loops.into());
            groups.saturating_mul(layer.neurons)
        });
        let sources = senders.fold(sources, u16::saturating_add);
        sources.saturating_mul(self.rows.len() as u16)
    }

    /// Returns the number of neurons in all layers.
    fn neurons(&self) -> u16 {
        self.layers.iter().fold(0, |sum, layer| layer.neurons.saturating_add(sum))
    }

    /// Returns an error unless these steps are consistent, and fit the network that was loaded and the state.
    fn check<I: Input, B, P>(
        &self,
        state: &StepsState,
        loaded: &Loaded<I>,
    ) -> Result<(), ChipError<B, P>> {
        let neurons = self.neurons();
        in_range("neurons of steps", neurons.into(), 1, I::PROBED.into())?;
        // The network may have a witness after the neurons of the layers.
        let least = loaded.neurons.saturating_sub(1);
        in_range("neurons of steps", neurons.into(), least.into(), loaded.neurons.into())?;
        in_range("neurons of the network", loaded.neurons.into(), 1, I::PROBED.into())?;
        let rows = i64::from(loaded.rows);
        in_range("rows of steps", self.all_rows().into(), rows, rows)?;
        in_range("lift", self.lift.into(), 0, self.rungs.into())?;
        in_range("own leaks", self.own_leaks.len().min(257) as i64, 0, neurons.into())?;
        let lists = self.leaks.len().clamp(1, usize::from(u16::MAX));
        in_range("list of leaks", state.turn.into(), 0, lists as i64 - 1)?;
        if state.turn > 0 {
            // The step that took the first list checked all of them.
            return Ok(());
        }
        for list in self.leaks {
            let mut least = 0;
            for leak in *list {
                in_range("leak", (*leak).into(), least.into(), self.rungs.into())?;
                least = *leak;
            }
        }
        Ok(())
    }

    /// Returns the number of rows of synapses that the network needs in the chip, including the rows that raise and
    /// lower potentials.
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
    /// Runs one time step of a network. `inputs` are the numbers of the inputs that fire, in any order. A number that
    /// is not an input of the network is dropped and [counted](super::Counters::unmapped_events). Passes each neuron
    /// that fires to `on_output` immediately, at most once in a step. This includes neurons of all layers;
    /// [`Describe::answers`](super::Describe::answers) makes a callback that ignores all neurons except the outputs.
    ///
    /// **Time:** the chip takes 2 clock cycles for every neuron in use, and 6 more, for each event that acts on all
    /// neurons. An event for one neuron takes less. The events of a step are:
    ///
    /// - for each input that fires, and for the bias: as many events as the sum of [`rows`](Steps::rows);
    /// - for each neuron that fires: the same number for the next layer, if there is one; and if its own layer is
    ///   recurrent, the same number again in the next step;
    /// - for each layer: [`rungs`](Steps::rungs) events that raise potentials, and one event for one neuron;
    /// - at the end: `rungs` events that lower all potentials, and one event for each of the [`leaks`](Steps::leaks);
    /// - if a neuron fired and the network has [`own_leaks`](Steps::own_leaks): twice [`lift`](Steps::lift) events, and
    ///   one event for one neuron for each own leak of a neuron that fired.
    ///
    /// When the call returns, the chip still works on the last event.
    ///
    /// # Errors
    /// Returns [`OutOfRange`](ChipError::OutOfRange) before anything is sent if `steps` contradicts its own
    /// documentation, or does not fit the network that [`load`](super::Gated::load) wrote, or
    /// [`verify`](super::Gated::verify) found, after the last reset. Returns [`OtherNetwork`](ChipError::OtherNetwork)
    /// if the chip was started with other [registers](super::Describe::registers) than those of that network, or if the
    /// network is recurrent.
    ///
    /// Also returns the errors of [`send`](Self::send). The step is then incomplete and the chip's potentials are
    /// useless: gate the chip, load the network again, and begin with [`StepsState::REST`].
    pub fn step(
        &mut self,
        steps: &Steps,
        state: &mut StepsState,
        inputs: impl IntoIterator<Item = u16>,
        on_output: impl FnMut(u8),
    ) -> Outcome<(), D, P> {
        self.check_steps(steps, state)?;
        let before = state.fired;
        let rows = steps.rows.len() as u16;
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
            (steps.inputs.saturating_add(steps.has_bias.into()).saturating_mul(rows), 0_u16);
        let mut rise = steps.first_rise();
        let last = steps.layers.len().saturating_sub(1);
        for (at, layer) in (0..steps.layers.len()).zip(steps.layers) {
            let group = layer.neurons.saturating_mul(rows);
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
            // The chip takes a word only after its work on the words before: when it takes this one, all outputs of the
            // layer have come.
            step.send(I::probe(I::PROBED))?;
            if at < last {
                for neuron in step.fired.of(first, layer.neurons) {
                    step.source(onward, neuron)?;
                }
            }
            first = first.saturating_add(layer.neurons);
        }
        // The rows that lower and lift all neurons follow the rows that raise the layers.
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

    fn check_steps(&self, steps: &Steps, state: &StepsState) -> Outcome<(), D, P> {
        let loaded = &self.chip.loaded;
        steps.check(state, loaded)?;
        if loaded.registers != self.chip.registers
            || !loaded.registers.as_ref().is_some_and(I::is_open_loop)
        {
            return Err(ChipError::OtherNetwork);
        }
        Ok(())
    }

    /// Gates the chip between two steps, compares the [witness](Steps#witness) of the network with its state before the
    /// first step, and lets the chip run again. Call this now and then: it notices most reset pulses that a chip received
    /// within a step.
    ///
    /// **Time:** about 60 frames of 5 bytes on tinyODIN, 3.7 ms at an SCK of 656 kHz, and the waits of
    /// [`gate`](Self::gate).
    ///
    /// # Errors
    /// Returns [`OutOfRange`](ChipError::OutOfRange) if the network has no witness; the chip then still runs. Returns
    /// [`ReadBack`](ChipError::ReadBack) if the witness has changed. Also returns the errors of [`gate`](Self::gate) and
    /// of [`run`](super::Gated::run). After any of these, reset the chip, load the network again, and begin with
    /// [`StepsState::REST`].
    pub fn check_witness(
        self,
        steps: &Steps,
        network: &impl Describe<I>,
        on_output: impl FnMut(u8),
    ) -> Outcome<Self, D, P> {
        let witness = steps.neurons();
        let after = i64::from(witness).saturating_add(1);
        in_range("neurons of the network", network.neurons().into(), after, after)?;
        let Some(registers) = self.chip.registers else { return Err(ChipError::NotReset) };
        let mut gated = self.gate(on_output)?;
        gated.expect_neuron(witness as u8, &network.neuron(witness as u8))?;
        gated.run(&registers)
    }

    fn count_unmapped(&mut self) {
        let count = &mut self.chip.counters.unmapped_events;
        *count = count.saturating_add(1);
    }
}

/// A time step in progress, and the neurons that fired in it so far.
struct Step<'r, 'c, I: Input, D, P, F> {
    running: &'r mut Running<'c, I, D, P>,
    rows: &'r [u16],
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

    /// Sends `times` spikes, each on all synapses of row `row`.
    fn row(&mut self, row: u16, times: u16) -> Outcome<(), D, P> {
        for _ in 0..times {
            // The steps have as many rows as the network that was loaded, which has 256 at most.
            self.send(I::spike(row as u8))?;
        }
        Ok(())
    }

    /// Sends a spike of an input or a neuron. For each row of synapses of this input or neuron, `self.rows` has the
    /// number of events to send. `first` is the first row of all inputs, or of all neurons of the layer. `number` is
    /// the index of this input or neuron among them.
    fn source(&mut self, first: u16, number: u16) -> Outcome<(), D, P> {
        let rows = self.rows;
        let mut row = first.saturating_add(number.saturating_mul(rows.len() as u16));
        for &times in rows {
            self.row(row, times)?;
            row = row.saturating_add(1);
        }
        Ok(())
    }
}
