// A network that `spikewire network` wrote. Build the library with NETWORK=network.rs in the environment:
// cargo build --release --manifest-path examples/Cargo.toml --package network-c --target thumbv7em-none-eabihf
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Number of inputs and of neurons of the last layer.
extern const size_t NETWORK_INPUTS, NETWORK_OUTPUTS;

// Runs ten steps whose spikes and potentials are known. Do not arm if it returns false.
bool network_is_intact(void);

// Bytes of a state. Give it memory that is aligned as `uint64_t`.
size_t network_size(void);

// Puts a state at rest; it needs no end.
void network_reset(void *state);

// Takes a step with the numbers of the inputs that fire, in this order; others than the network has are left out.
// Returns how many neurons of the last layer fired, and points `fired` at their numbers, rising, until the next step.
size_t network_step(void *state, const uint16_t *inputs, size_t count, const uint16_t **fired);

// The potentials of the last layer, until the next step: `float`, or `int32_t` with --numbers i8.
const void *network_values(const void *state);
