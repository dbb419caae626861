//! Time steps of a network that `spikewire network` brought onto `ReckOn`: they take one or several ticks of the chip.

use embedded_hal::spi::SpiDevice;

use super::{Outcome, Outputs, ReckOnAnswer, ReckOnPort, ReckOnSample, ReckOnStep};
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
    ///
    /// **Limit:** the chip clips a potential to 16 bits, after each weight that it adds. A potential at the end of its
    /// range is reported as [`Clipped`](ChipError::Clipped). Weights of both signs in one tick can hide a clip: one weight
    /// brings the potential to the end of its range, and the next one away from it. The answer then shows no trace of
    /// it. This cannot occur while the potential is further from the end of its range than the sum of all weights of
    /// one sign that lead to the output, after the left shift. The driver does not report it: it cannot see which neurons
    /// fired, so that it would have to refuse every potential that is closer, most of which are right. Outputs that are
    /// [`Leaky`](Self::Leaky) cannot clip.
    Potentials {
        /// Value of 1 in an answer, in the units of the trained network.
        unit: f32,
    },
    /// The outputs are neurons that never fire, and whose leaks the chip's one leak for all outputs does not match. The
    /// chip only adds up the weights of each step; the driver adds these sums to potentials that leak.
    ///
    /// **Limit:** for each output, all of its weights that are above 0, after the left shift, may have a sum of up to
    /// 16 382, and so may those below 0. The chip clips a potential to 16 bits, and a potential reaches twice the sum.
    /// With a left shift of 1, 64 weights of 127 fit. A larger shift gains nothing, because the driver's sums are exact.
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
    /// Largest sum of an output's weights of one sign, after the left shift, for outputs that are
    /// [`Leaky`](Self::Leaky).
    pub const LEAKY_SUM: u16 = 16_382;
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

    /// Returns the values of the outputs after the last step, also after a step that ended in
    /// [`Clipped`](ChipError::Clipped).
    #[must_use]
    pub const fn values(&self) -> [f32; 16] {
        self.values
    }
}

impl ReckOnSteps<'_> {
    /// Returns an error unless the steps fit the network that was loaded. `input` and `output` are the numbers of the
    /// network's last input and last output.
    fn check<B, P>(
        &self,
        input: u8,
        output: u8,
        outputs: Option<Outputs>,
    ) -> Result<(), ChipError<B, P>> {
        let Some(Outputs { shift, keep, sum }) = outputs else {
            return Err(ChipError::OtherNetwork);
        };
        in_range("ticks", self.ticks.len().min(256) as i64, 1, 255)?;
        in_range("inputs of steps", self.inputs.into(), 0, i64::from(input).saturating_add(1))?;
        for tick in self.ticks {
            for other in tick.always.iter().chain(tick.raises) {
                in_range("input of a tick", (*other).into(), 0, input.into())?;
            }
        }
        match self.outputs {
            ReckOnOutputs::Spikes => {
                let (_, shift_of_spikes, keep_of_spikes) = ReckOnOutputs::SPIKES;
                exactly("shift of outputs", shift, shift_of_spikes)?;
                exactly("keep of outputs", keep, keep_of_spikes)
            }
            // A factor above 1 would let potentials wrap around.
            ReckOnOutputs::Potentials { .. } => in_range("keep of outputs", keep.into(), 1, 128),
            ReckOnOutputs::Leaky { keeps, .. } => {
                exactly("keep of outputs", keep, ReckOnOutputs::LEAKY_KEEP)?;
                in_range("shift of outputs", shift.into(), 1, 7)?;
                let count = i64::from(output).saturating_add(1);
                in_range("keeps", keeps.len().min(17) as i64, count, count)?;
                let sum = i64::from(sum) << (shift & 7);
                in_range("sum of output weights", sum, 0, ReckOnOutputs::LEAKY_SUM.into())
            }
        }
    }
}

fn exactly<B, P>(what: &'static str, value: u8, expected: u8) -> Result<(), ChipError<B, P>> {
    in_range(what, value.into(), expected.into(), expected.into())
}

impl Outputs {
    /// Returns the number of an output whose potential was at the end of its range before it leaked to its answer, or
    /// `None` if all answers are those of smaller potentials.
    fn clipped(self, answer: [i16; 16]) -> Option<u8> {
        let [least, most] =
            [i16::MIN, i16::MAX].map(|end| (i32::from(end) * i32::from(self.keep)) >> 7);
        for (output, answer) in (0..).zip(answer) {
            let answer = i32::from(answer);
            if answer <= least || answer >= most {
                return Some(output);
            }
        }
        None
    }
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
    /// Before anything is sent, returns [`OutOfRange`](ChipError::OutOfRange) if `steps` contradicts its own
    /// documentation or does not fit the network that was loaded, and [`OtherNetwork`](ChipError::OtherNetwork) if none
    /// was loaded after the last reset.
    ///
    /// Returns [`Clipped`](ChipError::Clipped) after a complete step in which an output's potential reached the end of
    /// its 16 bits: this output's value is wrong until the potential has decayed.
    /// [`values`](ReckOnStepsState::values) returns the values of all outputs. The next call goes on.
    ///
    /// Also returns an error if the network has no such input or if the settings do not answer in each step, and the
    /// errors of [`step`](Self::step). The step is then incomplete: begin a new sample, or reset the chip if the driver
    /// refuses that.
    pub fn run(
        &mut self,
        steps: &ReckOnSteps<'_>,
        state: &mut ReckOnStepsState,
        inputs: impl IntoIterator<Item = u16>,
    ) -> Outcome<[f32; 16], D, P> {
        let (sizes, outputs) = (self.chip.sizes, self.chip.outputs);
        steps.check(sizes.input, sizes.output, outputs)?;
        let count = steps.ticks.len();
        let mut clipped = None;
        for input in inputs {
            in_range("input", input.into(), 0, i64::from(steps.inputs) - 1)?;
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
            if steps.outputs != ReckOnOutputs::Spikes {
                clipped = clipped.or_else(|| outputs.and_then(|outputs| outputs.clipped(answer)));
            }
        }
        state.has_run = true;
        match clipped {
            Some(output) => Err(ChipError::Clipped { output }),
            None => Ok(state.values),
        }
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
