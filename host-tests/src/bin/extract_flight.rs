//! Writes `data/*.csv` from the flight logs that two published crates carry, or into the directory that is named.
//!
//! ```text
//! cargo run -p host-tests --features extract --bin extract_flight
//! ```

use std::env;
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use cargo_metadata::{CargoOpt, MetadataCommand};
use host_tests::flight::Record;
use sha2::{Digest, Sha256};
use yule_log::builder::ULogParserBuilder;
use yule_log::model::inst::{FieldValue, Format};
use yule_log::model::msg::UlogMessage;

/// A flight log inside a published crate.
struct Log {
    package: &'static str,
    version: &'static str,
    file: &'static str,
    sha256: &'static str,
    output: &'static str,
}

const LOGS: [Log; 2] = [
    Log {
        package: "ulog-rs",
        version: "0.0.4",
        file: "test_data/sample-small.ulg",
        sha256: "0d94ea67eed1c8f3145d8b2d88e5430ab95c9be33898cbc98749c491f35a1118",
        output: "hexarotor",
    },
    Log {
        package: "yule_log",
        version: "0.4.0",
        file: "data/sample_log_small.ulg",
        sha256: "68d1020f688109f027dba08d2950247cc0ae34aaefdcf37e4a7d60838f3e1aa3",
        output: "vtol_at_rest",
    },
];

fn main() -> Result<(), Box<dyn Error>> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let metadata = MetadataCommand::new()
        .manifest_path(manifest)
        .features(CargoOpt::SomeFeatures(vec!["extract".into()]))
        .exec()?;
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let data = env::args_os().nth(1).map_or(data, PathBuf::from);
    for log in &LOGS {
        let package = metadata
            .packages
            .iter()
            .find(|package| {
                package.name == log.package && package.version.to_string() == log.version
            })
            .ok_or_else(|| format!("{} {} is not a dependency", log.package, log.version))?;
        let directory = package.manifest_path.parent().ok_or("a manifest lies in a directory")?;
        let bytes = fs::read(directory.join(log.file))?;
        if format!("{:x}", Sha256::digest(&bytes)) != log.sha256 {
            return Err(format!("{} is not the file that it was", log.file).into());
        }
        let samples = inertial_samples(&bytes)?;
        fs::write(data.join(log.output).with_extension("csv"), csv(&samples)?)?;
        describe(log.output, &samples);
    }
    Ok(())
}

/// The first instance of `sensor_combined`, with times from its first sample.
fn inertial_samples(log: &[u8]) -> Result<Vec<Record>, Box<dyn Error>> {
    let parser =
        ULogParserBuilder::new(log).set_subscription_allow_list(["sensor_combined"]).build()?;
    let mut samples = Vec::new();
    let mut first = None;
    for message in parser {
        let UlogMessage::LoggedData(logged) = message? else {
            continue;
        };
        if logged.data.multi_id_index.unwrap_or(0) != 0 {
            continue;
        }
        let first = *first.get_or_insert(logged.timestamp);
        let micros = u32::try_from(logged.timestamp - first)?;
        let [rx, ry, rz] = vector(&logged.data, "gyro_rad")?;
        let [ax, ay, az] = vector(&logged.data, "accelerometer_m_s2")?;
        samples.push(Record { micros, channels: [rx, ry, rz, ax, ay, az] });
    }
    Ok(samples)
}

fn vector(data: &Format, name: &str) -> Result<[f32; 3], String> {
    data.fields
        .iter()
        .find(|field| &*field.name == name)
        .and_then(|field| match &field.value {
            FieldValue::ArrayF32(values) => values.as_slice().try_into().ok(),
            _ => None,
        })
        .ok_or_else(|| format!("no three floats {name}"))
}

/// The shortest decimals that read back to the same bits.
fn csv(samples: &[Record]) -> Result<String, std::fmt::Error> {
    let mut text = String::from("time_us,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n");
    for sample in samples {
        write!(text, "{}", sample.micros)?;
        for value in sample.channels {
            write!(text, ",{value}")?;
        }
        text.push('\n');
    }
    Ok(text)
}

/// Prints what `data/README.md` says of a recording.
fn describe(name: &str, samples: &[Record]) {
    let steps: Vec<u32> = samples.windows(2).map(|pair| pair[1].micros - pair[0].micros).collect();
    let mut sorted = steps.clone();
    sorted.sort_unstable();
    let median = sorted[sorted.len() / 2];
    let duration = f64::from(steps.iter().sum::<u32>()) * 1e-6;
    let rate = steps.len() as f64 / duration;
    println!("{name}: {} samples, {duration:.3} s, {rate:.2} Hz", samples.len());
    println!("  step {median} us, {} at the least", sorted[0]);
    for (i, step) in steps.iter().enumerate() {
        if 2 * step > 3 * median {
            let missing = (step + median / 2) / median - 1;
            println!("  {step} us after sample {i}: {missing} missing");
        }
    }
    for (index, unit) in [(0, "rad/s"), (3, "m/s^2")] {
        let values = samples.iter().flat_map(|sample| &sample.channels[index..index + 3]);
        println!("  up to {} {unit}", values.fold(0.0, |most: f32, value| most.max(value.abs())));
    }
}
