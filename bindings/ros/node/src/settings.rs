//! Parameters of the nodes.

use crate::codec::plain;
use crate::names::of_catalogue;
use anyhow::{Context, Result, bail};
use catalogue::Info;
use catalogue::run::{Asked, Error, SET, SampleType, Value};
use std::collections::BTreeMap;
use yaml_rust2::{Yaml, YamlLoader};

/// Parameters by name, with the values that YAML has.
pub(crate) type Parameters = BTreeMap<String, Yaml>;

/// What a scheme takes where nothing else is said and `defaults` is set: the table of the nodes of ROS 1.
const DEFAULTS: &str = include_str!("../../ros1/spikewire_ros/config/defaults.yaml");

/// What a node was given.
pub(crate) struct Settings {
    /// The catalogue's name; the decoding node may take it from the messages.
    pub scheme: Option<String>,
    pub sample: SampleType,
    pub topic: Option<String>,
    pub field: String,
    /// How many samples stand in for what is not given.
    pub calibrate: usize,
    /// A step above so many usual ones is a gap.
    pub gap: f64,
    /// The scheme's own.
    own: Vec<(String, Yaml)>,
}

impl Settings {
    /// Reads parameters.
    ///
    /// # Errors
    /// One is not good; the text says which, what it was and what is allowed.
    pub(crate) fn read(given: &Parameters) -> Result<Self> {
        let text_of = |name: &str| given.get(name).map(text).transpose().context(name.to_owned());
        let scheme = text_of("encoding_scheme")?.filter(|name| !name.is_empty());
        let scheme = scheme.map(|name| of_catalogue(&name));
        let mut all = Parameters::new();
        if let (Some(Yaml::Boolean(true)), Some(scheme)) = (given.get("defaults"), &scheme) {
            all.extend(defaults(scheme)?);
        }
        all.extend(given.iter().map(|(name, value)| (name.clone(), value.clone())));
        let mut settings = Self {
            scheme,
            sample: SampleType::F32,
            topic: None,
            field: "data".to_owned(),
            calibrate: 0,
            gap: 1.5,
            own: Vec::new(),
        };
        for (name, value) in &all {
            settings.set(name, value).with_context(|| name.clone())?;
        }
        Ok(settings)
    }

    fn set(&mut self, name: &str, value: &Yaml) -> Result<()> {
        match name {
            "encoding_scheme" | "defaults" | "use_sim_time" | "start_type_description_service" => {}
            "sample" => self.sample = text(value)?.parse()?,
            "topic" => self.topic = Some(text(value)?).filter(|topic| !topic.is_empty()),
            "field" => self.field = text(value)?,
            "calibrate" => match value.as_i64().map(usize::try_from) {
                Some(Ok(samples)) => self.calibrate = samples,
                _ => bail!("{}: it must be a whole number of samples, 0 or more", shown(value)),
            },
            "gap" => match text(value)?.parse() {
                Ok(gap) if gap > 1.0 => self.gap = gap,
                _ => bail!("{}: it must be a number above 1, in usual steps", shown(value)),
            },
            // ROS's own, such as qos_overrides.
            _ if name.contains('.') => {}
            _ => self.own.push((name.to_owned(), value.clone())),
        }
        Ok(())
    }

    /// Returns the scheme's own parameters as values.
    ///
    /// # Errors
    /// The scheme takes no such parameter, or it is not good.
    pub(crate) fn asked(&self, info: &'static Info) -> Result<Asked> {
        let mut asked = Asked::default();
        for (name, value) in &self.own {
            let Some(parameter) = info.parameter(name) else {
                return Err(plain(Error::takes_no(info, name.clone())));
            };
            let value = match value {
                Yaml::Boolean(false) => continue,
                Yaml::Boolean(true) => parameter.check(SET),
                Yaml::Array(items) => parameter.check(numbers(items).context(name.clone())?),
                other => parameter.read(&text(other).context(name.clone())?),
            };
            asked.set(parameter.name, value.map_err(plain)?);
        }
        Ok(asked)
    }

    /// Returns the path of a flight's file, if one is given.
    ///
    /// # Errors
    /// A parameter is given that the file has.
    pub(crate) fn flight(&self) -> Result<Option<&str>> {
        let Some((_, path)) = self.own.iter().find(|(name, _)| name == "flight") else {
            return Ok(None);
        };
        if let Some((name, _)) = self.own.iter().find(|(name, _)| name != "flight") {
            bail!("{name}: it stands in the flight's file; parameters are flight, topic and gap");
        }
        Ok(Some(path.as_str().context("flight: it must be a path")?))
    }

    /// Returns the path of a flight's file and the topic, which the node of a flight must have.
    ///
    /// # Errors
    /// One is missing, or a parameter is given that the file has.
    pub(crate) fn to_fly(&self) -> Result<(&str, &str)> {
        let flight = self.flight()?.context("flight is missing: the path of a flight.toml")?;
        let topic = self.topic.as_deref();
        Ok((flight, topic.context("topic is missing: what to encode, such as /imu/data")?))
    }

    /// Returns scheme and topic, which an encoding node must have.
    ///
    /// # Errors
    /// One is missing.
    pub(crate) fn to_encode(&self) -> Result<(&str, &str)> {
        let topic = self.topic.as_deref();
        let topic = topic.context("topic is missing: what to encode, such as /imu/data")?;
        let scheme = self.scheme.as_deref();
        Ok((
            scheme.context("encoding_scheme is missing: how to encode, such as step_forward")?,
            topic,
        ))
    }
}

/// Returns the table's parameters of a scheme.
fn defaults(scheme: &str) -> Result<Parameters> {
    let table = YamlLoader::load_from_str(DEFAULTS).context("the table of defaults")?;
    let own = table.first().and_then(|table| table[scheme].as_hash());
    let pairs = own.into_iter().flatten();
    Ok(pairs.filter_map(|(name, value)| Some((name.as_str()?.to_owned(), value.clone()))).collect())
}

fn numbers(items: &[Yaml]) -> Result<Value> {
    let number = |item| Ok(text(item)?.parse::<f64>()?);
    items.iter().map(number).collect::<Result<_>>().map(Value::Numbers)
}

/// Returns a number or a text as it was written.
fn text(value: &Yaml) -> Result<String> {
    match value {
        Yaml::Real(text) | Yaml::String(text) => Ok(text.clone()),
        Yaml::Integer(number) => Ok(number.to_string()),
        other => {
            bail!("{other:?}: it must be a number, a text, a list of numbers, or true or false")
        }
    }
}

fn shown(value: &Yaml) -> String {
    text(value).unwrap_or_else(|_| format!("{value:?}"))
}
