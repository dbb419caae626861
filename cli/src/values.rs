//! From frames to values, with the receiver that runs on boards, in any sample type.

use crate::events::{Held, Item, Known, Values};
use crate::sample_type::{SampleType, for_sample_type};
use crate::settings::Settings;
use anyhow::{Result, bail};
use spikewire::link::{Raw, Received, Receiver};
use spikewire::temporal::{MovingWindow, StepDecoder, StepForward, TemporalContrast};
use spikewire::{Decoder, Scheme};

/// The channels that a receiver has, at addresses from 0 on.
const MOST: usize = 256;

/// A receiver with these settings, one for each channel, or one for all.
///
/// # Errors
/// A scheme whose decoder does not add up steps, or a parameter that makes no sense.
pub(crate) fn receiver(sample: SampleType, settings: &[Settings]) -> Result<Box<dyn Values>> {
    // The keyframes of the others are samples, from which their decoders start again.
    let are_held = settings.iter().all(|settings| matches!(settings, Settings::StepForward(_)));
    for_sample_type!(sample, S => {
        let decoders = settings.iter().map(|settings| {
            decoder::<S>(&settings.scaled(sample.one()))
        });
        let decoders = decoders.collect::<Result<Vec<_>>>()?;
        Ok(Box::new(Receiving::<S>::new(&decoders, sample.one(), are_held)?))
    })
}

fn decoder<S: Raw>(settings: &Settings) -> Result<StepDecoder<S>> {
    let mut decoder = match settings {
        Settings::Contrast(contrast) => TemporalContrast::with_step(
            S::from_f64(contrast.threshold),
            S::from_f64(contrast.step),
        )?
        .decoder(),
        Settings::StepForward(step_forward) => {
            StepForward::new(S::from_f64(step_forward.threshold))?.decoder()
        }
        // The window is the encoder's alone.
        Settings::MovingWindow(moving_window) => {
            MovingWindow::<S, 1>::new(S::from_f64(moving_window.threshold))?.decoder()
        }
        _ => bail!("a link's receiver adds up steps: tbr, sf and mw"),
    };
    if let Some(start) = settings.start() {
        decoder.resync(S::from_f64(start));
    }
    Ok(decoder)
}

struct Receiving<S> {
    receiver: Receiver<S, MOST>,
    channels: usize,
    /// What a 1 is in the unit of the decoders.
    one: f64,
    /// Beside what the receiver itself counts.
    outside: u64,
    /// Whether keyframes are what a decoder holds already.
    are_held: bool,
    held: Held,
    decoded: Vec<(u16, u32, S)>,
}

impl<S: Raw> Receiving<S> {
    fn new(decoders: &[StepDecoder<S>], one: f64, are_held: bool) -> Result<Self> {
        let (channels, same) = match decoders {
            [one] => (MOST, Some(*one)),
            [first, ..] if decoders.len() <= MOST => (decoders.len(), Some(*first)),
            _ => (0, None),
        };
        let Some(same) = same else { bail!("a receiver has 1 to {MOST} channels") };
        let decoders = std::array::from_fn(|channel| *decoders.get(channel).unwrap_or(&same));
        let receiver = Receiver::from_decoders(decoders);
        let (held, decoded) = (Held::default(), Vec::new());
        Ok(Self { receiver, channels, one, outside: 0, are_held, held, decoded })
    }

    /// Compares keyframes with what their channels hold before them, where that is exact.
    fn compare(&mut self, received: &Received<'_>) {
        if received.is_after_break() {
            return;
        }
        let has_decoder = |address: u16| usize::from(address) < self.channels;
        for keyframe in received.frame.keyframes().filter(|keyframe| has_decoder(keyframe.address))
        {
            if let Some(value) = self.receiver.exact(keyframe.address) {
                self.held.compared += 1;
                self.held.contradicted += u64::from(value.to_raw() != keyframe.raw);
            }
        }
    }
}

impl<S: Raw> Values for Receiving<S> {
    fn apply(&mut self, received: &Received<'_>, items: &mut Vec<Item>) {
        if self.are_held {
            self.compare(received);
        }
        let Self { receiver, channels, one, outside, decoded, .. } = self;
        let frame = &received.frame;
        // Keyframes come first.
        let applied = |address: u16| usize::from(address) < MOST && frame.is_wide() == S::IS_WIDE;
        let keyframes = frame.keyframes().filter(|keyframe| applied(keyframe.address)).count();
        receiver.apply(received, |address, tick, value| decoded.push((address, tick, value)));
        for (place, (address, tick, value)) in decoded.drain(..).enumerate() {
            if usize::from(address) >= *channels {
                *outside += 1;
                continue;
            }
            let known = if place < keyframes {
                Known::Keyframe
            } else if receiver.exact(address).is_some() {
                Known::Exact
            } else {
                Known::Estimate
            };
            items.push(Item::Value { tick, address, value: value.to_f64() / *one, known });
        }
    }

    fn outside(&self) -> u64 {
        self.outside + u64::from(self.receiver.outside())
    }

    fn misfits(&self) -> u64 {
        self.receiver.misfits().into()
    }

    fn held(&self) -> Held {
        self.held
    }
}
