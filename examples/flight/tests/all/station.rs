//! A sensor by its registers, through everything that happens to one.

use flight::{Channels, Counts, Fault, News, Registers, Sample, Station, Why};
use spikewire::{Bank, EventQueue, Item, Overflow, Source, temporal::SendOnDelta};
use std::{cell::Cell, future::pending, rc::Rc};

const PERIOD: u32 = 5_000;
const COUNTS: Counts = Counts::of_ranges(2000.0, 16.0);
static CODE: SendOnDelta<f32, 8> = SendOnDelta::new(0.05);
const CHANNELS: Channels<2> =
    Channels::new(COUNTS, ["accel_z", "gyro_x"], [[0.0, 1.0], [1.0, 0.0]], [1.0, 1.0]);

/// What has befallen the sensor.
#[derive(Clone, Copy, PartialEq)]
enum Fate {
    Well,
    Missing,
    Another,
    Forgets,
    Frozen,
    Hangs,
}

struct Fake {
    fate: Rc<Cell<Fate>>,
    samples: i16,
}

impl Fake {
    fn identify(&self) -> Result<(), Fault> {
        match self.fate.get() {
            Fate::Missing => Err(Fault::Identity(0xFF)),
            Fate::Another => Err(Fault::Identity(0x68)),
            _ => Ok(()),
        }
    }
}

impl Registers for Fake {
    const COUNTS: Counts = COUNTS;
    const RESET_US: u32 = 2_000;
    const SETTLE_US: u32 = 50_000;

    async fn reset(&mut self) -> Result<(), Fault> {
        Ok(())
    }

    async fn configure(&mut self) -> Result<(), Fault> {
        self.identify()
    }

    async fn check(&mut self) -> Result<(), Fault> {
        let fault = Fault::Register { address: 0x4F, wrote: 6, read: 0 };
        if self.fate.get() == Fate::Forgets { Err(fault) } else { Ok(()) }
    }

    async fn read(&mut self) -> Result<Sample, Fault> {
        if self.fate.get() == Fate::Hangs {
            pending::<()>().await;
        }
        self.identify()?;
        if self.fate.get() != Fate::Frozen {
            self.samples += 1;
        }
        Ok([self.samples % 7, 0, 0, 0, 0, 2048 + self.samples % 5])
    }
}

type Flown = Station<Fake, [&'static SendOnDelta<f32, 8>; 2], 2>;

fn station(fate: &Rc<Cell<Fate>>) -> Flown {
    let sensor = Fake { fate: fate.clone(), samples: 0 };
    Station::new(sensor, CHANNELS, Bank::per_channel([&CODE, &CODE]), PERIOD, 40)
}

/// What was new in so many periods, without the seconds, and what went into the queue.
fn fly(station: &mut Flown, periods: u32) -> (Vec<News>, Vec<Item>) {
    let queue = EventQueue::<1024>::new(Overflow::DropOldest);
    let mut items = queue.consumer().unwrap();
    let news = (0..periods).filter_map(|_| station.tick_blocking(&queue));
    let news = news.filter(|news| *news != News::Second).collect();
    (news, std::iter::from_fn(|| Some(items.take()?.item)).collect())
}

fn breaks(items: &[Item]) -> usize {
    items.iter().filter(|item| matches!(item, Item::Break(_))).count()
}

fn values(items: &[Item]) -> usize {
    items.iter().filter(|item| !matches!(item, Item::Break(_))).count()
}

#[test]
fn a_start_waits_by_periods_and_comes_before_the_first_value() {
    let mut station = station(&Rc::new(Cell::new(Fate::Well)));
    // Reset, 2 ms in one period; settings, 50 ms in ten; the look back.
    let (news, items) = fly(&mut station, 14);
    assert_eq!((news, items.len()), (vec![News::Started], 0));
    let (news, items) = fly(&mut station, 1);
    assert_eq!((news.len(), station.counters().samples), (0, 1));
    let first = items.first().unwrap();
    assert!(matches!(first, Item::Keyframe(one) if one.tick.micros() == 15 * 5_000), "{first:?}");
}

#[test]
fn a_sensor_that_does_not_start_has_no_value_and_is_tried_again() {
    for (fate, fault) in [
        (Fate::Missing, Fault::Identity(0xFF)),
        (Fate::Another, Fault::Identity(0x68)),
        (Fate::Forgets, Fault::Register { address: 0x4F, wrote: 6, read: 0 }),
    ] {
        let own = Rc::new(Cell::new(fate));
        let mut station = station(&own);
        let (news, items) = fly(&mut station, 200);
        assert!(news.len() >= 5 && news.iter().all(|one| *one == News::Fault(fault)), "{news:?}");
        assert_eq!((breaks(&items), values(&items)), (news.len(), 0));
        own.set(Fate::Well);
        let (news, items) = fly(&mut station, 50);
        assert_eq!(news, [News::Started]);
        assert!(values(&items) > 0);
    }
}

#[test]
fn a_sensor_that_dies_has_no_value_until_it_is_back() {
    for (fate, first, why) in [
        (Fate::Missing, Some(Fault::Identity(0xFF)), Why::Failing),
        (Fate::Another, Some(Fault::Identity(0x68)), Why::Failing),
        (Fate::Frozen, None, Why::Stuck),
    ] {
        let own = Rc::new(Cell::new(Fate::Well));
        let mut station = station(&own);
        fly(&mut station, 100);
        own.set(fate);
        let (news, items) = fly(&mut station, 22);
        let expected: Vec<_> =
            first.map(News::Fault).into_iter().chain([News::Dead(why)]).collect();
        assert_eq!(news[..expected.len()], expected);
        assert_eq!(breaks(&items), 1);
        assert_eq!(station.counters().deaths, 1);
        own.set(Fate::Well);
        let (news, items) = fly(&mut station, 60);
        assert_eq!(news.last(), Some(&News::Started));
        assert!(values(&items) > 0 && station.counters().starts == 2);
    }
}

#[test]
fn a_bus_that_waits_where_it_must_not_is_a_fault_and_the_clock_goes_on() {
    let own = Rc::new(Cell::new(Fate::Well));
    let mut station = station(&own);
    fly(&mut station, 20);
    own.set(Fate::Hangs);
    assert_eq!(fly(&mut station, 1).0, [News::Fault(Fault::Late)]);
    assert_eq!(station.now().micros(), 21 * 5_000);
}

#[test]
fn a_second_of_the_flight_is_news() {
    let mut station = station(&Rc::new(Cell::new(Fate::Well)));
    let queue = EventQueue::<1024>::new(Overflow::DropOldest);
    let seconds = (0..1_000).filter(|_| station.tick_blocking(&queue) == Some(News::Second));
    assert_eq!(seconds.count(), 5);
}

#[test]
fn channels_are_found_by_name_and_come_in_the_files_unit() {
    const DEGREE: f64 = core::f64::consts::PI / 180.0;
    const G: f64 = 9.806_65;
    const COUNT: Sample = [16_384, -8_192, 1, 2_048, -4_096, 1];
    const SI: Channels<6> = Channels::new(
        COUNTS,
        [
            "gyro_rad[0]",
            "gyroADC[1]",
            "rate_z_dps",
            "accSmooth[0]",
            "accelerometer_m_s2[1]",
            "Accel Z",
        ],
        [[1.0, 0.0], [1.0, 0.0], [DEGREE, 0.0], [0.0, 1.0], [0.0, G], [0.0, 1.0]],
        [1.0, 1.0, 1.0, 1.0, 1.0, 10.0],
    );
    let close =
        |own: f32, other: f64| assert!((f64::from(own) / other - 1.0).abs() < 1e-6, "{own}");
    let sample: [f32; 6] = SI.sample(COUNT);
    close(sample[0], 1000.0_f64.to_radians());
    close(sample[1], -(500.0_f64.to_radians()));
    close(sample[2], 2000.0 / 32_768.0);
    close(sample[3], 9.806_65);
    close(sample[4], -2.0);
    close(sample[5], 9.806_65 / 2048.0 * 10.0);
    // In counts of the sensor itself, and of another scale.
    const RAW: Channels<2> =
        Channels::new(COUNTS, ["acc_x", "acc_x2"], [[0.0, G]; 2], [2048.0, 20_480.0]);
    assert_eq!(RAW.sample::<i16>([0, 0, 0, -2_048, 0, 15]), [-2_048, 150]);
    assert_eq!(RAW.sample::<i16>([0, 0, 0, 32_767, 0, -32_768]), [32_767, i16::MIN]);
}
