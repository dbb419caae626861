//! `cargo demo`: real flight data through encoder, emulated flight controller and decoder.

use crate::{firmware, setup};
use anyhow::Result;

pub fn demo(_args: &[String]) -> Result<()> {
    println!("=== What this needs");
    setup::setup()?;

    println!("\n=== The flight on five emulated flight controllers, and on this computer");
    firmware::firmware(&["flight-log".to_owned()])
}
