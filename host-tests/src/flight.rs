//! Real flight data: what the gyroscopes and accelerometers of two aircraft said.
//!
//! Where it comes from, and under which licences, is told in `data/README.md`.

/// One reading of an inertial sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the first sample of the recording.
    pub time_us: u32,
    /// Turn rate about the body's x, y and z axes, rad/s.
    pub gyro: [f32; 3],
    /// Specific force along the body's x, y and z axes, m/s².
    pub accel: [f32; 3],
}

impl Sample {
    /// Gyroscope x, y, z, then accelerometer x, y, z.
    pub fn channels(&self) -> [f32; 6] {
        let mut channels = [0.0; 6];
        channels[..3].copy_from_slice(&self.gyro);
        channels[3..].copy_from_slice(&self.accel);
        channels
    }
}

/// A PX4 hexarotor in flight, about 197 Hz, with two gaps.
pub fn hexarotor() -> Vec<Sample> {
    read(flight_data::HEXAROTOR)
}

/// A VTOL aircraft at rest, 200 Hz.
pub fn vtol_at_rest() -> Vec<Sample> {
    read(flight_data::VTOL_AT_REST)
}

/// One channel of a recording, in the order of [`Sample::channels`].
///
/// # Panics
/// If there is no such channel.
pub fn channel(samples: &[Sample], index: usize) -> Vec<f32> {
    samples.iter().map(|sample| sample.channels()[index]).collect()
}

/// A channel of the hexarotor's flight in a sample type, where `unit` is 1 rad/s or 1 m/s².
pub fn flown<S: spikewire::Sample>(index: usize, unit: f64) -> Vec<S> {
    let channel = channel(&hexarotor(), index);
    channel.into_iter().map(|value| S::from_f64(f64::from(value) * unit)).collect()
}

/// A calibration that has seen the samples.
pub fn calibrated<S: spikewire::Sample>(samples: &[S]) -> spikewire::Calibration<S> {
    let mut calibration = spikewire::Calibration::new();
    for &sample in samples {
        calibration.observe(sample);
    }
    calibration
}

fn read(bytes: &[u8]) -> Vec<Sample> {
    let sample = |record: flight_data::Record| {
        let [rx, ry, rz, ax, ay, az] = record.channels;
        Sample { time_us: record.micros, gyro: [rx, ry, rz], accel: [ax, ay, az] }
    };
    flight_data::records(bytes).map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::{Sample, channel, hexarotor, vtol_at_rest};

    fn parse_csv(text: &str) -> Vec<Sample> {
        let mut lines = text.lines();
        let header = "time_us,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z";
        assert_eq!(lines.next(), Some(header));
        lines
            .map(|line| {
                let (time, channels) = line.split_once(',').unwrap();
                let channels: Vec<f32> = channels.split(',').map(|v| v.parse().unwrap()).collect();
                assert_eq!(channels.len(), 6, "{line}");
                Sample {
                    time_us: time.parse().unwrap(),
                    gyro: channels[..3].try_into().unwrap(),
                    accel: channels[3..].try_into().unwrap(),
                }
            })
            .collect()
    }

    #[test]
    fn both_forms_hold_the_same_bits() {
        for (csv, compact) in [
            (include_str!("../../data/hexarotor.csv"), hexarotor()),
            (include_str!("../../data/vtol_at_rest.csv"), vtol_at_rest()),
        ] {
            let parsed = parse_csv(csv);
            assert_eq!(parsed.len(), compact.len());
            for (parsed, compact) in parsed.iter().zip(&compact) {
                let bits = |sample: &Sample| (sample.time_us, sample.channels().map(f32::to_bits));
                assert_eq!(bits(parsed), bits(compact));
            }
        }
    }

    #[test]
    fn the_recordings_are_those_of_the_page() {
        let (hexarotor, vtol) = (hexarotor(), vtol_at_rest());
        assert_eq!((hexarotor.len(), vtol.len()), (3627, 1298));
        assert_eq!(hexarotor.last().unwrap().time_us, 18_402_588);
        assert_eq!(vtol.last().unwrap().time_us, 6_496_152);
        let steps = |samples: &[Sample], least: u32| {
            let steps = samples.windows(2).map(|pair| pair[1].time_us - pair[0].time_us);
            steps.filter(|&step| step > least).count()
        };
        assert_eq!((steps(&hexarotor, 10_000), steps(&hexarotor, 20_000)), (9, 1));
        assert_eq!((steps(&vtol, 10_000), steps(&vtol, 20_000)), (1, 1));
    }

    #[test]
    fn time_rises_from_zero_and_all_is_finite() {
        for samples in [hexarotor(), vtol_at_rest()] {
            assert_eq!(samples[0].time_us, 0);
            assert!(samples.windows(2).all(|pair| pair[0].time_us < pair[1].time_us));
            for index in 0..6 {
                assert!(channel(&samples, index).iter().all(|value| value.is_finite()));
            }
        }
    }
}
