//! Schemes chosen at run time: from what a user gave and a signal tells to settings, and from settings to a codec.
//!
//! A scheme says in its file how it is built from settings, and where needed how these come about. All else is here:
//! what the paper and the signal stand in for, what a sample type rounds, and the codec
//! whose type says nothing of the scheme.

mod asked;
mod calibrate;
mod codec;
mod error;
mod example;
mod exact;
mod filter;
mod needs;
mod quantiles;
mod resolve;
mod rust;
mod sample_type;
mod settings;
mod sweep;
mod value;
mod words;

pub use asked::Asked;
pub use calibrate::Calibrated;
pub use codec::{Codec, Event, Samples, Values};
pub use error::{End, Error, ErrorKind, Result};
pub use example::example;
pub use exact::{Outcome, Outcomes, Parabola, above, below, outcomes};
pub use filter::taps;
pub use needs::Needs;
pub use resolve::{Known, Resolve, missing};
pub use rust::{Constant, Counted, Rust, lengthened, state};
pub use sample_type::{Fixed32, SampleType};
pub use settings::Settings;
pub use sweep::{LANES, Rule, sweep};
pub use value::{SET, Value};
pub use words::{Given, Spell, Spelled, Worded, Words, joined, quoted};

use spikewire::{Sample, Scheme, Spike};

use crate::{Entry, Info, Parameter, Search, State, Unit, for_sample_type};

/// Populations up to this size have codes of this capacity, larger ones of the largest.
pub(crate) const FEW: usize = 64;

/// How many neurons a code has, and how many sub-timesteps a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Neurons.
    pub neurons: usize,
    /// Sub-timesteps.
    pub slots: usize,
}

/// A scheme in a sample type, which threads may share and whose states can be written.
pub trait Runs<S>:
    Scheme<
        Sample = S,
        EncoderState: State + Send + Sync,
        DecoderState: State + Send + Sync,
        Code: Send + Sync,
    > + Send
    + Sync
    + 'static
{
}

impl<S, P> Runs<S> for P where
    P: Scheme<
            Sample = S,
            EncoderState: State + Send + Sync,
            DecoderState: State + Send + Sync,
            Code: Send + Sync,
        > + Send
        + Sync
        + 'static
{
}

/// Takes a scheme of any type in a sample type.
pub trait Visit<S: Sample> {
    /// The result of the visit.
    type Output;

    /// Takes the scheme, and the state from which its encoder starts.
    ///
    /// # Errors
    /// The visitor's own.
    fn visit<P: Runs<S>>(self, scheme: P, start: P::EncoderState) -> Result<Self::Output>;

    /// Takes a scheme whose decoder adds up steps.
    ///
    /// # Errors
    /// The visitor's own.
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

/// How a scheme comes about at run time.
pub trait Build: Entry {
    /// Complete settings from what is asked for, the paper's settings and the signal.
    ///
    /// # Errors
    /// A parameter is missing or makes no sense.
    fn resolve(asked: &Resolve) -> Result<Settings> {
        asked.all()
    }

    /// The parameters that would make a calibration over the whole signal unnecessary.
    fn needs_signal(asked: &Asked) -> Option<Needs> {
        missing(&Self::INFO, asked)
    }

    /// How many samples its encoder takes to start from.
    fn looks_back(_: &Asked) -> usize {
        1
    }

    /// How many neurons and sub-timesteps it has.
    ///
    /// # Errors
    /// The settings lack them, or they make no sense.
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

    /// The bytes of RAM of one channel's encoder, on a flight controller.
    ///
    /// # Errors
    /// The settings lack its length, or it is not known.
    fn ram<S: Sample>(_: &Settings) -> Result<usize> {
        Err(ErrorKind::MemoryUnknown { scheme: &Self::INFO }.into())
    }

    /// The codec of the measured table that stands for its work.
    ///
    /// # Errors
    /// The settings lack its length, or none does.
    fn counted(_: &Settings) -> Result<Counted> {
        Err(ErrorKind::NotMeasured { scheme: &Self::INFO }.into())
    }

    /// Returns the outcomes that thresholds of a range can have on stretches of a signal, each coded by itself. Lists
    /// about `most` of them, and says whether any is missing, if each takes a pass over the signal. The settings are
    /// of any threshold. `None` if the scheme has no such list.
    fn outcomes(_: &Settings, _: &[&[f64]], _: (f64, f64), _: usize) -> Option<Outcomes> {
        None
    }

    /// Compares values of one parameter in one pass over stretches of a signal, and returns the spikes and squared errors
    /// of each: values of the threshold, or factors on the filter where it has no threshold. The settings are of any
    /// value. `None` if it takes a pass for each.
    fn swept(_: &Settings, _: &[&[f64]], _: &[f64; LANES]) -> Option<[(usize, f64); LANES]> {
        None
    }

    /// The scheme as a constant in Rust: its type in the crate, what that takes behind the sample type, and its
    /// constructor, as [`Rust::filled`] takes them.
    const CONSTANT: Option<[&str; 3]> = None;

    /// The scheme as a constant in Rust. The settings are those of a scheme that can be built.
    ///
    /// # Errors
    /// The settings lack something, or it has no constant.
    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let Some([scheme, shape, value]) = Self::CONSTANT else {
            return Err(ErrorKind::NoConstant { scheme: &Self::INFO }.into());
        };
        let filled = |template| rust.filled(template, &Self::INFO, settings);
        rust.constant(scheme, &filled(shape)?, &filled(value)?)
    }

    /// Whether the numbers of a parameter become samples, which rounds them to the sample type.
    fn is_in_samples(parameter: &Parameter, _: &Settings) -> bool {
        parameter.unit == Unit::Signal
    }

    /// The range in which a good value of a parameter is looked for, given the others.
    fn search(parameter: &Parameter, _: &Asked) -> Option<Search> {
        parameter.search
    }

    /// Builds it and hands it to a visitor.
    ///
    /// # Errors
    /// A parameter makes no sense, or the visitor's own.
    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output>;
}

/// Writes how a population code is built: its encoder's start and the scheme, from settings, in the sample type `S` with
/// codes that hold `M` neurons. These are as small as its neurons allow.
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

/// Writes what a scheme costs: the state of this type, and this codec of the measured table, so many times as long.
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

/// A scheme of the catalogue, whichever it is.
pub trait RunTime: Sync {
    /// The description of the scheme, without running it.
    fn info(&self) -> &'static Info;

    /// The parameters that would make a calibration over the whole signal unnecessary.
    fn needs_signal(&self, asked: &Asked) -> Option<Needs>;

    /// How many samples its encoder takes to start from.
    fn looks_back(&self, asked: &Asked) -> usize;

    /// Complete settings from what is asked for, the paper's settings and the signal, as they run in a sample type.
    ///
    /// # Errors
    /// A parameter is missing, not taken by the scheme, makes no sense, or becomes 0 in the sample type and must not.
    fn resolve(&self, sample: SampleType, asked: &Asked, known: &Known) -> Result<Settings>;

    /// How many neurons and sub-timesteps it has.
    ///
    /// # Errors
    /// The settings lack them, or they make no sense.
    fn shape(&self, settings: &Settings) -> Result<Shape>;

    /// The range in which a good value of a parameter is looked for, given the others.
    fn search(&self, parameter: &Parameter, asked: &Asked) -> Option<Search>;

    /// The bytes of RAM of one channel's encoder, on a flight controller.
    ///
    /// # Errors
    /// The settings lack its length, or it is not known.
    fn ram(&self, settings: &Settings) -> Result<usize>;

    /// The codec of the measured table that stands for its work.
    ///
    /// # Errors
    /// The settings lack its length, or none does.
    fn counted(&self, settings: &Settings) -> Result<Counted>;

    /// Returns the outcomes that thresholds of a range can have on stretches of a signal, each coded by itself. Lists
    /// about `most` of them, and says whether any is missing, if each takes a pass over the signal. The settings are
    /// of any threshold. `None` if the scheme has no such list.
    fn outcomes(
        &self,
        settings: &Settings,
        stretches: &[&[f64]],
        range: (f64, f64),
        most: usize,
    ) -> Option<Outcomes>;

    /// Compares values of one parameter in one pass over stretches of a signal, and returns the spikes and squared errors
    /// of each: values of the threshold, or factors on the filter where it has no threshold. The settings are of any
    /// value. `None` if it takes a pass for each.
    fn swept(
        &self,
        settings: &Settings,
        stretches: &[&[f64]],
        values: &[f64; LANES],
    ) -> Option<[(usize, f64); LANES]>;

    /// The scheme as a constant in Rust, as the settings run.
    ///
    /// # Errors
    /// The settings lack something, or it has no constant.
    fn constant(&self, settings: &Settings) -> Result<Constant>;

    /// An encoder and its decoder, as they start on a recording.
    ///
    /// # Errors
    /// A parameter makes no sense.
    fn codec(&self, settings: &Settings) -> Result<Codec>;

    /// The same, whose decoder starts from a value, if there is one.
    ///
    /// # Errors
    /// A parameter makes no sense.
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
        stretches: &[&[f64]],
        range: (f64, f64),
        most: usize,
    ) -> Option<Outcomes> {
        T::outcomes(settings, stretches, range, most)
    }

    fn swept(
        &self,
        settings: &Settings,
        stretches: &[&[f64]],
        values: &[f64; LANES],
    ) -> Option<[(usize, f64); LANES]> {
        T::swept(settings, stretches, values)
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

/// Settings as they run in a sample type that is not `f32`.
fn rounded<T: Build>(sample: SampleType, asked: &Settings) -> Result<Settings> {
    let one = sample.one();
    let round =
        |value: &f64| for_sample_type!(sample, S => S::from_f64(value * one).to_f64()) / one;
    let mut ran = asked.clone();
    ran.sample = sample;
    let first = ran.first_key();
    for (name, value) in ran.entries_mut() {
        let own = T::INFO.parameters.iter().find(|own| own.key() == *name);
        let is_rounded =
            own.is_some_and(|own| T::is_in_samples(own, asked)) || first == Some(*name);
        match value {
            Value::Number(number) if is_rounded => *number = round(number),
            Value::Numbers(numbers) if is_rounded => {
                for number in numbers {
                    *number = round(number);
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

/// Asks only whether a scheme can be built.
struct Nothing;

impl<S: Sample> Visit<S> for Nothing {
    type Output = ();

    fn visit<P: Scheme<Sample = S> + 'static>(self, _: P, _: P::EncoderState) -> Result<()> {
        Ok(())
    }
}
