//! Real flight data: what the gyroscopes and accelerometers of two aircraft said.
//!
//! Where it comes from, and under which licences, is told in `data/README.md`.

pub use flight_data::Record;

/// The six channels of two flights: of a PX4 hexarotor in flight, 198.5 Hz, with gaps, and of a VTOL aircraft at
/// rest, 200 Hz.
pub fn flights() -> [[Vec<f32>; 6]; 2] {
    [flight_data::HEXAROTOR, flight_data::VTOL_AT_REST].map(|recording| {
        std::array::from_fn(|index| flight_data::channel(recording, index).collect())
    })
}

/// A channel of the hexarotor's flight in a sample type, where `unit` is 1 rad/s or 1 m/s².
pub fn flown<S: spikewire::Sample>(index: usize, unit: f64) -> Vec<S> {
    let channel = flight_data::channel(flight_data::HEXAROTOR, index);
    channel.map(|value| S::from_f64(f64::from(value) * unit)).collect()
}

/// A calibration that has seen the samples.
pub fn calibrated<S: spikewire::Sample>(samples: &[S]) -> spikewire::Calibration<S> {
    let mut calibration = spikewire::Calibration::new();
    for &sample in samples {
        calibration.observe(sample);
    }
    calibration
}

#[cfg(test)]
mod tests {
    use super::Record;

    fn recordings() -> [Vec<Record>; 2] {
        [flight_data::HEXAROTOR, flight_data::VTOL_AT_REST]
            .map(|recording| flight_data::records(recording).collect())
    }

    fn parse_csv(text: &str) -> Vec<Record> {
        let mut lines = text.lines();
        let header = "time_us,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z";
        assert_eq!(lines.next(), Some(header));
        let record = |line: &str| {
            let (time, channels) = line.split_once(',').unwrap();
            let channels: Vec<f32> = channels.split(',').map(|v| v.parse().unwrap()).collect();
            Record { micros: time.parse().unwrap(), channels: channels.try_into().unwrap() }
        };
        lines.map(record).collect()
    }

    #[test]
    fn both_forms_hold_the_same_bits() {
        let texts =
            [include_str!("../../data/hexarotor.csv"), include_str!("../../data/vtol_at_rest.csv")];
        for (csv, compact) in texts.into_iter().zip(recordings()) {
            let bits = |record: &Record| (record.micros, record.channels.map(f32::to_bits));
            assert!(parse_csv(csv).iter().map(bits).eq(compact.iter().map(bits)));
        }
    }

    #[test]
    fn the_recordings_are_those_of_the_page() {
        let [hexarotor, vtol] = recordings();
        assert_eq!((hexarotor.len(), vtol.len()), (3627, 1298));
        assert_eq!(hexarotor.last().unwrap().micros, 18_402_588);
        assert_eq!(vtol.last().unwrap().micros, 6_496_152);
        let steps = |records: &[Record], least: u32| {
            let steps = records.windows(2).map(|pair| pair[1].micros - pair[0].micros);
            steps.filter(|&step| step > least).count()
        };
        assert_eq!((steps(&hexarotor, 10_000), steps(&hexarotor, 20_000)), (9, 1));
        assert_eq!((steps(&vtol, 10_000), steps(&vtol, 20_000)), (1, 1));
    }

    #[test]
    fn time_rises_from_zero_and_all_is_finite() {
        for records in recordings() {
            assert_eq!(records[0].micros, 0);
            assert!(records.windows(2).all(|pair| pair[0].micros < pair[1].micros));
            assert!(records.iter().flat_map(|record| record.channels).all(f32::is_finite));
        }
    }
}
