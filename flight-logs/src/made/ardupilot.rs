//! Generates `ArduPilot` logs, binary and text, and a `MAVLink` telemetry log, for tests.

use super::wave;

/// Number of samples in a log. Each sample is one message of each of two sensors.
const SAMPLES: u32 = 100;

/// Message formats: type, name, letters, column names, and unit letters of the columns.
const FORMATS: [(u8, &str, &str, &str, &str); 5] = [
    (0x80, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", ""),
    (0x81, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", "s---"),
    (0x82, "IMU", "QBfcgL", "TimeUS,I,GyrX,GyrY,T,Lat", "s#EkOD"),
    (0x83, "ISBD", "Qa", "TimeUS,x", "s-"),
    (0x84, "MSG", "QZ", "TimeUS,Message", "s-"),
];

fn size(letters: &str) -> u8 {
    let sizes = letters.bytes().map(|letter| match letter {
        b'Q' => 8,
        b'B' => 1,
        b'c' | b'g' => 2,
        b'f' | b'L' | b'n' => 4,
        b'N' => 16,
        _ => 64,
    });
    3 + sizes.sum::<u8>()
}

fn padded(text: &str, size: usize) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize(size, 0);
    bytes
}

/// Returns a binary message of type `kind` with these columns.
pub fn dataflash_message(kind: u8, columns: &[&[u8]]) -> Vec<u8> {
    [&[0xa3, 0x95, kind], &columns.concat()[..]].concat()
}

/// Returns the angular rate, column `GyrX`, of sensor number `sensor` in sample number `sample`.
pub fn dataflash_rate(sample: u32, sensor: u8) -> f32 {
    (wave(sample) * f64::from(sensor + 1)) as f32
}

/// Returns the binary messages of both sensors for sample number `sample`.
pub fn dataflash_sample(sample: u32) -> Vec<u8> {
    let time = 1_000_000 + u64::from(sample) * 5000;
    let of = |sensor: u8| {
        let rate = dataflash_rate(sample, sensor).to_le_bytes();
        let hundredths = ((wave(sample) * 1000.0) as i16).to_le_bytes();
        let latitude = (-353_632_620 + sample as i32).to_le_bytes();
        // 1.5 as a half-precision float.
        let half = 0x3e00_u16.to_le_bytes();
        dataflash_message(
            0x82,
            &[&time.to_le_bytes(), &[sensor], &rate, &hundredths, &half, &latitude],
        )
    };
    [of(0), of(1)].concat()
}

/// Returns a binary log. Apart from definitions, the log has 100 samples of each of two sensors, a message with an
/// array, and a message with a text.
pub fn dataflash() -> Vec<u8> {
    let mut log = Vec::new();
    for (kind, name, letters, columns, _) in FORMATS {
        let texts = [padded(name, 4), padded(letters, 16), padded(columns, 64)].concat();
        log.extend(dataflash_message(0x80, &[&[kind, size(letters)], &texts]));
    }
    for (kind, _, _, _, units) in FORMATS {
        let both = [padded(units, 16), padded("F-", 16)].concat();
        log.extend(dataflash_message(0x81, &[&[0; 8], &[kind], &both]));
    }
    log.extend(dataflash_message(0x84, &[&[0; 8], &padded("Copter, 4.5", 64)]));
    let array: Vec<u8> = (0..32_i16).flat_map(|item| (item - 16).to_le_bytes()).collect();
    log.extend(dataflash_message(0x83, &[&[0; 8], &array]));
    log.extend((0..SAMPLES).flat_map(dataflash_sample));
    log
}

/// Returns the log of [`dataflash`] in text form. The message with the array is left out.
pub fn dataflash_text() -> String {
    let mut log = "\nArduCopter V4.5\n".to_owned();
    let mut line = |line: String| log.extend([&line, "\n"]);
    for (kind, name, letters, columns, _) in FORMATS {
        line(format!("FMT, {kind}, {}, {name}, {letters}, {columns}", size(letters)));
    }
    for (kind, _, _, _, units) in FORMATS {
        line(format!("FMTU, 0, {kind}, {units}, F-"));
    }
    line("MSG, 0, Copter, 4.5".to_owned());
    for sample in 0..SAMPLES {
        for sensor in 0..2 {
            let time = 1_000_000 + sample * 5000;
            let rate = dataflash_rate(sample, sensor);
            let hundredths = f64::from((wave(sample) * 1000.0) as i16) / 100.0;
            let latitude = f64::from(-353_632_620 + sample as i32) / 1e7;
            line(format!("IMU, {time}, {sensor}, {rate}, {hundredths}, 1.5, {latitude}"));
        }
    }
    log
}

/// Returns a `MAVLink` 1 packet, preceded by its time of arrival in µs, as in a `.tlog`. `extra` is the last byte of
/// the checksum's input.
pub fn packet(time: u64, system: u8, number: u8, payload: &[u8], extra: u8) -> Vec<u8> {
    let checked = [&[payload.len() as u8, 0, system, 1, number], payload].concat();
    let mut sum = 0xffff_u16;
    for byte in checked.iter().chain([&extra]) {
        sum ^= u16::from(*byte);
        for _ in 0..8 {
            sum = if sum & 1 == 1 { sum >> 1 ^ 0x8408 } else { sum >> 1 };
        }
    }
    [&time.to_be_bytes()[..], &[0xfe], &checked, &sum.to_le_bytes()].concat()
}

/// Returns a telemetry log with 100 `RAW_IMU` messages from each of two systems, and 100 packets of an unknown message.
pub fn tlog() -> Vec<u8> {
    const EXTRA: u8 = 144;
    let mut log = Vec::new();
    for sample in 0..SAMPLES {
        let time = 1_700_000_000_000_000 + u64::from(sample) * 5000;
        for system in [1, 2] {
            let counts = (wave(sample) * 1000.0) as i16;
            let payload = [&u64::from(sample).to_le_bytes()[..], &counts.to_le_bytes().repeat(9)];
            log.extend(packet(time, system, 27, &payload.concat(), EXTRA));
        }
        log.extend(packet(time, 1, 199, &[1, 2, 3], 7));
    }
    log
}
