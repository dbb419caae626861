//! An I2C bus that a sensor holds.

use embedded_hal::{
    delay::DelayNs,
    digital::{InputPin, OutputPin},
};

/// A byte's bits and its acknowledge: whatever a sensor is in the middle of ends within these.
const MOST_CLOCKS: u32 = 9;
/// Half a period of 100 kHz.
const HALF_US: u32 = 5;

/// Clocks until SDA is free, then ends the transfer; says whether it is free. Both pins are open drain.
///
/// A controller that is reset in the midst of a read leaves the sensor waiting for its clock, with SDA held low: without this
/// no transfer ever begins again.
pub fn free_bus<P: InputPin + OutputPin>(
    scl: &mut impl OutputPin,
    sda: &mut P,
    wait: &mut impl DelayNs,
) -> bool {
    // A pin that cannot be set leaves the bus as it is, which the last look tells.
    let mut half = |_is_set: bool| wait.delay_us(HALF_US);
    half(sda.set_high().is_ok());
    half(scl.set_high().is_ok());
    for _ in 0..MOST_CLOCKS {
        if sda.is_high().unwrap_or(false) {
            break;
        }
        half(scl.set_low().is_ok());
        half(scl.set_high().is_ok());
    }
    // A stop: SDA rises while SCL is high.
    half(scl.set_low().is_ok());
    half(sda.set_low().is_ok());
    half(scl.set_high().is_ok());
    half(sda.set_high().is_ok());
    sda.is_high().unwrap_or(false)
}
