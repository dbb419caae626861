//! Exports a codec's functions under its names.

/// Declares codecs: for each its name, its scheme, and how it is made.
///
/// `made` is an initialisation in C with these arguments; the value is a `Result<_, ConfigError>`, in which `?` works.
/// `constant` is a value in flash, which C only starts.
///
/// ```ignore
/// spikewire_c::codecs! {
///     /// Step forward.
///     sf_f32: temporal::StepForward<f32> {
///         /// `threshold` is what the signal must leave the baseline by, above 0.
///         made init(threshold: f32) = temporal::StepForward::try_new(threshold);
///     }
///     /// Roll.
///     roll: temporal::StepForward<f32> {
///         constant temporal::StepForward::new(0.35);
///     }
/// }
/// ```
#[macro_export]
macro_rules! codecs {
    // The same for each of these sample types, which is then `S`: `sf` becomes `sf_f32` and `sf_q8_8`.
    (for $samples:tt; $($(#[doc = $words:literal])* $name:ident: $scheme:ty { $($how:tt)* })*) => {
        $(
            #[doc(hidden)]
            mod $name {
                $crate::codecs!(@each $samples; [$($words),*] $name $scheme, { $($how)* });
            }
        )*

        /// What is declared here, for the header: for each name its sample types.
        pub static CODECS: &[(&str, &[fn() -> $crate::Description])] =
            &[$((stringify!($name), $name::CODECS)),*];
    };

    ($($(#[doc = $words:literal])* $name:ident: $scheme:ty { $($how:tt)* })*) => {
        $(
            #[doc(hidden)]
            mod $name {
                #[allow(unused_imports)]
                use super::*;

                $crate::codecs!(@codec (stringify!($name)) "()", [$($words),*] $scheme { $($how)* });
            }
        )*

        /// What is declared here, for the header.
        pub static CODECS: &[(&str, &[fn() -> $crate::Description])] =
            &[$((stringify!($name), &[$name::description])),*];
    };

    (@each [$($suffix:ident: $sample:ident),*]; $words:tt $name:ident $scheme:ty, $how:tt) => {
        $crate::codecs!(@samples $words $name $scheme, $how $($suffix: $sample,)*);

        pub(super) static CODECS: &[fn() -> $crate::Description] = &[$($suffix::description),*];
    };

    (@samples $words:tt $name:ident $scheme:ty, $how:tt) => {};
    (@samples $words:tt $name:ident $scheme:ty, $how:tt $suffix:ident: $sample:ident, $($rest:tt)*) => {
        mod $suffix {
            #[allow(unused_imports)]
            use super::super::*;

            type S = $sample;

            $crate::codecs!(
                @codec (concat!(stringify!($name), "_", stringify!($suffix))) stringify!($sample), $words $scheme $how
            );
        }

        $crate::codecs!(@samples $words $name $scheme, $how $($rest)*);
    };

    (@codec ($name:expr) $sample:expr, [$($words:literal),*] $scheme:ty { $($how:tt)* }) => {
        use $crate::Status;
        use $crate::codec::{self, Codec, Decoder, Encoder};

        type Scheme = $scheme;
        type Sample = <Scheme as ::spikewire::Scheme>::Sample;
        type Code = <Scheme as ::spikewire::Scheme>::Code;

        const MARK: u32 = codec::mark($name);

        $crate::codecs!(@how $name; $($how)*);

        /// What the header tells of it.
        pub(super) fn description() -> $crate::Description {
            $crate::Description::of::<Scheme>(
                $name,
                &[$($words),*],
                (stringify!($scheme), $sample),
                CONSTRUCTORS,
            )
        }

        $crate::codecs!(@functions $name;
            encoder_start(encoder: *mut Encoder<Scheme>, codec: *const Codec<Scheme>), MARK;
            decoder_start(decoder: *mut Decoder<Scheme>, codec: *const Codec<Scheme>), MARK;
            encode(encoder: *mut Encoder<Scheme>, sample: Sample, code: *mut Code);
            encode_slice(encoder: *mut Encoder<Scheme>, samples: *const Sample, codes: *mut Code, count: usize);
            finish(encoder: *mut Encoder<Scheme>, code: *mut Code);
            prime(encoder: *mut Encoder<Scheme>, past: *const Sample, count: usize);
            keyframe(encoder: *const Encoder<Scheme>, value: *mut Sample);
            rejected(encoder: *const Encoder<Scheme>, count: *mut u32);
            decode(decoder: *mut Decoder<Scheme>, code: *const Code, value: *mut Sample);
            decode_slice(decoder: *mut Decoder<Scheme>, codes: *const Code, values: *mut Sample, count: usize);
            held(decoder: *const Decoder<Scheme>, value: *mut Sample);
            resync(decoder: *mut Decoder<Scheme>, value: Sample);
            firings(code: *const Code, firings: *mut $crate::event::CNeuronSpike, capacity: usize, count: *mut usize);
            assemble(firings: *const $crate::event::CNeuronSpike, count: usize, code: *mut Code);
            bank(encoders: *mut Encoder<Scheme>, samples: *const Sample, codes: *mut Code, channels: usize, stamp: *const $crate::event::Stamp, queue: *mut $crate::Kept<$crate::Queue>);
            keyframes(encoders: *mut Encoder<Scheme>, channels: usize, stamp: *const $crate::event::Stamp, queue: *mut $crate::Kept<$crate::Queue>);
        );
    };

    (@how $name:expr; $($(#[doc = $words:literal])* made $init:ident($($argument:ident: $type:ty),* $(,)?) = $value:expr;)+) => {
        const CONSTRUCTORS: &[$crate::Constructor] = &[$($crate::Constructor {
            name: stringify!($init),
            words: &[$($words),*],
            arguments: &[$((stringify!($argument), <$type as $crate::argument::Argument>::DECLARED)),*],
        }),+];

        $(
            #[unsafe(export_name = concat!("sw_", $name, "_", stringify!($init)))]
            unsafe extern "C" fn $init(
                codec: *mut Codec<Scheme>,
                $($argument: <$type as $crate::argument::Argument>::C,)*
                error: *mut $crate::Error,
            ) -> Status {
                let mut not_finite = None;
                let mut made = || {
                    // SAFETY: C's promise.
                    $(let $argument = unsafe { <$type as $crate::argument::Argument>::taken($argument) }?;)*
                    $(not_finite = not_finite.or($crate::argument::Argument::not_finite(&$argument));)*
                    let made = || -> Result<Scheme, ::spikewire::ConfigError> { $value };
                    Ok(made())
                };
                let made = made();
                // SAFETY: C's promise.
                unsafe { codec::init(codec, MARK, error, made, not_finite) }
            }
        )+
    };

    (@how $name:expr; constant $value:expr;) => {
        const CONSTRUCTORS: &[$crate::Constructor] = &[];

        #[unsafe(export_name = concat!("sw_", $name, "_codec"))]
        static CODEC: Codec<Scheme> = Codec::new(MARK, $value);
    };

    (@functions $name:expr; $($function:ident($($argument:ident: $type:ty),*) $(, $more:expr)?;)*) => {
        $(
            #[unsafe(export_name = concat!("sw_", $name, "_", stringify!($function)))]
            unsafe extern "C" fn $function($($argument: $type),*) -> Status {
                // SAFETY: C's promise.
                unsafe { codec::$function($($argument),* $(, $more)?) }
            }
        )*
    };
}

/// Checks sizes and alignments, for each type that is `S` in a scheme's: of parameters, of what an encoder and a decoder
/// keep, and of a code.
#[macro_export]
macro_rules! sized {
    ($($scheme:ty: $($sample:ty => $codec:tt $encoder:tt $decoder:tt $code:tt),*;)*) => {
        $($(const _: () = {
            #[allow(dead_code)]
            type S = $sample;
            type Scheme = $scheme;
            assert!(
                $crate::Layout::of::<$crate::codec::Codec<Scheme>>().is $codec
                    && $crate::Layout::of::<<Scheme as ::spikewire::Scheme>::EncoderState>().is $encoder
                    && $crate::Layout::of::<<Scheme as ::spikewire::Scheme>::DecoderState>().is $decoder
                    && $crate::Layout::of::<<Scheme as ::spikewire::Scheme>::Code>().is $code,
                "the header has another size: write it again"
            );
        };)*)*
    };
}
