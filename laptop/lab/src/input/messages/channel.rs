//! Reads fields of one topic of a log as samples.

use super::choice::{Choice, Found};
use super::damage;
use super::stamp::{SensorStamp, Time};
use crate::input::clock::prefers_stamps;
use crate::input::names::{few, with_units};
use crate::input::time::{Named, TimeUnit, of_given};
use crate::input::{CHUNK, Chunk, InputOptions, LogKind, Source, near};
use crate::unit::unit_of_name;
use crate::{Error, Place, Result, Spot};
use catalogue::run::Words;
use flight_logs::definition::{Definition, NoNumber, Path};
use flight_logs::{Entry, Fault, Kind, Log, Topic, open};

/// A source of samples from one topic of a log. Each chosen field of the topic is a channel.
pub struct Channel {
    log: Box<dyn Log>,
    file: String,
    topic: String,
    fields: Vec<String>,
    time: Option<String>,
    time_unit: Option<TimeUnit>,
    skip_non_finite: bool,
    /// For each topic of the log, the positions of the chosen fields; `None` if the topic's name is not the chosen one.
    plans: Vec<Option<Plan>>,
    /// Whether samples have the sensor's own stamps; `None` until the first samples show it.
    is_stamped: Option<bool>,
    /// The sensor's own stamps of the chunk's samples, in µs.
    stamps: Vec<i64>,
    samples: u64,
    values: Vec<f64>,
    origin: Vec<(&'static str, String)>,
    /// Note for the user on the times, if these are not those of recording.
    of_times: Option<Words>,
    /// The sensor that was found, if the user named no channel.
    found: Option<Found>,
    notes: Vec<Words>,
}

/// Name by which the user chooses the times at which messages were recorded.
const RECORDED: &str = "recorded";

/// Positions in a message of the chosen fields, and of the field that holds the time.
struct Plan {
    fields: Vec<Path>,
    time: Time,
    /// The sensor's own stamp, if the user chose no time.
    stamp: Option<SensorStamp>,
}

impl Channel {
    /// Opens the chosen fields of a topic of a log.
    ///
    /// # Errors
    /// Returns an error if the log, the topic or a field is missing or cannot be read.
    pub fn open(options: &InputOptions, kind: Kind) -> Result<Self> {
        let file = options.name();
        let Choice { topic, fields, found } = Choice::of(options, kind)?;
        Ok(Self {
            log: open(&options.input, kind, damage(options.accept_cut))?,
            file,
            origin: vec![("topic", topic.clone()), ("field", fields.join(","))],
            topic,
            fields,
            time: options.time.clone(),
            time_unit: options.time_unit,
            skip_non_finite: options.skip_non_finite,
            plans: Vec::new(),
            is_stamped: None,
            stamps: Vec::new(),
            samples: 0,
            values: Vec::new(),
            of_times: None,
            found,
            notes: Vec::new(),
        })
    }

    /// Plans how to read the topics that the log has introduced since the last call. Finds the positions of the chosen
    /// fields in the messages of these topics.
    fn plan(&mut self) -> Result<()> {
        for topic in self.log.topics().iter().skip(self.plans.len()) {
            // ROS accepts a topic's name with and without a leading slash.
            let is_asked = topic.name.trim_start_matches('/') == self.topic.trim_start_matches('/');
            let plan = if is_asked { Some(self.plan_of(topic)?) } else { None };
            self.plans.push(plan);
        }
        Ok(())
    }

    fn plan_of(&self, topic: &Topic) -> Result<Plan> {
        let (file, name) = (&self.file, &topic.name);
        let undefined = |why: &String| {
            let (topic, kind) = (name.clone(), topic.kind.clone());
            LogKind::Undefined { topic, kind, why: why.clone() }.at(file)
        };
        let definition = topic.definition.as_ref().map_err(undefined)?;
        let find = |field: &String| {
            let (topic, own) = (name.clone(), field.clone());
            definition.number(field).map_err(|why| match why {
                NoNumber::Text => LogKind::TextField { topic, field: own }.at(file),
                NoNumber::Several => {
                    let numbers = within(definition, field);
                    LogKind::SeveralNumbers { topic, field: own, numbers }.at(file)
                }
                NoNumber::Missing => {
                    let (numbers, _) = definition.names();
                    let near = near(field, numbers.iter().map(String::as_str));
                    LogKind::NoField { topic, field: own, near }.at(file)
                }
            })
        };
        let fields = self.fields.iter().map(find).collect::<Result<_>>()?;
        let time = match &self.time {
            None => Time::Recorded,
            Some(field) => match definition.stamp(field) {
                Some(stamp) => Time::Stamp(stamp),
                // PX4's field `timestamp` is the time at which a message was recorded.
                None if field == RECORDED
                    || field == "timestamp" && definition.time().is_some() =>
                {
                    Time::Recorded
                }
                None => Time::Number(find(field)?, self.unit(field)),
            },
        };
        let stamp = if self.time.is_none() { SensorStamp::of(definition) } else { None };
        Ok(Plan { fields, time, stamp })
    }

    /// Returns the unit of a field that holds times: the unit that the user chose or, if the user chose none, the unit
    /// that the field's name suggests.
    fn unit(&self, field: &str) -> TimeUnit {
        self.time_unit.unwrap_or_else(|| {
            match of_given(field.rsplit('.').next().unwrap_or(field)) {
                Named::In(unit) | Named::Whole(unit) => unit,
                Named::Dates => TimeUnit::S,
            }
        })
    }

    /// Appends the values and the time of a message, if the message belongs to the chosen topic.
    fn take(&mut self, entry: Entry, chunk: &mut Chunk) -> Result<()> {
        let Some(plan) = self.plans[entry.topic].as_ref() else { return Ok(()) };
        let topic = &self.log.topics()[entry.topic];
        self.values.clear();
        let read = read(topic, plan, self.log.message(), entry.time, &mut self.values);
        let (time, stamp) = match read {
            Ok(Times { time, stamp }) => (time, stamp),
            Err(fault) => {
                let what = format!("topic {}: {fault}", self.topic);
                return Ok(self.log.faults().skip(entry.at, what)?);
            }
        };
        if topic.is_longer(self.log.message()) {
            self.log.faults().long(entry.at);
        }
        let odd = self.values.iter().position(|value| !value.is_finite());
        if let Some(odd) = odd.filter(|_| !self.skip_non_finite) {
            let (topic, field) = (self.topic.clone(), self.fields[odd].clone());
            let (value, sample) = (self.values[odd], self.samples);
            let kind = LogKind::NotFinite { topic, field, value, time, sample };
            return Err(kind.at(Place::spot(&self.file, Spot::Byte(entry.at))));
        }
        for (column, value) in chunk.columns.iter_mut().zip(&self.values) {
            column.push(*value);
        }
        match self.is_stamped {
            Some(true) => chunk.times.push(stamp.unwrap_or(time)),
            Some(false) => chunk.times.push(time),
            None => {
                chunk.times.push(time);
                self.stamps.extend(stamp);
            }
        }
        self.samples += 1;
        Ok(())
    }

    /// Decides by the first chunk if samples have the sensor's own stamps, in the place of the times of arrival.
    fn choose_times(&mut self, chunk: &mut Chunk) {
        if self.is_stamped.is_some() {
            return;
        }
        let stamps = std::mem::take(&mut self.stamps);
        let is_stamped = prefers_stamps(&stamps, &chunk.times);
        self.is_stamped = Some(is_stamped);
        let stamp = self.plans.iter().flatten().find_map(|plan| plan.stamp.as_ref());
        if let Some(SensorStamp { name, .. }) = stamp.filter(|_| is_stamped) {
            let note = format!("times are the sensor's own, `{name}`, and not those of arrival; ");
            let other = format!(" {RECORDED} takes those");
            self.of_times = Some(Words::from(note).setting("time").text(other));
            chunk.times = stamps;
        }
    }

    /// Returns the note that says which channels are read, as the user named none.
    fn note_of(&self, found: &Found) -> Words {
        let units: Vec<Option<String>> = (self.units().into_iter().zip(&self.fields))
            .map(|(unit, field)| {
                let by_name =
                    || unit_of_name(&format!("{}.{field}", self.topic)).map(str::to_owned);
                unit.or_else(by_name)
            })
            .collect();
        let channels = with_units(&self.fields, &units);
        let rate = found.rate.map_or(String::new(), |rate| format!(", {rate:.0} Hz"));
        let others = match &found.others[..] {
            [] => String::new(),
            others => format!("; other sensors: {}", few(others)),
        };
        let note = format!("{}: reads {channels} of {}{rate}{others}; ", self.file, self.topic);
        Words::from(note).setting("columns").text(" chooses others")
    }

    /// Returns the error for a recording without samples: either the log lacks the topic, or the topic has no messages.
    fn nothing(&self) -> Error {
        let topic = self.topic.clone();
        if self.plans.iter().any(Option::is_some) {
            return LogKind::NoMessages { topic }.at(&self.file);
        }
        let names = self.log.topics().iter().map(|topic| topic.name.as_str());
        let near = near(&topic, names);
        LogKind::NoTopic { topic, near }.at(&self.file)
    }
}

/// The times of a message in µs: the one that the user chose or that of recording, and the sensor's own stamp.
struct Times {
    time: i64,
    stamp: Option<i64>,
}

/// Appends the values of a message's fields to `values`, and returns the message's times. If an array in the message is
/// too short to have a chosen element, the element's value is NaN. `recorded` is the time in ns at which the message was
/// recorded.
fn read(
    topic: &Topic,
    plan: &Plan,
    message: &[u8],
    recorded: i64,
    values: &mut Vec<f64>,
) -> Result<Times, Fault> {
    for path in &plan.fields {
        values.push(topic.number(path, message)?.unwrap_or(f64::NAN));
    }
    let time = plan.time.read(topic, message, recorded)?;
    let stamp = match &plan.stamp {
        Some(stamp) => Some(stamp.time.read(topic, message, recorded)?),
        None => None,
    };
    Ok(Times { time, stamp })
}

/// Lists the names of the numbers that a field contains, separated by commas.
fn within(definition: &Definition, field: &str) -> String {
    let (numbers, _) = definition.names();
    let own: Vec<&str> =
        numbers.iter().map(String::as_str).filter(|name| name.starts_with(field)).collect();
    own.join(", ")
}

impl Source for Channel {
    fn next(&mut self, chunk: &mut Chunk) -> Result<()> {
        chunk.clear(self.fields.len());
        while chunk.len() < CHUNK {
            let Some(entry) = self.log.next()? else { break };
            self.plan()?;
            self.take(entry, chunk)?;
        }
        if self.samples == 0 {
            return Err(self.nothing());
        }
        self.choose_times(chunk);
        self.notes = self.log.faults().notes().into_iter().map(Words::from).collect();
        self.notes.extend(self.of_times.clone());
        if let Some(found) = &self.found {
            self.notes.insert(0, self.note_of(found));
        }
        Ok(())
    }

    fn names(&self) -> Vec<&str> {
        self.fields.iter().map(String::as_str).collect()
    }

    fn units(&self) -> Vec<Option<String>> {
        let topic = self.plans.iter().position(Option::is_some);
        let unit = |field: &String| topic.and_then(|topic| self.log.unit(topic, field));
        self.fields.iter().map(unit).collect()
    }

    fn origin(&self) -> &[(&'static str, String)] {
        &self.origin
    }

    fn notes(&self) -> &[Words] {
        &self.notes
    }
}
