//! The templates of `examples/templates`: a HAL each, for firmware that a flight's file describes.

/// A template of `examples/templates`.
pub struct Template {
    /// Name of the HAL, and of the directory.
    pub hal: &'static str,
    pub target: &'static str,
    /// Name of the part in probe-rs.
    pub chip: &'static str,
    /// Name of the memory map: `examples/boards/memory/….x`.
    pub memory: &'static str,
    /// Sections that the HAL's images have besides; empty, or a linker script.
    pub sections: &'static str,
    pub baud: u32,
    /// Name of the emulated part, if there is one.
    pub emulated: Option<&'static str>,
}

const F4: &str = "thumbv7em-none-eabihf";

const STM32: Template = Template {
    hal: "embassy-stm32",
    target: F4,
    chip: "STM32F405RGTx",
    memory: "stm32f405",
    sections: "",
    baud: 921_600,
    emulated: Some("stm32f405"),
};
const RP: Template = Template {
    hal: "embassy-rp",
    target: "thumbv6m-none-eabi",
    chip: "RP2040",
    memory: "rp2040",
    sections: BOOT2,
    baud: 921_600,
    emulated: Some("rp2040"),
};

/// The boot code's place: an RP2040's ROM runs the first 256 bytes of flash.
const BOOT2: &str = "
SECTIONS
{
  .boot2 ORIGIN(BOOT2) :
  {
    KEEP(*(.boot2));
  } > BOOT2
} INSERT BEFORE .text;
";

pub const TEMPLATES: [Template; 7] = [
    STM32,
    Template {
        hal: "embassy-nrf",
        chip: "nRF52840_xxAA",
        memory: "nrf52840",
        baud: 1_000_000,
        emulated: Some("nrf52840"),
        ..STM32
    },
    RP,
    Template { hal: "stm32f4xx-hal", ..STM32 },
    Template { hal: "rtic", ..STM32 },
    Template { hal: "rp2040-hal", ..RP },
    Template {
        hal: "rp235x-hal",
        target: "thumbv8m.main-none-eabihf",
        chip: "RP235x",
        memory: "rp2350",
        sections: "",
        emulated: None,
        ..RP
    },
];
