//! What a board sends, while it comes: `spikewire listen` in a thread of its own.
//!
//! The bytes are asked for in the middle of the call, which the browser suspends until there are some.

use crate::host::{self, send, tell};
use crate::run::Choice;
use crate::words::label;
use anyhow::{Context, Result, bail};
use catalogue::run::{Known as Given, Worded};
use lab::events::{EventReader, EventWriter, Item, Known, LinkReader, values_writer};
use lab::events::{Format, Stream};
use lab::fit::rounding;
use lab::values::with_receiver;
use serde::Deserialize;
use serde_json::{Value, json};
use spikewire::Polarity;
use std::cell::RefCell;
use std::io::Write;
use std::rc::Rc;

/// How the bytes are read.
#[derive(Deserialize)]
pub(crate) struct Listen {
    /// The sender's scheme, if values are wanted.
    choice: Option<Choice>,
    /// Thresholds of each channel, in the place of the one of the scheme.
    thresholds: Vec<f64>,
    /// Length of the sender's sub-timesteps, in µs.
    slot_ticks: Option<u32>,
}

/// Listens until there are no more bytes; returns what should be known at the end.
pub(crate) fn listen(options: &Listen) -> Result<Value> {
    let Some(choice) = &options.choice else {
        return hear(None);
    };
    let (scheme, sample, mut asked) = choice.read()?;
    asked.paper = false;
    if !options.thresholds.is_empty() {
        asked.set("threshold", options.thresholds.clone());
    }
    let info = scheme.info();
    // Any value will do of what is the encoder's alone.
    for parameter in info.parameters.iter().filter(|own| own.is_of_encoder) {
        if asked.get(parameter.name).is_none() {
            asked.set(parameter.name, parameter.read(parameter.example)?);
        }
    }
    if let Some(missing) = scheme.needs_signal(&asked) {
        let missing = missing.spelled(label);
        bail!("{} needs {missing}, as the sender has it", scheme.name());
    }
    let known = Given { calibrated: None, first: &[0.0], can_calibrate: false };
    let channels = asked.channels(info)?.unwrap_or(1);
    let mut settings = Vec::new();
    for channel in 0..channels {
        settings.push(scheme.resolve(sample, &asked.channel(info, channel, channels)?, &known)?);
    }
    let first = settings.first().context("a receiver has at least one channel")?;
    let has_slots = !info.has_first_value() && scheme.shape(first)?.slots > 1;
    if has_slots && options.slot_ticks.is_none() {
        bail!("{} needs the length of the sender's sub-timesteps", scheme.name());
    }
    let slot_ticks = options.slot_ticks.filter(|_| has_slots);
    let mut said: Vec<String> = settings.iter().filter_map(rounding).collect();
    said.dedup();
    let mut heard = Ok(Value::Null);
    with_receiver(scheme, sample, &settings, slot_ticks, |values| {
        let reader = Box::new(LinkReader::new(Some(values)));
        heard = hear(Some((reader, values_writer(sample))));
        Ok(())
    })?;
    let mut answer = heard?;
    answer["rounding"] = said.into();
    Ok(answer)
}

/// Reads the board's bytes for spikes, and for values where there is something to decode them.
fn hear(values: Option<(Box<dyn EventReader + '_>, Box<dyn EventWriter>)>) -> Result<Value> {
    let format: Format = "link".parse()?;
    let heard = Rc::new(RefCell::new(Heard::default()));
    let stream = |(reader, own), is_values| {
        Stream::new(reader, Box::new(Recorder { own, heard: heard.clone(), is_values }), false)
    };
    let mut spikes = stream((format.reader("the board"), Format::Csv.writer(false)?), false);
    let mut values = values.map(|values| stream(values, true));
    let (mut spikes_file, mut values_file) = (Vec::new(), Vec::new());
    let mut buffer = vec![0; 1 << 14];
    loop {
        let bytes = host::hear(&mut buffer)?;
        let is_end = bytes.is_empty();
        let both = [(Some(&mut spikes), &mut spikes_file), (values.as_mut(), &mut values_file)];
        for (stream, file) in both {
            let Some(stream) = stream else { continue };
            if is_end { stream.finish(file)? } else { stream.push(bytes, None, file)? }
        }
        heard.take().send();
        send("spikes", &std::mem::take(&mut spikes_file));
        send("values", &std::mem::take(&mut values_file));
        let tally = spikes.tally();
        let (frames, lost) = tally.link.map_or((0, 0), |link| (link.frames, link.lost));
        let counts = json!({
            "bytes": spikes.bytes(), "spikes": spikes.count(), "frames": frames, "lost": lost,
            "skipped": tally.skipped, "values": values.as_ref().map_or(0, Stream::count),
        });
        tell(&counts);
        if is_end {
            let stream = values.as_ref().unwrap_or(&spikes);
            let wrong = stream.check_format(format, "the board").err();
            let words = stream.spelled(label).to_string();
            let error = wrong.map(|error| error.spelled(label).to_string());
            return Ok(json!({ "words": words, "wrong": error }));
        }
    }
}

/// What came since the page was told, for its picture.
#[derive(Default)]
struct Heard {
    spike_ticks: Vec<u32>,
    spike_addresses: Vec<u16>,
    ups: Vec<u8>,
    ticks: Vec<u32>,
    addresses: Vec<u16>,
    numbers: Vec<f64>,
    /// Whether the values are bit for bit the sender's.
    exact: Vec<u8>,
}

impl Heard {
    fn send(self) {
        send("spikeTicks", &self.spike_ticks);
        send("spikeAddresses", &self.spike_addresses);
        send("ups", &self.ups);
        send("ticks", &self.ticks);
        send("addresses", &self.addresses);
        send("numbers", &self.numbers);
        send("exact", &self.exact);
    }
}

/// Writes a file, and notes what the picture shows.
struct Recorder {
    own: Box<dyn EventWriter>,
    heard: Rc<RefCell<Heard>>,
    is_values: bool,
}

impl EventWriter for Recorder {
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> lab::Result<()> {
        let mut heard = self.heard.borrow_mut();
        match *item {
            Item::Event(event) if !self.is_values => {
                heard.spike_ticks.push(event.tick.micros());
                heard.spike_addresses.push(event.address);
                heard.ups.push((event.polarity == Polarity::Up).into());
            }
            Item::Value { tick, address, value, known } => {
                heard.ticks.push(tick.micros());
                heard.addresses.push(address);
                heard.numbers.push(value);
                heard.exact.push((known != Known::Estimate).into());
            }
            _ => {}
        }
        self.own.write(item, output)
    }

    fn finish(&mut self, output: &mut dyn Write) -> lab::Result<()> {
        self.own.finish(output)
    }

    fn notes(&self) -> Vec<String> {
        self.own.notes()
    }
}
