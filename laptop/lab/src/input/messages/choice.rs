//! Finds the topic and the fields of a log that the options name, by patterns too, or that flew if they name none.

use super::overview::{Overview, overview};
use crate::Result;
use crate::input::inertial::{self, Sensor, Topic};
use crate::input::names::{MOST_ITEMS, few, fits, is_pattern, items, near};
use crate::input::{InputOptions, LogKind, Unnamed};
use flight_logs::Kind;

/// A topic of a log, and fields of it that hold a number each.
#[derive(Debug)]
pub(super) struct Choice {
    pub topic: String,
    pub fields: Vec<String>,
    /// The sensor, if the user named no channel.
    pub found: Option<Found>,
}

/// The inertial sensor that was found.
#[derive(Debug)]
pub(super) struct Found {
    /// Messages of the topic a second, if known.
    pub rate: Option<f64>,
    /// Other topics with an inertial sensor.
    pub others: Vec<String>,
}

/// A topic with the names of its fields, in which an array's items are named one by one.
struct Listed {
    overview: Overview,
    fields: Vec<String>,
}

impl Choice {
    /// Finds the topic and the fields. Reads the log for it only if a name alone does not tell them.
    ///
    /// # Errors
    /// Returns an error if the log lacks a channel, if the names are those of several topics, or if none is named and no
    /// sensor is found.
    pub(super) fn of(options: &InputOptions, kind: Kind) -> Result<Self> {
        let names: Vec<String> = options
            .fields()
            .chain(options.columns())
            .flat_map(|name| items(name, MOST_ITEMS))
            .collect();
        if names.is_empty() {
            return Self::unnamed(options, kind);
        }
        match Self::plain(options, kind, &names) {
            Some(choice) => Ok(choice),
            None => Self::named(options, kind, &names),
        }
    }

    /// Returns the topic and the fields if the names tell them without a look at the log.
    fn plain(options: &InputOptions, kind: Kind, names: &[String]) -> Option<Self> {
        if names.iter().any(|name| is_pattern(name)) {
            return None;
        }
        let found = None;
        if let Some(topic) = &options.topic {
            return Some(Self { topic: first_instance(topic), fields: names.to_vec(), found });
        }
        // In ROS, `angular_velocity.x` may be a field, or a field of a topic that is named without its slash.
        let is_ros = matches!(kind, Kind::Bag | Kind::Mcap | Kind::Sqlite | Kind::Directory);
        let mut topics = Vec::new();
        let mut fields = Vec::new();
        for name in names {
            let (topic, field) = match (name.split_once('.'), kind.usual_topic()) {
                (Some((topic, field)), _) if !is_ros || name.starts_with('/') => (topic, field),
                (None, Some(usual)) => (usual, name.as_str()),
                _ => return None,
            };
            topics.push(first_instance(topic));
            fields.push(field.to_owned());
        }
        let topic = topics.pop()?;
        topics.iter().all(|other| *other == topic).then_some(Self { topic, fields, found })
    }

    /// Finds the channels of a log that fit the names.
    fn named(options: &InputOptions, kind: Kind, names: &[String]) -> Result<Self> {
        let topics = listed(options, kind, MOST_ITEMS)?;
        let mut topic: Option<&str> = None;
        let mut fields: Vec<String> = Vec::new();
        for name in names {
            let mut matches = matching(name, &topics, |topic, field| {
                format!("{}.{field}", topic.trim_start_matches('/'))
            });
            if matches.is_empty() {
                matches = matching(name, &topics, |_, field| field.to_owned());
            }
            if matches.is_empty() {
                return Err(missing(name, &topics).at(options.name()));
            }
            for (own, field) in matches {
                if topic.is_some_and(|topic| topic != own) {
                    return Err(several(names, &topics).at(options.name()));
                }
                topic = Some(own);
                if !fields.iter().any(|other| other == field) {
                    fields.push(field.to_owned());
                }
            }
        }
        Ok(Self { topic: topic.unwrap_or_default().to_owned(), fields, found: None })
    }

    /// Finds the inertial sensor that flew.
    fn unnamed(options: &InputOptions, kind: Kind) -> Result<Self> {
        /// An array that is longer has the items of many samples.
        const MOST: usize = 64;
        let topics = listed(options, kind, MOST)?;
        let candidates: Vec<Topic> = topics
            .iter()
            .map(|own| Topic {
                name: &own.overview.name,
                fields: &own.fields,
                count: own.overview.count,
            })
            .collect();
        let found = inertial::find(&candidates);
        match found {
            Some(Sensor { topic, fields, others }) if options.unnamed != Unnamed::One => {
                let own = topics.iter().find(|own| own.overview.name == topic);
                let rate = own.and_then(|own| own.overview.clock.rate());
                Ok(Self { topic, fields, found: Some(Found { rate, others }) })
            }
            found => {
                let example = match &found {
                    Some(Sensor { topic, fields, .. }) => Some(format!("{topic}.{}", fields[0])),
                    None => topics.iter().find_map(|own| {
                        let field = inertial::first_field(&own.overview.name, &own.fields)?;
                        Some(format!("{}.{field}", own.overview.name))
                    }),
                };
                let is_one = options.unnamed == Unnamed::One;
                Err(LogKind::NeedsChannel { example, is_one }.at(options.name()))
            }
        }
    }
}

/// Returns a topic's name without the number of the first instance.
fn first_instance(topic: &str) -> String {
    topic.strip_suffix(":0").unwrap_or(topic).to_owned()
}

/// Lists the topics of a log whose numbers can be read, or the one that is asked for.
fn listed(options: &InputOptions, kind: Kind, most: usize) -> Result<Vec<Listed>> {
    let (all, _) = overview(&options.input, kind, options.accept_cut, options.gap)?;
    let asked = options.topic.as_deref().map(first_instance);
    let mut topics = Vec::new();
    for overview in all {
        let is_asked = asked.as_deref().is_none_or(|asked| {
            asked.trim_start_matches('/') == overview.name.trim_start_matches('/')
        });
        if overview.unread.is_some() || !is_asked {
            continue;
        }
        let fields = overview.fields.iter().flat_map(|field| items(field, most)).collect();
        topics.push(Listed { overview, fields });
    }
    Ok(topics)
}

/// Returns the channels, as topic and field, whose name fits. `full` gives the name of a field.
fn matching<'a>(
    name: &str,
    topics: &'a [Listed],
    full: impl Fn(&str, &str) -> String,
) -> Vec<(&'a str, &'a str)> {
    let name = name.trim_start_matches('/');
    let mut found = Vec::new();
    for topic in topics {
        let own = topic.overview.name.as_str();
        for field in &topic.fields {
            let full = full(own, field);
            if full == name || is_pattern(name) && fits(name, &full) {
                found.push((own, field.as_str()));
            }
        }
    }
    found
}

/// Makes the error for a name that no channel has.
fn missing(name: &str, topics: &[Listed]) -> LogKind {
    let same = |topic: &Listed| {
        let (own, name) =
            (topic.overview.name.trim_start_matches('/'), name.trim_start_matches('/'));
        name.strip_prefix(own).is_some_and(|rest| rest.starts_with('.'))
    };
    if let Some(topic) = topics.iter().find(|topic| same(topic)) {
        let own = &topic.overview;
        let field =
            name.trim_start_matches('/')[own.name.trim_start_matches('/').len() + 1..].to_owned();
        let near = near(&field, own.fields.iter().map(String::as_str));
        return LogKind::NoField { topic: own.name.clone(), field, near };
    }
    let mut names = Vec::new();
    for Listed { overview, .. } in topics {
        names.extend(overview.fields.iter().map(|field| format!("{}.{field}", overview.name)));
    }
    let near = near(name, names.iter().map(String::as_str));
    LogKind::NoChannelOf { name: name.to_owned(), near }
}

/// Makes the error for names that fit channels of several topics.
fn several(names: &[String], topics: &[Listed]) -> LogKind {
    let mut own: Vec<&str> = Vec::new();
    for name in names {
        let full = matching(name, topics, |topic, field| {
            format!("{}.{field}", topic.trim_start_matches('/'))
        });
        let bare = matching(name, topics, |_, field| field.to_owned());
        let all = if full.is_empty() { bare } else { full };
        own.extend(all.into_iter().map(|(topic, _)| topic));
    }
    own.dedup();
    let field = names[0].rsplit('.').next().unwrap_or_default();
    let example = format!("{}.{field}", own[0]);
    LogKind::SeveralTopics { topics: few(&own), example }
}
