//! The nodes on DDS.

use crate::arguments::Arguments;
use crate::bank::{Bank, Unbank};
use crate::clock::Clock;
use crate::codec::Request;
use crate::counters::Counters;
use crate::decoding::Decoding;
use crate::encoding::{Coded, Encoding};
use crate::failures;
use crate::message::Fields;
use crate::settings::{Parameters, Settings};
use crate::wire::{
    DiagnosticArray, DiagnosticStatus, FlightSpikes, FlightValues, Header, Said, Spikes, Spyke,
    SpykeValue,
};
use anyhow::{Context as _, Result, anyhow, bail};
use ros2_client::builtin_interfaces::Time;
use ros2_client::dds::rustdds::discovery::DiscoveredWriterData;
use ros2_client::dds::rustdds::{DomainParticipantBuilder, QosPolicies, mio1, policy};
use ros2_client::qos::{Durability, History, Reliability, WhenFull};
use ros2_client::ros2::LogLevel;
use ros2_client::{
    Context, Gid, MessageInfo, MessageTypeName, Name, Node, NodeName, NodeOptions, ParameterValue,
    Publisher, QosProfile, ReadError, RosoutRaw, Subscription,
};
use serde::de::{DeserializeOwned, DeserializeSeed, Deserializer};
use serde::{Deserialize, Serialize};
use spikewire_flight::Flight;
use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::fs;
use std::marker::PhantomData;
use std::net::Ipv4Addr;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use yaml_rust2::Yaml;

/// Which node to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers of a topic to spikes.
    Encode,
    /// Spikes to values.
    Decode,
    /// All channels of a `flight.toml` to spikes.
    Flight,
}

/// As for wrong options.
const FAILURE: u8 = 2;
/// How often it looks for publishers, for an end, and for what is to be told.
const LOOK: Duration = Duration::from_millis(50);
const DIAGNOSE: Duration = Duration::from_secs(1);
/// How long what is left may take to its subscribers when a node ends.
const TO_SEND: Duration = Duration::from_millis(500);
/// How many messages may wait for the node: 4 s at 1 kHz.
const WAITING: usize = 4096;

/// Sends and receives all, and waits at most this long for room while a subscriber is slow.
const ALL: QosProfile = QosProfile::publisher_default()
    .reliability_reliable(WhenFull::Wait(Duration::from_secs(1)))
    .history(History::KeepAll);
/// For those who come later, too.
const LATCHED: QosProfile = QosProfile::publisher_default().durability(Durability::TransientLocal);

/// Runs a node with the program's arguments until it is interrupted.
///
/// Exit status 2: an argument, a parameter or a message is not good.
pub fn run(kind: Kind) -> ExitCode {
    let name = match kind {
        Kind::Encode => "encode",
        Kind::Decode => "decode",
        Kind::Flight => "flight",
    };
    let ran = Arguments::read(name, env::args().skip(1)).and_then(|own| match kind {
        Kind::Encode => encode(&own),
        Kind::Decode => decode(&own),
        Kind::Flight => fly(&own),
    });
    if let Err(error) = ran {
        eprintln!("[FATAL] [{name}]: {error:#}");
        return ExitCode::from(FAILURE);
    }
    ExitCode::SUCCESS
}

fn encode(arguments: &Arguments) -> Result<()> {
    let settings = Settings::read(&arguments.parameters)?;
    let (scheme, topic) = settings.to_encode()?;
    let mut encoding = Encoding::new(Request::new(scheme, &settings)?)?;
    let mut clock = Clock::new(settings.gap);
    let kind = if encoding.is_array { "SpykeArray" } else { "Spyke" };

    let mut ros = Ros::new(arguments)?;
    let mut sender = Sender {
        event: ros.publisher("event", "spyke_msgs", kind, ALL)?,
        header: Some(ros.publisher("event_header", "std_msgs", "String", LATCHED)?),
        decoded: ros.publisher("~/decoded", "spyke_msgs", "SpykeValue", ALL)?,
    };
    let topic = arguments.topic(topic);
    ros.listen(
        &topic,
        |kind| Fields::find(&[&settings.field], kind),
        |ros, taken| {
            let value = taken.all(&[&settings.field])?[0];
            let stamp = ros.stamp(taken.stamp);
            clock.observe(stamp, &mut ros.counters);
            let coded = encoding.take(value, stamp, &mut ros.counters)?;
            sender.send(ros, coded, &encoding);
            Ok(())
        },
    )?;
    let left = encoding.end(&mut ros.counters)?;
    sender.send(&mut ros, left, &encoding);
    ros.end();
    Ok(())
}

/// What an encoding node publishes.
struct Sender {
    event: Publisher<Spyke<Spikes>>,
    /// Until it is sent; the publisher stays for those who come later.
    header: Option<Publisher<String>>,
    decoded: Publisher<SpykeValue>,
}

impl Sender {
    fn send(&mut self, ros: &mut Ros, coded: Vec<Coded>, encoding: &Encoding) {
        for Coded { spikes, said, decoded } in coded {
            if let (Some(publisher), Some(header)) = (self.header.take(), encoding.header()) {
                ros.sent(publisher.publish(header).is_ok());
                ros.latched = Some(publisher);
            }
            let timestamp = said.timestamp;
            let is_sent = self.event.publish(Spyke { spike: spikes.into(), said }).is_ok();
            ros.sent(is_sent);
            ros.sent(self.decoded.publish(SpykeValue { value: decoded, timestamp }).is_ok());
            ros.given += 1;
        }
    }
}

fn fly(arguments: &Arguments) -> Result<()> {
    let settings = Settings::read(&arguments.parameters)?;
    let (path, topic) = settings.to_fly()?;
    let text = fs::read_to_string(path).with_context(|| path.to_owned())?;
    let mut bank = Bank::new(Flight::read(path)?, settings.gap)?;

    let mut ros = Ros::new(arguments)?;
    let spikes = ros.publisher("spikes", "spikewire_msgs", "Spikes", ALL)?;
    let decoded = ros.publisher("~/decoded", "spikewire_msgs", "Values", ALL)?;
    let file = ros.publisher("flight", "std_msgs", "String", LATCHED)?;
    ros.sent(file.publish(text).is_ok());
    ros.latched = Some(file);
    let send = |ros: &mut Ros, coded: Vec<(FlightSpikes, FlightValues)>| {
        for (own, values) in coded {
            ros.sent(spikes.publish(own).is_ok());
            ros.sent(decoded.publish(values).is_ok());
            ros.given += 1;
        }
    };
    let sources = bank.sources();
    let sources: Vec<&str> = sources.iter().map(String::as_str).collect();
    ros.listen(
        &arguments.topic(topic),
        |kind| Fields::find(&sources, kind),
        |ros, taken| {
            let values = taken.all(&sources)?;
            let stamp = Time::from_nanos(ros.stamp(taken.stamp));
            let header = Header { stamp, frame_id: taken.frame };
            let coded = bank.take(&values, header, &mut ros.counters)?;
            send(ros, coded);
            Ok(())
        },
    )?;
    let left = bank.end(&mut ros.counters)?;
    send(&mut ros, left);
    ros.end();
    Ok(())
}

fn decode(arguments: &Arguments) -> Result<()> {
    let settings = Settings::read(&arguments.parameters)?;
    if let Some(path) = settings.flight()? {
        return decode_flight(arguments, Unbank::new(Flight::read(path)?, settings.gap));
    }
    let mut decoding = Decoding::new(settings)?;
    let mut ros = Ros::new(arguments)?;
    let decoded = ros.publisher("~/decoded", "spyke_msgs", "SpykeValue", ALL)?;
    let kind = |kind: &str| match kind {
        "spyke_msgs/Spyke" => Ok(Heard { is_array: false }),
        "spyke_msgs/SpykeArray" => Ok(Heard { is_array: true }),
        _ => bail!("the topic is of {kind}; spikes are spyke_msgs/Spyke or spyke_msgs/SpykeArray"),
    };
    ros.listen(&arguments.topic("event"), kind, |ros, (spikes, said): (Vec<i8>, Said)| {
        if let Some(value) = decoding.take(&spikes, &said, &mut ros.counters)? {
            let timestamp = said.timestamp;
            ros.sent(decoded.publish(SpykeValue { value, timestamp }).is_ok());
            ros.given += 1;
        }
        Ok(())
    })?;
    ros.end();
    Ok(())
}

fn decode_flight(arguments: &Arguments, mut decoding: Unbank) -> Result<()> {
    let mut ros = Ros::new(arguments)?;
    let decoded = ros.publisher("~/decoded", "spikewire_msgs", "Values", ALL)?;
    let kind = |kind: &str| match kind {
        "spikewire_msgs/Spikes" => Ok(PhantomData),
        _ => bail!("the topic is of {kind}; spikes of a flight are spikewire_msgs/Spikes"),
    };
    ros.listen(&arguments.topic("spikes"), kind, |ros, message: FlightSpikes| {
        if let Some(values) = decoding.take(&message, &mut ros.counters)? {
            let header = message.header;
            ros.sent(decoded.publish(FlightValues { header, values }).is_ok());
            ros.given += 1;
        }
        Ok(())
    })?;
    ros.end();
    Ok(())
}

/// Reads either of the messages of spikes.
#[derive(Clone, Copy)]
struct Heard {
    is_array: bool,
}

impl<'de> DeserializeSeed<'de> for Heard {
    type Value = (Vec<i8>, Said);

    fn deserialize<D: Deserializer<'de>>(self, input: D) -> Result<(Vec<i8>, Said), D::Error> {
        Ok(if self.is_array {
            let Spyke { spike, said } = Spyke::<Vec<i8>>::deserialize(input)?;
            (spike, said)
        } else {
            let Spyke { spike, said } = Spyke::<i8>::deserialize(input)?;
            (vec![spike], said)
        })
    }
}

/// A node on DDS with what both kinds share: counters that are told, and an end.
struct Ros<'a> {
    arguments: &'a Arguments,
    node: Node,
    /// Serves parameters and the graph.
    spinner: Option<JoinHandle<()>>,
    context: Context,
    diagnostics: Option<Publisher<DiagnosticArray>>,
    /// What the node publishes: topics, types and qualities of service.
    offers: Vec<Offer>,
    /// Subscribers that cannot hear an offer, as they ask for more.
    refused: BTreeSet<Gid>,
    latched: Option<Publisher<String>>,
    is_stopped: Arc<AtomicBool>,
    next: Instant,
    counters: Counters,
    /// How many messages came and how many went.
    taken: u64,
    given: u64,
}

/// A topic that the node publishes, as DDS has it.
struct Offer {
    topic: String,
    kind: String,
    qos: QosPolicies,
}

/// A publisher of the topic that the node listens to.
struct Remote {
    /// Why its messages are refused.
    refused: Option<String>,
    /// The number of its last message.
    last: Option<i64>,
}

impl<'a> Ros<'a> {
    fn new(arguments: &'a Arguments) -> Result<Self> {
        failures::collect();
        let is_stopped = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&is_stopped);
        ctrlc::set_handler(move || stop.store(true, Ordering::Relaxed))?;
        let context = Context::from_domain_participant(
            participant()?.build().map_err(|error| anyhow!("{error}"))?,
        )?;
        let name = NodeName::new(&arguments.namespace, &arguments.name)?;
        let mut node = context.new_node(name, options(&arguments.parameters))?;
        let spinner = node.spinner()?;
        let spinner = thread::spawn(move || drop(futures::executor::block_on(spinner.spin())));
        let mut ros = Self {
            arguments,
            node,
            spinner: Some(spinner),
            context,
            diagnostics: None,
            offers: Vec::new(),
            refused: BTreeSet::new(),
            latched: None,
            is_stopped,
            next: Instant::now(),
            counters: Counters::default(),
            taken: 0,
            given: 0,
        };
        ros.diagnostics =
            Some(ros.publisher("/diagnostics", "diagnostic_msgs", "DiagnosticArray", ALL)?);
        Ok(ros)
    }

    fn publisher<M: Serialize>(
        &mut self,
        topic: &str,
        package: &str,
        kind: &str,
        qos: QosProfile,
    ) -> Result<Publisher<M>> {
        let topic = self.arguments.topic(topic);
        let name = name_of(&topic)?;
        self.offers.push(Offer {
            topic: format!("rt{topic}"),
            kind: format!("{package}::msg::dds_::{kind}_"),
            qos: (&qos).into(),
        });
        let topic = self.node.create_topic(&name, MessageTypeName::new(package, kind), &qos)?;
        Ok(self.node.create_publisher(&topic, Some(qos))?)
    }

    /// Waits for a publisher of the topic, whose type says how to read messages, and takes them until the end.
    fn listen<S, M>(
        &mut self,
        topic: &str,
        seed: impl Fn(&str) -> Result<S>,
        mut take: impl FnMut(&mut Self, M) -> Result<()>,
    ) -> Result<()>
    where
        S: for<'de> DeserializeSeed<'de, Value = M> + Clone,
        M: DeserializeOwned + 'static,
    {
        let first = loop {
            match self.writers(topic).into_iter().next() {
                _ if self.is_stopped() => return Ok(()),
                Some(writer) => break writer,
                None => thread::sleep(LOOK),
            }
            self.tell()?;
        };
        let kind = first.publication_topic_data.type_name.clone();
        let (package, own) =
            ros_type(&kind).with_context(|| format!("{topic}: {kind} is no type of ROS 2"))?;
        let seed = seed(&format!("{package}/{own}"))?;
        let is_reliable = self.writers(topic).iter().all(is_reliable);
        let mut qos = ALL.history(History::KeepLast { depth: WAITING });
        if !is_reliable {
            qos = qos.reliability(Reliability::BestEffort);
        }
        let dds =
            self.node.create_topic(&name_of(topic)?, MessageTypeName::new(package, own), &qos)?;
        let requested = QosPolicies::from(&qos);
        let mut subscription: Subscription<M> = self.node.create_subscription(&dds, Some(qos))?;

        let mut poll = mio1::Poll::new()?;
        poll.registry().register(&mut subscription, mio1::Token(0), mio1::Interest::READABLE)?;
        let mut events = mio1::Events::with_capacity(1);
        let mut remotes = BTreeMap::new();
        let expected = Expected { topic, kind: &kind, requested };
        while !self.is_stopped() {
            if self.tell()? {
                self.watch(&expected, &mut remotes);
            }
            // Events tell only of what is new, so all that is there is taken.
            loop {
                match subscription.take_seed(seed.clone()) {
                    Ok(None) => break,
                    Ok(Some((message, info))) => {
                        if self.is_accepted(&expected, &mut remotes, &info) {
                            self.taken += 1;
                            take(self, message)?;
                        }
                    }
                    Err(ReadError::Deserialization { reason }) => {
                        self.counters.add("messages refused", 1, &reason);
                    }
                    Err(error) => return Err(error.into()),
                }
            }
            if let Err(error) = poll.poll(&mut events, Some(LOOK))
                && error.kind() != std::io::ErrorKind::Interrupted
            {
                return Err(error.into());
            }
        }
        Ok(())
    }

    /// Returns whether the message is from a publisher of our type, and counts what was lost before it.
    fn is_accepted(
        &mut self,
        expected: &Expected,
        remotes: &mut BTreeMap<Gid, Remote>,
        info: &MessageInfo,
    ) -> bool {
        let publisher = info.publisher_gid();
        if !remotes.contains_key(&publisher) {
            self.watch(expected, remotes);
        }
        let number = info.sequence_number();
        match remotes.get_mut(&publisher) {
            Some(Remote { refused: None, last }) => {
                let last = last.replace(number).unwrap_or(number - 1);
                if number > last + 1 {
                    let detail = format!("between {last} and {number}");
                    self.counters.add("messages lost", number.abs_diff(last + 1), &detail);
                }
                true
            }
            Some(Remote { refused: Some(why), .. }) => {
                self.counters.add("messages refused", 1, why);
                false
            }
            None => {
                self.counters.add("messages refused", 1, "of a publisher that is not known");
                false
            }
        }
    }

    /// Looks for publishers that came or went.
    fn watch(&mut self, expected: &Expected, remotes: &mut BTreeMap<Gid, Remote>) {
        let writers = self.writers(expected.topic);
        let before = remotes.len();
        remotes.retain(|gid, _| writers.iter().any(|writer| gid_of(writer) == *gid));
        if remotes.len() < before {
            self.counters.add("publishers lost", (before - remotes.len()) as u64, expected.topic);
        }
        for writer in &writers {
            remotes.entry(gid_of(writer)).or_insert_with(|| {
                let offered = &writer.publication_topic_data;
                let refused = mismatch(
                    (&offered.type_name, &offered.qos()),
                    (expected.kind, &expected.requested),
                );
                if let Some(why) = &refused {
                    self.counters.add_rare("publishers refused", why);
                }
                Remote { refused, last: None }
            });
        }
    }

    /// Returns the publishers of a topic.
    fn writers(&self, topic: &str) -> Vec<DiscoveredWriterData> {
        let topic = format!("rt{topic}");
        let mut writers = self.context.domain_participant().discovered_writers();
        writers.retain(|writer| writer.publication_topic_data.topic_name == topic);
        writers
    }

    fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Returns a message's stamp, or the time if it has none.
    fn stamp(&self, stamp: Option<i64>) -> i64 {
        stamp.filter(|stamp| *stamp != 0).unwrap_or_else(|| self.now().to_nanos())
    }

    fn now(&self) -> Time {
        self.node.time_now().into()
    }

    fn sent(&mut self, is_sent: bool) {
        if !is_sent {
            self.counters.add("messages not sent", 1, "a subscriber is too slow");
        }
    }

    /// Tells warnings, and once a second the counts, where monitors look for them; returns whether it told these.
    ///
    /// # Errors
    /// DDS has stopped.
    fn tell(&mut self) -> Result<bool> {
        for failure in failures::take() {
            if failures::is_end(&failure) {
                bail!("DDS has stopped: {failure}");
            }
            self.counters.add("failures of DDS", 1, &failure);
        }
        for warning in self.counters.warnings() {
            self.log(LogLevel::Warn, &warning);
        }
        let is_due = self.next <= Instant::now();
        if is_due {
            self.next = Instant::now() + DIAGNOSE;
            self.look_at_subscribers();
            self.diagnose();
        }
        Ok(is_due)
    }

    /// Counts new subscribers that hear nothing of what the node publishes.
    fn look_at_subscribers(&mut self) {
        for reader in self.context.domain_participant().discovered_readers() {
            let wanted = &reader.subscription_topic_data;
            let topic = wanted.topic_name();
            let offer = self.offers.iter().find(|offer| offer.topic == *topic);
            let why = offer.and_then(|Offer { kind, qos, .. }| {
                mismatch((kind, qos), (wanted.type_name(), &wanted.qos()))
            });
            if let Some(why) = why
                && self.refused.insert(wanted.key().into())
            {
                let topic = topic.strip_prefix("rt").unwrap_or(topic);
                self.counters.add_rare("subscribers refused", &format!("{topic}: {why}"));
            }
        }
    }

    fn diagnose(&mut self) {
        let counts = self.counters.counts();
        let all = [("messages in", self.taken), ("messages out", self.given)];
        let all = all.into_iter().chain(counts.iter().map(|(name, count)| (*name, *count)));
        let status = DiagnosticStatus {
            level: u8::from(!counts.is_empty()),
            name: self.node.fully_qualified_name(),
            message: self.counters.to_string(),
            hardware_id: String::new(),
            values: all.map(|(name, count)| (name.to_owned(), count.to_string())).collect(),
        };
        let message = DiagnosticArray {
            header: Header { stamp: self.now(), frame_id: String::new() },
            status: vec![status],
        };
        let is_sent =
            self.diagnostics.as_ref().is_none_or(|publisher| publisher.publish(message).is_ok());
        self.sent(is_sent);
    }

    fn log(&self, level: LogLevel, text: &str) {
        let (now, name) = (self.now(), self.node.fully_qualified_name());
        let seconds = now.to_nanos() as f64 / 1e9;
        eprintln!("[{}] [{seconds:.9}] [{name}]: {text}", format!("{level:?}").to_uppercase());
        self.node.rosout_raw(now, level, name.trim_start_matches('/'), text, file!(), "", line!());
    }

    /// Tells the counts, and gives what is left time to arrive.
    fn end(mut self) {
        // What is told here of DDS has no consequence any more.
        let _ = self.tell();
        self.diagnose();
        self.log(LogLevel::Info, &self.counters.to_string());
        thread::sleep(TO_SEND);
        let spinner = self.spinner.take();
        drop(self);
        if let Some(spinner) = spinner {
            // Its thread has nothing that can be lost.
            let _ = spinner.join();
        }
    }
}

/// What publishers of the topic must be.
struct Expected<'a> {
    topic: &'a str,
    /// The type as DDS has it.
    kind: &'a str,
    requested: QosPolicies,
}

/// Returns why a subscriber hears nothing of a publisher: another type, or a quality of service that is not offered.
fn mismatch(offered: (&str, &QosPolicies), requested: (&str, &QosPolicies)) -> Option<String> {
    if offered.0 != requested.0 {
        return Some(format!("{} is offered, {} wanted", offered.0, requested.0));
    }
    let policy = offered.1.compliance_failure_wrt(requested.1)?;
    Some(format!("the {policy:?} that is wanted is not offered").to_lowercase())
}

/// Returns how to take part: in the domain and the range that ROS's environment names.
fn participant() -> Result<DomainParticipantBuilder> {
    let domain = env::var("ROS_DOMAIN_ID").unwrap_or_default();
    let domain = if domain.is_empty() { 0 } else { domain.parse().context("ROS_DOMAIN_ID")? };
    let is = |name: &str, value: &str| env::var(name).is_ok_and(|own| own == value);
    let is_local =
        is("ROS_LOCALHOST_ONLY", "1") || is("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
    let participant = DomainParticipantBuilder::new(domain);
    Ok(if is_local { participant.with_only_networks([Ipv4Addr::LOCALHOST]) } else { participant })
}

/// Returns options that show the parameters and refuse to change them: they are read at the start.
fn options(parameters: &Parameters) -> NodeOptions {
    let values: BTreeMap<String, ParameterValue> =
        parameters.iter().map(|(name, value)| (name.clone(), shown(value))).collect();
    let options = values.iter().fold(NodeOptions::new(), |options, (name, value)| {
        options.declare_parameter(name, value.clone())
    });
    options.parameter_validator(Box::new(move |name, value| {
        let is_same = name == "use_sim_time" || values.get(name) == Some(value);
        if is_same { Ok(()) } else { Err(format!("{name} is read when the node starts")) }
    }))
}

fn shown(value: &Yaml) -> ParameterValue {
    let number = |item: &Yaml| item.as_f64().or(item.as_i64().map(|number| number as f64));
    match value {
        Yaml::Boolean(is) => ParameterValue::Boolean(*is),
        Yaml::Integer(number) => ParameterValue::Integer(*number),
        Yaml::Real(text) => text.parse().map_or(ParameterValue::NotSet, ParameterValue::Double),
        Yaml::String(text) => ParameterValue::String(text.clone()),
        Yaml::Array(items) => {
            let numbers = items.iter().map(number).collect::<Option<_>>();
            numbers.map_or(ParameterValue::NotSet, ParameterValue::DoubleArray)
        }
        _ => ParameterValue::NotSet,
    }
}

fn name_of(topic: &str) -> Result<Name> {
    Name::parse(topic).with_context(|| format!("topic {topic}"))
}

/// `sensor_msgs::msg::dds_::Imu_` is `sensor_msgs` and `Imu`.
fn ros_type(dds: &str) -> Option<(&str, &str)> {
    let (package, own) = dds.split_once("::msg::dds_::")?;
    Some((package, own.strip_suffix('_')?))
}

fn gid_of(writer: &DiscoveredWriterData) -> Gid {
    writer.publication_topic_data.key.into()
}

fn is_reliable(writer: &DiscoveredWriterData) -> bool {
    writer.publication_topic_data.reliability != Some(policy::Reliability::BestEffort)
}
