//! Digests of the chip's state. The simulation of the register-transfer code computes the same digests, for comparison.

use super::chip::ReckOn;

/// A digest to which words are added one by one.
#[derive(Default)]
struct Mixed(u64);

impl Mixed {
    fn add(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 ^= self.0 >> 29;
    }

    fn wide(&mut self, word: u128) {
        self.add(word as u64);
        self.add((word >> 64) as u64);
    }
}

impl ReckOn {
    /// Returns two numbers. The first contains the pins, the states of both controllers and the current event. The
    /// second is a digest of all registers.
    pub fn digest(&self) -> [u64; 2] {
        let now = &self.now;
        let (state, event_state) = (now.state as u64, now.event_state as u64);
        let mut mixed = Mixed::default();
        mixed.add(
            state
                | event_state << 4
                | u64::from(now.event_count) << 8
                | u64::from(now.pair_count) << 16
                | u64::from(now.step_count) << 24
                | u64::from(now.tick_count) << 32,
        );
        mixed.add(
            u64::from(now.send_count)
                | u64::from(now.target_count) << 5
                | u64::from(now.post_low) << 10
                | u64::from(now.post_high) << 15
                | u64::from(now.pre) << 19
                | u64::from(now.is_buffering) << 28
                | u64::from(now.timing_error) << 29
                | u64::from(now.has_label) << 30
                | u64::from(now.label) << 32,
        );
        for set in [now.fired, now.dirty, now.inputs, now.next_inputs] {
            for word in set {
                mixed.add(word);
            }
        }
        let words = [now.neuron_word, now.input_weights, now.recurrent_weights, now.output_weights];
        for word in words {
            mixed.wide(word);
        }
        for k in 0..16 {
            let bits = |value: i16| u64::from(value as u16);
            mixed.add(
                bits(now.outputs[k])
                    | bits(now.targets[k]) << 16
                    | bits(now.signals[k]) << 32
                    | u64::from(now.winners[k]) << 48,
            );
            mixed.add(u64::from(now.slopes[k] as u8 & 31) | u64::from(now.regularised[k]) << 8);
        }
        mixed.add(now.read.into());
        let out = self.outputs();
        let pins = u64::from(out.miso)
            | u64::from(out.acknowledge) << 1
            | u64::from(out.request) << 2
            | u64::from(out.spi_ready) << 3
            | u64::from(out.error_or_ready) << 4
            | u64::from(out.data) << 8
            | state << 16
            | event_state << 20
            | u64::from(now.event_count) << 24;
        [pins, mixed.0]
    }

    /// Returns a digest of the four memories.
    pub fn memory_digest(&self) -> u64 {
        let mut mixed = Mixed::default();
        let weights = [&self.input_weights, &self.recurrent_weights, &self.output_weights];
        let weights = weights.into_iter().flat_map(super::Memory::iter);
        self.neurons.iter().copied().chain(weights).for_each(|word| mixed.wide(word));
        mixed.0
    }
}
