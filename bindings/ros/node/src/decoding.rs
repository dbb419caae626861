//! Messages of spikes to values.

use crate::clock::Clock;
use crate::codec::{Codec, Request};
use crate::counters::Counters;
use crate::names::{GAUSSIAN_FIELDS, of_catalogue};
use crate::settings::Settings;
use crate::wire::Said;
use anyhow::Result;

/// Decodes messages as they come.
///
/// What is not given stands in the first message: the scheme, the value to start from, the range, the threshold, and
/// how many neurons there are. When an encoder starts anew, with another scheme or start, so does the decoder.
pub(crate) struct Decoding {
    settings: Settings,
    clock: Clock,
    codec: Option<Codec>,
    /// The scheme and the start that the encoder's messages tell.
    encoder: (String, f32),
}

impl Decoding {
    /// # Errors
    /// A parameter is not good.
    pub(crate) fn new(settings: Settings) -> Result<Self> {
        if let Some(scheme) = &settings.scheme {
            Request::new(scheme, &settings)?;
        }
        let clock = Clock::new(settings.gap);
        Ok(Self { settings, clock, codec: None, encoder: (String::new(), 0.0) })
    }

    /// Returns the value, unless the message is none of the scheme's: that is counted, and the decoder stays as it is.
    ///
    /// # Errors
    /// A parameter is missing or not good.
    pub(crate) fn take(
        &mut self,
        spikes: &[i8],
        said: &Said,
        counters: &mut Counters,
    ) -> Result<Option<f64>> {
        self.clock.observe(said.timestamp.to_nanos(), counters);
        let is_same = self.encoder.0 == said.scheme && self.encoder.1 == said.start;
        let codec = match &mut self.codec {
            Some(codec) if is_same => codec,
            other => {
                if other.is_some() {
                    counters.add("new starts of the encoder", 1, "");
                }
                let codec = start(&self.settings, spikes.len(), said)?;
                if codec.starts_at_first() && said.input != said.start {
                    let detail = format!(
                        "the first sample heard is {}, the encoder's was {}: values are off by what was missed",
                        said.input, said.start
                    );
                    counters.add("starts in the middle", 1, &detail);
                }
                self.encoder = (said.scheme.clone(), said.start);
                other.insert(codec)
            }
        };
        match codec.decode(spikes) {
            Ok(value) => Ok(Some(value)),
            Err(error) => {
                counters.add("messages refused", 1, &error.to_string());
                Ok(None)
            }
        }
    }
}

fn start(settings: &Settings, length: usize, said: &Said) -> Result<Codec> {
    let scheme = settings.scheme.clone().unwrap_or_else(|| of_catalogue(&said.scheme));
    let (mut low, mut high) = (f64::from(said.min_input), f64::from(said.max_input));
    if said.scheme == GAUSSIAN_FIELDS {
        // The range in which our neurons have the centres of the toolbox's.
        let field = (high - low) / length.saturating_sub(2).max(1) as f64;
        (low, high) = (low - field, high - field);
    }
    let told = [("threshold", said.threshold.into()), ("min", low), ("max", high), ("shift", low)];
    Request::new(&scheme, settings)?.receive(&told, length, said.start.into())
}

#[cfg(test)]
mod tests {
    use super::Decoding;
    use crate::codec::Request;
    use crate::counters::Counters;
    use crate::encoding::{Coded, Encoding};
    use crate::settings::{Parameters, Settings};
    use crate::wire::Said;
    use yaml_rust2::{Yaml, YamlLoader};

    fn settings(scheme: &str, yaml: &str) -> anyhow::Result<Settings> {
        let read = YamlLoader::load_from_str(&format!("{{{yaml}}}")).unwrap();
        let own = read[0].as_hash().unwrap();
        let mut given: Parameters = own
            .iter()
            .map(|(name, value)| (name.as_str().unwrap().to_owned(), value.clone()))
            .collect();
        given.insert("encoding_scheme".to_owned(), Yaml::String(scheme.to_owned()));
        Settings::read(&given)
    }

    /// About the toolbox's signal: three sines, 100 samples a second.
    fn signal() -> Vec<f64> {
        let sines = [(2.0, 1.0), (-0.5, 3.0), (0.75, 5.0)];
        let at = |index: u32| {
            let time = std::f64::consts::TAU * f64::from(index) / 100.0;
            sines.iter().map(|(peak, hertz)| peak * (hertz * time).sin()).sum::<f64>() as f32
        };
        (0..400).map(|index| at(index).into()).collect()
    }

    fn encoded(
        scheme: &str,
        yaml: &str,
        samples: &[f64],
        counters: &mut Counters,
    ) -> anyhow::Result<Vec<Coded>> {
        let mut encoding = Encoding::new(Request::new(scheme, &settings(scheme, yaml)?)?)?;
        let mut coded = Vec::new();
        for (stamp, sample) in (0..).step_by(10_000_000).zip(samples) {
            coded.extend(encoding.take(*sample, stamp, counters)?);
        }
        coded.extend(encoding.end(counters)?);
        Ok(coded)
    }

    #[test]
    fn every_scheme_with_its_defaults_decodes_to_what_its_encoder_decoded() {
        let (samples, mut counters) = (signal(), Counters::default());
        for scheme in catalogue::ALL.iter().map(|scheme| scheme.info().name) {
            let coded = encoded(scheme, "defaults: true", &samples, &mut counters).unwrap();
            assert_eq!(coded.len(), samples.len(), "{scheme}");
            assert!(
                coded.iter().any(|coded| coded.spikes.iter().any(|cell| *cell != 0)),
                "{scheme}"
            );
            let mut decoding = Decoding::new(settings(scheme, "defaults: true").unwrap()).unwrap();
            for (sample, coded) in samples.iter().zip(&coded) {
                assert_eq!(f64::from(coded.said.input), *sample, "{scheme}");
                let value = decoding.take(&coded.spikes, &coded.said, &mut counters).unwrap();
                assert_eq!(value, Some(coded.decoded), "{scheme}");
            }
        }
        assert!(counters.counts().is_empty(), "{counters}");
    }

    #[test]
    fn what_is_not_good_is_named() {
        for (scheme, yaml, why) in [
            ("step", "threshold: 0.1", "encoding_scheme step: there are tbr,"),
            ("sf", "treshold: 0.1", "sf takes no treshold; it takes threshold start"),
            ("sf", "threshold: 0", "threshold 0 must be above 0"),
            ("sf", "threshold: {a: 1}", "threshold"),
            ("sf", "threshold: 0.1, gap: 1", "gap: 1: it must be a number above 1"),
            ("sf", "threshold: 0.1, calibrate: -1", "calibrate: -1: it must be a whole number"),
            ("sf", "threshold: 0.1, sample: f16", "f16"),
            ("grf", "neurons: 20", "grf needs min and max, or calibrate"),
        ] {
            let told = encoded(scheme, yaml, &[], &mut Counters::default()).unwrap_err();
            let told = format!("{told:#}");
            assert!(told.contains(why), "{scheme}, {yaml}: {told}");
        }
    }

    #[test]
    fn what_is_not_finite_emits_nothing_and_is_counted() {
        let mut counters = Counters::default();
        let samples = [0.0, f64::NAN, 1.0, f64::INFINITY, -1e39, 2.0];
        let coded = encoded("sf", "threshold: 0.5", &samples, &mut counters).unwrap();
        assert_eq!((coded.len(), counters.counts()["samples not finite"]), (3, 3));
    }

    #[test]
    fn a_signal_too_short_to_start_is_told_and_a_window_is_not_waited_for_at_the_end() {
        let mut counters = Counters::default();
        assert!(encoded("grf", "defaults: true", &[0.0; 99], &mut counters).unwrap().is_empty());
        assert_eq!(counters.to_string(), "99 samples that came too few to start");
        assert_eq!(
            encoded("mw", "defaults: true", &[0.0, 1.0, 2.0], &mut counters).unwrap().len(),
            3
        );
    }

    #[test]
    fn messages_of_another_scheme_are_refused_and_late_and_new_starts_are_counted() {
        let mut counters = Counters::default();
        let samples = signal();
        let coded = encoded("sf", "threshold: 0.35", &samples, &mut counters).unwrap();
        let mut decoding = Decoding::new(settings("", "").unwrap()).unwrap();
        let mut take =
            |spikes: &[i8], said: &Said| decoding.take(spikes, said, &mut counters).unwrap();
        assert_eq!(take(&coded[50].spikes, &coded[50].said), Some(0.0));
        assert_eq!(take(&[0, 1], &coded[51].said), None);
        assert_eq!(take(&[3], &coded[52].said), None);
        let again = Said { start: 1.5, input: 1.5, ..coded[53].said.clone() };
        assert_eq!(take(&[1], &again), Some(1.5));
        assert_eq!(
            counters.to_string(),
            "2 messages refused, 1 new starts of the encoder, 1 starts in the middle"
        );
    }

    #[test]
    fn the_toolbox_numbers_its_fields_from_0() {
        let coded = encoded("grf", "defaults: true", &signal(), &mut Counters::default()).unwrap();
        let mut row = vec![0; 20];
        row[7] = 1;
        for (scheme, place) in [("gaussian_fields", 7.0), ("grf", 8.0)] {
            let said = Said {
                scheme: scheme.to_owned(),
                min_input: -1.0,
                max_input: 1.0,
                ..coded[0].said.clone()
            };
            let mut decoding = Decoding::new(settings("", "").unwrap()).unwrap();
            let value = decoding.take(&row, &said, &mut Counters::default()).unwrap().unwrap();
            assert!(
                (value - (-1.0 + (2.0 * place - 3.0) / 18.0)).abs() < 1e-6,
                "{scheme}: {value}"
            );
        }
    }
}
