//! The signal of the demo.

/// The yaw rate of the recorded flight, as the firmware encodes it.
pub struct Signal {
    /// Seconds since the first sample.
    pub times: Vec<f64>,
    /// Angular rates in rad/s.
    pub rates: Vec<f32>,
}

impl Signal {
    /// Reads the same bytes as the firmware.
    pub fn read() -> Self {
        let records = || flight_data::records(flight_data::HEXAROTOR);
        Self {
            times: records().map(|record| f64::from(record.micros) / 1e6).collect(),
            rates: records().map(|record| record.channels[2]).collect(),
        }
    }

    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or_default()
    }

    /// Returns the usual time between two samples, as the median: the recording has gaps.
    pub fn interval(&self) -> f64 {
        let mut steps: Vec<f64> = self.times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or_default()
    }
}
