//! Writes a flight's bank and its writer in C: a header to go with those of its codecs.

use crate::Result;
use crate::flight::Flight;
use crate::tune::RequestKind;
use catalogue::run::{Constant, SampleType, Settings};
use std::fmt::Write;
use std::path::Path;

/// Consecutive channels with equal parameters, which share one codec of the library.
struct Run {
    /// The codec's name in C: `flight_0` gives `sw_flight_0_encode`.
    name: String,
    channels: usize,
}

/// A flight's bank in C.
pub(crate) struct CBank<'a> {
    flight: &'a Flight,
    codecs: Vec<(String, &'a Settings, Constant)>,
    runs: Vec<Run>,
    sample: &'static str,
}

impl<'a> CBank<'a> {
    /// Prepares the bank of a flight.
    ///
    /// # Errors
    /// Returns an error if the library has no such scheme or sample type.
    pub(crate) fn new(flight: &'a Flight) -> Result<Self> {
        let info = flight.scheme;
        let is_in_c =
            catalogue::IN_C.iter().any(|(own, all)| own.name == info.name && !all.is_empty());
        if !is_in_c {
            return Err(RequestKind::Draws { scheme: info.name }.into());
        }
        let sample = match flight.sample {
            SampleType::F32 => "float",
            SampleType::Fixed16 { fraction: 0 } => "int16_t",
            SampleType::Fixed16 { fraction: 8 } => "sw_q8_8",
            SampleType::Fixed32 { fraction: 16 } => "sw_q16_16",
            sample => return Err(RequestKind::NotInC { sample }.into()),
        };
        let (mut codecs, mut runs): (Vec<(String, _, Constant)>, Vec<Run>) =
            (Vec::new(), Vec::new());
        for (channel, settings) in flight.settings().iter().enumerate() {
            let constant = flight.constant(channel)?;
            let place = codecs.iter().position(|(_, _, known)| *known == constant);
            let place = place.unwrap_or_else(|| {
                codecs.push((format!("flight_{}", codecs.len()), settings, constant));
                codecs.len() - 1
            });
            let name = &codecs[place].0;
            match runs.last_mut() {
                Some(run) if run.name == *name => run.channels += 1,
                _ => runs.push(Run { name: name.clone(), channels: 1 }),
            }
        }
        Ok(Self { flight, codecs, runs, sample })
    }

    /// Returns the codecs: name, settings and constant.
    pub(crate) fn codecs(&self) -> &[(String, &'a Settings, Constant)] {
        &self.codecs
    }

    /// Returns the header's text; `directory` is that of the crate whose header it includes.
    pub(crate) fn header(&self, directory: &Path) -> String {
        let Self { flight, runs, sample, .. } = self;
        let codecs =
            directory.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let codecs: String =
            codecs.chars().map(|own| if own.is_ascii_alphanumeric() { own } else { '_' }).collect();
        let neurons = flight.neurons();
        let each = |line: &dyn Fn(usize, &Run, usize) -> String| -> String {
            let mut first = 0;
            let lines = runs.iter().enumerate().map(|(place, run)| {
                let line = line(place, run, first);
                first += run.channels;
                line
            });
            lines.collect()
        };
        let fields = each(&|place, run, _| {
            format!("    sw_{}_encoder run_{place}[{}];\n", run.name, run.channels)
        });
        let starts = each(&|place, Run { name, channels }, _| {
            format!(
                "    for (i = 0; (i < {channels}u) && (status == SW_OK); i++) {{\n        \
                     status = sw_{name}_encoder_start(&bank->run_{place}[i], &sw_{name}_codec);\n    }}\n"
            )
        });
        let rooms = each(&|place, Run { name, channels }, _| {
            format!("    sw_{name}_code codes_{place}[{channels}];\n")
        });
        let encodes = each(&|place, Run { name, channels }, first| {
            format!(
                "    if (status == SW_OK) {{\n        stamp.first_address = {}u;\n        \
                     status = sw_{name}_bank(bank->run_{place}, samples + {first}, codes_{place}, {channels}u, &stamp, queue);\n    }}\n",
                first * neurons
            )
        });
        // A heartbeat stands for all channels.
        let has_keyframes = flight.scheme.has_first_value();
        let keyframes = each(&|place, Run { name, channels }, first| {
            if place > 0 && !has_keyframes {
                return String::new();
            }
            format!(
                "    if (status == SW_OK) {{\n        stamp.first_address = {}u;\n        \
                     status = sw_{name}_keyframes(bank->run_{place}, {channels}u, &stamp, queue);\n    }}\n",
                first * neurons
            )
        });
        let stamp = format!(
            "    sw_stamp stamp = {{0}};\n\n    stamp.tick = now;\n    stamp.slot_ticks = {}u;\n",
            flight.slot_ticks()
        );
        let names: Vec<&str> = flight.channels.iter().map(|own| own.name.as_str()).collect();
        let mut text = format!(
            "/* The sender of a flight, written from its file. Channels: {}. */\n\
             #ifndef FLIGHT_BANK_H\n#define FLIGHT_BANK_H\n\n#include \"{codecs}.h\"\n\n\
             #define FLIGHT_CHANNELS {}u\n\
             #define FLIGHT_PERIOD {}u /* microseconds from sample to sample */\n\
             #define FLIGHT_KEYFRAME_EVERY {}u /* samples */\n\n",
            names.join(", ").replace("*/", ""),
            names.len(),
            flight.period,
            flight.keyframe_every,
        );
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "typedef struct flight_bank {{\n{fields}}} flight_bank;\n\n\
             /* Starts, or resets, the encoders. */\n\
             static inline sw_status flight_bank_start(flight_bank *bank)\n{{\n    \
                 sw_status status = SW_OK;\n    size_t i;\n\n{starts}    return status;\n}}\n\n\
             /* Encodes a sample of each channel, taken at this time in microseconds, in the context that encodes. */\n\
             static inline sw_status flight_bank_encode(flight_bank *bank, uint32_t now, const {sample} *samples, sw_queue *queue)\n{{\n    \
                 sw_status status = SW_OK;\n{rooms}{stamp}{encodes}    return status;\n}}\n\n\
             /* Puts keyframes, or a heartbeat, after the sample of this time: every FLIGHT_KEYFRAME_EVERY samples. */\n\
             static inline sw_status flight_bank_keyframes(flight_bank *bank, uint32_t now, sw_queue *queue)\n{{\n    \
                 sw_status status = SW_OK;\n{stamp}{keyframes}    return status;\n}}\n\n\
             /* The writer of the flight's frames; `session` is one that no other start has. */\n\
             static inline sw_status flight_writer_init(sw_writer *writer, uint64_t session)\n{{\n    \
                 return sw_writer_init(writer, {}u, FLIGHT_PERIOD, session);\n}}\n\n#endif\n",
            names.len() * neurons
        );
        text
    }
}
