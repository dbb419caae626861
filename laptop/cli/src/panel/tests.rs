//! Tests of the panel, which draws a recorded flight while its frames arrive over a link.

use super::Panel;
use lab::events::{LinkReader, Stream, values_writer};
use lab::flight::{Flight, with_receiver};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use spikewire::link::{MAX_FRAME, Session, Transmitter};
use spikewire::temporal::SendOnDelta;
use spikewire::{Bank, FromItems, Item, Put, Tick};
use std::cell::RefCell;
use std::fmt::Write;
use std::rc::Rc;

const THRESHOLDS: [f32; 6] = [0.25, 0.2, 0.2, 2.0, 2.0, 2.0];
const NAMES: [&str; 6] = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"];
const PERIOD: usize = 5000;

struct Items(Vec<Item>);

impl Put for &mut Items {
    fn put(&mut self, item: Item) {
        self.0.push(item);
    }
}

fn flight(first: f32) -> Flight {
    let mut text = format!(
        "version = 1\nscheme = \"sod\"\nsample = \"f32\"\nperiod = {PERIOD}\nkeyframe_every = 40\nparameters = {{ spikes = 8 }}\n"
    );
    for (place, (name, threshold)) in NAMES.iter().zip(THRESHOLDS).enumerate() {
        let unit = if place < 3 { "rad/s" } else { "m/s²" };
        let threshold = if place == 0 { first } else { threshold };
        let channel =
            format!("name = \"{name}\"\nunit = \"{unit}\"\nparameters.threshold = {threshold:?}");
        writeln!(text, "[[channel]]\n{channel}").unwrap();
    }
    Flight::parse(&text).unwrap()
}

/// Encodes the first `samples` samples of the recorded flight; returns the bytes that the link sends for each sample.
fn frames(samples: usize) -> Vec<Vec<u8>> {
    let schemes = THRESHOLDS.map(SendOnDelta::<f32, 8>::new);
    let mut bank = Bank::<_, 6>::per_channel(schemes.each_ref());
    let flight = flight(THRESHOLDS[0]);
    let link = Transmitter::new(flight.coding(), Session::counted(1));
    let mut link = link.with_fingerprint(flight.fingerprint());
    let recorded = include_str!("../../../../data/hexarotor.csv");
    let rows = recorded.lines().skip(1).take(samples).enumerate();
    let sent = rows.map(|(place, row)| {
        let mut row = row.split(',').skip(1).map(|own| own.parse().unwrap());
        let sample = std::array::from_fn(|_| row.next().unwrap());
        let (tick, mut items) = (Tick::from_micros((place * PERIOD) as u64), Items(Vec::new()));
        bank.encode_into(tick, sample, &mut items);
        if place % 40 == 0 {
            bank.keyframe_into(tick, &mut items);
        }
        let (mut items, mut buffer) = (FromItems(items.0.into_iter()), [0; MAX_FRAME]);
        let mut bytes = Vec::new();
        while let Some(frame) = link.next_frame(&mut items, &mut buffer).unwrap() {
            bytes.extend_from_slice(frame);
        }
        bytes
    });
    sent.collect()
}

/// Returns the lines of the panel after `samples` samples of the recorded flight. `is_lost` decides for each sample
/// whether the link loses its frame.
fn picture(flight: &Flight, samples: usize, is_lost: impl Fn(usize) -> bool) -> Vec<String> {
    let panel = Rc::new(RefCell::new(Panel::of_flight(flight)));
    let mut drawn = Vec::new();
    with_receiver(flight, |values| {
        let reader = Box::new(LinkReader::new(Some(Panel::noting(&panel, values))));
        let mut stream = Stream::new(reader, values_writer(flight.sample), false);
        for (place, bytes) in frames(samples).iter().enumerate() {
            if !is_lost(place) {
                stream.push(bytes, None, &mut std::io::sink())?;
            }
        }
        let mut terminal = Terminal::new(TestBackend::new(80, 10)).unwrap();
        let tally = stream.tally().link.unwrap();
        terminal.draw(|frame| panel.borrow().draw(frame, &tally)).unwrap();
        let cells: Vec<_> = terminal
            .backend()
            .buffer()
            .content()
            .iter()
            .map(ratatui::buffer::Cell::symbol)
            .collect();
        drawn = cells.chunks(80).map(|line| line.concat().trim_end().to_owned()).collect();
        Ok(())
    })
    .unwrap();
    drawn
}

#[test]
fn the_recorded_flight_is_drawn() {
    let drawn = picture(&flight(THRESHOLDS[0]), 1700, |_| false);
    assert_eq!(
        drawn,
        include_str!("flight.txt").lines().collect::<Vec<_>>(),
        "{}",
        drawn.join("\n")
    );
}

#[test]
fn what_was_lost_is_held_until_a_keyframe() {
    let flight = flight(THRESHOLDS[0]);
    // Keyframes come with samples 2400 and 2440.
    let is_lost = |place: usize| (2405..2420).contains(&place);
    let marks = |samples: usize, mark: &str| {
        let drawn = picture(&flight, samples, is_lost);
        let count = drawn.iter().filter(|line| line.contains(mark)).count();
        (count, drawn.join(" "))
    };
    let (held, drawn) = marks(2439, " held ");
    assert!(
        held == 6 && drawn.contains(": no keyframe since the start or the last loss"),
        "{drawn}"
    );
    assert!(drawn.contains(" lost in 1 gaps"), "{drawn}");
    let (exact, drawn) = marks(2441, " exact ");
    assert_eq!(exact, 6, "{drawn}");
}

#[test]
fn another_flight_is_never_exact() {
    let drawn = picture(&flight(0.26), 2500, |_| false).join("\n");
    assert!(!drawn.contains(" exact ") && drawn.contains(": the sender's schemes have"), "{drawn}");
}
