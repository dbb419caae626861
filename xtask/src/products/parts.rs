//! The boards of `examples/boards`.

/// A board of `examples/boards`.
pub struct Part {
    /// Name of its feature.
    pub name: &'static str,
    pub target: &'static str,
    /// Name of the part in probe-rs.
    pub chip: &'static str,
    /// Name of its files: `src/board/….rs`, `src/part/….rs`, `memory/….x`.
    pub board: &'static str,
    pub part: &'static str,
    pub memory: &'static str,
    pub baud: u32,
    /// Arguments of `spikewire listen` at the far end.
    pub listen: &'static str,
    /// Shortest way to flash the image.
    pub flash: &'static str,
}

const F4: &str = "thumbv7em-none-eabihf";
const M0: &str = "thumbv6m-none-eabi";
/// Codes of the sensors, as in `flight::bmi323`, `flight::bmi088` and `icm42688p`.
pub const BMI323: &str = "--scheme sod --spikes 16 --sample i16 --thresholds 98,98,98,205,205,205";
pub const BMI088: &str = "--scheme sod --spikes 16 --sample i16 --thresholds 98,98,98,137,137,137";
pub const ICM42688P: &str = "--scheme sf --sample i16 --thresholds 98,98,98,328,328,328";
const PROBE: &str =
    "cargo run --release          # with a debug probe: cargo install probe-rs-tools";

const PICO: Part = Part {
    name: "pico",
    target: M0,
    chip: "RP2040",
    board: "pico",
    part: "rp",
    memory: "rp2040",
    baud: 921_600,
    listen: BMI323,
    flash: PROBE,
};
const SPEEDYBEE: Part = Part {
    name: "speedybee-f405",
    target: F4,
    chip: "STM32F405RGTx",
    board: "speedybee_f405",
    part: "stm32f405",
    memory: "stm32f405",
    baud: 2_000_000,
    listen: ICM42688P,
    flash: PROBE,
};

pub const BOARDS: [Part; 7] = [
    PICO,
    Part { name: "pico-8khz", board: "pico_8khz", listen: ICM42688P, ..PICO },
    Part {
        name: "pico2",
        target: "thumbv8m.main-none-eabihf",
        chip: "RP235x",
        board: "pico_8khz",
        memory: "rp2350",
        listen: ICM42688P,
        ..PICO
    },
    SPEEDYBEE,
    Part {
        name: "crazyflie",
        board: "crazyflie",
        memory: "crazyflie",
        baud: 921_600,
        listen: BMI088,
        ..SPEEDYBEE
    },
    Part {
        name: "matek-h743",
        chip: "STM32H743VITx",
        board: "matek_h743",
        part: "stm32h743",
        memory: "stm32h743",
        ..SPEEDYBEE
    },
    Part {
        name: "nrf52840-dk",
        chip: "nRF52840_xxAA",
        board: "nrf52840_dk",
        part: "nrf52840",
        memory: "nrf52840",
        baud: 1_000_000,
        ..SPEEDYBEE
    },
];
