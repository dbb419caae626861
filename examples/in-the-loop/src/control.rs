//! The cascade of `laptop/loop/control.py`, in the order in which it stands there, which gives the same bits.

use libm::sqrtf;

const TRUST: f32 = 0.2;
const LEARN: f32 = 0.01;
const ATTITUDE: [f32; 3] = [8.0, 8.0, 3.0];
const FASTEST_TURN: f32 = 18.0;
const RATE: [f32; 3] = [35.0, 35.0, 12.0];
const INTEGRAL: [f32; 3] = [40.0, 40.0, 10.0];
const DERIVATIVE: [f32; 3] = [1.0, 1.0, 0.0];
const SMOOTH: f32 = 0.3;
const MOST: f32 = 60.0;

/// The Crazyflie's, as RotorPy has them.
const INERTIA: [f32; 3] = [1.43e-5, 1.43e-5, 2.89e-5];
const K_ETA: f64 = 2.3e-8;
const K_M: f64 = 7.8e-10;
const LEVER: f64 = 4.0 * 0.030_405_591_590_739_998;
const PARTS: [f32; 3] =
    [(1.0 / (4.0 * K_ETA)) as f32, (1.0 / (LEVER * K_ETA)) as f32, (1.0 / (4.0 * K_M)) as f32];
/// What roll, pitch and yaw ask of each rotor.
const SIGNS: [[f32; 3]; 4] =
    [[1.0, -1.0, 1.0], [-1.0, -1.0, -1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, -1.0]];
const FASTEST: f32 = 2500.0 * 2500.0;

pub struct Control {
    dt: f32,
    q: [f32; 4],
    offset: [f32; 3],
    integral: [f32; 3],
    last: Option<[f32; 3]>,
    slope: [f32; 3],
}

impl Control {
    pub const fn new(rate: f32) -> Self {
        Self {
            dt: 1.0 / rate,
            q: [1.0, 0.0, 0.0, 0.0],
            offset: [0.0; 3],
            integral: [0.0; 3],
            last: None,
            slope: [0.0; 3],
        }
    }

    /// The speeds of the rotors, in rad/s.
    pub fn step(
        &mut self,
        sample: [f32; 6],
        wanted: [f32; 4],
        thrust: f32,
        feed: [f32; 3],
    ) -> [f32; 4] {
        let rates = self.estimate(sample);
        let moments = self.moments(rates, wanted, feed);
        mix(thrust, moments)
    }

    fn estimate(&mut self, [gx, gy, gz, ax, ay, az]: [f32; 6]) -> [f32; 3] {
        let [w, x, y, z] = self.q;
        let length = ax * ax + ay * ay + az * az;
        let rates = [gx + self.offset[0], gy + self.offset[1], gz + self.offset[2]];
        let mut turned = rates;
        if length > 0.0 {
            let scale = 1.0 / sqrtf(length);
            let (ax, ay, az) = (ax * scale, ay * scale, az * scale);
            let up = [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)];
            let error = [ay * up[2] - az * up[1], az * up[0] - ax * up[2], ax * up[1] - ay * up[0]];
            for axis in 0..3 {
                self.offset[axis] += LEARN * error[axis] * self.dt;
                turned[axis] = rates[axis] + TRUST * error[axis];
            }
        }
        let [p, q, r] = turned.map(|own| 0.5 * self.dt * own);
        let [w, x, y, z] = [
            w - x * p - y * q - z * r,
            x + w * p + y * r - z * q,
            y + w * q - x * r + z * p,
            z + w * r + x * q - y * p,
        ];
        let scale = 1.0 / sqrtf(w * w + x * x + y * y + z * z);
        self.q = [w * scale, x * scale, y * scale, z * scale];
        rates
    }

    fn moments(&mut self, rates: [f32; 3], wanted: [f32; 4], feed: [f32; 3]) -> [f32; 3] {
        let [w, x, y, z] = self.q;
        let [a, b, c, d] = wanted;
        let way = w * a + x * b + y * c + z * d;
        let left = [
            w * b - x * a - y * d + z * c,
            w * c + x * d - y * a - z * b,
            w * d - x * c + y * b - z * a,
        ];
        let sign = if way >= 0.0 { 2.0 } else { -2.0 };
        let last = self.last.replace(rates).unwrap_or(rates);
        core::array::from_fn(|axis| {
            let turn = ATTITUDE[axis] * sign * left[axis] + feed[axis];
            let turn = least(most(turn, -FASTEST_TURN), FASTEST_TURN);
            let error = turn - rates[axis];
            let integral = self.integral[axis] + INTEGRAL[axis] * error * self.dt;
            self.integral[axis] = least(most(integral, -MOST), MOST);
            let slope = (rates[axis] - last[axis]) / self.dt;
            self.slope[axis] += SMOOTH * (slope - self.slope[axis]);
            let wish =
                RATE[axis] * error + self.integral[axis] - DERIVATIVE[axis] * self.slope[axis];
            INERTIA[axis] * wish
        })
    }
}

fn mix(thrust: f32, moments: [f32; 3]) -> [f32; 4] {
    let base = thrust * PARTS[0];
    let squares = SIGNS.map(|[roll, pitch, yaw]| {
        let tilt = roll * moments[0] * PARTS[1] + pitch * moments[1] * PARTS[1];
        (tilt, yaw * moments[2] * PARTS[2])
    });
    let [first, ..] = squares.map(|(tilt, _)| tilt);
    let highest = squares.iter().fold(first, |so_far, own| most(so_far, own.0));
    let lowest = squares.iter().fold(first, |so_far, own| least(so_far, own.0));
    let base = least(most(base, -lowest), most(FASTEST - highest, -lowest));
    let room = squares.map(|(tilt, _)| least(base + tilt, FASTEST - base - tilt));
    let [first, ..] = room;
    let room = most(room.iter().fold(first, |so_far, own| least(so_far, *own)), 0.0);
    squares.map(|(tilt, yaw)| {
        let square = base + tilt + least(most(yaw, -room), room);
        sqrtf(least(most(square, 0.0), FASTEST))
    })
}

/// Python's `max`, which takes the first of equals.
fn most(one: f32, other: f32) -> f32 {
    if other > one { other } else { one }
}

/// Python's `min`.
fn least(one: f32, other: f32) -> f32 {
    if other < one { other } else { one }
}
