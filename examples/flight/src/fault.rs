//! Faults of a sensor.

/// Reason why a sensor does not start, or a read brought no samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Fault {
    /// The bus failed, or nobody acknowledged.
    Bus,
    /// The identity register holds this. 0x00 and 0xFF are an open or stuck line.
    Identity(u16),
    /// A register does not hold what was written.
    Register {
        /// Address of the register.
        address: u16,
        /// Value that was written.
        wrote: u16,
        /// Value that was read back.
        read: u16,
    },
    /// The sensor has no new sample.
    NoData,
    /// The sensor was reset since its start, as by a dip of its supply.
    Restarted,
    /// The FIFO ran over: samples are lost.
    Overrun,
    /// The bus did not finish in time.
    Late,
    /// The clock stood still while the sensor started: no tick would be right.
    Clock,
}
