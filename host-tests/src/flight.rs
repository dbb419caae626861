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
    /// The bytes of one sample in the compact form.
    pub const SIZE: usize = 28;

    /// Gyroscope x, y, z, then accelerometer x, y, z.
    pub fn channels(&self) -> [f32; 6] {
        let mut channels = [0.0; 6];
        channels[..3].copy_from_slice(&self.gyro);
        channels[3..].copy_from_slice(&self.accel);
        channels
    }

    /// Reads a sample as the compact form holds it: time and six channels, little endian.
    pub fn from_bytes(bytes: &[u8; Self::SIZE]) -> Self {
        let word = |index: usize| {
            let at = 4 * index;
            [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]
        };
        let float = |index| f32::from_le_bytes(word(index));
        Self {
            time_us: u32::from_le_bytes(word(0)),
            gyro: [float(1), float(2), float(3)],
            accel: [float(4), float(5), float(6)],
        }
    }

    /// Writes a sample as [`Self::from_bytes`] reads it.
    pub fn to_bytes(&self) -> [u8; Self::SIZE] {
        let mut bytes = [0; Self::SIZE];
        let floats = self.channels().map(f32::to_le_bytes);
        bytes[..4].copy_from_slice(&self.time_us.to_le_bytes());
        bytes[4..].copy_from_slice(floats.as_flattened());
        bytes
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

fn read(bytes: &[u8]) -> Vec<Sample> {
    bytes
        .chunks(Sample::SIZE)
        .map(|chunk| Sample::from_bytes(chunk.try_into().expect("a flight is whole samples")))
        .collect()
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
                assert_eq!(parsed.to_bytes(), compact.to_bytes());
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
