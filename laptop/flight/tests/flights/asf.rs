/// Both ends of a flight, written from its file.
#[allow(dead_code, unreachable_pub, clippy::all, clippy::pedantic)]
pub mod flight {
    /// Number of channels.
    pub const CHANNELS: usize = 6;

    /// Names of the channels, in the order of a sample.
    pub const NAMES: [&str; CHANNELS] = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"];

    /// Units of the channels, empty where they are not known.
    pub const UNITS: [&str; CHANNELS] = ["rad/s", "rad/s", "rad/s", "m/s²", "m/s²", "m/s²"];

    /// Counts for one unit of each channel.
    pub const COUNTS: [f64; CHANNELS] = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0];

    /// The code of every channel.
    pub type Code = spikewire::temporal::AdaptiveStepForward<f32>;

    /// Parameters of gyro_x, gyro_y, gyro_z.
    static SCHEME_0: Code = spikewire::temporal::AdaptiveStepForward::new(0.05, 3).with_run(2);

    /// Parameters of accel_x, accel_y, accel_z.
    static SCHEME_1: Code = spikewire::temporal::AdaptiveStepForward::new(0.2, 3).with_run(2);

    /// The scheme of each channel.
    pub const SCHEMES: [&Code; CHANNELS] = [&SCHEME_0, &SCHEME_0, &SCHEME_0, &SCHEME_1, &SCHEME_1, &SCHEME_1];

    /// The type of the bank.
    pub type Bank = spikewire::Bank<[&'static Code; CHANNELS], CHANNELS>;

    /// The encoders, before the first sample.
    pub const BANK: Bank = spikewire::Bank::per_channel(SCHEMES);

    /// What the schemes do not say of the flight: period, names, units, counts. Both ends compare it.
    pub const LABEL: &str = "5000 us; gyro_x [rad/s] 1; gyro_y [rad/s] 1; gyro_z [rad/s] 1; accel_x [m/s²] 1; accel_y [m/s²] 1; accel_z [m/s²] 1";

    /// µs from sample to sample.
    pub const PERIOD: u16 = 5000;

    /// Samples from one keyframe or heartbeat to the next.
    pub const KEYFRAME_EVERY: u32 = 4;

    /// The bits that the parts of an event take on the link.
    pub const CODING: spikewire::link::Coding = spikewire::link::Coding::for_channels(6, PERIOD);

    /// The sender's half of the link, before the first frame of this session. Its frames carry the fingerprint of bank and label.
    #[must_use]
    pub fn transmitter(session: spikewire::link::Session) -> spikewire::link::Transmitter {
        spikewire::link::Transmitter::new(CODING, session).with_fingerprint(BANK.fingerprint()).with_label(LABEL)
    }

    /// The most events of a sample that the receiver keeps.
    pub const EVENTS: usize = 6;

    /// The type of the receiver.
    pub type Receiver = spikewire::link::Receiver<[&'static Code; CHANNELS], CHANNELS, EVENTS>;

    /// The receiver's half of the link, before the first frame.
    #[must_use]
    pub fn receiver() -> Receiver {
        Receiver::per_channel(SCHEMES).with_clock_tolerance(20000).with_label(LABEL)
    }
}
