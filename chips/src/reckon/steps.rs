//! Time steps of a network that `spikewire network` brought onto `ReckOn`: they take one or several ticks of the chip.

use embedded_hal::spi::SpiDevice;

use super::{Outcome, ReckOnAnswer, ReckOnPort, ReckOnSample, ReckOnStep};
use crate::ChipError;
use crate::error::in_range;

/// Describes how `ReckOn` runs a time step of a network, and what its outputs mean. [`ReckOnSample::run`] runs such a
/// step. The command `spikewire network` writes such a constant beside the network.
///
/// A tick keeps at least 0.875 of a neuron's potential. If the neurons keep less in a step, a step has several ticks,
/// of which each keeps a root of it.
///
/// # Examples
/// A network whose outputs are the neurons of a population code: [`Readout`](spikewire::Readout) decodes their spikes.
/// ```
/// use embedded_hal::{delay::DelayNs, spi::SpiDevice};
/// use spikewire::{Bank, Event, Polarity, Readout, Tick, population::Position};
/// use spikewire_chips::{
///     ChipError, DescribeReckOn, ReckOn, ReckOnPort, ReckOnSettings, ReckOnSteps, ReckOnStepsState, Spikes,
/// };
///
/// static RATES: Position<f32, 16> = Position::linear(-8.0..=8.0);
/// static TURN: Position<f32, 3> = Position::new([-1.0, 0.0, 1.0]);
///
/// /// `STEPS` and `NETWORK`, as `spikewire network` writes them, are the last two arguments.
/// fn fly<D: SpiDevice, P: ReckOnPort>(
///     chip: &mut ReckOn<D, P>,
///     delay: &mut impl DelayNs,
///     rates: impl Iterator<Item = (Tick, f32)>, // rad/s
///     mut command: impl FnMut(f32),
///     steps: &ReckOnSteps,
///     network: &impl DescribeReckOn,
/// ) -> Result<(), ChipError<D::Error, P::Error>> {
///     let mut programmed = chip.reset(delay)?;
///     programmed.load(network, |_| ())?;
///     let mut sample = programmed.run(&ReckOnSettings::POTENTIALS)?.begin()?;
///     let mut state = ReckOnStepsState::REST;
///     let mut bank = Bank::<_, 1>::new(&RATES);
///     let mut readout = Readout::<_, 1>::new(&TURN);
///     for (now, rate) in rates {
///         let mut events = Spikes::<16>::new();
///         bank.encode(now, [rate], |event| events.push(event));
///         let inputs = events.as_slice().iter().map(|event| event.address);
///         let outputs = sample.run(steps, &mut state, inputs)?;
///         let mut spikes = Spikes::<3>::new();
///         for (address, _) in (0..3).zip(outputs).filter(|(_, output)| *output > 0.0) {
///             spikes.push(Event { tick: now, address, polarity: Polarity::Up });
///         }
///         let [value] = readout.decode(now, spikes.as_slice());
///         command(value);
///     }
///     Ok(())
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReckOnSteps<'a> {
    /// Number of inputs of the network. The chip's inputs that follow them are those that [`ticks`](Self::ticks) lists.
    pub inputs: u16,
    /// The ticks of a step. The network's inputs fire before the first of them.
    pub ticks: &'a [ReckOnTick<'a>],
    /// Number of ticks from the inputs of a step to the answer that shows their effect.
    pub late: u16,
    /// The meaning of the outputs.
    pub outputs: ReckOnOutputs<'a>,
}

/// Inputs that fire before a tick of a step in addition to the network's own: biases, and gates. A gate is an input
/// that lowers the potentials of neurons, so that they do not fire at some ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReckOnTick<'a> {
    /// Inputs that fire in every step.
    pub always: &'a [u8],
    /// Gates that raise neurons again. In the first step they fire only before the last tick, because the neurons of
    /// the other ticks have not been lowered yet.
    pub raises: &'a [u8],
}

/// The meaning of the outputs of a network on `ReckOn`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReckOnOutputs<'a> {
    /// Each output reports the spikes of a neuron of the last layer.
    Spikes,
    /// The outputs are neurons that never fire, which share the leak of the chip's outputs.
    Potentials {
        /// Value of 1 in an answer, in the units of the trained network.
        unit: f32,
    },
    /// The outputs are neurons that never fire, and whose leaks the chip's one leak for all outputs does not match. The
    /// chip only adds up the weights of each step; the driver adds these sums to potentials that leak.
    Leaky {
        /// Value of 1 in a sum of weights, in the units of the trained network.
        unit: f32,
        /// For each output, the factor by which a step multiplies its potential.
        keeps: &'a [f32],
    },
}

impl ReckOnOutputs<'_> {
    /// Weight, left shift and [`keep`](super::ReckOnShared::keep) of outputs that report [`Spikes`](Self::Spikes). Each
    /// tick of the chip halves the output's potential. The bits of the potential therefore show in which of the last
    /// ticks the neuron fired.
    pub const SPIKES: (i8, u8, u8) = (64, 7, 64);
    /// The [`keep`](super::ReckOnShared::keep) of outputs that are [`Leaky`](Self::Leaky). Their left shift is
    /// 1 or more. Each tick of the chip halves the output's potential. The driver calculates the sum of a tick's weights
    /// from two answers.
    pub const LEAKY_KEEP: u8 = 64;
    /// The bit of an answer that says whether the neuron of an output that reports spikes fired.
    const FIRED: u8 = 12;
}

/// The state of [`ReckOnSteps`] between two steps: the last answer of the chip, and the values of the outputs. Takes
/// 100 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReckOnStepsState {
    has_run: bool,
    /// The answer of the last tick.
    answer: [i16; 16],
    values: [f32; 16],
}

impl ReckOnStepsState {
    /// The state at the beginning of a sample.
    pub const REST: Self = Self { has_run: false, answer: [0; 16], values: [0.0; 16] };
}

impl<D: SpiDevice, P: ReckOnPort> ReckOnSample<'_, D, P> {
    /// Runs one time step of a network: sends the numbers of the inputs that fire, and the ticks of a step with their
    /// biases and gates. Returns the values of the outputs. They show the effect of the inputs that were sent
    /// `late / ticks` (rounded down) calls earlier. The value of an output that reports spikes is 1 if its neuron
    /// fired, and 0 otherwise. Other outputs' values are potentials in the units of the trained network. Begin each
    /// sample with [`ReckOnStepsState::REST`], and run the chip with
    /// [`ReckOnSettings::POTENTIALS`](super::ReckOnSettings::POTENTIALS).
    ///
    /// # Errors
    /// Returns an error if the network has no such input, if `steps` has no ticks or more than 255, or if the settings
    /// do not answer in each step. Also returns the errors of [`step`](Self::step). The step is then incomplete: begin
    /// a new sample, or reset the chip if the driver refuses that.
    pub fn run(
        &mut self,
        steps: &ReckOnSteps<'_>,
        state: &mut ReckOnStepsState,
        inputs: impl IntoIterator<Item = u16>,
    ) -> Outcome<[f32; 16], D, P> {
        let count = steps.ticks.len();
        in_range("ticks", count.min(256) as i64, 1, 255)?;
        for input in inputs {
            in_range("input", input.into(), 0, i64::from(steps.inputs.min(256)) - 1)?;
            self.send(input as u8)?;
        }
        let shown = usize::from(steps.late).checked_rem(count).unwrap_or(0);
        for (at, ReckOnTick { always, raises }) in steps.ticks.iter().enumerate() {
            let is_due = state.has_run || at.saturating_add(1) == count;
            let raises = if is_due { *raises } else { &[] };
            for input in always.iter().chain(raises) {
                self.send(*input)?;
            }
            let Some(ReckOnAnswer::Potentials(answer)) = self.step(ReckOnStep::default())? else {
                return Err(ChipError::OutOfRange { what: "answers", value: 0, min: 1, max: 1 });
            };
            if at == shown {
                state.show(&steps.outputs, answer);
            }
            state.answer = answer;
        }
        state.has_run = true;
        Ok(state.values)
    }
}

impl ReckOnStepsState {
    /// Calculates the outputs' values from the answer of a tick.
    fn show(&mut self, outputs: &ReckOnOutputs<'_>, answer: [i16; 16]) {
        match outputs {
            ReckOnOutputs::Spikes => {
                self.values = answer.map(|bits| f32::from(bits >> ReckOnOutputs::FIRED & 1));
            }
            ReckOnOutputs::Potentials { unit } => {
                self.values = answer.map(|potential| f32::from(potential) * unit);
            }
            ReckOnOutputs::Leaky { unit, keeps } => {
                let before = self.answer.into_iter().zip(answer);
                for ((value, keep), (before, answer)) in
                    self.values.iter_mut().zip(*keeps).zip(before)
                {
                    // The sums are even, so the bit that was lost when the potential was halved is the lowest bit of
                    // the answer before.
                    let sum = 2 * i32::from(answer) - i32::from(before & !1);
                    *value = *value * keep + sum as f32 * unit;
                }
            }
        }
    }
}
