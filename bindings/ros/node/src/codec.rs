//! The run-time codecs of the catalogue, a sample at a time. All use of them is here.

use crate::settings::Settings;
use anyhow::{Context, Result, anyhow, bail};
use catalogue::run::{
    Asked, Calibrated, Codec as Running, Known, RunTime, SampleType, Samples, Settings as Complete,
    Value, Values, Worded,
};
use spikewire_flight::Flight;

/// Schemes whose messages have a number for each neuron.
const NEURON_BY_NEURON: [&str; 4] = ["position", "grf", "grf-prob", "grf-nonlinear"];
/// Parameters from which an encoder finds its threshold, which messages tell.
const OF_THRESHOLD: [&str; 2] = ["factor", "magnitudes"];

/// A scheme with what was given of its parameters; samples or messages may tell the rest.
#[derive(Clone)]
pub(crate) struct Request {
    scheme: &'static dyn RunTime,
    sample: SampleType,
    asked: Asked,
    calibrate: usize,
    /// Number of its stream of random numbers.
    stream: u64,
}

impl Request {
    /// Takes the settings' parameters for a scheme.
    ///
    /// # Errors
    /// There is no such scheme, or it takes no such parameter.
    pub(crate) fn new(scheme: &str, settings: &Settings) -> Result<Self> {
        let own = catalogue::ALL.iter().find(|own| own.info().name == scheme);
        let own = own.with_context(|| {
            let names: Vec<&str> = catalogue::ALL.iter().map(|own| own.info().name).collect();
            format!("encoding_scheme {scheme}: there are {}", names.join(", "))
        })?;
        let asked = settings.asked(own.info())?;
        let Settings { sample, calibrate, .. } = *settings;
        Ok(Self { scheme: *own, sample, asked, calibrate, stream: 0 })
    }

    /// Takes the parameters of a flight's channel.
    pub(crate) fn of_flight(flight: &Flight, channel: usize) -> Self {
        Self {
            scheme: flight.run_time(),
            sample: flight.sample,
            asked: flight.asked(&flight.channels[channel]),
            calibrate: 0,
            stream: channel as u64,
        }
    }

    /// How many samples it takes to start: to calibrate on, or to fill a window.
    pub(crate) fn enough(&self) -> usize {
        self.least().max(self.scheme.looks_back(&self.asked))
    }

    /// How many it takes where there will be no more.
    pub(crate) fn least(&self) -> usize {
        self.calibrate.max(1)
    }

    /// Returns whether a sample has several numbers: of several neurons, or of several sub-timesteps.
    ///
    /// # Errors
    /// A parameter is missing or not good.
    pub(crate) fn is_array(&self) -> Result<bool> {
        // Neither depends on what the samples are.
        let samples = if self.calibrate > 0 { &[0.0, 1.0, 0.5][..] } else { &[0.0] };
        Ok(self.codec(samples)?.width() > 1)
    }

    /// Returns the codec as it starts on these samples, which stand in for what is not given if `calibrate` is set.
    ///
    /// # Errors
    /// A parameter is missing or not good.
    pub(crate) fn codec(&self, samples: &[f64]) -> Result<Codec> {
        let needs = self.scheme.needs_signal(&self.asked);
        let calibrated = match needs {
            None => None,
            Some(what) if self.calibrate == 0 => {
                let name = self.scheme.info().name;
                let what = what.spelled(str::to_owned);
                bail!("{name} needs {what}, or calibrate: as many samples as tell it");
            }
            Some(_) => {
                let mut calibrated = Calibrated::new(self.sample);
                calibrated.observe(samples);
                Some(calibrated)
            }
        };
        let known = Known { calibrated: calibrated.as_ref(), first: samples, can_calibrate: false };
        Codec::new(self.scheme, self.sample, &self.asked, &known, self.stream)
    }

    /// Returns the codec that decodes messages of so many numbers which tell these parameters, from a first value on.
    ///
    /// # Errors
    /// A parameter is missing or not good.
    pub(crate) fn receive(&self, told: &[(&str, f64)], length: usize, first: f64) -> Result<Codec> {
        let info = self.scheme.info();
        let mut asked = Asked::default();
        for (name, value) in told {
            if let Some(own) = info.parameter(name) {
                asked.set(own.name, own.check(Value::Number(*value)).map_err(plain)?);
            }
        }
        if NEURON_BY_NEURON.contains(&info.name) {
            asked.set("neurons", length as u64);
        }
        for (name, value) in self.asked.iter().filter(|(name, _)| !OF_THRESHOLD.contains(name)) {
            asked.set(name, value.clone());
        }
        let past = vec![first; self.scheme.looks_back(&asked)];
        let known = Known { calibrated: None, first: &past, can_calibrate: false };
        Codec::new(self.scheme, self.sample, &asked, &known, self.stream)
    }
}

/// An encoder and its decoder. The spikes of a sample are cells: a number for each neuron of each sub-timestep.
pub(crate) struct Codec {
    scheme: &'static dyn RunTime,
    sample: SampleType,
    settings: Complete,
    running: Running,
}

impl Codec {
    fn new(
        scheme: &'static dyn RunTime,
        sample: SampleType,
        asked: &Asked,
        known: &Known,
        stream: u64,
    ) -> Result<Self> {
        let settings = scheme.resolve(sample, asked, known).map_err(plain)?.with_stream(stream);
        let running = scheme.codec(&settings).map_err(plain)?;
        Ok(Self { scheme, sample, settings, running })
    }

    pub(crate) fn name(&self) -> &'static str {
        self.scheme.info().name
    }

    /// Number of cells of a sample.
    pub(crate) fn width(&self) -> usize {
        let shape = self.running.shape();
        shape.neurons * shape.slots
    }

    /// Whether decoding starts from the first sample's value, whose spike then changes nothing.
    pub(crate) fn starts_at_first(&self) -> bool {
        self.settings.starts_at_first()
    }

    /// The value that decoding starts from; 0 where the scheme has none.
    pub(crate) fn first(&self) -> f64 {
        self.settings.first_value().unwrap_or(0.0)
    }

    /// 0 where the scheme has none.
    pub(crate) fn threshold(&self) -> f64 {
        self.settings.number("threshold").unwrap_or(0.0)
    }

    /// Returns the range that it codes, or that of the samples where it has none.
    pub(crate) fn range(&self, (lowest, highest): (f64, f64)) -> (f64, f64) {
        let number = |name| self.settings.number(name);
        (
            number("min").or_else(|_| number("shift")).unwrap_or(lowest),
            number("max").unwrap_or(highest),
        )
    }

    /// Returns the header of a file of spikes: all that decoding needs.
    pub(crate) fn header(&self) -> String {
        let mut lines = vec![
            "spikewire=1".to_owned(),
            format!("scheme={}", self.name()),
            format!("sample={}", self.sample),
        ];
        lines.extend(self.settings.entries().iter().map(|(name, value)| format!("{name}={value}")));
        lines.join("\n") + "\n"
    }

    /// Takes finite samples, and returns the cells of those that these complete.
    pub(crate) fn encode(&mut self, samples: &[f64]) -> Vec<Vec<i8>> {
        self.rows(samples.len(), |running, cells| {
            running.encode_cells(Samples::F64(samples), cells)
        })
    }

    /// Returns the cells of the samples that wait for later ones.
    pub(crate) fn finish(&mut self) -> Vec<Vec<i8>> {
        self.rows(self.running.latency(), Running::finish_cells)
    }

    fn rows(
        &mut self,
        most: usize,
        code: impl FnOnce(&mut Running, &mut [i8]) -> usize,
    ) -> Vec<Vec<i8>> {
        let mut cells = vec![0; most * self.width()];
        let made = code(&mut self.running, &mut cells);
        cells.chunks(self.width()).take(made).map(<[i8]>::to_vec).collect()
    }

    /// Decodes the next sample's cells.
    ///
    /// # Errors
    /// No encoder of the scheme sends them; the decoder stays as it was.
    pub(crate) fn decode(&mut self, cells: &[i8]) -> Result<f64> {
        let (name, width) = (self.name(), self.width());
        if cells.len() != width {
            bail!("{} numbers a message, where {name} has {width}", cells.len());
        }
        let mut value = [0.0];
        if self.running.decode_cells(cells, &mut Values::F64(&mut value)).is_err() {
            bail!("{cells:?} is no code of {name}");
        }
        Ok(value[0])
    }
}

/// An error of the catalogue in the words of a node: parameters are named as in YAML.
#[allow(clippy::needless_pass_by_value)] // as `map_err` gives it
pub(crate) fn plain(error: catalogue::run::Error) -> anyhow::Error {
    anyhow!("{}", error.spelled(str::to_owned))
}
