//! Turning a vehicle by hand, with its sensor mounted in each of the eight ways.

use flight::Alignment::{self, *};

type Vector = [i32; 3];

/// Axes of the sensor on the vehicle, as a data sheet and a board's drawing give them: where its x, y and z point, in the
/// vehicle's forward, left and up.
fn axes(alignment: Alignment) -> [Vector; 3] {
    let (forward, left, up) = ([1, 0, 0], [0, 1, 0], [0, 0, 1]);
    let minus = |vector: Vector| vector.map(|part| -part);
    match alignment {
        Cw0 => [forward, left, up],
        // A quarter clockwise, as seen from above: x, which pointed forward, points right.
        Cw90 => [minus(left), forward, up],
        Cw180 => [minus(forward), minus(left), up],
        Cw270 => [left, minus(forward), up],
        // On the lower side, turned over about the vehicle's y.
        Cw0Flip => [minus(forward), left, minus(up)],
        Cw90Flip => [left, forward, minus(up)],
        Cw180Flip => [forward, minus(left), minus(up)],
        Cw270Flip => [minus(left), minus(forward), minus(up)],
    }
}

/// What a sensor with these axes measures of a vector of the vehicle.
fn measured(alignment: Alignment, vehicle: Vector) -> [i16; 3] {
    axes(alignment).map(|axis| {
        let part: i32 = axis.iter().zip(vehicle).map(|(one, other)| one * other).sum();
        part as i16
    })
}

#[test]
fn the_vehicles_own_rates_and_accelerations_come_back() {
    for alignment in [Cw0, Cw90, Cw180, Cw270, Cw0Flip, Cw90Flip, Cw180Flip, Cw270Flip] {
        // Roll right, nose down, yaw left, with gravity's reaction upwards; then about one axis after the other.
        let all = [[300, 200, 100], [500, 0, 0], [0, 500, 0], [0, 0, 500], [-7, 8, -9]];
        for (rates, accelerations) in all.into_iter().zip(all.into_iter().rev()) {
            let [rx, ry, rz] = measured(alignment, rates);
            let [ax, ay, az] = measured(alignment, accelerations);
            let turned = alignment.apply([rx, ry, rz, ax, ay, az]).map(i32::from);
            assert_eq!(
                (&turned[..3], &turned[3..]),
                (&rates[..], &accelerations[..]),
                "{alignment:?}"
            );
        }
    }
}

#[test]
fn the_lowest_count_does_not_wrap() {
    assert_eq!(
        Cw180.apply([i16::MIN; 6]),
        [i16::MAX, i16::MAX, i16::MIN, i16::MAX, i16::MAX, i16::MIN]
    );
}
