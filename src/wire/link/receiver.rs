//! Frames to values, with the knowledge of which are exact.

use super::Received;
use crate::event::{Raw, Tick};
use crate::temporal::StepDecoder;
use crate::{Decoder, Scheme};

/// The decoders of `N` channels of a step code, numbered from address 0, at the end of a link.
///
/// A step code's events say when the value changes, not when a sample was taken. The value of a
/// channel therefore holds from its event on until the next: read it after each event, from the
/// call-back, or whenever it is wanted, from [`exact`](Self::exact).
///
/// After a loss a channel is not exact until its next keyframe, nor is it before its first. Meanwhile
/// events go on being applied, which gives an [`estimate`](Self::estimate).
///
/// Exact is what a decoder beside the encoder holds that goes on from the same keyframes, bit for bit.
/// How near that is to the signal is the scheme's affair: SF follows one threshold a sample, and TBR
/// and MW drift from keyframe to keyframe.
#[derive(Clone, Copy, Debug)]
pub struct Receiver<S, const N: usize> {
    channels: [Channel<S>; N],
    outside: u32,
    misfits: u32,
}

#[derive(Clone, Copy, Debug)]
struct Channel<S> {
    decoder: StepDecoder<S>,
    is_exact: bool,
}

impl<S: Raw, const N: usize> Receiver<S, N> {
    /// The same scheme on every channel; that of the sender.
    pub fn new<P: Scheme<Sample = S, Decoder = StepDecoder<S>>>(scheme: P) -> Self {
        Self::from_schemes([scheme; N])
    }

    /// A scheme for each channel; those of the sender.
    pub fn from_schemes<P: Scheme<Sample = S, Decoder = StepDecoder<S>>>(schemes: [P; N]) -> Self {
        Self::from_decoders(schemes.map(Scheme::decoder))
    }

    /// Decoders of the caller's, each with parameters of its own.
    pub fn from_decoders(decoders: [StepDecoder<S>; N]) -> Self {
        const { assert!(N >= 1 && N <= 1 << 16, "addresses have 16 bits") };
        let channels = decoders.map(|decoder| Channel { decoder, is_exact: false });
        Self { channels, outside: 0, misfits: 0 }
    }

    /// Applies a frame, and hands the channel, tick and new value of each keyframe and event to
    /// `on_value`, in order.
    pub fn apply(&mut self, received: &Received<'_>, mut on_value: impl FnMut(u16, Tick, S)) {
        let frame = &received.frame;
        if received.is_after_break() {
            self.mark_stale();
        }
        for keyframe in frame.keyframes() {
            let channel = self.channels.get_mut(usize::from(keyframe.address));
            match (channel, keyframe.value::<S>()) {
                (None, _) => self.outside = self.outside.saturating_add(1),
                (Some(_), None) => self.misfits = self.misfits.saturating_add(1),
                (Some(channel), Some(value)) => {
                    channel.decoder.resync(value);
                    channel.is_exact = true;
                    on_value(keyframe.address, keyframe.tick, value);
                }
            }
        }
        let mut events = frame.events();
        for event in &mut events {
            match self.channels.get_mut(usize::from(event.address)) {
                None => self.outside = self.outside.saturating_add(1),
                Some(channel) => {
                    let value = channel.decoder.decode(event.polarity.into());
                    on_value(event.address, event.tick, value);
                }
            }
        }
        if !events.is_complete() {
            self.misfits = self.misfits.saturating_add(1);
            self.mark_stale();
        }
    }

    /// Marks every channel as not exact, for a loss that the link did not see.
    pub fn mark_stale(&mut self) {
        for channel in &mut self.channels {
            channel.is_exact = false;
        }
    }

    /// The value of a channel, if it is exact.
    pub fn exact(&self, channel: u16) -> Option<S> {
        let channel = self.channels.get(usize::from(channel))?;
        channel.is_exact.then(|| channel.decoder.value())
    }

    /// The value of a channel, exact or not; 0 for one that there is not.
    pub fn estimate(&self, channel: u16) -> S {
        let channel = self.channels.get(usize::from(channel));
        channel.map(|channel| channel.decoder.value()).unwrap_or_default()
    }

    /// How many events and keyframes had an address of `N` or above.
    pub const fn outside(&self) -> u32 {
        self.outside
    }

    /// How many keyframes had the width of another sample type, and how many frames had events that
    /// cannot be.
    pub const fn misfits(&self) -> u32 {
        self.misfits
    }
}
