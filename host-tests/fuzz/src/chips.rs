//! Chips' drivers against junk: buses that answer anything, and fail now and then. A driver returns, and says that it
//! failed; it never waits for ever.

use std::cell::RefCell;
use std::num::NonZeroU32;
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use silicon::Board;
use silicon::board::CallFault;
use spikewire::Tick;
use spikewire_chips::{
    AerPort, Akd1500, ConvolutionEvent, DenseEvent, Describe, Input, InputBank, NetworkBytes, Odin,
    OdinChip, OdinInput, OdinRegisters, OdinSynapse, OutputSource, ReckOn, ReckOnOutputs,
    ReckOnPort, ReckOnSettings, ReckOnStep, ReckOnSteps, ReckOnStepsState, ReckOnTarget,
    ReckOnTick, Registers, Steps, StepsLayer, StepsState, TinyOdin, TinyOdinInput, TinyOdinNeuron,
    TinyOdinRegisters, Xylo, XyloMap,
};

use crate::script::Script;

/// More accesses of a bus than any call needs, so that a driver that never returns is noticed.
const MOST: usize = 40_000_000;

/// Every bus and port of a chip that answers what it likes.
#[derive(Clone)]
struct Junk(Rc<RefCell<State>>);

struct State {
    answers: Vec<u8>,
    at: usize,
    count: usize,
    /// An access in so many fails; 0: none.
    failing: usize,
    is_acknowledging: bool,
    is_polite: bool,
}

impl Junk {
    fn new(script: &mut Script) -> Self {
        let failing = usize::from(script.byte());
        let is_polite = script.below(2) == 0;
        let answers = script.rest().to_vec();
        let state = State { answers, at: 0, count: 0, failing, is_acknowledging: false, is_polite };
        Self(Rc::new(RefCell::new(state)))
    }

    /// The next answer, or a failure.
    fn next(&self) -> Result<u8, ErrorKind> {
        let mut state = self.0.borrow_mut();
        state.count += 1;
        assert!(state.count < MOST, "the driver does not return");
        if state.failing > 2 && state.count.is_multiple_of(state.failing) {
            return Err(ErrorKind::Other);
        }
        let answer = state.answers.get(state.at).copied().unwrap_or(0);
        state.at = if state.at + 1 < state.answers.len() { state.at + 1 } else { 0 };
        Ok(answer)
    }

    /// What a request is acknowledged with: politely as it is, or anything.
    fn line(&self) -> Result<bool, ErrorKind> {
        let answer = self.next()?;
        let state = self.0.borrow();
        Ok(if state.is_polite && answer != 0xFF { state.is_acknowledging } else { answer & 1 == 1 })
    }
}

impl ErrorType for Junk {
    type Error = ErrorKind;
}

impl SpiDevice for Junk {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        for operation in operations {
            match operation {
                Operation::Read(bytes)
                | Operation::Transfer(bytes, _)
                | Operation::TransferInPlace(bytes) => {
                    for byte in bytes.iter_mut() {
                        *byte = self.next()?;
                    }
                }
                Operation::Write(_) | Operation::DelayNs(_) => drop(self.next()?),
            }
        }
        Ok(())
    }
}

impl DelayNs for Junk {
    fn delay_ns(&mut self, _: u32) {}
}

impl AerPort for Junk {
    type Error = ErrorKind;

    fn set_input(&mut self, _: u32) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn set_input_request(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        self.0.borrow_mut().is_acknowledging = is_high;
        self.next().map(drop)
    }
    fn input_acknowledge(&mut self) -> Result<bool, ErrorKind> {
        self.line()
    }
    fn output_request(&mut self) -> Result<bool, ErrorKind> {
        Ok(self.next()? & 3 == 3)
    }
    fn output(&mut self) -> Result<u8, ErrorKind> {
        self.next()
    }
    fn set_output_acknowledge(&mut self, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn set_reset(&mut self, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
}

impl ReckOnPort for Junk {
    type Error = ErrorKind;

    fn set_input(&mut self, _: u8, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn set_input_request(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        self.0.borrow_mut().is_acknowledging = is_high;
        self.next().map(drop)
    }
    fn input_acknowledge(&mut self) -> Result<bool, ErrorKind> {
        self.line()
    }
    fn output_request(&mut self) -> Result<bool, ErrorKind> {
        Ok(self.next()? & 1 == 1)
    }
    fn output(&mut self) -> Result<u8, ErrorKind> {
        self.next()
    }
    fn set_output_acknowledge(&mut self, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn set_sample(&mut self, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn set_tick(&mut self, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn set_target_valid(&mut self, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn set_infer(&mut self, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn ready(&mut self) -> Result<bool, ErrorKind> {
        self.line()
    }
    fn set_reset(&mut self, _: bool) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
}

impl Registers for Junk {
    type Error = ErrorKind;

    fn write(&mut self, _: u16, _: u32) -> Result<(), ErrorKind> {
        self.next().map(drop)
    }
    fn read(&mut self, _: u16) -> Result<u32, ErrorKind> {
        Ok(u32::from_le_bytes([self.next()?, self.next()?, self.next()?, self.next()?]))
    }
}

/// A driver, of which the first byte chooses one, on a bus that answers with the rest.
pub fn junk(bytes: &[u8]) {
    let mut script = Script::new(bytes);
    match script.below(8) {
        0 => {
            let registers = TinyOdinRegisters {
                is_open_loop: script.below(2) == 0,
                output_source: OutputSource::Neurons,
                last_neuron: script.byte(),
            };
            let bus = Junk::new(&mut script);
            family(
                TinyOdin::new(bus.clone(), bus.clone(), 3),
                &bus,
                &registers,
                1,
                TinyOdinInput::DISABLED,
            );
        }
        1 => {
            let synapse = OdinSynapse { weight: script.byte() & 7, is_mapped: true };
            let bus = Junk::new(&mut script);
            let registers = OdinRegisters::PLAIN;
            family(
                Odin::new(bus.clone(), bus.clone(), 3),
                &bus,
                &registers,
                synapse,
                OdinInput::DISABLED,
            );
        }
        2 => reckon(&mut script),
        3 => {
            let mut chip = Akd1500::new(Junk::new(&mut script));
            let mut words = [0; 70];
            let _ = chip.program(0xFC00_0020, &words);
            let _ = chip.read(0xFC00_0020, &mut words);
            let _ = chip.write(4, &words);
        }
        4 => {
            let mut chip = Xylo::new(Junk::new(&mut script), XyloMap::a2(1), 3);
            for _ in 0..20 {
                let _ = chip.set_input(InputBank::First, [9; 16]);
                let _ = (chip.next_bank(), chip.set_next_input([3; 16]));
                let _ = (chip.step(), chip.clear_input());
            }
        }
        5 => {
            // A network as bytes, that came over a radio.
            let network = script.rest();
            let mut copy = vec![0; network.len() + 64];
            if let Ok(read) = NetworkBytes::<TinyOdinInput>::new(network)
                && let Ok(length) = NetworkBytes::<TinyOdinInput>::write(&read, &mut copy)
            {
                assert_eq!(&copy[..length], &network[..length], "written as it was read");
            }
            let _ = NetworkBytes::<OdinInput>::new(network);
        }
        6 => stepped(&mut script),
        _ => {
            let words = [script.word(), script.word()];
            let event = ConvolutionEvent::from_words(words);
            if let Ok(again) = event.words::<()>() {
                assert_eq!(ConvolutionEvent::from_words(again), event);
            }
            if let Some(event) = DenseEvent::from_words(words) {
                let again = event.words::<()>().expect("an event of the chip has words");
                assert_eq!(DenseEvent::from_words(again), Some(event));
            }
        }
    }
}

fn family<I: Input>(
    chip: OdinChip<I, Junk, Junk>,
    bus: &Junk,
    registers: &I::Registers,
    synapse: I::Synapse,
    neuron: I::Neuron,
) {
    let mut chip = chip.with_time_step(NonZeroU32::MIN);
    let mut fired = 0_u32;
    for _ in 0..3 {
        if let Ok(mut gated) = chip.reset(&mut bus.clone()) {
            let _ = gated.set_neuron(1, &neuron);
            let _ = gated.neuron(1).is_ok();
            let _ = gated.set_synapse(1, 2, synapse);
            let _ = gated.synapse(1, 2).is_ok();
            let _ = gated.neuron_byte(1, 2);
            if let Ok(mut running) = gated.run(registers) {
                let _ = running.send(I::LEAK_ALL, |_| fired += 1);
                let _ = running.poll(|_| fired += 1);
                let _ = running.advance(Tick::from(3), |_| fired += 1);
                let _ = running.gate(|_| fired += 1).is_ok();
            }
        }
        if let Ok(gated) = chip.gated() {
            let _ = gated.run(registers).is_ok();
        }
        if let Ok(mut running) = chip.running() {
            let _ = running.send(I::LEAK_ALL, |_| fired += 1);
            let _ = running.open_loop().is_ok();
        }
    }
}

/// A network of any weights, with as many neurons and rows as steps need.
struct Weights {
    neurons: u16,
    rows: u16,
    seed: u8,
}

impl Describe<TinyOdinInput> for Weights {
    fn neurons(&self) -> u16 {
        self.neurons
    }

    fn neuron(&self, neuron: u8) -> TinyOdinNeuron {
        let of = |factor: u8| neuron.wrapping_mul(factor).wrapping_add(self.seed);
        TinyOdinNeuron {
            threshold: 1 + u16::from(of(7)),
            leak: of(3) & 7,
            potential: -i16::from(of(5)),
            is_disabled: false,
        }
    }

    fn inputs(&self) -> u16 {
        self.rows
    }

    fn virtual_input(&self, _: u16) -> Option<(u8, i8)> {
        None
    }

    fn input_weight(&self, input: u16, post: u8) -> i8 {
        let bits = (input as u8).wrapping_mul(31) ^ post.wrapping_mul(17) ^ self.seed;
        (bits & 15) as i8 - 8
    }

    fn is_recurrent(&self) -> bool {
        false
    }

    fn weight(&self, _: u8, _: u8) -> i8 {
        0
    }

    fn output(&self, neuron: u8) -> Option<u16> {
        Some(neuron.into())
    }
}

/// Steps of any description, with the network that they need if it is small, or with another one, on the chip's model, whose
/// port fails now and then: junk never brings a chip to where it runs. A neuron fires once a step.
fn stepped(script: &mut Script) {
    let few = |script: &mut Script| -> Vec<u16> {
        let count = script.below(6);
        (0..count).map(|_| script.byte().into()).collect()
    };
    // Most networks are small enough to be loaded.
    let is_small = script.below(4) > 0;
    let size = |size: u16| if is_small { size & 3 } else { size };
    let mut layers = vec![];
    for neurons in few(script) {
        let loops = neurons & 1 == 1;
        layers.push(StepsLayer { neurons: size(neurons >> 1 << script.below(9)), loops });
    }
    let mut leaks: Vec<Vec<u16>> = (0..script.below(4)).map(|_| few(script)).collect();
    let rungs: u16 = script.byte().into();
    let mut lift: u16 = script.byte().into();
    if script.below(4) > 0 {
        // In their range and order, as steps must have them.
        lift %= rungs + 1;
        leaks.iter_mut().flatten().for_each(|leak| *leak %= rungs + 1);
        for list in &mut leaks {
            list.sort_unstable();
        }
    }
    let leaks: Vec<&[u16]> = leaks.iter().map(Vec::as_slice).collect();
    let steps = Steps {
        inputs: size(script.byte().into()),
        has_bias: script.below(2) == 0,
        rows: &few(script).into_iter().map(size).collect::<Vec<_>>(),
        layers: &layers,
        rungs,
        leaks: &leaks,
        lift,
        own_leaks: &few(script).into_iter().map(size).collect::<Vec<_>>(),
    };
    assert!(steps.first_rise() <= steps.all_rows(), "rows behind those of the sources");
    let neurons = steps
        .layers
        .iter()
        .fold(script.below(2) as u16, |sum, layer| sum.saturating_add(layer.neurons));
    let (neurons, rows, seed) = (neurons.clamp(1, 40), steps.all_rows().min(60), script.byte());
    let network = Weights { neurons, rows, seed };
    let registers = if script.below(8) > 0 {
        network.registers()
    } else {
        TinyOdinRegisters {
            is_open_loop: true,
            output_source: OutputSource::Neurons,
            last_neuron: script.byte() & 31,
        }
    };
    let recording = [few(script), few(script), few(script)];

    let board = Board::<silicon::TinyOdin>::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).expect("a chip that is reset");
    gated.load(&network, |_| ()).expect("a network that fits");
    let mut running = gated.run(&registers).expect("a chip that runs");
    let now = board.pins().calls;
    let fault = if script.below(2) == 0 { CallFault::Before } else { CallFault::After };
    let after = u64::from(script.word() >> (script.byte() & 31));
    board.pins().call_faults.push_back((now + after, fault));
    let mut state = StepsState::REST;
    for inputs in recording {
        let mut has_fired = [false; 256];
        let on_output = |neuron: u8| {
            let before = std::mem::replace(&mut has_fired[usize::from(neuron)], true);
            assert!(!before, "a neuron fires once a step");
        };
        if running.step(&steps, &mut state, inputs, on_output).is_err() {
            return;
        }
    }
}

fn reckon(script: &mut Script) {
    let ticks = [ReckOnTick { always: &[1, 2], raises: &[3] }; 8];
    let outputs = [
        ReckOnOutputs::Spikes,
        ReckOnOutputs::Potentials { unit: 0.5 },
        ReckOnOutputs::Leaky { unit: 0.5, keeps: &[0.5; 20] },
    ];
    let steps = ReckOnSteps {
        inputs: script.byte().into(),
        ticks: &ticks[..script.below(9)],
        late: script.byte().into(),
        outputs: outputs[script.below(3)],
    };
    let inputs = [script.byte().into(), u16::from(script.byte()) << script.below(9)];
    let bus = Junk::new(script);
    let mut chip = ReckOn::new(bus.clone(), bus.clone(), 3);
    for settings in [ReckOnSettings::POTENTIALS, ReckOnSettings::LABEL] {
        let Ok(mut programmed) = chip.reset(&mut bus.clone()) else { continue };
        let _ = (programmed.input_weight(1, 2), programmed.set_register(85, 3));
        let Ok(started) = programmed.run(&settings) else { continue };
        let Ok(mut sample) = started.begin() else { continue };
        for step in 0..4 {
            let _ = sample.send(step);
            let target = Some(ReckOnTarget::Label(1)).filter(|_| step > 1);
            let _ = sample.step(ReckOnStep { counts: true, target });
        }
        let mut state = ReckOnStepsState::REST;
        for _ in 0..3 {
            let _ = sample.run(&steps, &mut state, inputs);
        }
        let _ = sample.end().is_ok();
    }
    let _ = chip.started().is_ok();
}
