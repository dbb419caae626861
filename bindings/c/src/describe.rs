//! What the header tells of a codec.

use core::any::type_name;

use spikewire::{Code, Spike};

use crate::argument::{Declared, Number};
use crate::codec::{Codec, Exported};

/// A size and an alignment in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Bytes.
    pub size: usize,
    /// A multiple of this many bytes.
    pub align: usize,
}

impl Layout {
    /// That of a type.
    pub const fn of<T>() -> Self {
        Self { size: size_of::<T>(), align: align_of::<T>() }
    }

    /// Whether it is this one.
    pub const fn is(self, size: usize, align: usize) -> bool {
        self.size == size && self.align == align
    }
}

/// An initialisation.
#[derive(Clone, Copy, Debug)]
pub struct Constructor {
    /// How its name ends: `init`.
    pub name: &'static str,
    /// What it makes, in lines.
    pub words: &'static [&'static str],
    /// Its arguments.
    pub arguments: &'static [(&'static str, Declared)],
}

/// A codec.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// Its name without `sw_`: `sf_f32`.
    pub name: &'static str,
    /// What it is, in lines.
    pub words: &'static [&'static str],
    /// Its initialisations; none if it is a constant.
    pub constructors: &'static [Constructor],
    /// The type of its samples in C.
    pub sample: &'static str,
    /// Its type in Rust, within the library, and the type that is called `S` in it; `()` if none is.
    pub rust: (&'static str, &'static str),
    /// Its parameters.
    pub codec: Layout,
    /// What an encoder keeps, beside a pointer.
    pub encoder: Layout,
    /// What a decoder keeps, beside a pointer.
    pub decoder: Layout,
    /// A code.
    pub code: Layout,
    /// Whether a code is an `int8_t`: a spike, or a signed number of them.
    pub is_byte: bool,
    /// The latency in samples.
    pub latency: usize,
    /// Neurons of a channel.
    pub neurons: usize,
    /// Sub-timesteps of a sample.
    pub slots: usize,
}

impl Description {
    /// That of a scheme.
    pub fn of<P: Exported<Sample: Number>>(
        name: &'static str,
        words: &'static [&'static str],
        rust: (&'static str, &'static str),
        constructors: &'static [Constructor],
    ) -> Self {
        Self {
            name,
            words,
            constructors,
            sample: <P::Sample as Number>::TYPE,
            rust,
            codec: Layout::of::<Codec<P>>(),
            encoder: Layout::of::<P::EncoderState>(),
            decoder: Layout::of::<P::DecoderState>(),
            code: Layout::of::<P::Code>(),
            is_byte: type_name::<P::Code>() == type_name::<Spike>()
                || type_name::<P::Code>().contains("::Steps<"),
            latency: P::LATENCY,
            neurons: P::Code::NEURONS,
            slots: P::Code::SLOTS,
        }
    }
}
