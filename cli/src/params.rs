//! Files of parameters, TOML: what `tune` writes and every command that takes a scheme reads.

use crate::scheme::Scheme;
use anyhow::{Context, Result, bail};
use catalogue::Kind;
use catalogue::run::{Options, SampleType};
use std::fs;
use toml::{Table, Value};

/// A scheme, the sample type that it runs in, and its parameters as options take them.
#[derive(Clone, Debug)]
pub(crate) struct Params {
    /// The scheme.
    pub scheme: Scheme,
    /// The sample type, if the file says one.
    pub sample: Option<SampleType>,
    /// The parameters.
    pub options: Options,
}

impl Params {
    /// Reads a file.
    ///
    /// # Errors
    /// There is none, it is no TOML, names no scheme, or holds what the scheme does not take.
    pub(crate) fn read(path: &str) -> Result<Self> {
        let text = fs::read_to_string(path).with_context(|| format!("{path}: cannot be opened"))?;
        let table: Table = text.parse().with_context(|| format!("{path}: no TOML"))?;
        Self::from_table(table).with_context(|| path.to_owned())
    }

    /// The scheme of the file, if that is the one named.
    ///
    /// # Errors
    /// Another one is.
    pub(crate) fn agreed(&self, named: Option<Scheme>) -> Result<Scheme> {
        match named {
            Some(named) if named != self.scheme => {
                bail!("--params is of {}, --scheme says {}", self.scheme.name(), named.name())
            }
            _ => Ok(self.scheme),
        }
    }

    fn from_table(mut table: Table) -> Result<Self> {
        let mut word = |name: &str| match table.remove(name) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(other) => bail!("{name} = {other}: it must be a text"),
        };
        let Some(name) = word("scheme")? else { bail!("`scheme = \"...\"` is missing") };
        let Some(scheme) = Scheme::named(&name) else {
            let names: Vec<&str> = Scheme::all().map(Scheme::name).collect();
            bail!("there is no scheme `{name}`; there are {}", names.join(", "))
        };
        let sample = word("sample")?.map(|name| name.parse()).transpose()?;
        let mut options = Options::default();
        for (name, value) in table {
            let kind = scheme.info().parameters.iter().find(|own| own.name == name);
            let text = match (&value, kind.map(|own| own.kind)) {
                (Value::Boolean(false), Some(Kind::Flag)) => continue,
                (Value::Boolean(true), Some(Kind::Flag)) => String::new(),
                // A comma at the end, or one tap alone would be the name of a file.
                (Value::Array(taps), Some(Kind::Filter)) => {
                    let taps: Result<Vec<String>> =
                        taps.iter().map(|tap| plain(&name, tap)).collect();
                    taps?.join(",") + ","
                }
                // A parameter that there is not is told below.
                _ => plain(&name, &value)?,
            };
            options.set(&name, &text);
        }
        options.check(scheme.info())?;
        Ok(Self { scheme, sample, options })
    }
}

/// A number or a text, as an option takes it.
fn plain(name: &str, value: &Value) -> Result<String> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(number.to_string()),
        other => bail!("{name} = {other}: it must be a number or a text"),
    }
}

/// The text of a file of parameters, below these comments.
pub(crate) fn write(
    comments: &[String],
    scheme: Scheme,
    sample: SampleType,
    options: &Options,
) -> String {
    let mut table = Table::new();
    for (name, text) in options.iter() {
        let kind = scheme.info().parameters.iter().find(|own| own.name == name).map(|own| own.kind);
        let number = |text: &str| match text.parse::<i64>() {
            Ok(whole) => Value::Integer(whole),
            Err(_) => text.parse().map_or(Value::String(text.to_owned()), Value::Float),
        };
        let value = match kind {
            Some(Kind::Flag) => Value::Boolean(true),
            Some(Kind::Filter) if text.contains(',') && !text.contains('=') => {
                text.split(',').filter(|tap| !tap.is_empty()).map(number).collect::<Vec<_>>().into()
            }
            _ => number(text),
        };
        table.insert(name.to_owned(), value);
    }
    let comments = comments.iter().map(|line| "# ".to_owned() + line);
    let named = [format!("scheme = \"{}\"", scheme.name()), format!("sample = \"{sample}\"")];
    let lines: Vec<String> = comments.chain(named).collect();
    lines.join("\n") + "\n" + &table.to_string()
}

/// As the value of `--params`.
pub(crate) fn parse(path: &str) -> Result<Params, String> {
    Params::read(path).map_err(|error| format!("{error:#}"))
}

#[cfg(test)]
mod tests {
    use super::{Params, write};

    fn read(text: &str) -> anyhow::Result<Params> {
        Params::from_table(text.parse().unwrap())
    }

    #[test]
    fn what_is_written_is_read() {
        let text = "scheme = \"hsa\"\nsample = \"q8.8\"\nfilter = [0.25, 1, 0.5]\nshift = -2.5\n";
        let params = read(text).unwrap();
        assert_eq!(params.options.get("filter"), Some("0.25,1,0.5,"));
        assert_eq!(write(&[], params.scheme, params.sample.unwrap(), &params.options), text);
        let flag = read("scheme = \"tbr\"\nfactor = 0.5\nmagnitudes = true\n").unwrap();
        assert_eq!(flag.options.get("magnitudes"), Some(""));
    }

    #[test]
    fn what_is_none_is_told() {
        for (text, words) in [
            ("threshold = 1", "`scheme = "),
            ("scheme = \"snf\"", "there are tbr, "),
            ("scheme = \"sf\"\nsample = \"f64\"", "no sample type `f64`"),
            ("scheme = \"sf\"\nwindow = 5", "sf takes no --window"),
            ("scheme = \"sf\"\nthreshold = [1]", "must be a number or a text"),
        ] {
            let told = read(text).unwrap_err().to_string();
            assert!(told.contains(words), "{text}: {told}");
        }
    }
}
