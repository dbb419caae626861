//! The bodies of the examples on the host: against exact bus transactions, and against a sensor that fails in every way that
//! a bus and a supply can.

mod align;
mod bmi088;
mod bmi323;
mod bounced;
mod code;
mod device;
mod i2c;
mod sampler;
mod simulated;
mod station;

/// The result of a future that never waits, as a bus on the host does not.
fn finish<F: Future>(future: F) -> F::Output {
    embassy_futures::block_on(future)
}
