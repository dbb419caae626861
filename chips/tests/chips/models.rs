//! Tests of the models of tinyODIN and ODIN without the drivers. The tests check how long the chips work on an input
//! word, and what goes wrong if a driver gates a chip or accesses its memories at the wrong moment. The expected
//! figures come from a simulation of the chips' register-transfer code.

#![allow(
    clippy::cast_possible_wrap,
    clippy::verbose_bit_mask,
    reason = "the chips' fields are packed"
)]

use embedded_hal::spi::SpiDevice;
use proptest::prelude::*;
use silicon::{Board, Kind, Odin, TinyOdin};
use spikewire_chips::AerPort;

const WRITE: u32 = 1 << 18;
const READ: u32 = 1 << 19;
const NEURON: u32 = 1 << 16;
const SYNAPSE: u32 = 2 << 16;

/// Sends an SPI frame of 20 bits of address and 20 bits of data; returns the last byte that comes back.
fn frame<K: Kind>(board: &Board<K>, address: u32, data: u32) -> u8 {
    let [_, _, _, bytes @ ..] = (u64::from(address) << 20 | u64::from(data)).to_be_bytes();
    let mut frame: [u8; 5] = bytes;
    board.spi().transfer_in_place(&mut frame).unwrap();
    frame[4]
}

/// Makes a board, resets and gates its chip, and writes `registers`: pairs of a register's number and its value.
fn gated<K: Kind>(ratio: u32, registers: &[(u32, u32)]) -> Board<K> {
    let board = Board::new(ratio, 1);
    board.pins().chip.set_reset(true);
    board.run(10);
    board.pins().chip.set_reset(false);
    board.run(10);
    frame(&board, 0, 1);
    for &(register, value) in registers {
        frame(&board, register, value);
    }
    board
}

/// Sends a word with its handshake, and ignores outputs. Returns the number of clock cycles from REQ to ACK, or `None`
/// if no ACK comes.
fn send<K: Kind>(board: &Board<K>, word: u32) -> Option<u64> {
    let mut port = board.port();
    port.set_input(word).unwrap();
    let start = board.pins().chip.clocks;
    port.set_input_request(true).unwrap();
    let is_taken = (0..40_000).any(|_| port.input_acknowledge().unwrap());
    let clocks = board.pins().chip.clocks - start;
    port.set_input_request(false).unwrap();
    let is_released = (0..10).any(|_| !port.input_acknowledge().unwrap());
    (is_taken && is_released).then_some(clocks)
}

fn tiny_neuron(threshold: u32, leak: u32, potential: i32) -> u128 {
    u128::from(leak << 24 | threshold << 12 | potential as u32 & 0xFFF)
}

/// Returns the potential of a neuron of tinyODIN.
fn potential(board: &Board<TinyOdin>, neuron: usize) -> i32 {
    ((board.pins().chip.neurons[neuron] as u32) << 20) as i32 >> 20
}

const CLOSED: [(u32, u32); 3] = [(1, 0), (2, 0), (3, 255)];
const OPEN: [(u32, u32); 3] = [(1, 1), (2, 0), (3, 255)];

#[test]
fn a_sweep_takes_two_clocks_a_neuron_and_a_virtual_event_two_in_all() {
    for last in [0, 11, 63, 255] {
        let board = gated::<TinyOdin>(4, &[(1, 1), (2, 0), (3, last)]);
        board.pins().chip.neurons.fill(tiny_neuron(2047, 0, 0));
        frame(&board, 0, 0);
        let work = |word| {
            send(&board, word).unwrap();
            let start = board.pins().chip.clocks;
            while !board.pins().chip.is_idle() {
                board.run(1);
            }
            board.pins().chip.clocks - start
        };
        let sweep = 2 * u64::from(last + 1);
        // The state WAIT before the sweep and the removal from the queue after it take up to three more cycles, some of
        // which the handshake hides.
        assert!((sweep..sweep + 3).contains(&work(0x007)), "{last}");
        assert!(work(0x225) <= 3);
        let leak = send(&board, 0x1FF).unwrap();
        assert!((sweep + 3..sweep + 7).contains(&leak), "{last}: {leak}");
    }
}

#[test]
fn gating_within_a_sweep_writes_the_last_spi_data_to_the_rest() {
    // The ratio of the chip's clock to SCK, and the number of potentials that are wrong afterwards.
    for (ratio, wrong) in [(4, 176), (16, 0)] {
        let board = gated::<TinyOdin>(ratio, &OPEN);
        for neuron in 0..256 {
            board.pins().chip.neurons[neuron] = tiny_neuron(2047, 0, 100 + neuron as i32);
        }
        board.pins().chip.synapses.fill(0x3333_3333);
        frame(&board, READ | NEURON, 0);
        frame(&board, 0, 0);
        send(&board, 7).unwrap();
        board.run(2);
        frame(&board, 0, 1);
        board.run(2_000);
        let is_wrong = |&neuron: &usize| potential(&board, neuron) != 103 + neuron as i32;
        assert_eq!((0..256).filter(is_wrong).count(), wrong, "{ratio}");
    }
}

#[test]
fn gating_with_an_output_unserved_breaks_the_neurons_after_it() {
    for ratio in [2, 4, 16, 64] {
        let board = gated::<TinyOdin>(ratio, &OPEN);
        for neuron in 0..256 {
            board.pins().chip.neurons[neuron] = tiny_neuron(2047, 0, 100 + neuron as i32);
        }
        board.pins().chip.neurons[10] = tiny_neuron(5, 0, 4);
        board.pins().chip.synapses.fill(0x3333_3333);
        frame(&board, READ | NEURON, 0);
        frame(&board, 0, 0);
        send(&board, 7).unwrap();
        board.run(10_000);
        assert!(board.pins().chip.output().request, "it waits for ever");
        frame(&board, 0, 1);
        board.run(2_000);
        let is_wrong =
            |&neuron: &usize| neuron != 10 && potential(&board, neuron) != 103 + neuron as i32;
        assert_eq!((0..256).filter(is_wrong).count(), 245, "{ratio}");
    }
}

#[test]
fn parameters_are_zeroed_where_their_byte_was_read_last() {
    for byte in [2, 3] {
        let board = gated::<TinyOdin>(4, &OPEN);
        board.pins().chip.neurons.fill(tiny_neuron(0x7FF, 0x55, 0));
        frame(&board, READ | NEURON | byte << 8, 0);
        frame(&board, 0, 0);
        send(&board, 7).unwrap();
        frame(&board, 0, 1);
        board.run(2_000);
        let zeroed = |neuron: &&u128| **neuron >> (8 * byte) & 0xFF == 0;
        assert!(board.pins().chip.neurons.iter().filter(zeroed).count() > 100);
    }
}

#[test]
fn a_synapse_written_behind_a_sweep_is_lost() {
    let board = gated::<TinyOdin>(4, &OPEN);
    board.pins().chip.neurons.fill(tiny_neuron(2047, 0, 0));
    frame(&board, 0, 0);
    send(&board, 7).unwrap();
    frame(&board, 0, 1);
    frame(&board, WRITE | SYNAPSE, 0x0003);
    frame(&board, WRITE | SYNAPSE | 1, 0x0003);
    board.run(2_000);
    let pins = board.pins();
    assert_eq!((pins.chip.synapse(0, 0), pins.chip.synapse(0, 8)), (0, 3));
}

#[test]
fn programming_in_closed_loop_queues_spikes_that_move_every_potential() {
    let program = |registers: &[(u32, u32)]| {
        let board = gated::<TinyOdin>(16, registers);
        board.pins().chip.synapses.fill(0x1111_1111);
        for neuron in 0..256 {
            for (byte, value) in (0..).zip([0, 0xF0, 0x7F, 0]) {
                frame(&board, WRITE | NEURON | byte << 8 | neuron, value);
            }
        }
        let queued = board.pins().chip.waiting();
        frame(&board, 0, 0);
        board.run(100_000);
        let moved = (0..256).filter(|&neuron| potential(&board, neuron) != 0).count();
        (queued, moved)
    };
    assert_eq!(program(&CLOSED), (128, 256));
    assert_eq!(program(&OPEN), (0, 0));
}

#[test]
fn in_closed_loop_a_leak_overtakes_the_spikes_that_wait() {
    for (open_loop, overtaken) in [(0, true), (1, false)] {
        let board = gated::<TinyOdin>(4, &[(1, open_loop), (2, 0), (3, 255)]);
        board.pins().chip.neurons.fill(tiny_neuron(2047, 1, 0));
        for neuron in 0..20 {
            board.pins().chip.neurons[neuron] = tiny_neuron(1, 0, 0);
        }
        board.pins().chip.synapses[..32].fill(0x1111_1111); // those of 0
        frame(&board, 0, 0);
        // The spike makes twenty neurons fire, whose outputs are acknowledged immediately.
        send(&board, 0).unwrap();
        for _ in 0..20 {
            let request = |chip: &silicon::Chip<TinyOdin>| chip.output().request;
            while !request(&board.pins().chip) {
                board.run(1);
            }
            board.pins().chip.set_output_acknowledge(true);
            board.run(5);
            board.pins().chip.set_output_acknowledge(false);
            board.run(5);
        }
        send(&board, 0x1FF).unwrap();
        assert_eq!(board.pins().chip.waiting() > 0, overtaken);
    }
}

#[test]
fn register_2_echoes_the_inputs_in_open_loop() {
    let board = gated::<TinyOdin>(4, &[(1, 1), (2, 1), (3, 15)]);
    board.pins().chip.neurons.fill(tiny_neuron(2047, 0, 0));
    frame(&board, 0, 0);
    send(&board, 77).unwrap();
    board.run(100);
    assert_eq!(board.pins().chip.fired, [77]);
}

#[test]
fn neurons_that_were_not_programmed_fire_at_every_event_and_at_leaks() {
    for word in [7, 0x1FF] {
        let board = gated::<TinyOdin>(4, &[(1, 1), (2, 0), (3, 15)]);
        frame(&board, 0, 0);
        let _ = send(&board, word);
        board.run(100);
        assert_eq!(board.pins().chip.fired, [0], "the first, and the others as it is served");
    }
}

#[test]
fn odins_gate_waits_for_an_output_and_for_a_sweep() {
    for (is_output_waiting, clocks) in [(true, 100_000), (false, 10)] {
        let registers: Vec<_> =
            (1..26).map(|register| (register, u32::from(register == 1))).collect();
        let board = gated::<Odin>(4, &registers);
        board.pins().chip.neurons.fill(1 | 255 << 9);
        if is_output_waiting {
            board.pins().chip.neurons[10] = 1 | 1 << 9 | 1 << 70;
        }
        frame(&board, 0, 0);
        send(&board, 0x707).unwrap();
        board.run(clocks);
        frame(&board, 0, 1);
        assert!(!board.pins().chip.is_gated());
        frame(&board, WRITE | SYNAPSE, 0x0003);
        assert_ne!(frame(&board, READ | SYNAPSE, 0), 3);
        board.run(2_000);
        assert_eq!(board.pins().chip.is_gated(), !is_output_waiting);
    }
}

#[test]
fn odins_bistability_moves_the_synapses_from_the_neuron() {
    let registers: Vec<_> = (1..26).map(|register| (register, u32::from(register == 1))).collect();
    let board = gated::<Odin>(4, &registers);
    board.pins().chip.synapses.fill(0xDB5C_0F38);
    frame(&board, 0, 0);
    assert!((64..72).contains(&send(&board, 0x0980).unwrap()));
    let pins = board.pins();
    // Synapses without the mapping bit stay. With it, weights from 4 rise, weights up to 3 fall; 7 and 0 stay.
    for post in 0..=255_u8 {
        let new = [0x8, 0x3, 0xF, 0x0, 0xD, 0x5, 0xA, 0xE][usize::from(post & 7)];
        assert_eq!(pins.chip.synapse(9, post), new);
        for pre in (0..=255).filter(|&pre| pre != 9) {
            assert_eq!(
                pins.chip.synapse(pre, post),
                (0xDB5C_0F38_u32 >> (4 * (post & 7))) as u8 & 15
            );
        }
    }
}

#[test]
fn odins_synapse_needs_the_mapping_bit_or_register_24() {
    for (synapse, propagates, potential) in [(0x5, 0, 0), (0x5, 1, 5), (0xD, 0, 5)] {
        let board = gated::<Odin>(4, &[(1, 1), (19, 0), (20, 0), (24, propagates)]);
        board.pins().chip.neurons.fill(1 | 255 << 9);
        board.pins().chip.synapses.fill(synapse);
        frame(&board, 0, 0);
        send(&board, 1 << 16 | 3 << 8 | 8).unwrap();
        assert_eq!(board.pins().chip.neurons[8] >> 70, potential);
    }
}

/// Returns the potential of a neuron of tinyODIN after an event, and whether it fires, computed in plain arithmetic.
/// `neuron` is threshold, leak and potential; `event` is a weight, or `None` for a time step.
fn expected(neuron: (i32, i32, i32), event: Option<i32>) -> (i32, bool) {
    let (threshold, leak, potential) = neuron;
    let next = match event {
        Some(weight) => (potential + weight).clamp(-2048, 2047),
        None if potential < 0 => (potential + leak).min(0),
        None => (potential - leak).max(0),
    };
    let fires = next >= 0 && next >= threshold;
    (if fires { 0 } else { next }, fires)
}

proptest! {
    #![proptest_config(crate::cases(256))]

    #[test]
    fn a_neuron_saturates_at_12_bits_leaks_to_0_and_fires_at_its_threshold(
        threshold in 0..4096_i32,
        leak in 0..128_i32,
        start in -2048..2048_i32,
        events in prop::collection::vec(prop::option::of((-8..8_i32).prop_filter("", |w| *w != 0)), 1..20),
    ) {
        let board = gated::<TinyOdin>(4, &[(1, 1), (2, 0), (3, 15)]);
        board.pins().chip.neurons.fill(tiny_neuron(2047, 0, -2048));
        board.pins().chip.neurons[3] = tiny_neuron(threshold as u32, leak as u32, start);
        frame(&board, 0, 0);
        let mut state = start;
        for event in events {
            let word = event.map_or(0x103, |weight| 0x203 | (weight as u32 & 0xF) << 4);
            send(&board, word).unwrap();
            let (next, fires) = expected((threshold, leak, state), event);
            for _ in 0..100 {
                let request = board.pins().chip.output().request;
                board.pins().chip.set_output_acknowledge(request);
                board.run(1);
            }
            prop_assert_eq!(potential(&board, 3), next);
            let fired = std::mem::take(&mut board.pins().chip.fired);
            prop_assert_eq!(fired, if fires { vec![3] } else { vec![] });
            state = next;
        }
    }

    #[test]
    fn odins_neuron_stays_within_8_bits_leaks_to_0_and_fires_at_its_threshold(
        threshold in 1..256_i32,
        leak in 0..128_i32,
        is_leaking in any::<bool>(),
        start in 0..256_i32,
        events in prop::collection::vec(prop::option::of((1..8_i32, any::<bool>())), 1..20),
    ) {
        let board = gated::<Odin>(4, &[(1, 1), (19, 0), (20, 0), (24, 0)]);
        board.pins().chip.neurons.fill(1 | 255 << 9);
        board.pins().chip.neurons[3] = 1
            | (leak as u128) << 1
            | u128::from(is_leaking) << 8
            | (threshold as u128) << 9
            | (start as u128) << 70;
        frame(&board, 0, 0);
        let mut state = start;
        for event in events {
            let (word, next) = match event {
                None => (0x03FF, state - if is_leaking { leak } else { 0 }),
                Some((w, false)) => (0x0301 | (w as u32) << 5, state + w),
                Some((w, true)) => (0x0311 | (w as u32) << 5, state - w),
            };
            send(&board, word).unwrap();
            for _ in 0..100 {
                let request = board.pins().chip.output().request;
                board.pins().chip.set_output_acknowledge(request);
                board.run(1);
            }
            let next = next.clamp(0, 255);
            let fires = next >= threshold;
            state = if fires { 0 } else { next };
            prop_assert_eq!((board.pins().chip.neurons[3] >> 70) as i32, state);
            let fired = std::mem::take(&mut board.pins().chip.fired);
            prop_assert_eq!(fired, if fires { vec![3] } else { vec![] });
        }
    }
}
