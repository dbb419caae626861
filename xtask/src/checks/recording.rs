//! Recordings that an emulated sensor measures: the channels of a flight file, from any log that `spikewire` reads.

use crate::common::output;
use crate::products::new_firmware;
use crate::programs::host;
use anyhow::{Context, Result, ensure};
use spikewire_flight::{Flight, STANDARD_GRAVITY};
use std::{fmt::Write, fs, path::Path};

/// The size of a sensor's count on an axis, in rad/s or m/s², with the full scales that the firmware of the templates
/// configures: 2000 °/s and 16 g.
pub fn count_size(axis: usize) -> f64 {
    let full = if axis < 3 { 2000_f64.to_radians() } else { 16.0 * STANDARD_GRAVITY };
    full / 32_768.0
}

/// Samples with their times in s, from the first one on: rates in rad/s about x, y, z, then accelerations in m/s² along them.
pub struct Recording(Vec<(f64, [f64; 6])>);

impl Recording {
    /// Reads the channels of the flight file from the log. An axis without a channel measures nothing, 0.
    pub fn read(flight: &Path, log: &Path) -> Result<Self> {
        let table = output(host::spikewire("samples --flight")?.arg(flight).arg(log))?;
        let mut lines = table.lines();
        let names = lines.next().context("a table has names")?;
        let channels = names.strip_prefix("time,");
        let channels = channels.with_context(|| format!("{}: has no times", log.display()))?;
        let axis = |name: &str| {
            let axis = new_firmware::axis(name);
            axis.with_context(|| {
                format!("channel `{name}` has no axis in its name, such as gyro_x")
            })
        };
        let axes = channels.split(',').map(axis).collect::<Result<Vec<_>>>()?;
        let row = |line: &str| {
            let numbers = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            let [time, values @ ..] = &numbers[..] else { anyhow::bail!("a line without a time") };
            ensure!(values.len() == axes.len(), "a line has a number for each name: {line}");
            let mut sample = [0.0; 6];
            for (&axis, &value) in axes.iter().zip(values) {
                sample[axis] = value;
            }
            Ok((*time, sample))
        };
        let rows = lines.map(row).collect::<Result<Vec<_>>>()?;
        ensure!(!rows.is_empty(), "{}: has no samples", log.display());
        Ok(Self(rows))
    }

    /// The recording from this time in s on.
    pub fn from(mut self, start: f64) -> Self {
        self.0.retain(|row| row.0 >= start);
        for row in &mut self.0 {
            row.0 -= start;
        }
        self
    }

    pub fn seconds(&self) -> f64 {
        self.0.last().map_or(0.0, |row| row.0)
    }

    /// Writes the table that the emulated sensor reads.
    pub fn write(&self, to: &Path) -> Result<()> {
        let mut table = String::new();
        for (time, [rx, ry, rz, ax, ay, az]) in &self.0 {
            writeln!(table, "{time:.6},{rx},{ry},{rz},{ax},{ay},{az}")?;
        }
        if let Some(directory) = to.parent() {
            fs::create_dir_all(directory)?;
        }
        Ok(fs::write(to, table)?)
    }

    /// The counts of a sensor with these full scales at a time in µs: those of the last sample until then.
    pub fn counts(&self, micros: i64) -> [i64; 6] {
        // The sensor keeps its times in ns, the recording in µs: half of a µs decides nothing.
        let until = self.0.partition_point(|row| (row.0 * 1e6).round() as i64 <= micros);
        let (_, sample) = self.0[until.saturating_sub(1)];
        core::array::from_fn(|axis| {
            let count = (sample[axis] / count_size(axis)).round() as i64;
            count.clamp(i16::MIN.into(), i16::MAX.into())
        })
    }

    /// The samples behind the flight's filter, with their times in µs.
    pub fn filtered(&self, flight: &Flight) -> Result<Vec<(i64, [f64; 6])>> {
        let mut filters = flight.filters()?;
        let row = |&(time, mut sample): &(f64, [f64; 6])| {
            for (value, filter) in sample.iter_mut().zip(&mut filters) {
                *value = filter(*value);
            }
            ((time * 1e6) as i64, sample)
        };
        Ok(self.0.iter().map(row).collect())
    }
}
