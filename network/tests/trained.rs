//! The trained network of `examples/trained`, as the laptop program writes it, has its checksum and its spikes.

#[rustfmt::skip]
#[path = "../../examples/trained/src/braille.rs"]
#[allow(dead_code, unreachable_pub, reason = "a firmware's module")]
mod network;

use spikewire_network::{Network, State};

#[test]
fn a_written_network_is_intact() {
    assert!(network::is_intact());
    let mut state = network::NETWORK.state();
    network::NETWORK.step(&mut state, &[0]);
    assert_eq!(state.rejected(), 0);
}
