//! Schemes chosen at run time: from what a user gave and a signal tells to settings, and from settings to a codec.
//!
//! A scheme says in its file how it is built from settings, and where needed how these come about. All else is here:
//! reading options and files, what the paper and the signal stand in for, what a sample type rounds, and the codec
//! whose type says nothing of the scheme.

mod asked;
mod calibrate;
mod codec;
mod exact;
mod filter;
mod given;
mod quantiles;
mod rust;
mod sample_type;
mod settings;

pub use asked::{Asked, Known, Options, missing};
pub use calibrate::Calibrated;
pub use codec::{Codec, Event};
pub use exact::{Outcome, Parabola, below, outcomes};
pub use filter::taps;
pub use given::{Given, Ran};
pub use rust::{Constant, Counted, Mean, Rust, lengthened, state};
pub use sample_type::{Fixed32, SampleType};
pub use settings::{Settings, is_list, number};

use anyhow::{Result, bail};
use spikewire::{Sample, Scheme, Spike};

use crate::{Entry, Info, Parameter, Search, State, for_sample_type};

/// Populations up to this size have codes of this capacity, larger ones of the largest.
const FEW: usize = 64;

/// How many neurons a code has, and how many sub-timesteps a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Neurons.
    pub neurons: usize,
    /// Sub-timesteps.
    pub slots: usize,
}

/// Takes a scheme of any type in a sample type.
pub trait Visit<S: Sample> {
    /// What it makes of it.
    type Output;

    /// Takes the scheme, and the state from which its encoder starts.
    ///
    /// # Errors
    /// The visitor's own.
    fn visit<P>(self, scheme: P, start: P::EncoderState) -> Result<Self::Output>
    where
        P: Scheme<
                Sample = S,
                EncoderState: State + Send + Sync,
                DecoderState: State + Send + Sync,
                Code: Send + Sync,
            > + Send
            + Sync
            + 'static;

    /// Takes a scheme whose decoder adds up steps.
    ///
    /// # Errors
    /// The visitor's own.
    fn visit_steps<P>(self, scheme: P, start: P::EncoderState) -> Result<Self::Output>
    where
        P: Scheme<
                Sample = S,
                Code = Spike,
                EncoderState: State + Send + Sync,
                DecoderState: State + Send + Sync,
            > + Send
            + Sync
            + 'static,
        Self: Sized,
    {
        self.visit(scheme, start)
    }
}

/// How a scheme comes about at run time.
pub trait Build: Entry {
    /// Complete settings from options, the paper's settings and the signal.
    ///
    /// # Errors
    /// A parameter is missing or makes no sense.
    fn resolve(asked: &Asked) -> Result<Settings> {
        asked.all()
    }

    /// The options that would make a calibration over the whole signal unnecessary.
    fn needs_signal(options: &Options) -> Option<String> {
        missing(&Self::INFO, options)
    }

    /// How many samples its encoder takes to start from.
    fn looks_back(_: &Options) -> usize {
        1
    }

    /// How many neurons and sub-timesteps it has.
    ///
    /// # Errors
    /// The settings lack them, or they make no sense.
    fn shape(given: &Given) -> Result<Shape> {
        let has = |name: &str| Self::INFO.parameters.iter().any(|own| own.name == name);
        let neurons = if has("neurons") { given.neurons()? } else { 1 };
        let slots =
            if has("slots") { given.count("slots", 2..=spikewire::dynamic::LEVELS)? } else { 1 };
        Ok(Shape { neurons, slots })
    }

    /// The bytes of RAM of one channel's encoder, on a flight controller.
    ///
    /// # Errors
    /// The settings lack its length, or it is not known.
    fn ram<S: Sample>(_: &Given) -> Result<usize> {
        bail!("the memory of {} is not known here", Self::INFO.name)
    }

    /// Which codec of the measured table stands for its work.
    ///
    /// # Errors
    /// The settings lack its length, or none does.
    fn counted(_: &Given) -> Result<Counted> {
        bail!("{} is not among the codecs that were measured", Self::INFO.name)
    }

    /// Every outcome that its threshold can have on stretches of a signal, each coded by itself; about so many at most.
    /// The settings are of any threshold. `None`: it has no such list.
    fn outcomes(_: &Given, _: &[&[f64]], _: usize) -> Option<Vec<Outcome>> {
        None
    }

    /// It as a constant in Rust.
    ///
    /// # Errors
    /// The settings lack something, or it has no constant.
    fn constant(_: &Given, _: &Rust) -> Result<Constant> {
        bail!("{} has no constant", Self::INFO.name)
    }

    /// Where a good value of a parameter is looked for beside these options.
    fn search(parameter: &Parameter, _: &Options) -> Option<Search> {
        parameter.search
    }

    /// Builds it and hands it to a visitor.
    ///
    /// # Errors
    /// A parameter makes no sense, or the visitor's own.
    fn build<S: Sample, V: Visit<S>>(given: &Given, visitor: V) -> Result<V::Output>;
}

/// A population code, built with codes of a capacity that holds its neurons.
pub trait BuildPopulation: Build {
    /// Builds it with codes of the capacity `M` and hands it to a visitor.
    ///
    /// # Errors
    /// A parameter makes no sense, or the visitor's own.
    fn build_within<S: Sample, V: Visit<S>, const M: usize>(
        given: &Given,
        visitor: V,
    ) -> Result<V::Output>;

    /// Builds it with codes as small as its neurons allow.
    ///
    /// # Errors
    /// A parameter makes no sense, or the visitor's own.
    fn build_population<S: Sample, V: Visit<S>>(given: &Given, visitor: V) -> Result<V::Output> {
        if Self::shape(given)?.neurons <= FEW {
            Self::build_within::<S, V, FEW>(given, visitor)
        } else {
            Self::build_within::<S, V, { spikewire::dynamic::NEURONS }>(given, visitor)
        }
    }
}

/// A scheme of the catalogue, whichever it is.
pub trait RunTime: Sync {
    /// What is known of it without running it.
    fn info(&self) -> &'static Info;

    /// The options that would make a calibration over the whole signal unnecessary.
    fn needs_signal(&self, options: &Options) -> Option<String>;

    /// How many samples its encoder takes to start from.
    fn looks_back(&self, options: &Options) -> usize;

    /// Complete settings from options, the paper's settings and the signal.
    ///
    /// # Errors
    /// A parameter is missing, not taken by the scheme, or makes no sense.
    fn resolve(&self, options: &Options, known: &Known) -> Result<Settings>;

    /// How many neurons and sub-timesteps it has.
    ///
    /// # Errors
    /// The settings lack them, or they make no sense.
    fn shape(&self, settings: &Settings) -> Result<Shape>;

    /// The settings as they run in a sample type, and which of them it rounded.
    ///
    /// # Errors
    /// A parameter becomes 0 that must not, or makes no sense.
    fn rounded(&self, sample: SampleType, settings: &Settings) -> Result<(Settings, Vec<Ran>)>;

    /// Where a good value of a parameter is looked for beside these options.
    fn search(&self, parameter: &Parameter, options: &Options) -> Option<Search>;

    /// The bytes of RAM of one channel's encoder, on a flight controller.
    ///
    /// # Errors
    /// The settings lack its length, or it is not known.
    fn ram(&self, sample: SampleType, settings: &Settings) -> Result<usize>;

    /// Which codec of the measured table stands for its work.
    ///
    /// # Errors
    /// The settings lack its length, or none does.
    fn counted(&self, settings: &Settings) -> Result<Counted>;

    /// Every outcome that its threshold can have on stretches of a signal, each coded by itself; about so many at most.
    /// The settings are of any threshold. `None`: it has no such list.
    fn outcomes(
        &self,
        settings: &Settings,
        stretches: &[&[f64]],
        most: usize,
    ) -> Option<Vec<Outcome>>;

    /// It as a constant in Rust, of settings that are [rounded](Self::rounded).
    ///
    /// # Errors
    /// The settings lack something, or it has no constant.
    fn constant(&self, sample: SampleType, settings: &Settings) -> Result<Constant>;

    /// An encoder and its decoder, as they start on a recording.
    ///
    /// # Errors
    /// A parameter makes no sense.
    fn codec(&self, sample: SampleType, settings: &Settings) -> Result<Codec>;
}

impl<T: Build + Sync> RunTime for T {
    fn info(&self) -> &'static Info {
        const { &T::INFO }
    }

    fn needs_signal(&self, options: &Options) -> Option<String> {
        if options.paper {
            return Some("parameters in the place of --paper".to_owned());
        }
        T::needs_signal(options)
    }

    fn looks_back(&self, options: &Options) -> usize {
        T::looks_back(options)
    }

    fn resolve(&self, options: &Options, known: &Known) -> Result<Settings> {
        let asked = Asked::new(&T::INFO, options, known)?;
        let mut settings = T::resolve(&asked)?;
        if T::INFO.has_first_value {
            settings.first = asked.first_window(T::looks_back(asked.options))?;
        }
        Ok(settings)
    }

    fn shape(&self, settings: &Settings) -> Result<Shape> {
        T::shape(&Given::new(settings, 1.0))
    }

    fn rounded(&self, sample: SampleType, settings: &Settings) -> Result<(Settings, Vec<Ran>)> {
        if sample == SampleType::F32 {
            return Ok((settings.clone(), Vec::new()));
        }
        let given = Given::new(settings, sample.one());
        let built = for_sample_type!(sample, S => T::build::<S, _>(&given, Nothing));
        let mut told = given.told();
        if T::INFO.has_first_value
            && let Some(name) = settings.first_key()
        {
            for_sample_type!(sample, S => given.signal::<S>(name).map(drop))?;
            told = given.told();
        }
        let vanished =
            |ran: &&Ran| matches!((&ran.asked[..], &ran.ran[..]), ([asked], [0.0]) if *asked > 0.0);
        if let (Err(_), Some(ran)) = (&built, told.iter().find(vanished)) {
            bail!(
                "{} {} is 0 in {sample}, whose step is {}; a type with more bits after the point, or f32, would \
                 hold it",
                ran.name,
                ran.asked[0],
                sample.step()
            );
        }
        built?;
        let mut rounded = settings.clone();
        for ran in &told {
            rounded.set(ran.name, settings::list(&ran.ran));
        }
        told.retain(|ran| ran.asked != ran.ran);
        Ok((rounded, told))
    }

    fn search(&self, parameter: &Parameter, options: &Options) -> Option<Search> {
        T::search(parameter, options)
    }

    fn ram(&self, sample: SampleType, settings: &Settings) -> Result<usize> {
        let given = Given::new(settings, sample.one());
        for_sample_type!(sample, S => T::ram::<S>(&given))
    }

    fn counted(&self, settings: &Settings) -> Result<Counted> {
        T::counted(&Given::new(settings, 1.0))
    }

    fn outcomes(
        &self,
        settings: &Settings,
        stretches: &[&[f64]],
        most: usize,
    ) -> Option<Vec<Outcome>> {
        T::outcomes(&Given::new(settings, 1.0), stretches, most)
    }

    fn constant(&self, sample: SampleType, settings: &Settings) -> Result<Constant> {
        T::constant(&Given::new(settings, sample.one()), &Rust::new(sample))
    }

    fn codec(&self, sample: SampleType, settings: &Settings) -> Result<Codec> {
        let given = Given::new(settings, sample.one());
        let mut visitor = codec::Start { settings, one: sample.one(), first: None };
        if T::INFO.has_first_value {
            let Some(name) = settings.first_key() else {
                bail!("the header lacks `# first=` or `# start=`; is it a file of spikes?")
            };
            visitor.first = Some(given.number(name)?);
        }
        for_sample_type!(sample, S => T::build::<S, _>(&given, visitor))
    }
}

/// Asks only whether a scheme can be built.
struct Nothing;

impl<S: Sample> Visit<S> for Nothing {
    type Output = ();

    fn visit<P: Scheme<Sample = S> + 'static>(self, _: P, _: P::EncoderState) -> Result<()> {
        Ok(())
    }
}
