//! Both ends of a flight in Rust.

use crate::{Flight, FlightError, FlightErrorKind};
use catalogue::run::{Constant, Rust};
use std::fmt::{Debug, Write};

/// Writes the module `flight` of a flight in Rust, for `include!`. It needs the crate `spikewire` with the feature `link`,
/// and the crate `fixed` if its samples are fixed point.
///
/// | item | |
/// |---|---|
/// | `CHANNELS`, `NAMES`, `UNITS`, `COUNTS` | number of channels, their names, units, counts a unit |
/// | `Code`, `SCHEMES` | the type of their schemes, and the schemes, in flash |
/// | `Bank`, `BANK` | the encoders before the first sample |
/// | `LABEL` | what the schemes do not say of the flight, in a text |
/// | `PERIOD`, `KEYFRAME_EVERY` | µs from sample to sample; samples from one keyframe to the next |
/// | `CODING`, `transmitter(session)` | the sender's half of the link |
/// | `EVENTS`, `Receiver`, `receiver()` | the receiver's half |
///
/// # Errors
/// Returns an error if the scheme has no constant: those by chance take a generator of the user's.
pub fn rust(flight: &Flight) -> Result<String, FlightError> {
    // Channels with the same parameters share them.
    let mut statics: Vec<(Constant, Vec<&str>)> = Vec::new();
    let mut schemes = Vec::new();
    for (channel, own) in flight.channels.iter().enumerate() {
        let constant = flight.constant(channel)?;
        let place = statics.iter().position(|(known, _)| *known == constant);
        let place = place.unwrap_or_else(|| {
            statics.push((constant, Vec::new()));
            statics.len() - 1
        });
        statics[place].1.push(&own.name);
        schemes.push(format!("&SCHEME_{place}"));
    }
    let Some((Constant { scheme: code, .. }, _)) = statics.first() else {
        return Err(FlightError::new("channel", FlightErrorKind::Missing));
    };
    let (channels, coding) = (flight.channels.len(), flight.coding());
    let names = listed(flight.channels.iter().map(|own| &own.name));
    let units = listed(flight.channels.iter().map(|own| &own.unit));
    let counts = listed(flight.channels.iter().map(|own| own.counts));
    let slots = match flight.slot_ticks() {
        0 => String::new(),
        ticks => format!(".with_slot_ticks({ticks})"),
    };
    let jitter = match coding.jitter_bits {
        0 => String::new(),
        bits => format!(".with_jitter_bits({bits})"),
    };
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
        "Units of the channels, empty where they are not known.",
        format!("pub const UNITS: [&str; CHANNELS] = [{units}];"),
    );
    item(
        "Counts for one unit of each channel.",
        format!("pub const COUNTS: [f64; CHANNELS] = [{counts}];"),
    );
    item("The code of every channel.", format!("pub type Code = {code};"));
    for (place, (Constant { value, .. }, of)) in statics.iter().enumerate() {
        let words = format!("Parameters of {}.", of.join(", ").replace(['\n', '\r'], " "));
        item(&words, format!("static SCHEME_{place}: Code = {value};"));
    }
    item(
        "The scheme of each channel.",
        format!("pub const SCHEMES: [&Code; CHANNELS] = [{}];", schemes.join(", ")),
    );
    item(
        "The type of the bank.",
        "pub type Bank = spikewire::Bank<[&'static Code; CHANNELS], CHANNELS>;".to_owned(),
    );
    item(
        "The encoders, before the first sample.",
        format!("pub const BANK: Bank = spikewire::Bank::per_channel(SCHEMES){slots};"),
    );
    item(
        "What the schemes do not say of the flight: period, names, units, counts. Both ends compare it.",
        format!("pub const LABEL: &str = {:?};", flight.label()),
    );
    item("µs from sample to sample.", format!("pub const PERIOD: u16 = {};", flight.period));
    item(
        "Samples from one keyframe or heartbeat to the next.",
        format!("pub const KEYFRAME_EVERY: u32 = {};", flight.keyframe_every),
    );
    item(
        "The bits that the parts of an event take on the link.",
        format!(
            "pub const CODING: spikewire::link::Coding = spikewire::link::Coding::for_channels({}, PERIOD){jitter};",
            channels * flight.neurons()
        ),
    );
    item(
        "The sender's half of the link, before the first frame of this session. Its frames carry the fingerprint of bank and label.",
        "#[must_use]\npub fn transmitter(session: spikewire::link::Session) -> spikewire::link::Transmitter {\n    \
             spikewire::link::Transmitter::new(CODING, session).with_fingerprint(BANK.fingerprint()).with_label(LABEL)\n}"
            .to_owned(),
    );
    item(
        "The most events of a sample that the receiver keeps.",
        format!("pub const EVENTS: usize = {};", flight.events()),
    );
    item(
        "The type of the receiver.",
        "pub type Receiver = spikewire::link::Receiver<[&'static Code; CHANNELS], CHANNELS, EVENTS>;"
            .to_owned(),
    );
    item(
        "The receiver's half of the link, before the first frame.",
        format!(
            "#[must_use]\npub fn receiver() -> Receiver {{\n    Receiver::per_channel(SCHEMES){slots}.with_clock_tolerance({}).with_label(LABEL)\n}}",
            flight.clock_ppm
        ),
    );
    Ok(module(&items))
}

/// The module of these items.
fn module(items: &str) -> String {
    let lines = items
        .lines()
        .map(|line| if line.is_empty() { "\n".to_owned() } else { format!("    {line}\n") });
    format!(
        "/// Both ends of a flight, written from its file.\n#[allow(dead_code, unreachable_pub, clippy::all, clippy::pedantic)]\npub mod flight {{\n{}}}\n",
        lines.skip(1).collect::<String>()
    )
}

/// Values as a list in Rust.
fn listed<T: Debug>(values: impl Iterator<Item = T>) -> String {
    values.map(|own| format!("{own:?}")).collect::<Vec<_>>().join(", ")
}

impl Flight {
    /// The scheme of a channel, behind the flight's filter, as a constant in Rust.
    ///
    /// # Errors
    /// Returns an error if there is no such channel, or the scheme has no constant.
    pub fn constant(&self, channel: usize) -> Result<Constant, FlightError> {
        let error = |name, kind| FlightError::new(name, kind).of_channel(channel);
        let settings = self.settings().get(channel);
        let settings = settings.ok_or_else(|| error("channel", FlightErrorKind::Missing))?;
        let constant = self.run_time().constant(settings);
        let constant = constant.map_err(|_| error("scheme", FlightErrorKind::NoConstant))?;
        let Some(filter) = self.filter else { return Ok(constant) };
        let sample = Rust::new(self.sample).sample();
        let own = [constant.scheme, constant.value];
        let [scheme, value] = filter.constant(&sample, self.rate() as f32, own);
        Ok(Constant { scheme, value })
    }
}
