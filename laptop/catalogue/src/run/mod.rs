//! Chooses schemes at run time: makes settings from what a user gave and a signal shows, and codecs from settings.
//!
//! A scheme's file says how it is built from settings and, if necessary, how these are found. This module does
//! everything else: default values from the paper and the signal, rounding to the sample type, and codecs whose type
//! does not depend on the scheme.

mod asked;
mod calibrate;
mod chance;
mod codec;
mod error;
mod exact;
mod example;
mod filter;
mod lanes;
mod needs;
mod piece;
mod quantiles;
mod resolve;
mod rust;
mod sample_type;
mod settings;
mod unordered;
mod value;
mod words;

pub use asked::Asked;
pub use calibrate::Calibrated;
pub use codec::{Codec, Event, Samples, Values};
pub use error::{End, Error, ErrorKind, Result};
pub use exact::{Outcome, Outcomes, Parabola, above, below, outcomes};
pub use example::example;
pub use filter::taps;
pub use needs::Needs;
pub use piece::Piece;
pub use resolve::{Known, Resolve, missing};
pub use rust::{Constant, Counted, Rust, lengthened, state};
pub use sample_type::{Fixed32, SampleType};
pub use settings::Settings;
pub use value::{SET, Value};
pub use words::{Given, Spell, Spelled, Worded, Words, joined, quoted};

use spikewire::{Sample, Scheme, Spike};

use crate::{Entry, Info, Parameter, Search, State, Unit, for_sample_type};

/// Populations up to this size get codes of this capacity, and larger ones codes of the largest capacity.
pub(crate) const FEW: usize = 64;

/// The shape of a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Number of neurons.
    pub neurons: usize,
    /// Number of sub-timesteps in a sample.
    pub slots: usize,
}

/// A scheme in a sample type that may be shared between threads, and whose states can be written.
pub trait Runs<S>:
    Scheme<
        Sample = S,
        EncoderState: State + Clone + Send + Sync,
        DecoderState: State + Send + Sync,
        Output: Send + Sync,
        Code: Send + Sync,
    > + Send
    + Sync
    + 'static
{
}

impl<S, P> Runs<S> for P where
    P: Scheme<
            Sample = S,
            EncoderState: State + Clone + Send + Sync,
            DecoderState: State + Send + Sync,
            Output: Send + Sync,
            Code: Send + Sync,
        > + Send
        + Sync
        + 'static
{
}

/// A visitor that is given a scheme of any type, in a sample type.
pub trait Visit<S: Sample> {
    /// The result of the visit.
    type Output;

    /// Visits the scheme; `start` is the state in which its encoder starts.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    fn visit<P: Runs<S>>(self, scheme: P, start: P::EncoderState) -> Result<Self::Output>;

    /// Visits a scheme whose decoder adds up steps.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    fn visit_steps<P: Runs<S> + Scheme<Code = Spike>>(
        self,
        scheme: P,
        start: P::EncoderState,
    ) -> Result<Self::Output>
    where
        Self: Sized,
    {
        self.visit(scheme, start)
    }
}

/// How a scheme is built at run time.
pub trait Build: Entry {
    /// Makes complete settings from the parameters given, the paper's values and the signal.
    ///
    /// # Errors
    /// Returns an error if a parameter is missing or invalid.
    fn resolve(asked: &Resolve) -> Result<Settings> {
        asked.all()
    }

    /// Returns the parameters that would have to be given so that the whole signal need not be calibrated on; `None` if
    /// there are enough.
    fn needs_signal(asked: &Asked) -> Option<Needs> {
        missing(&Self::INFO, asked)
    }

    /// Returns the number of samples from which the encoder starts.
    fn looks_back(_: &Asked) -> usize {
        1
    }

    /// Returns the numbers of neurons and sub-timesteps.
    ///
    /// # Errors
    /// Returns an error if the settings lack them, or if they are invalid.
    fn shape(settings: &Settings) -> Result<Shape> {
        let has = |name: &str| Self::INFO.parameters.iter().any(|own| own.name == name);
        let neurons = if has("neurons") { settings.neurons()? } else { 1 };
        let slots = if has("slots") {
            settings.count("slots", 2..=spikewire::dynamic::LEVELS)?
        } else {
            1
        };
        Ok(Shape { neurons, slots })
    }

    /// Returns the size of one channel's encoder on a flight controller, in bytes of RAM.
    ///
    /// # Errors
    /// Returns an error if the settings lack its length, or if the size is not known.
    fn ram<S: Sample>(_: &Settings) -> Result<usize> {
        Err(ErrorKind::MemoryUnknown { scheme: &Self::INFO }.into())
    }

    /// Returns the codec in the table of measurements whose work is comparable.
    ///
    /// # Errors
    /// Returns an error if the settings lack its length, or if there is no such codec.
    fn counted(_: &Settings) -> Result<Counted> {
        Err(ErrorKind::NotMeasured { scheme: &Self::INFO }.into())
    }

    /// Returns the outcomes of a range of thresholds on pieces of a signal, each coded by itself; `None` if the
    /// scheme has no such list. If each outcome takes a pass over the signal, lists only about `most` of them, and says
    /// whether any is missing. The threshold in the settings is ignored.
    fn outcomes(_: &Settings, _: &[Piece], _: (f64, f64), _: usize) -> Option<Outcomes> {
        None
    }

    /// The scheme as a Rust constant: its type in the crate, the type's further arguments, and its constructor, as
    /// [`Rust::filled`] takes them.
    const CONSTANT: Option<[&str; 3]> = None;

    /// Writes the scheme as a Rust constant. The settings must be those of a scheme that can be built.
    ///
    /// # Errors
    /// Returns an error if the settings lack something, or if the scheme cannot be written as a constant.
    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let Some([scheme, shape, value]) = Self::CONSTANT else {
            return Err(ErrorKind::NoConstant { scheme: &Self::INFO }.into());
        };
        let filled = |template| rust.filled(template, &Self::INFO, settings);
        rust.constant(scheme, &filled(shape)?, &filled(value)?)
    }

    /// Returns whether the numbers of a parameter become samples, and are rounded to the sample type.
    fn is_in_samples(parameter: &Parameter, _: &Settings) -> bool {
        parameter.unit == Unit::Signal
    }

    /// Returns the range in which a good value of a parameter is searched, given the others.
    fn search(parameter: &Parameter, _: &Asked) -> Option<Search> {
        parameter.search
    }

    /// Builds the scheme and passes it to a visitor.
    ///
    /// # Errors
    /// Returns an error if a parameter is invalid; or the visitor's error.
    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output>;
}

/// Writes the `build` of a population code from an expression for its encoder's start and the scheme. Its sample type
/// is `S`, and its codes have room for `M` neurons; `M` is the smaller of two capacities if the neurons fit.
macro_rules! population {
    (|$settings:ident| $built:expr) => {
        fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
            fn within<S: Sample, V: Visit<S>, const M: usize>(
                $settings: &Settings,
                visitor: V,
            ) -> Result<V::Output> {
                let (start, scheme) = $built;
                visitor.visit(scheme, start)
            }
            if Self::shape(settings)?.neurons <= FEW {
                within::<S, V, FEW>(settings, visitor)
            } else {
                within::<S, V, { dynamic::NEURONS }>(settings, visitor)
            }
        }
    };
}
pub(crate) use population;

/// Writes the costs of a scheme: its RAM, from the type of its state, and the codec in the table of measurements, with
/// how many times as long it is.
macro_rules! costs {
    ($scheme:ty, $codec:literal) => {
        costs!($scheme, $codec, |_settings| 1.0);
    };
    ($scheme:ty, $codec:literal, |$settings:ident| $longer:expr) => {
        fn ram<S: Sample>(_: &Settings) -> Result<usize> {
            Ok(state::<$scheme>())
        }

        fn counted($settings: &Settings) -> Result<Counted> {
            Ok(Counted::at_most($codec, $longer))
        }
    };
}
pub(crate) use costs;

/// A scheme of the catalogue whose type is not known at compile time.
pub trait RunTime: Sync {
    /// Returns the description of the scheme.
    fn info(&self) -> &'static Info;

    /// Returns the parameters that would have to be given so that the whole signal need not be calibrated on; `None` if
    /// there are enough.
    fn needs_signal(&self, asked: &Asked) -> Option<Needs>;

    /// Returns the number of samples from which the encoder starts.
    fn looks_back(&self, asked: &Asked) -> usize;

    /// Makes complete settings for a sample type from the parameters given, the paper's values and the signal.
    ///
    /// # Errors
    /// Returns an error if a parameter is missing, unknown to the scheme, invalid, or rounded to 0 where that is not
    /// allowed.
    fn resolve(&self, sample: SampleType, asked: &Asked, known: &Known) -> Result<Settings>;

    /// Returns the numbers of neurons and sub-timesteps.
    ///
    /// # Errors
    /// Returns an error if the settings lack them, or if they are invalid.
    fn shape(&self, settings: &Settings) -> Result<Shape>;

    /// Returns the range in which a good value of a parameter is searched, given the others.
    fn search(&self, parameter: &Parameter, asked: &Asked) -> Option<Search>;

    /// Returns the size of one channel's encoder on a flight controller, in bytes of RAM.
    ///
    /// # Errors
    /// Returns an error if the settings lack its length, or if the size is not known.
    fn ram(&self, settings: &Settings) -> Result<usize>;

    /// Returns the codec in the table of measurements whose work is comparable.
    ///
    /// # Errors
    /// Returns an error if the settings lack its length, or if there is no such codec.
    fn counted(&self, settings: &Settings) -> Result<Counted>;

    /// Returns the outcomes of a range of thresholds on pieces of a signal, each coded by itself; `None` if the
    /// scheme has no such list. If each outcome takes a pass over the signal, lists only about `most` of them, and says
    /// whether any is missing. The threshold in the settings is ignored.
    fn outcomes(
        &self,
        settings: &Settings,
        pieces: &[Piece],
        range: (f64, f64),
        most: usize,
    ) -> Option<Outcomes>;

    /// Writes the scheme as a Rust constant.
    ///
    /// # Errors
    /// Returns an error if the settings lack something, or if the scheme cannot be written as a constant.
    fn constant(&self, settings: &Settings) -> Result<Constant>;

    /// Makes an encoder and its decoder, in the state in which a recording begins.
    ///
    /// # Errors
    /// Returns an error if a parameter is invalid.
    fn codec(&self, settings: &Settings) -> Result<Codec>;

    /// Makes an encoder and its decoder, which starts from the value `first` if there is one.
    ///
    /// # Errors
    /// Returns an error if a parameter is invalid.
    fn codec_from(&self, settings: &Settings, first: Option<f64>) -> Result<Codec>;
}

impl<T: Build + Sync> RunTime for T {
    fn info(&self) -> &'static Info {
        const { &T::INFO }
    }

    fn needs_signal(&self, asked: &Asked) -> Option<Needs> {
        if asked.paper {
            return Some(Needs::Paper);
        }
        T::needs_signal(asked)
    }

    fn looks_back(&self, asked: &Asked) -> usize {
        T::looks_back(asked)
    }

    fn resolve(&self, sample: SampleType, asked: &Asked, known: &Known) -> Result<Settings> {
        let resolve = Resolve::new(&T::INFO, asked, known)?;
        let mut settings = T::resolve(&resolve)?;
        resolve.check_range(&settings)?;
        if T::INFO.has_first_value() {
            settings.first = resolve.first_window(T::looks_back(asked))?;
        }
        if sample == SampleType::F32 { Ok(settings) } else { rounded::<T>(sample, &settings) }
    }

    fn shape(&self, settings: &Settings) -> Result<Shape> {
        T::shape(settings)
    }

    fn search(&self, parameter: &Parameter, asked: &Asked) -> Option<Search> {
        T::search(parameter, asked)
    }

    fn ram(&self, settings: &Settings) -> Result<usize> {
        for_sample_type!(settings.sample, S => T::ram::<S>(settings))
    }

    fn counted(&self, settings: &Settings) -> Result<Counted> {
        T::counted(settings)
    }

    fn outcomes(
        &self,
        settings: &Settings,
        pieces: &[Piece],
        range: (f64, f64),
        most: usize,
    ) -> Option<Outcomes> {
        T::outcomes(settings, pieces, range, most)
    }

    fn constant(&self, settings: &Settings) -> Result<Constant> {
        for_sample_type!(settings.sample, S => T::build::<S, _>(settings, Nothing))?;
        T::constant(settings, &Rust::new(settings.sample))
    }

    fn codec(&self, settings: &Settings) -> Result<Codec> {
        if !T::INFO.has_first_value() {
            return self.codec_from(settings, None);
        }
        let Some(name) = settings.first_key() else {
            let kind = ErrorKind::Lacking { or: Some("start") };
            return Err(Error::of(Given::listed("first", None::<&str>), kind));
        };
        self.codec_from(settings, Some(settings.number(name)?))
    }

    fn codec_from(&self, settings: &Settings, first: Option<f64>) -> Result<Codec> {
        let visitor = codec::Start { settings, shape: T::shape(settings)?, first };
        for_sample_type!(settings.sample, S => T::build::<S, _>(settings, visitor))
    }
}

/// Rounds settings to a sample type other than `f32`.
fn rounded<T: Build>(sample: SampleType, asked: &Settings) -> Result<Settings> {
    let mut ran = asked.clone();
    ran.sample = sample;
    let first = ran.first_key();
    for (name, value) in ran.entries_mut() {
        let own = T::INFO.parameters.iter().find(|own| own.key() == *name);
        let is_rounded =
            own.is_some_and(|own| T::is_in_samples(own, asked)) || first == Some(*name);
        match value {
            Value::Number(number) if is_rounded => *number = sample.rounded(*number),
            Value::Numbers(numbers) if is_rounded => {
                for number in numbers {
                    *number = sample.rounded(*number);
                }
            }
            _ => {}
        }
    }
    let built = for_sample_type!(sample, S => T::build::<S, _>(&ran, Nothing));
    let pairs = || asked.entries().iter().zip(ran.entries());
    let vanished = pairs().find(|((_, asked), (_, ran))| {
        asked.number().is_some_and(|number| number > 0.0) && ran.number() == Some(0.0)
    });
    if let (Err(_), Some(((name, asked), _))) = (&built, vanished) {
        let kind = ErrorKind::Vanishes { sample };
        return Err(Error::of(Given::listed(name, Some(asked)), kind));
    }
    built?;
    let changed = pairs().filter(|((_, asked), (_, ran))| asked != ran);
    ran.rounded = changed.map(|(asked, _)| asked.clone()).collect();
    Ok(ran)
}

/// A visitor that only checks whether a scheme can be built.
struct Nothing;

impl<S: Sample> Visit<S> for Nothing {
    type Output = ();

    fn visit<P: Scheme<Sample = S> + 'static>(self, _: P, _: P::EncoderState) -> Result<()> {
        Ok(())
    }
}
