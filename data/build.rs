//! Packs the tables of flights into bytes that firmware can hold.

use std::{env, fs, path::Path};

fn main() {
    let out = env::var("OUT_DIR").unwrap();
    println!("cargo:rerun-if-changed=build.rs");
    for flight in ["hexarotor", "vtol_at_rest"] {
        let table = format!("{flight}.csv");
        println!("cargo:rerun-if-changed={table}");
        let bytes = packed(&fs::read_to_string(&table).unwrap());
        fs::write(Path::new(&out).join(flight).with_extension("f32le"), bytes).unwrap();
    }
}

/// Time and six channels of each line, little endian.
fn packed(table: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    for line in table.lines().skip(1) {
        let (time, channels) = line.split_once(',').unwrap();
        bytes.extend(time.parse::<u32>().unwrap().to_le_bytes());
        for value in channels.split(',') {
            bytes.extend(value.parse::<f32>().unwrap().to_le_bytes());
        }
    }
    bytes
}
