//! The state of a `ReckOn` whose memories can be accessed.

use embedded_hal::spi::SpiDevice;

use super::network::check;
use super::wire::Address;
use super::{
    DescribeReckOn, OPEN, Outcome, Outputs, ReckOn, ReckOnPair, ReckOnPort, ReckOnSettings,
    ReckOnShared, Sizes, Started, State,
};
use crate::error::{at_most, in_range};
use crate::{ChipError, Progress};

/// A `ReckOn` that has been reset and does not run yet: its memories can be accessed.
#[derive(Debug)]
pub struct Programmed<'a, D, P> {
    pub(super) chip: &'a mut ReckOn<D, P>,
}

/// Number of pairs of neurons in the chip.
const PAIRS: u16 = 128;

impl<'a, D: SpiDevice, P: ReckOnPort> Programmed<'a, D, P> {
    /// Writes a network, and sets all pairs of neurons that the network does not use to [`REST`](ReckOnPair::REST).
    /// Reads everything back. Calls `progress` after each pair and each row of weights.
    ///
    /// **Time:** two transfers of 8 bytes, a write and a read, for each 32-bit word. The pairs take 512 words, and four
    /// weights take one word. 256 inputs, 256 neurons and 16 outputs take 68 608 transfers, 4.4 s at an SCK of 1 MHz.
    ///
    /// # Errors
    /// Returns an error if the network does not fit; nothing was written then. Also returns an error if the bus failed,
    /// or if memory reads back a wrong value; then reset the chip, and load again.
    pub fn load(
        &mut self,
        network: &impl DescribeReckOn,
        mut progress: impl FnMut(Progress),
    ) -> Outcome<(), D, P> {
        check::<D::Error, P::Error>(network)?;
        let half = words(network);
        let total = half.wrapping_mul(2);
        let chip = &mut *self.chip;
        each_word(
            network,
            |address, word| chip.write(address, word),
            |done| progress(Progress { done, total }),
        )?;
        chip.check_sync()?;
        each_word(
            network,
            |address, word| chip.expect(address, word),
            |done| progress(Progress { done: half.wrapping_add(done), total }),
        )?;
        chip.check_sync()?;
        chip.sizes = sizes(network);
        chip.outputs = None;
        let shared = network.shared();
        for (register, shift) in (12..).zip(shared.shifts) {
            self.set_register(register, shift.into())?;
        }
        self.set_register(8, shared.resets_to_zero.into())?;
        self.set_register(69, shared.keep.into())?;
        let Sizes { input, neuron, output } = self.chip.sizes;
        for (register, last) in (94..).zip([input, neuron, output]) {
            self.set_register(register, last.into())?;
        }
        for register in 0..4 {
            let pairs = (0..32).filter(|&bit| pair(network, register * 32 + bit).keep >> 15 == 1);
            let bits = pairs.fold(0_u32, |bits, bit| bits | 1 << bit);
            self.set_register(register.wrapping_add(65), bits)?;
        }
        self.chip.outputs = Some(outputs(network));
        Ok(())
    }

    /// Compares the chip's memories with a network, including weights that learning may have changed.
    ///
    /// # Errors
    /// Returns an error if the network does not fit or the bus failed. Returns [`ReadBack`](ChipError::ReadBack) at the
    /// first difference; then reset the chip.
    pub fn verify(&mut self, network: &impl DescribeReckOn) -> Outcome<(), D, P> {
        check::<D::Error, P::Error>(network)?;
        let chip = &mut *self.chip;
        each_word(
            network,
            // Quarters 0 to 2 hold potentials and traces, which change as the network runs.
            |address, word| match address.0 >> 28 {
                1 if address.0 & 3 != 3 => Ok(()),
                1 => match chip.read(address)? {
                    read if (read ^ word) >> 4 == 0 => Ok(()),
                    read => {
                        let error = ChipError::ReadBack { address: address.0, written: word, read };
                        chip.heed(Err(error))
                    }
                },
                _ => chip.expect(address, word),
            },
            |_| (),
        )?;
        chip.check_sync()
    }

    /// Reads the weight from an input to a neuron. Learning may have changed this weight.
    ///
    /// # Errors
    /// Returns an error if the bus failed or is out of sync: then reset the chip.
    pub fn input_weight(&mut self, input: u8, neuron: u8) -> Outcome<i8, D, P> {
        self.weight(Address::input(input.into()), neuron)
    }

    /// Reads the weight from neuron `from` to neuron `to`.
    ///
    /// # Errors
    /// See [`input_weight`](Self::input_weight).
    pub fn recurrent_weight(&mut self, from: u8, to: u8) -> Outcome<i8, D, P> {
        self.weight(Address::recurrent(from.into()), to)
    }

    /// Reads the weight from a neuron to an output.
    ///
    /// # Errors
    /// Returns an error if `output` is above 15, and the errors of [`input_weight`](Self::input_weight).
    pub fn output_weight(&mut self, neuron: u8, output: u8) -> Outcome<i8, D, P> {
        at_most("output", output.into(), 15)?;
        self.weight(Address::output(neuron.into()), output)
    }

    fn weight(&mut self, row: Address, at: u8) -> Outcome<i8, D, P> {
        let address = row.next(u16::from(at >> 2));
        let word = self.chip.read(address)?;
        self.chip.check_sync()?;
        self.chip.expect(address, word)?;
        // If the bus was out of sync, `expect` may have read a 0 that equals the weight, and may have written to
        // memory.
        self.chip.check_sync()?;
        Ok((word >> (8 * u32::from(at & 3))) as i8)
    }

    /// Writes a register that neither [`ReckOnSettings`] nor the network sets, and checks that chip and bus are still
    /// in sync. Register 0, which opens the memories, is reserved for the driver.
    ///
    /// # Errors
    /// Returns an error if `register` is not in 1 to 104. Also returns an error if the bus failed or is out of sync;
    /// then reset the chip.
    pub fn set_register(&mut self, register: u16, value: u32) -> Outcome<(), D, P> {
        in_range("register", register.into(), 1, 104)?;
        self.configure(register, value)
    }

    fn configure(&mut self, register: u16, value: u32) -> Outcome<(), D, P> {
        self.chip.expect_programmed()?;
        let result = self.chip.wire.configure(register, value);
        self.chip.heed_bus(result)?;
        self.chip.check_sync()
    }

    /// Writes the registers and lets the chip run. Then checks that the chip has closed its memories: a read of any
    /// address must then return the word that was last read while the memories were open.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range; nothing was changed then. Also returns an error if the bus
    /// failed or is out of sync, or if the memories are still open; then reset the chip.
    pub fn run(mut self, settings: &ReckOnSettings) -> Outcome<Started<'a, D, P>, D, P> {
        check_settings::<D::Error, P::Error>(settings)?;
        let answers = settings.answers;
        // The values make a step that comes too early stop the chip, make the ready pin say ready, and keep MISO for
        // SPI alone. They also make the chip send an answer in each step, which proves the step even where the ready
        // pin is read too rarely to be seen low.
        let fixed = [(3, 0), (10, 0), (11, 1), (23, 0), (30, 1)];
        let chosen = [
            (25, u32::from(settings.task == super::ReckOnTask::Regression)),
            (26, u32::from(settings.task == super::ReckOnTask::Classification)),
            (31, u32::from(answers.is_label())),
        ];
        for (register, value) in fixed.into_iter().chain(chosen) {
            self.configure(register, value)?;
        }
        let learns = settings.learning.map_or([false; 3], |learning| learning.learns);
        if let Some(learning) = &settings.learning {
            self.learn(learning)?;
        }
        let learns = learns.into_iter().rev().fold(0, |bits, is| bits << 1 | u32::from(is));
        self.configure(9, learns)?;

        let chip = self.chip;
        let anchor = Address::anchor();
        let open = chip.read(anchor)?;
        let result = chip.wire.configure(OPEN, 0);
        chip.heed_bus(result)?;
        // While its memories are closed, the chip ignores the write, and the read returns the last word read.
        let result = chip.wire.write(anchor, !open).and_then(|()| chip.wire.read(anchor));
        let read = chip.heed_bus(result)?;
        if read != open {
            return chip.heed(Err(ChipError::NotStarted));
        }
        chip.settings = *settings;
        chip.state = State::Started;
        Ok(Started { chip })
    }

    fn learn(&mut self, learning: &super::ReckOnLearning) -> Outcome<(), D, P> {
        let traces = (15..18).zip(learning.traces.map(u32::from));
        let thresholds = (70..74).zip(learning.thresholds.map(|at| u32::from(at as u16)));
        let slopes = (74..79).zip(learning.slopes.map(|slope| u32::from(slope as u8 & 31)));
        let others = [(18, learning.signal.into()), (27, learning.is_linear.into())];
        let all = traces.chain(thresholds).chain(slopes).chain(others);
        for (register, value) in all {
            self.configure(register, value)?;
        }
        let rates = learning.rates.into_iter().flat_map(|(right, left)| [right, left]);
        for (register, rate) in (79..85).zip(rates) {
            self.configure(register, rate.into())?;
        }
        Ok(())
    }
}

fn check_settings<B, X>(settings: &ReckOnSettings) -> Result<(), ChipError<B, X>> {
    let is_regression = settings.task == super::ReckOnTask::Regression;
    at_most("label of a regression", (settings.answers.is_label() && is_regression).into(), 0)?;
    let Some(learning) = &settings.learning else { return Ok(()) };
    at_most("signal", learning.signal.into(), 15)?;
    for trace in learning.traces {
        at_most("trace", trace.into(), 7)?;
    }
    for slope in learning.slopes {
        in_range("slope", slope.into(), -16, 15)?;
    }
    for (right, left) in learning.rates {
        at_most("rate", right.into(), 31)?;
        at_most("rate", left.into(), 31)?;
    }
    Ok(())
}

fn sizes(network: &impl DescribeReckOn) -> Sizes {
    let last = |count: u16| count.saturating_sub(1) as u8;
    Sizes {
        input: last(network.inputs()),
        // The chip processes pairs: with an even last number it would leave out the first neuron of the last pair.
        neuron: last(network.neurons()) | 1,
        output: last(network.outputs()),
    }
}

fn outputs(network: &impl DescribeReckOn) -> Outputs {
    let ReckOnShared { shifts: [.., shift], keep, .. } = network.shared();
    let mut sum = 0_u16;
    for output in 0..network.outputs() {
        // 256 weights of -128 have the sum -32 768: the sums fit 16 bits without their sign.
        let [mut rises, mut falls] = [0_u16; 2];
        for neuron in 0..network.neurons() {
            let weight = network.output_weight(neuron, output);
            let side = if weight > 0 { &mut rises } else { &mut falls };
            *side = side.saturating_add(weight.unsigned_abs().into());
        }
        sum = sum.max(rises).max(falls);
    }
    Outputs { shift, keep, sum }
}

fn pair(network: &impl DescribeReckOn, pair: u16) -> ReckOnPair {
    if pair < network.neurons().div_ceil(2) { network.pair(pair) } else { ReckOnPair::REST }
}

/// Returns the number of words that [`each_word`] visits.
fn words(network: &impl DescribeReckOn) -> u32 {
    let rows = u32::from(network.inputs()) + 256;
    let row = u32::from(network.neurons().div_ceil(4));
    let outputs = 256 * u32::from(network.outputs().div_ceil(4));
    // The sum is below 2³¹ for any network that fits, so it cannot wrap.
    rows.wrapping_mul(row).wrapping_add(outputs).wrapping_add(4 * u32::from(PAIRS))
}

/// Calls `visit` with the address and the value of every 32-bit word that the network needs in the chip's memories.
/// Calls `progress` with the number of words visited so far.
fn each_word<B, X>(
    network: &impl DescribeReckOn,
    mut visit: impl FnMut(Address, u32) -> Result<(), ChipError<B, X>>,
    mut progress: impl FnMut(u32),
) -> Result<(), ChipError<B, X>> {
    let mut done = 0_u32;
    for at in 0..PAIRS {
        let ReckOnPair { keep, threshold } = pair(network, at);
        let (keep, threshold) = (u32::from(keep & 0xFFF), u32::from(threshold as u16));
        for (quarter, word) in (0..).zip([0, 0, 0, keep << 20 | threshold << 4]) {
            visit(Address::pair(at, quarter), word)?;
            done = done.wrapping_add(1);
        }
        progress(done);
    }
    let neurons = network.neurons();
    let mut row = |row: Address, length: u16, weight: &dyn Fn(u16) -> i8| {
        for word in 0..length.div_ceil(4) {
            let weights = [0, 1, 2, 3].map(|at| {
                let at = word.wrapping_mul(4).wrapping_add(at);
                if at < length { weight(at) as u8 } else { 0 }
            });
            visit(row.next(word), u32::from_le_bytes(weights))?;
            done = done.wrapping_add(1);
        }
        progress(done);
        Ok::<(), ChipError<B, X>>(())
    };
    for input in 0..network.inputs() {
        row(Address::input(input), neurons, &|neuron| network.input_weight(input, neuron))?;
    }
    // Clears the rows of unused neurons, too: they do not fire, but the network does not depend on that.
    for from in 0..256 {
        let is_own = from < neurons;
        let weight = |to| if is_own { network.recurrent_weight(from, to) } else { 0 };
        row(Address::recurrent(from), neurons, &weight)?;
    }
    for from in 0..256 {
        let is_own = from < neurons;
        let weight = |output| if is_own { network.output_weight(from, output) } else { 0 };
        row(Address::output(from), network.outputs(), &weight)?;
    }
    Ok(())
}
