//! `cargo xtask emulate IMAGE --part PART`: runs any image from its reset vector, with a sensor on its bus.

use crate::checks::emulator;
use crate::common::{paths, usage};
use anyhow::{Context, Result};
use std::fs;
use std::io::{Write, stderr, stdout};

const USAGE: &str = "\
cargo xtask emulate IMAGE --part PART [--sensor SENSOR] [--seconds N] [--rtt] [TIME:FATE]...

Writes what left the serial port to standard output, such as frames for `spikewire listen - --flight flight.toml`.
An access to an address that nothing models ends the run, and names it.

  --part      rp2040, nrf52840, stm32f405, stm32h743, or crazyflie
  --sensor    icm42688p (default; bmi088 on a crazyflie), or bmi323
  --seconds   of the part's time; default: 2
  --rtt       writes the defmt log to standard error
  TIME:FATE   such as 500:miso-cut 800:mend: breaks a wire and mends it, in ms; pico.mjs lists them";

pub fn emulate(args: &[String]) -> Result<()> {
    let (mut image, mut part, mut sensor, mut seconds) = (None, None, None, "2");
    let (mut wants_log, mut fates) = (false, Vec::new());
    let mut args = args.iter().map(String::as_str);
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or_else(|| usage(USAGE.to_owned()));
        match arg {
            "--part" => part = Some(value()?),
            "--sensor" => sensor = Some(value()?),
            "--seconds" => seconds = value()?,
            "--rtt" => wants_log = true,
            fate if fate.contains(':') => fates.push(fate.to_owned()),
            path if image.is_none() && !path.starts_with('-') => image = Some(path),
            _ => return Err(usage(USAGE.to_owned())),
        }
    }
    let (Some(image), Some(part)) = (image, part) else { return Err(usage(USAGE.to_owned())) };
    let seconds =
        seconds.parse().with_context(|| format!("`{seconds}` is no number of seconds"))?;
    let sensor = sensor.unwrap_or(if part == "crazyflie" { "bmi088" } else { "icm42688p" });
    let (image, directory) =
        (std::env::current_dir()?.join(image), paths::target().join("emulated/image"));
    _ = fs::remove_file(directory.join("uart")); // what an earlier image left
    let run = emulator::strictly(part, &image, sensor, seconds, &directory, &fates);
    // An image that ends in a fault has said something, too.
    if let Ok(said) = fs::read(directory.join("uart")) {
        stdout().write_all(&said)?;
    }
    if wants_log && run.is_ok() {
        stderr().write_all(emulator::log(&image, &directory)?.as_bytes())?;
    }
    run.map(drop)
}
