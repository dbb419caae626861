//! A choice of scheme, sample type and parameters. Reads and writes the choice as a TOML file of parameters.

use crate::error::At;
use crate::scheme::Scheme;
use crate::tune::RequestKind;
use crate::{Error, Place, Result, Spot};
use catalogue::Parameter;
use catalogue::run::{Asked, Given, Known, SET, SampleType, Settings, Value};
use spikewire_flight::escaped;
use std::fs;
use std::path::Path;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table};

/// A scheme, its sample type, and the parameters that were set.
#[derive(Clone, Debug, PartialEq)]
pub struct Coding {
    /// The scheme.
    pub scheme: Scheme,
    /// The sample type.
    pub sample: SampleType,
    /// The parameters that were set. All other parameters have their defaults or come from a recording.
    pub asked: Asked,
}

impl Coding {
    /// Makes the coding with all parameters of `settings`.
    pub fn of_settings(scheme: Scheme, settings: &Settings) -> Self {
        Self { scheme, sample: settings.sample, asked: settings.to_asked(scheme.info()) }
    }

    /// Reads a TOML file of parameters.
    ///
    /// # Errors
    /// Returns an error, with file and line, if the file is missing, is not TOML, names no scheme, or has an entry that
    /// the scheme does not accept.
    pub fn read(path: &str) -> Result<Self> {
        let text = fs::read_to_string(path).map_err(|error| Error::open(path, error))?;
        Self::parse(path, &text)
    }

    /// Parses `text`, the content of a TOML file of parameters. Errors report the file as `file`.
    ///
    /// # Errors
    /// See [`read`](Self::read).
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let table =
            DeTable::parse(text).map_err(|error| RequestKind::NotToml { error }.at(file))?;
        let mut table = table.into_inner();
        let place = |at: usize| {
            let before = text.bytes().take(at).filter(|byte| *byte == b'\n').count();
            Place::spot(file, Spot::Entry(1 + before as u64))
        };
        let mut word = |name: &str| match table.remove(name) {
            None => Ok(None),
            Some(value) => {
                let at = value.span().start;
                if let DeValue::String(word) = value.get_ref() {
                    return Ok(Some((word.to_string(), at)));
                }
                let given = Given::listed(name, None::<&str>);
                Err(RequestKind::NotAText.of(given).at(place(at)))
            }
        };
        let Some((name, at)) = word("scheme")? else {
            return Err(RequestKind::NoSchemeNamed.at(file));
        };
        let Some(scheme) = Scheme::named(&name) else {
            return Err(Error::from(catalogue::run::Error::no_scheme(&name)).at(place(at)));
        };
        let sample = match word("sample")? {
            Some((name, at)) => name.parse().at(|| place(at))?,
            None => SampleType::default(),
        };
        let mut asked = Asked::default();
        let mut lines = Vec::new();
        for (name, value) in table {
            let at = value.span().start;
            let Some(parameter) = scheme.info().parameter(name.get_ref()) else {
                let name = name.get_ref().to_string();
                let error = catalogue::run::Error::takes_no(scheme.info(), name);
                return Err(Error::from(error).at(place(at)));
            };
            let directory = Path::new(file).parent().unwrap_or(Path::new(""));
            let value = read(parameter, &value, directory).map_err(|error| {
                let said = text.get(value.span()).unwrap_or_default();
                let given = Given::listed(parameter.name, Some(format_args!("= {said}")));
                Error { parameter: Some(given), ..error }.at(place(at))
            })?;
            if let Some(value) = value {
                asked.set(parameter.name, value);
                lines.push((parameter.name, at));
            }
        }
        let coding = Self { scheme, sample, asked };
        coding.built_alone().map_err(|mut error| {
            let line = |name: &str| {
                let is_it = |own: &Parameter| own.name == name || own.key() == name;
                let own = scheme.info().parameters.iter().find(|own| is_it(own))?;
                lines.iter().find(|(name, _)| *name == own.name).map(|&(_, at)| at)
            };
            let named = error.parameter.as_mut().and_then(|own| {
                own.is_listed = true;
                line(&own.name)
            });
            error.at(named.map_or_else(|| Place::of(file), place))
        })?;
        Ok(coding)
    }

    /// Checks the parameters by building a codec for each channel. Skips the check if a parameter is still missing, and
    /// will come from the options or from a recording. The caller adds the line of the file to an error.
    fn built_alone(&self) -> Result<()> {
        let Self { scheme, sample, asked } = self;
        let is_open = |own: &Parameter| {
            own.default.is_none() && own.found.is_none() && asked.get(own.name).is_none()
        };
        let recorded = scheme.info().parameters.iter().filter(|own| own.is_recorded);
        if asked.paper || scheme.needs_signal(asked).is_some() || recorded.clone().any(is_open) {
            return Ok(());
        }
        let past = vec![0.0; scheme.looks_back(asked)];
        let known = Known { calibrated: None, first: &past, can_calibrate: false };
        let info = scheme.info();
        let channels = asked.channels(info)?.unwrap_or(1);
        (0..channels).try_for_each(|channel| {
            let asked = asked.channel(info, channel, channels)?;
            scheme.codec(&scheme.resolve(*sample, &asked, &known)?)?;
            Ok(())
        })
    }

    /// Formats the coding as a TOML file of parameters, with `comments` at its start.
    pub fn to_toml(&self, comments: &[String]) -> String {
        let mut table = Table::new();
        for (name, value) in self.asked.iter() {
            let value = match value {
                value if *value == SET => true.into(),
                Value::Number(value) => number(*value),
                Value::Count(count) => toml::Value::from(*count as i64),
                Value::Word(word) => word.as_ref().into(),
                Value::Numbers(all) => {
                    all.iter().map(|value| number(*value)).collect::<Vec<_>>().into()
                }
            };
            table.insert(name.to_owned(), value);
        }
        let comments = comments.iter().map(|line| format!("# {}", escaped(line)));
        let named = [
            format!("scheme = \"{}\"", self.scheme.name()),
            format!("sample = \"{}\"", self.sample),
        ];
        let lines: Vec<String> = comments.chain(named).collect();
        lines.join("\n") + "\n" + &table.to_string()
    }
}

/// Converts a TOML value to a value of `parameter`. Returns `None` if the parameter is a flag and the value is `false`.
/// The path of a file of taps is relative to `directory`.
fn read(
    parameter: &Parameter,
    value: &Spanned<DeValue>,
    directory: &Path,
) -> Result<Option<Value>> {
    let number = |value: &DeValue| -> Result<f64> {
        let number = match value {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
            DeValue::Float(number) => number.as_str().parse().ok(),
            _ => None,
        };
        number.ok_or_else(|| RequestKind::NotANumber.into())
    };
    let value = match value.get_ref() {
        DeValue::Boolean(false) => return Ok(None),
        DeValue::Boolean(true) => SET,
        DeValue::String(text) => return Ok(Some(parameter.read_in(text, directory)?)),
        DeValue::Array(all) => {
            let all = all.iter().map(|value| number(value.get_ref()));
            Value::Numbers(all.collect::<Result<_>>()?)
        }
        DeValue::Table(_) | DeValue::Datetime(_) => {
            return Err(RequestKind::NeitherNumberNorText.into());
        }
        value => Value::Number(number(value)?),
    };
    Ok(Some(parameter.check(value)?))
}

/// Converts a number to TOML; a whole number is written without a decimal point.
fn number(value: f64) -> toml::Value {
    match value.to_string().parse::<i64>() {
        Ok(whole) => whole.into(),
        Err(_) => value.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::Coding;
    use catalogue::run::{SET, Value};

    fn read(text: &str) -> crate::Result<Coding> {
        Coding::parse("own.toml", text)
    }

    #[test]
    fn what_is_written_is_read() {
        let text = "scheme = \"hsa\"\nsample = \"q8.8\"\nfilter = [0.25, 1, 0.5]\nshift = -2.5\n";
        let coding = read(text).unwrap();
        assert_eq!(coding.asked.get("filter"), Some(&Value::from(vec![0.25, 1.0, 0.5])));
        assert_eq!(coding.to_toml(&[]), text);
        // A list of one number stays a list; a text would be the name of a file.
        let one = text.replace("[0.25, 1, 0.5]", "[2]");
        assert_eq!(read(&one).unwrap().to_toml(&[]), one);
        let flag = read("scheme = \"tbr\"\nfactor = 0.5\nmagnitudes = true\n").unwrap();
        assert_eq!(flag.asked.get("magnitudes"), Some(&SET));
        let each = read("scheme = \"sf\"\nthreshold = [0.1, 0.2]\n").unwrap();
        assert_eq!(each.asked.get("threshold"), Some(&Value::from(vec![0.1, 0.2])));
    }

    #[test]
    fn an_invalid_entry_is_reported_with_file_and_line() {
        for (text, words) in [
            ("threshold = 1", "own.toml: `scheme = "),
            ("scheme = \"snf\"", "own.toml:1: there is no scheme `snf`; there are tbr, "),
            ("scheme = \"sf\"\nsample = \"f64\"", "own.toml:2: no sample type `f64`"),
            ("scheme = \"sf\"\n\nwindow = 5", "own.toml:3: sf takes no `window`"),
            (
                "scheme = \"sf\"\n# half\nthreshold = \"abc\"",
                "own.toml:3: threshold = \"abc\" is not a number",
            ),
            (
                "scheme = \"sf\"\nthreshold = [\"a\"]",
                "own.toml:2: threshold = [\"a\"]: must be a number",
            ),
            ("scheme = \"sf\"\nthreshold = 1979-05-27", "must be a number or a text"),
            ("scheme = \"sf\"\n\nthreshold = -1", "own.toml:3: threshold -1 must be above 0"),
            ("scheme = \"sf\"\nthreshold = [1, -1]", "own.toml:2: "),
            ("scheme = \"mw\"\nthreshold = 1\nwindow = 99999", "own.toml:3: "),
            (
                "scheme = \"position\"\nneurons = 4\nmin = 5\nmax = 1",
                "own.toml:3: min 5 must be below",
            ),
            ("scheme = \"sf\"\nsample = \"q8.8\"\nthreshold = 0.0001", "own.toml:3: "),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
