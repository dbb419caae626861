//! Tests of the input words of tinyODIN and ODIN, and of the fields in their memories.

use proptest::prelude::*;
use spikewire_chips::{
    ChipError, Input, OdinInput, OdinLearning, OdinNeuron, OdinRegisters, OdinSynapse,
    OutputSource, TinyOdinInput, TinyOdinNeuron, TinyOdinRegisters,
};

type Word = Result<u32, ChipError<(), ()>>;

#[test]
fn tiny_odin_words_are_golden() {
    use TinyOdinInput::{Leak, LeakAll, Spike, Virtual};
    for (input, word) in [
        (Spike { pre: 7 }, 0x007),
        (Virtual { neuron: 5, weight: 2 }, 0x225),
        (Virtual { neuron: 15, weight: -8 }, 0x28F),
        (Virtual { neuron: 0, weight: -1 }, 0x2F0),
        (Leak { neuron: 254 }, 0x1FE),
        (LeakAll, 0x1FF),
    ] {
        let got: Word = input.word();
        assert_eq!(got, Ok(word), "{input:?}");
    }
    let zero: Word = Virtual { neuron: 5, weight: 0 }.word();
    assert_eq!(zero, Err(ChipError::ZeroWeight));
    for input in [
        Virtual { neuron: 16, weight: 1 },
        Virtual { neuron: 0, weight: 8 },
        Virtual { neuron: 0, weight: -9 },
        Leak { neuron: 255 },
    ] {
        let got: Word = input.word();
        assert!(matches!(got, Err(ChipError::OutOfRange { .. })), "{input:?}");
    }
    let low: Word = Virtual { neuron: 0, weight: -9 }.word();
    assert_eq!(low, Err(ChipError::OutOfRange { what: "weight", value: -9, min: -8, max: 7 }));
}

#[test]
fn errors_of_a_chip_are_told_in_words() {
    use spikewire_chips::FormatError;
    let read_back = ChipError::ReadBack { address: 0x1F, written: 3, read: 0xA };
    for (error, text) in [
        (ChipError::Bus("noise"), "the bus failed: \"noise\""),
        (ChipError::Port(7), "the port failed: 7"),
        (ChipError::NotReset, "the chip must be reset first"),
        (read_back, "wrote 0x3 to 0x1f, read back 0xa"),
        (
            ChipError::OutOfRange { what: "weight", value: -9, min: -8, max: 7 },
            "weight -9 must lie in -8..=7",
        ),
    ] {
        assert_eq!(error.to_string(), text);
    }
    let short = FormatError::Length { needed: 300, given: 12 };
    assert_eq!(short.to_string(), "the network takes 300 bytes, not 12");
}

/// Events that do not fit into the list are counted. After `clear` the list is empty, and the count stays.
#[test]
fn a_list_of_spikes_counts_what_it_has_no_room_for() {
    use spikewire::{Event, Polarity, Tick};
    use spikewire_chips::Spikes;
    let spike = |address| Event { tick: Tick::from(0), address, polarity: Polarity::Up };
    let mut spikes = Spikes::<2>::new();
    (4..8).for_each(|address| spikes.push(spike(address)));
    assert_eq!((spikes.as_slice(), spikes.lost()), (&[spike(4), spike(5)][..], 2));
    spikes.clear();
    assert!(spikes.as_slice().is_empty());
    spikes.push(spike(8));
    assert_eq!((spikes.as_slice(), spikes.lost()), (&[spike(8)][..], 2));
}

#[test]
fn odin_words_are_those_of_the_documentation() {
    use OdinInput::{
        Bistability, BistabilityAll, Leak, LeakAll, Spike, Synapse, Virtual, VirtualLeak,
    };
    for (input, word) in [
        (Synapse { pre: 0xAB, post: 0xCD }, 0x1_ABCD),
        (Spike { pre: 0xAB }, 0x0_AB07),
        (Virtual { neuron: 3, weight: 5, is_inhibitory: false }, 0x0_03A1),
        (Virtual { neuron: 3, weight: 5, is_inhibitory: true }, 0x0_03B1),
        (VirtualLeak { neuron: 3 }, 0x0_0309),
        (Leak { neuron: 3 }, 0x0_03FF),
        (LeakAll, 0x0_007F),
        (Bistability { neuron: 3 }, 0x0_0380),
        (BistabilityAll, 0),
    ] {
        let got: Word = input.word();
        assert_eq!(got, Ok(word), "{input:?}");
    }
    let zero: Word = Virtual { neuron: 3, weight: 0, is_inhibitory: true }.word();
    assert_eq!(zero, Err(ChipError::ZeroWeight));
    let wide: Word = Virtual { neuron: 3, weight: 8, is_inhibitory: true }.word();
    assert!(matches!(wide, Err(ChipError::OutOfRange { what: "weight", .. })));
}

#[test]
fn a_virtual_event_of_odin_has_its_sign_apart() {
    for (weight, is_inhibitory) in [(-7_i8, true), (-1, true), (0, false), (3, false)] {
        let event = OdinInput::Virtual { neuron: 9, weight: weight.unsigned_abs(), is_inhibitory };
        assert_eq!(OdinInput::virtual_event(9, weight), event);
    }
}

/// `before_step` gets the state of a neuron after a time step, and must return the state before that step. It must
/// return `None` if the neuron cannot have reached the given state without firing.
#[test]
fn before_a_time_step_a_neuron_of_odin_was_higher() {
    let neuron = |potential| OdinNeuron { threshold: 100, leak: 5, potential, ..OdinNeuron::REST };
    let before = |neuron| OdinInput::before_step(&neuron);
    assert_eq!(before(neuron(0)), Some(neuron(0)), "it stays at rest");
    assert_eq!([1, 99].map(|at| before(neuron(at))), [6, 104].map(|at| Some(neuron(at))));
    assert_eq!(before(neuron(100)), None, "it would have fired");
    let high = OdinNeuron { threshold: 255, ..neuron(251) };
    assert_eq!(before(high), None, "no neuron is as high");
    let fires = OdinNeuron { threshold: 0, ..neuron(0) };
    assert_eq!(before(fires), None, "memory that was never written");
    let silent = OdinNeuron { is_disabled: true, ..neuron(100) };
    assert_eq!(before(silent), Some(silent));
    let learning = OdinLearning { potential: 9, calcium: [1, 2, 3], calcium_leak: 0 };
    assert_eq!(before(OdinNeuron { learning: Some(learning), ..neuron(0) }), None);
}

/// Checks the number and the value of each register that the driver writes, and the result of `is_open_loop`. Also
/// checks the number of clock cycles that tinyODIN takes to apply one spike to all neurons in use.
#[test]
fn registers_are_those_of_the_documentation() {
    fn written<I: Input>(registers: &I::Registers) -> Vec<(u16, u32)> {
        let mut all = Vec::new();
        let write = |register, value| {
            all.push((register, value));
            Ok::<_, ()>(())
        };
        I::each_register(registers, write).unwrap();
        all
    }
    let (output_source, last_neuron) = (OutputSource::Queue, 99);
    let tiny = TinyOdinRegisters { is_open_loop: false, output_source, last_neuron };
    assert_eq!(written::<TinyOdinInput>(&tiny), [(2, 1), (3, 99), (1, 0)]);
    assert_eq!(TinyOdinInput::sweep_clocks(&tiny), 2 * 100 + 4);
    let open = TinyOdinRegisters { is_open_loop: true, ..tiny };
    assert_eq!([&tiny, &open].map(TinyOdinInput::is_open_loop), [false, true]);

    let odin = OdinRegisters { is_open_loop: false, output_source, ..OdinRegisters::PLAIN };
    let registers = written::<OdinInput>(&odin);
    assert!(registers.contains(&(19, 1)) && registers.contains(&(1, 0)));
    assert_eq!([&odin, &OdinRegisters::PLAIN].map(OdinInput::is_open_loop), [false, true]);
}

type Bytes = Result<[u8; 16], ChipError<(), ()>>;

#[test]
fn a_neuron_of_tiny_odin_has_its_fields_where_the_documentation_says() {
    let neuron = TinyOdinNeuron { threshold: 0x123, leak: 0x45, potential: -2, is_disabled: true };
    let bytes: Bytes = TinyOdinInput::neuron_bytes(&neuron);
    assert_eq!(bytes.unwrap()[..5], [0xFE, 0x3F, 0x12, 0xC5, 0]);
    for neuron in [
        TinyOdinNeuron { threshold: 0, ..neuron },
        TinyOdinNeuron { threshold: 2048, ..neuron },
        TinyOdinNeuron { leak: 128, ..neuron },
        TinyOdinNeuron { potential: 2048, ..neuron },
        TinyOdinNeuron { potential: -2049, ..neuron },
    ] {
        let bytes: Bytes = TinyOdinInput::neuron_bytes(&neuron);
        assert!(matches!(bytes, Err(ChipError::OutOfRange { .. })), "{neuron:?}");
    }
}

#[test]
fn a_neuron_of_odin_has_its_fields_where_the_documentation_says() {
    let neuron = OdinNeuron { threshold: 0x81, leak: 3, potential: 0xFF, ..OdinNeuron::DISABLED };
    let bits = |neuron| {
        let bytes: Bytes = OdinInput::neuron_bytes(&neuron);
        bytes.map(u128::from_le_bytes)
    };
    let plain = 1 | 3 << 1 | 1 << 8 | 0x81 << 9 | 0xFF << 70 | 1 << 127;
    assert_eq!(bits(neuron), Ok(plain));
    let learning = OdinLearning { potential: 0x55, calcium: [1, 2, 7], calcium_leak: 31 };
    let learns = 1 << 17 | 0x55 << 18 | 1 << 26 | 2 << 29 | 7 << 32 | 31 << 35;
    assert_eq!(bits(OdinNeuron { learning: Some(learning), ..neuron }), Ok(plain | learns));
    assert_eq!(bits(OdinNeuron { leak: 0, ..neuron }), Ok(plain & !(3 << 1 | 1 << 8)));
    assert!(bits(OdinNeuron { threshold: 0, ..neuron }).is_err());
    assert!(bits(OdinNeuron { leak: 128, ..neuron }).is_err());
}

#[test]
fn weights_are_signed_in_tiny_odin_and_have_a_mapping_bit_in_odin() {
    type Bits = Result<u8, ChipError<(), ()>>;
    for (weight, tiny, odin) in
        [(0, 0, Some(0)), (7, 7, Some(0xF)), (-1, 0xF, Some(9)), (-8, 8, None)]
    {
        let bits: Bits = TinyOdinInput::weight_bits(weight);
        assert_eq!(bits, Ok(tiny));
        assert_eq!(TinyOdinInput::synapse(tiny), weight);
        let bits: Bits = OdinInput::weight_bits(weight);
        assert_eq!(bits.ok(), odin);
    }
    let bits: Bits = TinyOdinInput::weight_bits(8);
    assert!(bits.is_err());
    let bits: Bits = OdinInput::synapse_bits(OdinSynapse { weight: 5, is_mapped: true });
    assert_eq!(bits, Ok(0xD));
    for (bits, weight, is_mapped) in [(7, 7, false), (8, 0, true), (0xD, 5, true)] {
        assert_eq!(OdinInput::synapse(bits), OdinSynapse { weight, is_mapped });
    }
}

proptest! {
    #![proptest_config(crate::cases(256))]

    #[test]
    fn neurons_come_back_from_their_bytes(
        tiny in (1..=2047_u16, 0..=127_u8, -2048..=2047_i16, any::<bool>()),
        odin in (1..=255_u8, 0..=127_u8, any::<u8>(), any::<bool>()),
        learning in prop::option::of((any::<u8>(), [0..=7_u8, 0..=7, 0..=7], 0..=31_u8)),
    ) {
        let (threshold, leak, potential, is_disabled) = tiny;
        let neuron = TinyOdinNeuron { threshold, leak, potential, is_disabled };
        let bytes: Bytes = TinyOdinInput::neuron_bytes(&neuron);
        prop_assert_eq!(TinyOdinInput::neuron(bytes.unwrap()), neuron);

        let (threshold, leak, potential, is_disabled) = odin;
        let learning = learning.map(|(potential, calcium, calcium_leak)| {
            OdinLearning { potential, calcium, calcium_leak }
        });
        let neuron = OdinNeuron { threshold, leak, potential, learning, is_disabled };
        let bytes: Bytes = OdinInput::neuron_bytes(&neuron);
        prop_assert_eq!(OdinInput::neuron(bytes.unwrap()), neuron);
    }
}
