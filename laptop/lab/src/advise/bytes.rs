//! Bytes on a wire: of a code's frames, and of what else could be sent in their place.

use crate::Result;
use crate::flight::Flight;
use crate::trial::Trial;
use catalogue::run::{Event as Fired, SampleType};
use serde::Serialize;
use spikewire::link::{Coding, MAX_FRAME, Session, Transmitter};
use spikewire::{Event, FromItems, Item, Keyframe, SampleKind, Tick};

/// Number of bytes a frame of raw samples takes beside them: as in a link written by hand, a start, a number and a
/// checksum.
const FRAME: f64 = 4.0;

/// Rate in Hz to which low-passed samples are thinned out in place of a code.
const SLOWER: f64 = 125.0;

/// Samples of all channels in lean frames, without a code.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lean {
    /// Number of channels.
    pub(super) channels: usize,
    /// Type of the samples.
    pub(super) sample: SampleType,
}

impl Lean {
    /// Returns the number of bytes a second at `rate` samples a second, a frame for each sample of all channels.
    pub(super) fn bytes_per_second(self, rate: f64) -> f64 {
        rate * (FRAME + self.channels as f64 * self.value())
    }

    /// Returns the number of bytes of one value.
    fn value(self) -> f64 {
        if matches!(self.sample, SampleType::Fixed16 { .. }) { 2.0 } else { 4.0 }
    }
}

/// Something else that could be sent in place of a code, in the same lean frames.
#[derive(Debug, Serialize)]
pub(super) struct Rival {
    /// Description in a few words.
    pub(super) name: String,
    pub(super) bytes_per_second: f64,
}

/// Returns what could be sent in place of a flight's code: the samples, low-passed samples at 125 Hz and, if the code has
/// thresholds, a dead band: the value of each channel that has moved by its threshold since it was last sent. `channels` are
/// the samples that the encoders get, `rate` a second.
pub(super) fn rivals(flight: &Flight, channels: &[Vec<f64>], rate: f64) -> Vec<Rival> {
    let lean = Lean { channels: flight.channels.len(), sample: flight.sample };
    let mut rivals =
        vec![Rival { name: "samples".to_owned(), bytes_per_second: lean.bytes_per_second(rate) }];
    if rate > SLOWER {
        rivals.push(Rival {
            name: format!("low-passed samples at {SLOWER} Hz"),
            bytes_per_second: lean.bytes_per_second(SLOWER),
        });
    }
    let thresholds = flight.settings().iter().map(|settings| settings.number("threshold").ok());
    if flight.scheme.has_baseline()
        && let Some(thresholds) = thresholds.collect::<Option<Vec<f64>>>()
    {
        let band = DeadBand { lean, thresholds: &thresholds };
        rivals.push(Rival {
            name: "a dead band of values with the code's thresholds".to_owned(),
            bytes_per_second: band.bytes_per_second(channels, rate),
        });
    }
    rivals
}

/// A sender of the values that have moved by their threshold.
struct DeadBand<'a> {
    lean: Lean,
    thresholds: &'a [f64],
}

impl DeadBand<'_> {
    fn bytes_per_second(&self, channels: &[Vec<f64>], rate: f64) -> f64 {
        let samples = channels.iter().map(Vec::len).min().unwrap_or_default();
        let mut known = vec![f64::NAN; channels.len()];
        let mut bytes = 0.0;
        for sample in 0..samples {
            let mut sent = 0.0;
            for ((known, channel), threshold) in known.iter_mut().zip(channels).zip(self.thresholds)
            {
                let value = channel[sample];
                // The first value is always sent: nothing is known of a channel before it.
                if known.is_nan() || (value - *known).abs() > *threshold {
                    *known = value;
                    sent += self.lean.value();
                }
            }
            if sent > 0.0 {
                bytes += FRAME + sent;
            }
        }
        bytes * rate / samples.max(1) as f64
    }
}

/// The transmitter of a code's events and the bytes of its frames so far.
struct Sent<'a> {
    transmitter: Transmitter,
    trials: &'a [Trial],
    /// Number of neurons of a channel.
    neurons: u16,
    /// Sample type of the keyframes.
    kind: SampleKind,
    items: Vec<Item>,
    bytes: usize,
}

impl Sent<'_> {
    /// Adds the keyframes after this sample, or a heartbeat of a code without keyframes.
    fn keyframes(&mut self, sample: usize, tick: Tick) {
        let has_keyframes =
            self.trials.first().is_some_and(|own| own.scheme.info().has_first_value());
        if !has_keyframes {
            self.items.push(Item::Heartbeat { tick, address: 0 });
            return;
        }
        for (channel, trial) in (0..).zip(self.trials) {
            let value = trial.decoded.get(sample).copied().unwrap_or_default();
            let keyframe = Keyframe::new(tick, channel * self.neurons, value as f32);
            self.items.push(Item::Keyframe(Keyframe { kind: self.kind, ..keyframe }));
        }
    }

    /// Sends all items.
    fn flush(&mut self) -> Result<()> {
        let mut buffer = [0; MAX_FRAME];
        let mut source = FromItems(self.items.drain(..));
        while let Some(frame) = self.transmitter.next_frame(&mut source, &mut buffer)? {
            self.bytes += frame.len();
        }
        Ok(())
    }
}

/// Returns the number of bytes that a trial's events take as frames of `spikewire`'s link, each of which is sent once it is
/// full. If the scheme's decoder needs keyframes, the bytes include one every `keyframe_every` samples of the whole recording.
/// `rate` is the number of samples a second.
///
/// # Errors
/// Returns an error if the link cannot express the events.
pub fn link_bytes(trial: &Trial, rate: f64, keyframe_every: u64) -> Result<f64> {
    let period = (1e6 / rate).round().max(1.0) as u32;
    let channels = u16::try_from(trial.shape.neurons).unwrap_or(u16::MAX);
    let mut sent = Sent {
        transmitter: Transmitter::new(Coding::for_channels(channels, period), Session::counted(0)),
        trials: std::slice::from_ref(trial),
        neurons: channels,
        kind: trial.settings.sample.into(),
        items: Vec::new(),
        bytes: 0,
    };
    let mut events = trial.events.iter().peekable();
    for sample in 0..trial.decoded.len() {
        let tick = Tick::from_micros(sample as u64 * u64::from(period));
        while let Some(event) = events.next_if(|own| own.sample <= sample as u64) {
            let Fired { neuron: address, polarity, .. } = *event;
            sent.items.push(Item::Event(Event { tick, address, polarity }));
        }
        let is_due = (sample as u64).is_multiple_of(keyframe_every.max(1));
        if is_due && trial.scheme.info().has_first_value() {
            sent.keyframes(sample, tick);
        }
    }
    sent.flush()?;
    Ok(sent.bytes as f64)
}

/// Events and bytes of a flight on the link.
#[derive(Clone, Copy, Debug)]
pub(super) struct Traffic {
    pub(super) events: usize,
    pub(super) bytes: usize,
}

/// Returns the events of all channels of a flight, and the bytes that its transmitter sends for `samples` samples, including
/// keyframes. If `in_loop` is true, each sample is sent in a frame of its own, as a control loop needs it. Otherwise, events of
/// several samples share a frame.
pub(super) fn sent(
    flight: &Flight,
    trials: &[Trial],
    samples: u64,
    in_loop: bool,
) -> Result<Traffic> {
    let (neurons, period) = (flight.neurons() as u16, u64::from(flight.period.get()));
    let mut events: Vec<Fired> = Vec::new();
    for (channel, trial) in (0..).zip(trials) {
        let own = trial.events.iter();
        events.extend(own.map(|own| Fired { neuron: channel * neurons + own.neuron, ..*own }));
    }
    events.sort_by_key(|own| (own.sample, own.slot, own.neuron));
    let mut sent = Sent {
        transmitter: flight.transmitter(Session::counted(0)),
        trials,
        neurons,
        kind: flight.sample.into(),
        items: Vec::new(),
        bytes: 0,
    };
    let mut rest = events.iter().peekable();
    for sample in 0..samples {
        let tick = Tick::from_micros(sample * period);
        while let Some(own) = rest.next_if(|own| own.sample <= sample) {
            let tick = tick + u32::from(own.slot) * flight.slot_ticks();
            let event = Event { tick, address: own.neuron, polarity: own.polarity };
            sent.items.push(Item::Event(event));
        }
        if sample.is_multiple_of(flight.keyframe_every.into()) {
            sent.keyframes(sample as usize, tick);
        }
        if in_loop {
            sent.flush()?;
        }
    }
    sent.flush()?;
    Ok(Traffic { events: events.len(), bytes: sent.bytes })
}

#[cfg(test)]
mod tests {
    use super::{DeadBand, Lean, link_bytes};
    use crate::scheme::Scheme;
    use crate::trial::{Recording, Trial};
    use catalogue::run::{Asked, SampleType};

    /// A code that sends no spike still sends its keyframes, over the whole recording.
    #[test]
    fn a_silent_code_costs_its_keyframes() {
        let recording = Recording::of("still".to_owned(), vec![0.25; 1000], Some(100.0));
        let mut asked = Asked::default();
        asked.set("threshold", 1.0);
        let trial = Trial::new(Scheme::named("sf").unwrap(), &asked, SampleType::F32, &recording);
        let trial = trial.unwrap();
        assert!(trial.events.is_empty());
        let (rare, often) = (link_bytes(&trial, 100.0, 100), link_bytes(&trial, 100.0, 10));
        // A short frame with a keyframe of 4 bytes takes 17 bytes or more.
        assert!(rare.as_ref().is_ok_and(|bytes| *bytes >= 10.0 * 17.0), "{rare:?}");
        assert!(often.unwrap() > 5.0 * rare.unwrap());
    }

    /// Samples in lean frames have 4 bytes beside their own, which are 2 in 16 bits.
    #[test]
    fn rivals_have_frames_of_4_bytes() {
        let sample = SampleType::Fixed16 { fraction: 8 };
        let lean = Lean { channels: 6, sample };
        assert_eq!(lean.bytes_per_second(500.0), 8000.0);
        assert_eq!(Lean { sample: SampleType::F32, ..lean }.bytes_per_second(500.0), 14_000.0);
        let band = DeadBand { lean: Lean { channels: 2, sample }, thresholds: &[1.0, 1.0] };
        // Both values at first, then one of the first channel, and one of each.
        let channels = [vec![0.0, 1.0, 1.5, 1.5, 3.0], vec![0.0, 1.0, 1.0, 1.0, -1.5]];
        assert_eq!(band.bytes_per_second(&channels, 5.0), 8.0 + 6.0 + 8.0);
    }
}
