//! `cargo xtask emulate IMAGE --part PART`: runs any image from its reset vector, with a sensor on its bus.

use crate::checks::emulator::{self, Run};
use crate::checks::recording::Recording;
use crate::common::{paths, usage};
use anyhow::{Context, Result, ensure};
use std::fs::{self, File};
use std::io::{Read, Write, stderr, stdout};
use std::path::Path;

const USAGE: &str = "\
cargo xtask emulate IMAGE --part PART [--log LOG --flight FLIGHT.toml] [--sensor SENSOR] [--seconds N] [--rtt] [TIME:FATE]...

Writes what left the serial port to standard output, such as frames for `spikewire listen - --flight flight.toml`.
An access to an address that nothing models ends the run, and names it.

  --log       what the sensor measures: any recording that `spikewire` reads. The sensor samples at the rate that the image
              configures, in its own counts, and has the log's last sample until then; without a log, sines with noise
  --flight    the file that the image was built with: it names the log's channels, their axes and units
  --part      rp2040, nrf52840, stm32f405, stm32h743, or crazyflie
  --sensor    icm42688p (default; bmi088 on a crazyflie), or bmi323
  --seconds   of the part's time; default: the log's length, or 2
  --rtt       writes the defmt log to standard error
  TIME:FATE   such as 500:miso-cut 800:mend: breaks a wire and mends it, in ms; pico.mjs lists them";

pub fn emulate(args: &[String]) -> Result<()> {
    let (mut image, mut part, mut sensor, mut seconds) = (None, None, None, None);
    let (mut log, mut flight) = (None, None);
    let (mut wants_log, mut fates) = (false, Vec::new());
    let mut args = args.iter().map(String::as_str);
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or_else(|| usage(USAGE.to_owned()));
        match arg {
            "--part" => part = Some(value()?),
            "--sensor" => sensor = Some(value()?),
            "--seconds" => seconds = Some(value()?),
            "--log" => log = Some(Path::new(value()?)),
            "--flight" => flight = Some(Path::new(value()?)),
            "--rtt" => wants_log = true,
            fate if fate.contains(':') => fates.push(fate.to_owned()),
            path if image.is_none() && !path.starts_with('-') => image = Some(path),
            _ => return Err(usage(USAGE.to_owned())),
        }
    }
    let (Some(image), Some(part)) = (image, part) else { return Err(usage(USAGE.to_owned())) };
    ensure!(
        emulator::PARTS.contains(&part),
        "no part `{part}` is modelled; there are {}",
        emulator::PARTS.join(", ")
    );
    ensure!(
        emulator::SENSORS.contains(&sensor.unwrap_or(emulator::SENSORS[0])),
        "no sensor `{}` is modelled; there are {}",
        sensor.unwrap_or_default(),
        emulator::SENSORS.join(", ")
    );
    let seconds = seconds.map(|text| {
        text.parse::<f64>().with_context(|| format!("`{text}` is no number of seconds"))
    });
    let seconds = seconds.transpose()?;
    let sensor = sensor.unwrap_or(if part == "crazyflie" { "bmi088" } else { "icm42688p" });
    let (image, directory) =
        (std::env::current_dir()?.join(image), paths::target().join("emulated/image"));
    check_image(&image)?;
    let recording = match (log, flight) {
        (Some(log), Some(flight)) => Some(Recording::read(flight, log)?),
        (None, None) => None,
        _ => {
            return Err(usage(
                "--log needs --flight, which names the log's channels, and --flight --log"
                    .to_owned(),
            ));
        }
    };
    let table = directory.join("recording.csv");
    if let Some(recording) = &recording {
        recording.write(&table)?;
    }
    _ = fs::remove_file(directory.join("uart")); // what an earlier image left
    let run = Run {
        part,
        image: &image,
        sensor,
        seconds: seconds.or(recording.as_ref().map(Recording::seconds)).unwrap_or(2.0),
        directory: &directory,
        fates: &fates,
        recording: recording.is_some().then_some(&table),
    };
    let run = run.strictly();
    // An image that ends in a fault has said something, too.
    if let Ok(said) = fs::read(directory.join("uart")) {
        stdout().write_all(&said)?;
    }
    if wants_log && run.is_ok() {
        stderr().write_all(emulator::log(&image, &directory)?.as_bytes())?;
    }
    run.map(drop)
}

/// Checks that an image is there, and is a program for a 32-bit Arm.
fn check_image(image: &Path) -> Result<()> {
    let name = image.display().to_string();
    let mut start = Vec::new();
    let file = File::open(image).with_context(|| name.clone())?;
    file.take(20).read_to_end(&mut start).with_context(|| name.clone())?;
    // The format's first bytes, for 32 bits and the lower byte first; and the number of Arm.
    let is_image = start.starts_with(b"\x7fELF\x01\x01") && start.get(18..20) == Some(&[40, 0]);
    ensure!(is_image, "{name}: not an ELF image for a 32-bit Arm, as `cargo build` writes");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::emulate;

    /// What cannot run is refused with a sentence, before the emulator starts.
    #[test]
    fn what_cannot_run_is_refused() {
        let refused = |line: &str, words: &str| {
            let args: Vec<String> = line.split(' ').map(str::to_owned).collect();
            let error = format!("{:#}", emulate(&args).unwrap_err());
            assert!(error.contains(words), "{line}: {error}");
        };
        refused("no-such-image --part stm32f405", "no-such-image: No such file");
        refused("Cargo.toml --part stm32f405", "Cargo.toml: not an ELF image");
        refused("Cargo.toml --part rp2350", "no part `rp2350` is modelled; there are rp2040,");
        refused("Cargo.toml --part rp2040 --sensor mpu6050", "no sensor `mpu6050` is modelled");
    }
}
