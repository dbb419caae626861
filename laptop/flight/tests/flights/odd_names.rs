/// Sender and receiver of a flight, generated from its flight file.
#[allow(dead_code, unreachable_pub, clippy::all, clippy::pedantic)]
pub mod flight {
    /// Number of channels.
    pub const CHANNELS: usize = 4;

    /// Names of the channels, in the order of a sample.
    pub const NAMES: [&str; CHANNELS] = ["e\u{301}", "a\u{85}b", "\u{202e}*/ x", "x??/'\"\\"];

    /// Units of the channels, empty where unknown.
    pub const UNITS: [&str; CHANNELS] = ["rad/s", "rad/s", "1\u{2028}", "g"];

    /// Number of counts in one unit of each channel.
    pub const COUNTS: [f64; CHANNELS] = [1.0, 1.0, 1.0, 1.0];

    /// Size of each channel's unit, in rad/s and in m/s²; 0 where the unit is none of that quantity.
    pub const SI: [[f64; 2]; CHANNELS] = [[1.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 9.80665]];

    /// Type of every channel's scheme.
    pub type Code = spikewire::temporal::SendOnDelta<fixed::types::I8F8, 4>;

    /// Scheme with the parameters of e\u{301}, a\u{85}b, \u{202e}*/ x, x??/'"\.
    /// Rounded: e\u{301}: threshold 0.1 is 0.1015625 in q8.8.
    /// Rounded: a\u{85}b: threshold 0.1 is 0.1015625 in q8.8.
    /// Rounded: \u{202e}*/ x: threshold 0.1 is 0.1015625 in q8.8.
    /// Rounded: x??/'"\: threshold 0.1 is 0.1015625 in q8.8.
    static SCHEME_0: Code = spikewire::temporal::SendOnDelta::new(fixed::types::I8F8::from_bits(26));

    /// Scheme of each channel.
    pub const SCHEMES: [&Code; CHANNELS] = [&SCHEME_0, &SCHEME_0, &SCHEME_0, &SCHEME_0];

    /// Type of the bank of encoders.
    pub type Bank = spikewire::Bank<[&'static Code; CHANNELS], CHANNELS>;

    /// Encoders of all channels, in their state before the first sample.
    pub const BANK: Bank = spikewire::Bank::per_channel(SCHEMES);

    /// Period, names, units and counts as text. The fingerprints that sender and receiver compare include it.
    pub const LABEL: &str = "2000 us; e\u{301} [rad/s] 1; a\u{85}b [rad/s] 1; \u{202e}*/ x [1\u{2028}] 1; x??/'\"\\ [g] 1";

    /// Time from one sample to the next, in µs.
    pub const PERIOD: u32 = 2000;

    /// Number of samples from one keyframe or heartbeat to the next.
    pub const KEYFRAME_EVERY: u32 = 10;

    /// Frame format: the number of bits for each part of an event, and the period.
    pub const CODING: spikewire::link::Coding = spikewire::link::Coding::for_channels(4, PERIOD);

    /// Returns the sender's half of the link, before the first frame of this session. Its frames carry the fingerprint of bank and label.
    #[must_use]
    pub fn transmitter(session: spikewire::link::Session) -> spikewire::link::Transmitter {
        spikewire::link::Transmitter::new(CODING, session).with_addresses(0..=3).with_fingerprint(BANK.fingerprint()).with_label(LABEL)
    }

    /// Maximum number of events of a sample that the receiver stores.
    pub const EVENTS: usize = 0;

    /// Type of the receiver's half of the link.
    pub type Receiver = spikewire::link::Receiver<[&'static Code; CHANNELS], CHANNELS, EVENTS>;

    /// Returns the receiver's half of the link, before the first frame.
    #[must_use]
    pub fn receiver() -> Receiver {
        Receiver::per_channel(SCHEMES).with_clock_tolerance(20000).with_label(LABEL)
    }
}
