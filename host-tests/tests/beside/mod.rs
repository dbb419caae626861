//! What a receiver's values are compared with in the tests of whole links: decoders beside the encoders.
#![allow(dead_code, reason = "each test takes what it needs")]

use catalogue::{State, Storable};
use spikewire::link::Session;
use spikewire::{Code, Item, Output, Put, Recovery, Scheme};

/// How many channels a link has.
pub(crate) const CHANNELS: usize = 2;

/// What an interrupt puts into a queue.
#[derive(Default)]
pub(crate) struct Items(pub(crate) Vec<Item>);

impl Put for &mut Items {
    fn put(&mut self, item: Item) {
        self.0.push(item);
    }
}

/// Reads a state that was written.
pub(crate) fn read<T: State>(bytes: &[u8]) -> T {
    postcard::from_bytes(bytes).unwrap()
}

/// The session whose first frame has this number: of the bits that `Session` spreads to it.
pub(crate) fn session_from(first: u64) -> Session {
    const RATIO: u64 = 0x9E37_79B9_7F4A_7C15;
    // Newton's steps to the inverse modulo 2⁶⁴.
    let inverse = (0..6).fold(RATIO, |inverse, _| {
        inverse.wrapping_mul(2_u64.wrapping_sub(RATIO.wrapping_mul(inverse)))
    });
    Session::random((first << 16).wrapping_mul(inverse))
}

/// The length of a code's sub-timesteps on a link of this period; 0 if it has none.
pub(crate) fn slot_ticks<P: Scheme>(scheme: &P, period: u32) -> u32 {
    let has_slots = scheme.slots() > 1 && P::RECOVERY != Recovery::Keyframe;
    if has_slots { period / scheme.slots() as u32 } else { 0 }
}

/// Encoders and decoders beside those of a link: nothing is lost between them.
pub(crate) struct Beside<'a, P: Scheme> {
    scheme: &'a P,
    encoders: [P::EncoderState; CHANNELS],
    decoders: [P::DecoderState; CHANNELS],
    /// Samples since a channel had a spike.
    pub(crate) silent: [u32; CHANNELS],
}

impl<'a, P: Storable> Beside<'a, P> {
    /// Encoders that go on from a state that was written.
    pub(crate) fn new(scheme: &'a P, start: &[u8]) -> Self {
        Self {
            scheme,
            encoders: [(); CHANNELS].map(|()| read(start)),
            decoders: [(); CHANNELS].map(|()| scheme.decoder_state()),
            silent: [0; CHANNELS],
        }
    }

    /// Takes a sample of each channel, and sets the values of those that give a code.
    pub(crate) fn sample(
        &mut self,
        samples: [P::Sample; CHANNELS],
        values: &mut [P::Sample; CHANNELS],
    ) {
        for channel in 0..CHANNELS {
            let code = self.scheme.encode(&mut self.encoders[channel], samples[channel]).code();
            if let Some(code) = code {
                let has_spike = code.firings().next().is_some();
                self.silent[channel] = if has_spike { 0 } else { self.silent[channel] + 1 };
                values[channel] = self.scheme.decode(&mut self.decoders[channel], code);
            }
        }
    }

    /// Sets the values of the channels that have a keyframe.
    pub(crate) fn keyframe(&mut self, values: &mut [P::Sample; CHANNELS]) {
        let ends = self.encoders.iter().zip(&mut self.decoders);
        for ((encoder, decoder), value) in ends.zip(values) {
            if let Some(keyframe) = self.scheme.keyframe(encoder) {
                self.scheme.resync(decoder, keyframe);
                *value = keyframe;
            }
        }
    }

    /// Whether a channel must be exact after a keyframe and what its code needs to recover.
    pub(crate) fn is_due(&self, channel: usize, beat: u32) -> bool {
        match self.scheme.recovery() {
            Recovery::Keyframe | Recovery::Samples(_) => true,
            Recovery::TimedKeyframe(_) => self.scheme.keyframe(&self.encoders[channel]).is_some(),
            Recovery::Spike => self.silent[channel] < beat,
            Recovery::Fading(_) => false,
        }
    }

    /// How many samples the code needs to recover.
    pub(crate) fn recovery(&self) -> u32 {
        match self.scheme.recovery() {
            Recovery::Samples(samples) | Recovery::TimedKeyframe(samples) => samples as u32,
            Recovery::Keyframe | Recovery::Spike | Recovery::Fading(_) => 0,
        }
    }

    /// Whether the code counts samples.
    pub(crate) fn counts(&self) -> bool {
        !matches!(self.scheme.recovery(), Recovery::Keyframe | Recovery::Spike)
    }
}
