/// Sender and receiver of a flight, generated from its flight file.
#[allow(dead_code, unreachable_pub, clippy::all, clippy::pedantic)]
pub mod flight {
    /// Number of channels.
    pub const CHANNELS: usize = 6;

    /// Names of the channels, in the order of a sample.
    pub const NAMES: [&str; CHANNELS] = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"];

    /// Units of the channels, empty where unknown.
    pub const UNITS: [&str; CHANNELS] = ["rad/s", "rad/s", "rad/s", "m/s²", "m/s²", "m/s²"];

    /// Number of counts in one unit of each channel.
    pub const COUNTS: [f64; CHANNELS] = [100000.0, 100000.0, 100000.0, 100000.0, 100000.0, 100000.0];

    /// Size of each channel's unit, in rad/s and in m/s²; 0 where the unit is none of that quantity.
    pub const SI: [[f64; 2]; CHANNELS] = [[1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0], [0.0, 1.0]];

    /// Type of every channel's scheme.
    pub type Code = spikewire::temporal::SendOnDelta<fixed::types::I32F0, 4>;

    /// Scheme with the parameters of gyro_x, gyro_y, gyro_z.
    static SCHEME_0: Code = spikewire::temporal::SendOnDelta::new(fixed::types::I32F0::from_bits(12000));

    /// Scheme with the parameters of accel_x, accel_y, accel_z.
    static SCHEME_1: Code = spikewire::temporal::SendOnDelta::new(fixed::types::I32F0::from_bits(50000));

    /// Scheme of each channel.
    pub const SCHEMES: [&Code; CHANNELS] = [&SCHEME_0, &SCHEME_0, &SCHEME_0, &SCHEME_1, &SCHEME_1, &SCHEME_1];

    /// Type of the bank of encoders.
    pub type Bank = spikewire::Bank<[&'static Code; CHANNELS], CHANNELS>;

    /// Encoders of all channels, in their state before the first sample.
    pub const BANK: Bank = spikewire::Bank::per_channel(SCHEMES);

    /// Period, names, units and counts as text. The fingerprints that sender and receiver compare include it.
    pub const LABEL: &str = "2000 us; gyro_x [rad/s] 100000; gyro_y [rad/s] 100000; gyro_z [rad/s] 100000; accel_x [m/s²] 100000; accel_y [m/s²] 100000; accel_z [m/s²] 100000";

    /// Time from one sample to the next, in µs.
    pub const PERIOD: u32 = 2000;

    /// Number of samples from one keyframe or heartbeat to the next.
    pub const KEYFRAME_EVERY: u32 = 10;

    /// Frame format: the number of bits for each part of an event, and the period.
    pub const CODING: spikewire::link::Coding = spikewire::link::Coding::for_channels(6, PERIOD);

    /// Returns the sender's half of the link, before the first frame of this session. Its frames carry the fingerprint of bank and label.
    #[must_use]
    pub fn transmitter(session: spikewire::link::Session) -> spikewire::link::Transmitter {
        spikewire::link::Transmitter::new(CODING, session).with_addresses(0..=5).with_fingerprint(BANK.fingerprint()).with_label(LABEL)
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
