//! Ticks over the wrap, and events in time steps.

use core::num::NonZeroU32;

use proptest::prelude::*;
use spikewire::{Bins, Event, Polarity, StepOver, Tick};

fn up(tick: u32, address: u16) -> Event {
    Event { tick: tick.into(), address, polarity: Polarity::Up }
}

proptest! {
    #![proptest_config(crate::common::cases(256))]

    #[test]
    fn a_tick_widens_to_its_time(now in any::<u64>(), away in -(1_i64 << 31)..1 << 31) {
        if let Some(time) = now.checked_add_signed(away) {
            prop_assert_eq!(Tick::from_micros(time).widen(now), time);
        }
    }

    #[test]
    fn comparison_agrees_with_the_times(now in any::<u64>(), away in 1_u64..1 << 31) {
        if let Some(later) = now.checked_add(away) {
            let (now, later) = (Tick::from_micros(now), Tick::from_micros(later));
            prop_assert_eq!(later.since(now), away as i32);
            prop_assert_eq!(now + away as u32, later);
            prop_assert!(now.is_before(later) && !later.is_before(now));
            prop_assert!(!now.is_before(now));
        }
    }

    #[test]
    fn every_event_is_counted_once(
        start in any::<u32>(),
        step in 1_u32..5_000,
        limit in 1_u8..20,
        gaps in prop::collection::vec((-2_000_i32..4_000, 0_u16..5), 0..200),
    ) {
        let mut bins = Bins::<4>::new(start.into(), NonZeroU32::new(step).unwrap()).with_limit(limit);
        let (mut tick, mut counted) = (start, 0);
        for &(gap, address) in &gaps {
            tick = tick.wrapping_add_signed(gap);
            while bins.add(up(tick, address)).is_err() {
                counted += bins.take().map(u32::from).iter().sum::<u32>();
            }
        }
        let last = bins.take();
        prop_assert!(last.iter().all(|&count| count <= limit));
        counted += last.map(u32::from).iter().sum::<u32>();
        let apart = bins.saturated() + bins.late() + bins.outside();
        prop_assert_eq!(counted + apart, gaps.len() as u32);
    }
}

#[test]
fn counts_stop_at_their_limit() {
    let step = NonZeroU32::new(10).unwrap();
    for (limit, saturated) in [(2, 298), (255, 45)] {
        let mut bins = Bins::<1>::new(0.into(), step).with_limit(limit);
        (0..300).for_each(|_| bins.add(up(5, 0)).unwrap());
        assert_eq!((bins.saturated(), bins.take()), (saturated, [limit]));
    }
}

#[test]
fn a_tick_near_the_ends_of_time_stays_there() {
    assert_eq!(Tick::from(0xFFFF_FFFF).widen(5), 0xFFFF_FFFF); // there is no time -1
    assert_eq!(Tick::from(0).widen(u64::MAX), u64::MAX - 0xFFFF_FFFF);
}

#[test]
fn time_steps_go_over_the_wrap() {
    let mut bins = Bins::<1>::new((u32::MAX - 499).into(), NonZeroU32::new(1_000).unwrap());
    assert_eq!(bins.add(up(u32::MAX, 0)), Ok(()));
    assert_eq!(bins.add(up(499, 0)), Ok(()));
    assert!(!bins.is_over(499.into()) && bins.is_over(500.into()));
    assert_eq!(bins.add(up(500, 0)), Err(StepOver));
    assert_eq!((bins.take(), bins.start()), ([2], 500.into()));
    assert_eq!(bins.add(up(499, 0)), Ok(()));
    assert_eq!(bins.add(up(500, 0)), Ok(()), "the first tick of a step is in it");
    assert_eq!((bins.late(), bins.take()), (1, [1]));
}
