//! Generates sender and receiver of a flight in Rust.

use crate::{Flight, FlightError, FlightErrorKind, UnitSize, escaped};
use catalogue::run::{Constant, Rust};
use spikewire::link::{Coding, Transmitter};
use std::fmt::{Debug, Write};

/// Returns the source code of a module `flight`, for `include!`. It needs the crate `spikewire` with the feature
/// `link`, and the crate `fixed` if the samples are fixed point.
///
/// | item | |
/// |---|---|
/// | `CHANNELS`, `NAMES`, `UNITS`, `COUNTS` | number of channels; their names; their units; the number of counts in one unit of each |
/// | `SI` | size of each unit, in rad/s and in m/s²; 0 where the unit is none of that quantity |
/// | `Code`, `SCHEMES` | type of the channels' schemes; the schemes, in flash |
/// | `Bank`, `BANK` | type of the bank of encoders; the bank before the first sample |
/// | `LABEL` | period, names, units and counts as text, a part of the fingerprint |
/// | `PERIOD`, `KEYFRAME_EVERY` | µs from one sample to the next; samples from one keyframe to the next |
/// | `CODING`, `transmitter(session)` | frame format; the sender's half of the link |
/// | `EVENTS`, `Receiver`, `receiver()` | events that a receiver stores for a sample; the receiver's half of the link |
///
/// # Errors
/// Returns an error if the scheme cannot be written as a constant: random codes need a generator of the user's.
pub fn rust(flight: &Flight) -> Result<String, FlightError> {
    let (statics, schemes) = constants(flight)?;
    let Some((Constant { scheme: code, .. }, _)) = statics.first() else {
        return Err(FlightError::new("channel", FlightErrorKind::Missing));
    };
    let (channels, coding) = (flight.channels.len(), flight.coding());
    let names = listed(flight.channels.iter().map(|channel| &channel.name));
    let units = listed(flight.channels.iter().map(|channel| &channel.unit));
    let counts = listed(flight.channels.iter().map(|channel| channel.counts));
    let (slots, bits, sending) = (slots(flight), bits(coding), sending(flight));
    let mut items = String::new();
    let mut item = |words: &str, code: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(items, "\n/// {words}\n{code}");
    };
    item("Number of channels.", format!("pub const CHANNELS: usize = {channels};"));
    item(
        "Names of the channels, in the order of a sample.",
        format!("pub const NAMES: [&str; CHANNELS] = [{names}];"),
    );
    item(
        "Units of the channels, empty where unknown.",
        format!("pub const UNITS: [&str; CHANNELS] = [{units}];"),
    );
    item(
        "Number of counts in one unit of each channel.",
        format!("pub const COUNTS: [f64; CHANNELS] = [{counts}];"),
    );
    item(
        "Size of each channel's unit, in rad/s and in m/s²; 0 where the unit is none of that quantity.",
        format!("pub const SI: [[f64; 2]; CHANNELS] = [{}];", listed(sizes(flight).into_iter())),
    );
    item("Type of every channel's scheme.", format!("pub type Code = {code};"));
    let rounded = flight.rounded();
    for (index, (Constant { value, .. }, names)) in statics.iter().enumerate() {
        let mut words = format!("Scheme with the parameters of {}.", escaped(&names.join(", ")));
        for rounded in rounded.iter().filter(|rounded| names.contains(&rounded.channel.as_str())) {
            // Writing to a string cannot fail.
            let _ = write!(words, "\n/// Rounded: {}.", escaped(&rounded.to_string()));
        }
        item(&words, format!("static SCHEME_{index}: Code = {value};"));
    }
    item(
        "Scheme of each channel.",
        format!("pub const SCHEMES: [&Code; CHANNELS] = [{}];", schemes.join(", ")),
    );
    item(
        "Type of the bank of encoders.",
        "pub type Bank = spikewire::Bank<[&'static Code; CHANNELS], CHANNELS>;".to_owned(),
    );
    item(
        "Encoders of all channels, in their state before the first sample.",
        format!("pub const BANK: Bank = {}{slots};", bank(flight, &schemes)?),
    );
    item(
        "Period, names, units and counts as text. The fingerprints that sender and receiver compare include it.",
        format!("pub const LABEL: &str = {:?};", flight.label()),
    );
    item(
        "Time from one sample to the next, in µs.",
        format!("pub const PERIOD: u32 = {};", flight.period),
    );
    item(
        "Number of samples from one keyframe or heartbeat to the next.",
        format!("pub const KEYFRAME_EVERY: u32 = {};", flight.keyframe_every),
    );
    item(
        "Frame format: the number of bits for each part of an event, and the period.",
        format!(
            "pub const CODING: spikewire::link::Coding = spikewire::link::Coding::for_channels({}, PERIOD){bits};",
            channels * flight.neurons()
        ),
    );
    item(
        "Returns the sender's half of the link, before the first frame of this session. Its frames carry the fingerprint of bank and label.",
        format!(
            "#[must_use]\npub fn transmitter(session: spikewire::link::Session) -> spikewire::link::Transmitter {{\n    \
             spikewire::link::Transmitter::new(CODING, session).with_addresses(0..={}).with_fingerprint(BANK.fingerprint()).with_label(LABEL){sending}\n}}",
            channels * flight.neurons() - 1
        ),
    );
    item(
        "Maximum number of events of a sample that the receiver stores.",
        format!("pub const EVENTS: usize = {};", flight.events()),
    );
    item(
        "Type of the receiver's half of the link.",
        "pub type Receiver = spikewire::link::Receiver<[&'static Code; CHANNELS], CHANNELS, EVENTS>;"
            .to_owned(),
    );
    item(
        "Returns the receiver's half of the link, before the first frame.",
        format!(
            "#[must_use]\npub fn receiver() -> Receiver {{\n    Receiver::per_channel(SCHEMES){slots}.with_clock_tolerance({}).with_label(LABEL)\n}}",
            flight.clock_ppm
        ),
    );
    Ok(module(&items))
}

/// Returns the call that sets the length of a sub-timestep, if the scheme has sub-timesteps.
fn slots(flight: &Flight) -> String {
    match flight.slot_ticks() {
        0 => String::new(),
        ticks => format!(".with_slot_ticks({ticks})"),
    }
}

/// Returns the calls that set the frame format's bits for jitter and step numbers, where there are some.
fn bits(coding: Coding) -> String {
    let mut calls = String::new();
    // Writing to a string cannot fail.
    if coding.jitter_bits > 0 {
        let _ = write!(calls, ".with_jitter_bits({})", coding.jitter_bits);
    }
    if coding.step_bits > 0 {
        let _ = write!(calls, ".with_step_bits({})", coding.step_bits);
    }
    calls
}

/// Returns the calls that set when a transmitter sends, where that is not the usual time.
fn sending(flight: &Flight) -> String {
    let mut calls = String::new();
    // Writing to a string cannot fail.
    if flight.gathering > 0 {
        let _ = write!(calls, ".with_gathering({})", flight.gathering);
    }
    if flight.full_every != Transmitter::FULL_EVERY {
        let _ = write!(calls, ".with_full_every({})", flight.full_every);
    }
    calls
}

/// Returns the size of each channel's unit in rad/s and in m/s²; 0 where the unit is none of that quantity.
fn sizes(flight: &Flight) -> Vec<[f64; 2]> {
    let mut sizes = Vec::new();
    for channel in &flight.channels {
        let size = UnitSize::of(&channel.unit);
        let rate = size.and_then(UnitSize::rate).unwrap_or_default();
        sizes.push([rate, size.and_then(UnitSize::acceleration).unwrap_or_default()]);
    }
    sizes
}

/// Returns the bank without sub-timesteps, in Rust. `schemes` has a reference to the scheme of each channel.
///
/// # Errors
/// Returns an error if the scheme cannot be written as a constant.
fn bank(flight: &Flight, schemes: &[String]) -> Result<String, FlightError> {
    let starts = flight.settings().iter().map(|settings| settings.number("start").ok());
    let starts: Vec<Option<f64>> = starts.collect();
    if starts.iter().all(Option::is_none) {
        return Ok("spikewire::Bank::per_channel(SCHEMES)".to_owned());
    }
    let rust = Rust::new(flight.sample);
    let mut channels = Vec::new();
    for ((channel, scheme), start) in schemes.iter().enumerate().zip(starts) {
        let Some(start) = start else {
            channels.push(format!("({scheme}, <Code as spikewire::Start>::START)"));
            continue;
        };
        let Constant { scheme: unfiltered, .. } = flight.unfiltered(channel)?;
        let state = format!("<{unfiltered}>::state_at({})", rust.number(start));
        let state = match flight.filter {
            Some(_) => format!("Code::start({state})"),
            None => state,
        };
        channels.push(format!("({scheme}, {state})"));
    }
    Ok(format!("spikewire::Bank::per_channel_with_states([{}])", channels.join(", ")))
}

/// Constants of a flight's schemes, each with the names of its channels, and for each channel a reference to its constant.
type Constants<'a> = (Vec<(Constant, Vec<&'a str>)>, Vec<String>);

/// Returns the constants of a flight's schemes. Channels with the same parameters share one.
fn constants(flight: &Flight) -> Result<Constants<'_>, FlightError> {
    let mut statics: Vec<(Constant, Vec<&str>)> = Vec::new();
    let mut schemes = Vec::new();
    for (channel, described) in flight.channels.iter().enumerate() {
        let constant = flight.constant(channel)?;
        let index = statics.iter().position(|(known, _)| *known == constant);
        let index = index.unwrap_or_else(|| {
            statics.push((constant, Vec::new()));
            statics.len() - 1
        });
        statics[index].1.push(&described.name);
        schemes.push(format!("&SCHEME_{index}"));
    }
    Ok((statics, schemes))
}

/// Returns the source code of the module with these items.
fn module(items: &str) -> String {
    let lines = items
        .lines()
        .map(|line| if line.is_empty() { "\n".to_owned() } else { format!("    {line}\n") });
    format!(
        "/// Sender and receiver of a flight, generated from its flight file.\n#[allow(dead_code, unreachable_pub, clippy::all, clippy::pedantic)]\npub mod flight {{\n{}}}\n",
        lines.skip(1).collect::<String>()
    )
}

/// Returns values as the items of a list in Rust: their debug form, separated by commas.
fn listed<T: Debug>(values: impl Iterator<Item = T>) -> String {
    values.map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ")
}

impl Flight {
    /// Returns the scheme of a channel, including the flight's filter, as a constant in Rust.
    ///
    /// # Errors
    /// Returns an error if there is no such channel, or if the scheme cannot be written as a constant.
    pub fn constant(&self, channel: usize) -> Result<Constant, FlightError> {
        let constant = self.unfiltered(channel)?;
        let Some(filter) = self.filter else { return Ok(constant) };
        let sample = Rust::new(self.sample).sample();
        let unfiltered = [constant.scheme, constant.value];
        let [scheme, value] = filter.constant(&sample, self.rate() as f32, unfiltered);
        Ok(Constant { scheme, value })
    }

    /// Returns the scheme of a channel, without the flight's filter, as a constant in Rust.
    ///
    /// # Errors
    /// See [`constant`](Self::constant).
    fn unfiltered(&self, channel: usize) -> Result<Constant, FlightError> {
        let error = |name, kind| FlightError::new(name, kind).of_channel(channel);
        let settings = self.settings().get(channel);
        let settings = settings.ok_or_else(|| error("channel", FlightErrorKind::Missing))?;
        let constant = self.run_time().constant(settings);
        constant.map_err(|_| error("scheme", FlightErrorKind::NoConstant))
    }
}
