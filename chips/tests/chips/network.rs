//! Tests of networks on the models of tinyODIN and ODIN: described, loaded, verified, run on a recorded flight, and
//! decoded.

use std::num::NonZeroU32;

use proptest::prelude::*;
use silicon::board::ClockFault;
use silicon::chip::{Drive, Registers};
use silicon::{Board, Kind};
use spikewire::population::Position;
use spikewire::temporal::StepForward;
use spikewire::{
    Bank, Event, EventQueue, FromEvents, Overflow, Polarity, Readout, Scheme, Source, Tick,
};
use spikewire_chips::{
    ChipError, Describe, FormatError, Input, Inputs, NetworkBytes, Odin, OdinInput, OdinNetwork,
    OdinNeuron, Spikes, TinyOdin, TinyOdinInput, TinyOdinNetwork, TinyOdinNeuron, neurons_from,
};

type TinyBoard = Board<silicon::TinyOdin>;

static RATE: Position<f32, 64> = Position::linear(-8.0..=8.0);

static NETWORK: TinyOdinNetwork<64, 64, 64> = TinyOdinNetwork {
    neurons: [TinyOdinNeuron { threshold: 7, leak: 3, ..TinyOdinNeuron::REST }; 64],
    inputs: Inputs::one_to_one(7),
    recurrent: &[],
    outputs: neurons_from::<0, 64>(),
};

fn tiny(
    board: &TinyBoard,
) -> TinyOdin<silicon::Spi<silicon::TinyOdin>, silicon::Port<silicon::TinyOdin>> {
    TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS)
}

/// Each neuron fires at each event of its own input, so that the outputs are the events of the encoder.
#[test]
fn a_network_of_64_neurons_flies() {
    let board = TinyBoard::new(16, 1);
    let mut chip = tiny(&board).with_time_step(NonZeroU32::new(1_000).unwrap());
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&NETWORK, |_| ()).unwrap();
    gated.verify(&NETWORK, |_| ()).unwrap();
    let mut running = gated.run(&NETWORK.registers()).unwrap();
    let mut bank = Bank::<_, 1>::new(&RATE);
    let mut readout = Readout::<_, 1>::new(&RATE);
    let mut direct = RATE.decoder();
    for sample in crate::flight().take(1_000) {
        let (now, rate) = (Tick::from(sample.micros), sample.channels[0]);
        let mut inputs = Vec::new();
        bank.encode(now, [rate], |event| inputs.push(event));
        let mut spikes = Spikes::<64>::new();
        let mut answers = NETWORK.answers(now, |event| spikes.push(event));
        let to_input = |event: Event| NETWORK.input(event.address).unwrap();
        running.feed(FromEvents(inputs.into_iter()), to_input, &mut answers).unwrap();
        running.quiesce(&mut answers).unwrap();
        drop(answers);
        let [value] = readout.decode(now, spikes.as_slice());
        assert_eq!(value, direct.decode(RATE.encoder().encode(rate)), "{now:?}");
        assert!((value - rate).abs() <= 0.5 * 16.0 / 62.0 + 1e-5, "{rate} came back as {value}");
    }
    assert_eq!(running.counters().skipped_steps, 0);
}

#[test]
fn a_network_is_described_neuron_by_neuron() {
    assert_eq!(neurons_from::<7, 3>(), [7, 8, 9]);
    let wide = Inputs::Rows([[5, 0, 0], [0, 5, 0]]);
    assert_eq!(Inputs::<2, 3>::one_to_one(5), wide);
    let tall = Inputs::Rows([[5, 0], [0, 5], [0, 0]]);
    assert_eq!(Inputs::<3, 2>::one_to_one(5), tall, "the last drives none");
}

/// A signed code such as [`StepForward`] takes two inputs for each address, one for each polarity. A code without signs
/// takes one input for each address.
#[test]
fn events_find_their_inputs() {
    let step = StepForward::<f32>::new(1.0);
    let at = |address, polarity| Event { tick: 0.into(), address, polarity };
    for (address, polarity, input) in
        [(2, Polarity::Up, 4), (2, Polarity::Down, 5), (31, Polarity::Down, 63)]
    {
        let found = NETWORK.input_for(&step, at(address, polarity));
        assert!(found.is_some() && found == NETWORK.input(input));
    }
    assert_eq!(NETWORK.input_for(&step, at(32, Polarity::Up)), None);
    let found = NETWORK.input_for(&RATE, at(5, Polarity::Up));
    assert!(found.is_some() && found == NETWORK.input(5));
}

#[test]
fn answers_go_into_a_queue() {
    static ANSWERS: EventQueue<16> = EventQueue::new(Overflow::DropNewest);
    let board = TinyBoard::new(8, 1);
    let mut chip = tiny(&board);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&NETWORK, |_| ()).unwrap();
    let mut running = gated.run(&NETWORK.registers()).unwrap();
    for input in [63, 0] {
        let mut answers = NETWORK.answers(1_234.into(), |event| _ = ANSWERS.push(event));
        running.send(NETWORK.input(input).unwrap(), &mut answers).unwrap();
        running.quiesce(&mut answers).unwrap();
    }
    let answer = |address| Event { tick: 1_234.into(), address, polarity: Polarity::Up };
    let mut answers = ANSWERS.consumer().unwrap();
    let taken = [answers.take_event(), answers.take_event()];
    assert_eq!(taken, [Some(answer(63)), Some(answer(0))]);
}

#[test]
fn loading_tells_how_far_it_is_and_takes_as_long_as_it_says() {
    // The bytes are those of 64 neurons, one for each of 192 disabled neurons, and 64 rows; each byte is written and
    // read.
    let board = TinyBoard::new(4, 1);
    let mut chip = tiny(&board);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    let before = board.pins().spi_clocks;
    let mut seen = vec![];
    gated.load(&NETWORK, |progress| seen.push((progress.done, progress.total))).unwrap();
    let frames = (board.pins().spi_clocks - before) / 40;
    let total = 2 * (64 * 4 + 192 + 64 * 32);
    assert_eq!(u64::from(total) + 10, frames, "and two checks of the step");
    assert_eq!((seen.first(), seen.last()), (Some(&(4, total)), Some(&(total, total))));
    assert!(seen.is_sorted());
    // The documentation of `load` gives this number of frames for a network that fills tinyODIN.
    assert_eq!(2 * (256 * 4 + 256 * 128), 67_584);
}

#[test]
fn the_neurons_that_are_not_the_networks_are_disabled_and_keep_the_rest() {
    let board = TinyBoard::new(8, 1);
    board.pins().chip.neurons.fill(0x5512_3456);
    board.pins().chip.synapses.fill(0x7777_7777);
    let network = TinyOdinNetwork::<1, 3, 1> {
        neurons: [TinyOdinNeuron::REST; 3],
        inputs: Inputs::Rows([[1, -8, 7]]),
        recurrent: &[],
        outputs: [2],
    };
    let mut chip = tiny(&board);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&network, |_| ()).unwrap();
    assert_eq!(gated.neuron(2), Ok(TinyOdinNeuron::REST));
    assert_eq!((gated.synapse(0, 1), gated.synapse(0, 3)), (Ok(-8), Ok(7)));
    let pins = board.pins();
    assert!(pins.chip.neurons[3..].iter().all(|&neuron| neuron == 0xD512_3456));
    assert_eq!(pins.chip.synapses[0], 0x7777_7781 & !0xF00 | 0x700);
}

#[test]
fn loading_with_a_fault_is_an_error_or_right() {
    let network = TinyOdinNetwork::<2, 2, 2> {
        neurons: [TinyOdinNeuron { potential: -3, ..TinyOdinNeuron::REST }; 2],
        inputs: Inputs::Rows([[0, 0], [5, -6]]),
        recurrent: &[],
        outputs: [0, 1],
    };
    let load = |at, fault| {
        let board = TinyBoard::new(4, 1);
        let mut chip = tiny(&board);
        let mut gated = chip.reset(&mut board.clone()).unwrap();
        let start = board.pins().spi_clocks;
        board.pins().clock_faults.push_back((start + at, fault));
        let result = gated.load(&network, |_| ());
        let pins = board.pins();
        let memories = (pins.chip.neurons.clone(), pins.chip.synapses.clone());
        (result.map(|()| memories), pins.spi_clocks - start)
    };
    let (memories, clocks) = load(u64::MAX >> 1, ClockFault::Lost);
    let mut noticed = 0;
    let at = (0..clocks - 200).step_by(499).chain(clocks - 200..clocks);
    for at in at.clone() {
        for fault in [ClockFault::Lost, ClockFault::Doubled] {
            match load(at, fault).0 {
                Ok(loaded) => assert_eq!(Ok(loaded), memories, "{fault:?} at {at} of {clocks}"),
                Err(_) => noticed += 1,
            }
        }
    }
    // A fault in the last frame, after which nothing is read, shows at the next call.
    assert!(noticed > 2 * at.count() - 100, "{noticed}");
}

#[test]
fn a_network_that_does_not_fit_is_refused_before_a_byte_is_written() {
    let network = TinyOdinNetwork::<1, 2, 1> {
        neurons: [TinyOdinNeuron::REST; 2],
        inputs: Inputs::Rows([[7, 7]]),
        recurrent: &[],
        outputs: [0],
    };
    let refused = |network: &TinyOdinNetwork<1, 2, 1>| {
        let board = TinyBoard::new(4, 1);
        let mut chip = tiny(&board);
        let mut gated = chip.reset(&mut board.clone()).unwrap();
        let before = board.pins().spi_clocks;
        let error = gated.load(network, |_| ()).unwrap_err();
        assert_eq!(board.pins().spi_clocks, before);
        error
    };
    let wrong = TinyOdinNetwork { inputs: Inputs::Rows([[7, 8]]), ..network };
    assert!(matches!(refused(&wrong), ChipError::OutOfRange { what: "weight", value: 8, .. }));
    let wrong = TinyOdinNetwork { inputs: Inputs::Virtual([(16, 1)]), ..network };
    assert!(matches!(refused(&wrong), ChipError::OutOfRange { what: "neuron", .. }));
    let wrong = TinyOdinNetwork { inputs: Inputs::Virtual([(1, 0)]), ..network };
    assert_eq!(refused(&wrong), ChipError::ZeroWeight);
    let deaf = TinyOdinNeuron { threshold: 2048, ..TinyOdinNeuron::REST };
    let wrong = TinyOdinNetwork { neurons: [deaf; 2], ..network };
    assert!(matches!(refused(&wrong), ChipError::OutOfRange { what: "threshold", .. }));

    let board = TinyBoard::new(4, 1);
    let mut chip = tiny(&board);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    let wide = TinyOdinNetwork::<255, 2, 1> {
        neurons: [TinyOdinNeuron::REST; 2],
        inputs: Inputs::Rows([[1; 2]; 255]),
        recurrent: &[[0; 2]; 2],
        outputs: [0],
    };
    let error = gated.load(&wide, |_| ()).unwrap_err();
    assert!(matches!(error, ChipError::OutOfRange { what: "rows of synapses", value: 257, .. }));

    let board = Board::<silicon::Odin>::new(4, 1);
    let mut chip = Odin::new(board.spi(), board.port(), 1_600);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    let mixed = OdinNetwork::<2, 2, 1> {
        neurons: [OdinNeuron::REST; 2],
        inputs: Inputs::Rows([[1, 0], [1, -1]]),
        recurrent: &[],
        outputs: [0],
    };
    assert_eq!(gated.load(&mixed, |_| ()), Err(ChipError::MixedSigns { pre: 1 }));
}

#[test]
fn a_network_may_have_all_neurons_of_the_chip() {
    let board = TinyBoard::new(4, 1);
    let mut chip = tiny(&board);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    let network = TinyOdinNetwork::<1, 256, 1> {
        neurons: [TinyOdinNeuron::REST; 256],
        inputs: Inputs::Rows([[1; 256]]),
        recurrent: &[],
        outputs: [255],
    };
    assert_eq!(gated.load(&network, |_| ()), Ok(()));
}

/// The error contains the address of the first difference in the chip's memory, and the bits that the network has
/// there.
#[test]
fn verify_reports_the_first_difference() {
    let board = TinyBoard::new(4, 1);
    let mut chip = tiny(&board);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&NETWORK, |_| ()).unwrap();
    for (neuron, bits, address, written, read) in
        [(200, 0x7F00_0000, 0x1_03C8, 0x80, 0), (5, 0x0300_F000, 0x1_0105, 0x70, 0xF0)]
    {
        board.pins().chip.neurons[neuron] = bits;
        let error = gated.verify(&NETWORK, |_| ()).unwrap_err();
        assert_eq!(error, ChipError::ReadBack { address, written, read });
        gated = chip.reset(&mut board.clone()).unwrap();
    }
}

/// The network has two neurons: an input drives the first, which drives the second, which inhibits the first.
#[test]
fn a_recurrent_network_runs_in_closed_loop_on_either_chip() {
    let board = TinyBoard::new(8, 1);
    let network = TinyOdinNetwork::<1, 2, 1> {
        neurons: [TinyOdinNeuron { threshold: 5, ..TinyOdinNeuron::REST }; 2],
        inputs: Inputs::Rows([[5, 0]]),
        recurrent: &[[0, 5], [-4, 0]],
        outputs: [1],
    };
    assert_eq!(network.input(0), Some(TinyOdinInput::Spike { pre: 2 }), "behind the neurons' rows");
    assert_eq!(network.input(1), None);
    let mut chip = tiny(&board);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&network, |_| ()).unwrap();
    let mut running = gated.run(&network.registers()).unwrap();
    let mut answers = Spikes::<4>::new();
    let mut on_output = network.answers(7.into(), |event| answers.push(event));
    running.send(network.input(0).unwrap(), &mut on_output).unwrap();
    let mut gated = running.gate(&mut on_output).unwrap();
    drop(on_output);
    assert_eq!(answers.as_slice(), [Event { tick: 7.into(), address: 0, polarity: Polarity::Up }]);
    assert_eq!(board.pins().chip.fired, [0, 1]);
    assert_eq!(gated.neuron(0).unwrap().potential, -4);

    let board = Board::<silicon::Odin>::new(8, 1);
    let network = OdinNetwork::<1, 2, 1> {
        neurons: [OdinNeuron { threshold: 5, potential: 2, ..OdinNeuron::REST }; 2],
        inputs: Inputs::Rows([[5, 0]]),
        recurrent: &[[0, 5], [-4, 0]],
        outputs: [1],
    };
    let mut chip = Odin::new(board.spi(), board.port(), OdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&network, |_| ()).unwrap();
    gated.verify(&network, |_| ()).unwrap();
    assert_eq!(network.registers().inhibitory[0], 0b10);
    let mut running = gated.run(&network.registers()).unwrap();
    running.send(network.input(0).unwrap(), drop).unwrap();
    let mut gated = running.gate(drop).unwrap();
    assert_eq!(board.pins().chip.fired, [0, 1]);
    let potentials = [0, 1].map(|neuron| gated.neuron(neuron).unwrap().potential);
    assert_eq!(potentials, [0, 0], "inhibition stops at 0");
}

fn network(
    weights: &[i8],
    thresholds: &[u16],
    is_virtual: bool,
    is_recurrent: bool,
) -> TinyOdinNetwork<4, 7, 3> {
    static RECURRENT: [[i8; 7]; 7] = [[1, -2, 3, -4, 5, -6, 7]; 7];
    let at = |n: usize| weights[n % weights.len()];
    TinyOdinNetwork {
        neurons: std::array::from_fn(|n| TinyOdinNeuron {
            threshold: thresholds[n % thresholds.len()],
            leak: n as u8,
            potential: -5,
            is_disabled: n == 3,
        }),
        inputs: if is_virtual {
            Inputs::Virtual(std::array::from_fn(|n| (n as u8, at(n).max(1))))
        } else {
            Inputs::Rows(std::array::from_fn(|row| std::array::from_fn(|n| at(7 * row + n))))
        },
        recurrent: if is_recurrent { &RECURRENT } else { &[] },
        outputs: [6, 1, 4],
    }
}

/// Writing a network as bytes must fail if the bytes would not give the same network when read.
#[test]
fn a_network_that_bytes_cannot_hold_is_not_written() {
    let network = network(&[3], &[50], true, false);
    let written = |network: &TinyOdinNetwork<4, 7, 3>| {
        NetworkBytes::<TinyOdinInput>::write(network, &mut [0; 200])
    };
    assert!(written(&network).is_ok());
    // A neuron cannot be two outputs, and neuron 7 is not part of the network.
    for outputs in [[6, 6, 4], [6, 7, 4], [7, 6, 4]] {
        assert_eq!(written(&TinyOdinNetwork { outputs, ..network }), Err(FormatError::Value));
    }
    // A weight of 0 would act as a full spike; only the first 16 neurons take virtual events.
    for virtual_input in [(0, 0), (0, 8), (16, 1)] {
        let inputs = Inputs::Virtual([virtual_input; 4]);
        assert_eq!(written(&TinyOdinNetwork { inputs, ..network }), Err(FormatError::Value));
    }
    // ODIN has weights of three bits and a sign: -8 does not fit.
    let odin = |weight| OdinNetwork::<1, 1, 1> {
        neurons: [OdinNeuron::REST],
        inputs: Inputs::Rows([[weight]]),
        recurrent: &[],
        outputs: [0],
    };
    let write = |weight| NetworkBytes::<OdinInput>::write(&odin(weight), &mut [0; 200]);
    assert!(write(-7).is_ok());
    assert_eq!(write(-8), Err(FormatError::Value));
}

proptest! {
    #![proptest_config(crate::cases(48))]

    #[test]
    fn bytes_are_the_same_network(
        weights in prop::collection::vec(-8..=7_i8, 1..28),
        thresholds in prop::collection::vec(1..=2047_u16, 1..7),
        is_virtual in any::<bool>(),
        is_recurrent in any::<bool>(),
    ) {
        let network = network(&weights, &thresholds, is_virtual, is_recurrent);
        let mut buffer = [0; 200];
        let length = NetworkBytes::write(&network, &mut buffer).unwrap();
        let bytes = NetworkBytes::<TinyOdinInput>::new(&buffer[..length]).unwrap();
        prop_assert_eq!(bytes.registers(), network.registers());
        for input in 0..5 {
            prop_assert_eq!(bytes.input(input), network.input(input));
        }
        for neuron in 0..=255 {
            prop_assert_eq!(bytes.output(neuron), network.output(neuron));
        }
        let load = |network: &dyn Fn(&mut TinyBoard)| {
            let mut board = TinyBoard::new(4, 1);
            network(&mut board);
            let pins = board.pins();
            (pins.chip.neurons.clone(), pins.chip.synapses.clone())
        };
        let one = load(&|board| {
            let mut chip = tiny(board);
            chip.reset(&mut board.clone()).unwrap().load(&network, |_| ()).unwrap();
        });
        let other = load(&|board| {
            let mut chip = tiny(board);
            let mut gated = chip.reset(&mut board.clone()).unwrap();
            gated.load(&bytes, |_| ()).unwrap();
            gated.verify(&network, |_| ()).unwrap();
        });
        prop_assert_eq!(one, other);
    }

    #[test]
    fn no_bytes_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..100), is_headed in any::<bool>()) {
        if is_headed && bytes.len() > 12 {
            bytes[..5].copy_from_slice(b"SWN1\x01");
            bytes[5] &= 3;
            for at in [7, 9, 11] {
                bytes[at] = 0;
            }
        }
        if let Ok(network) = NetworkBytes::<TinyOdinInput>::new(&bytes) {
            let board = TinyBoard::new(4, 1);
            let mut chip = tiny(&board);
            let _ = chip.reset(&mut board.clone()).unwrap().load(&network, |_| ());
        }
    }
}

/// A reference model of ODIN, without queue and timing. It applies each input to the neurons one after the other.
#[derive(Clone, Debug)]
struct Twin {
    neurons: Vec<u128>,
    synapses: Vec<u32>,
    registers: Registers,
    fired: Vec<u8>,
}

impl Twin {
    fn act(&mut self, neuron: u8, pre: u8, is_leak: bool, virtual_bits: u8) {
        let word = self.synapses[usize::from(pre) << 5 | usize::from(neuron) >> 3];
        let synapse = (word >> (4 * (neuron & 7)) & 0xF) as u8;
        let drive = Drive { is_event: true, is_leak, virtual_bits, synapse, pre };
        let place = &mut self.neurons[usize::from(neuron)];
        let old = *place;
        let (next, fires) = silicon::Odin::update(old, drive, &self.registers);
        *place = next;
        if fires && !silicon::Odin::is_disabled(old) {
            self.fired.push(neuron);
        }
    }

    fn take(&mut self, input: OdinInput) {
        match input {
            OdinInput::Synapse { pre, post } => self.act(post, pre, false, 0),
            OdinInput::Spike { pre } => (0..=255).for_each(|post| self.act(post, pre, false, 0)),
            OdinInput::Virtual { neuron, weight, is_inhibitory } => {
                self.act(neuron, 0, false, weight << 2 | u8::from(is_inhibitory) << 1);
            }
            OdinInput::VirtualLeak { neuron } => self.act(neuron, 0, false, 1),
            OdinInput::Leak { neuron } => self.act(neuron, 0, true, 0),
            OdinInput::LeakAll => (0..=255).for_each(|neuron| self.act(neuron, 0, true, 0)),
            OdinInput::Bistability { .. } | OdinInput::BistabilityAll => {}
        }
    }
}

fn odin_input() -> impl Strategy<Value = OdinInput> {
    let neuron = 0..8_u8;
    prop_oneof![
        (0..3_u8, neuron.clone()).prop_map(|(pre, post)| OdinInput::Synapse { pre, post }),
        (0..3_u8).prop_map(|pre| OdinInput::Spike { pre }),
        (neuron.clone(), 1..8_u8, any::<bool>()).prop_map(|(neuron, weight, is_inhibitory)| {
            OdinInput::Virtual { neuron, weight, is_inhibitory }
        }),
        neuron.clone().prop_map(|neuron| OdinInput::VirtualLeak { neuron }),
        neuron.prop_map(|neuron| OdinInput::Leak { neuron }),
        Just(OdinInput::LeakAll),
    ]
}

proptest! {
    #![proptest_config(crate::cases(24))]

    #[test]
    fn odin_ends_every_flight_as_its_words_say(
        thresholds in prop::collection::vec((1..=20_u8, 0..4_u8, any::<bool>()), 8),
        rows in prop::collection::vec((any::<bool>(), prop::collection::vec(0..8_i8, 8)), 3),
        inputs in prop::collection::vec(odin_input(), 1..30),
        delay in 0..2_000_u32,
        ratio in 4..40_u32,
    ) {
        let network = OdinNetwork::<3, 8, 8> {
            neurons: std::array::from_fn(|n| {
                let (threshold, leak, is_disabled) = thresholds[n];
                OdinNeuron { threshold, leak, is_disabled, ..OdinNeuron::REST }
            }),
            inputs: Inputs::Rows(std::array::from_fn(|row| {
                let (is_inhibitory, weights) = &rows[row];
                let sign = if *is_inhibitory { -1 } else { 1 };
                std::array::from_fn(|n| sign * weights[n])
            })),
            recurrent: &[],
            outputs: neurons_from::<0, 8>(),
        };
        let board = Board::<silicon::Odin>::new(ratio, 1);
        let mut chip = Odin::new(board.spi(), board.port(), OdinInput::MAX_CLOCKS);
        let mut gated = chip.reset(&mut board.clone()).unwrap();
        gated.load(&network, |_| ()).unwrap();
        let mut running = gated.run(&network.registers()).unwrap();
        board.pins().output_delays = [delay, 0, delay / 7].into();
        let mut twin = {
            let pins = board.pins();
            let (neurons, synapses) = (pins.chip.neurons.clone(), pins.chip.synapses.clone());
            Twin { neurons, synapses, registers: pins.chip.registers, fired: vec![] }
        };
        let mut out = vec![];
        for &input in &inputs {
            running.send(input, |neuron| out.push(neuron)).unwrap();
            // In open loop no leak overtakes a spike: at most one word waits, and the chip finishes it first.
            twin.take(input);
        }
        running.gate(|neuron| out.push(neuron)).unwrap();
        prop_assert_eq!(&out, &twin.fired);
        prop_assert_eq!(&board.pins().chip.neurons, &twin.neurons);
        prop_assert_eq!(&board.pins().chip.synapses, &twin.synapses);
    }
}

#[test]
fn bytes_that_are_no_network_say_why() {
    let mut buffer = [0; 200];
    let network = network(&[1], &[5], false, false);
    let length = NetworkBytes::write(&network, &mut buffer).unwrap();
    assert_eq!(length, 12 + 7 * 4 + 4 * 4 + 3);
    let golden = [b'S', b'W', b'N', b'1', 1, 0, 7, 0, 4, 0, 3, 0, 0xFB, 0x5F, 0, 0];
    assert_eq!(buffer[..16], golden);
    let new = |bytes: &[u8]| NetworkBytes::<TinyOdinInput>::new(bytes).map(drop);
    let changed = |at: usize, to| {
        let mut buffer = buffer;
        buffer[at] = to;
        new(&buffer[..length])
    };
    assert_eq!(new(&buffer[..11]), Err(FormatError::Magic));
    assert_eq!(changed(0, b'X'), Err(FormatError::Magic));
    assert_eq!(changed(4, 2), Err(FormatError::Chip));
    assert_eq!(changed(5, 4), Err(FormatError::Chip));
    assert_eq!(changed(6, 0), Err(FormatError::Size));
    assert_eq!(changed(9, 1), Err(FormatError::Size));
    let given = length - 1;
    assert_eq!(new(&buffer[..given]), Err(FormatError::Length { needed: length, given }));
    // A weight onto a neuron beyond the last is 0, although the bytes of the next row follow.
    let square = TinyOdinNetwork::<2, 2, 1> {
        neurons: [TinyOdinNeuron::REST; 2],
        inputs: Inputs::Rows([[1, 2], [3, 4]]),
        recurrent: &[],
        outputs: [0],
    };
    let mut room = [0; 30];
    let end = NetworkBytes::write(&square, &mut room).unwrap();
    let read = NetworkBytes::<TinyOdinInput>::new(&room[..end]).unwrap();
    assert_eq!([0, 1, 2].map(|post| read.input_weight(0, post)), [1, 2, 0]);
    // A weight that does not fit into four bits is refused in both halves of a byte.
    for weights in [[8, 0], [0, 8], [-9, 0], [0, -9]] {
        let wrong = TinyOdinNetwork::<1, 2, 1> {
            neurons: [TinyOdinNeuron::REST; 2],
            inputs: Inputs::Rows([weights]),
            recurrent: &[],
            outputs: [0],
        };
        let error = NetworkBytes::write(&wrong, &mut [0; 200]);
        assert_eq!(error, Err(FormatError::Value), "{weights:?}");
    }
    let mut small = [0; 20];
    let error = NetworkBytes::write(&network, &mut small);
    assert_eq!(error, Err(FormatError::Length { needed: length, given: 20 }));
}
