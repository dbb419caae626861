"""The drone's controller: Mahony's filter, then attitude, rate and mixer. The same for every code, and it knows of none.

All of it is in single precision and in the order in which it stands, so that a flight controller has the same bits: no
sum is left to a library. It decides nothing by a code's name; what it hears is six values a sample.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from world import CRAZYFLIE, Drone

F = np.float32
ZERO, HALF, ONE, TWO = F(0), F(0.5), F(1), F(2)

#: The filter trusts the accelerometer by so much, 1/s, and learns the gyroscope's offset so fast, 1/s².
TRUST, LEARN = F(0.2), F(0.01)
#: Rate wanted per attitude error, 1/s: roll, pitch, yaw; and the most that is wanted, rad/s.
ATTITUDE = (F(8), F(8), F(3))
FASTEST_TURN = F(18)
#: Angular acceleration per rate error, 1/s, per its integral, 1/s², and per its derivative.
RATE = (F(35), F(35), F(12))
INTEGRAL = (F(40), F(40), F(10))
DERIVATIVE = (F(1.0), F(1.0), F(0))
#: How much of a new slope the derivative's low pass takes a sample: 28 Hz at 500 samples a second.
SMOOTH = F(0.3)
#: The integral stops here, rad/s².
MOST = F(60)


class Control:
    """From a sample of six channels to the commands of a drone's four rotors."""

    def __init__(self, rate: int, drone: Drone = CRAZYFLIE):
        self.dt = F(1) / F(rate)
        self.attitude_gains, self.rate_gains = ATTITUDE, RATE
        self.q = np.array([ONE, ZERO, ZERO, ZERO])  # w, x, y, z
        self.offset = np.zeros(3, F)
        self.integral = [ZERO] * 3
        self.last = None
        self.slope = [ZERO] * 3
        self.inertia = [F(own) for own in drone.inertia]
        self.most = F(drone.fastest * drone.fastest)
        lever = 4 * abs(drone.arm[0][0])
        k_eta, k_m = drone.k_eta, drone.k_m
        self.parts = np.array([1 / (4 * k_eta), 1 / (lever * k_eta), 1 / (lever * k_eta), 1 / (4 * k_m)], F)
        rotors = zip(drone.arm, drone.turns)
        self.signs = np.array([(1 if y > 0 else -1, -1 if x > 0 else 1, way) for (x, y, _), way in rotors], F)

    def step(self, sample, wanted, thrust: float, feed=(0.0, 0.0, 0.0)) -> list[float]:
        """The speeds for a `wanted` attitude (w, x, y, z), a thrust in N and the rate at which what is wanted turns."""
        gx, gy, gz, ax, ay, az = (F(own) for own in sample)
        rates = self._estimate(gx, gy, gz, ax, ay, az)
        turns = self._turns([F(own) for own in wanted], [F(own) for own in feed])
        moments = [inertia * wish for inertia, wish in zip(self.inertia, self._wishes(rates, turns))]
        return self._mix(F(thrust), moments)

    def _estimate(self, gx, gy, gz, ax, ay, az):
        """Mahony's filter; the rates without the offset that it has learnt."""
        return list(estimate(self.q, self.offset, np.array([gx, gy, gz, ax, ay, az]), self.dt))

    def _turns(self, wanted, feed):
        """Attitude: the rates that turn the drone to where it is wanted."""
        w, x, y, z = self.q
        a, b, c, d = wanted
        # The turn that is left, in the drone's axes: conj(q) * wanted.
        way = w * a + x * b + y * c + z * d
        left = [
            w * b - x * a - y * d + z * c,
            w * c + x * d - y * a - z * b,
            w * d - x * c + y * b - z * a,
        ]
        sign = TWO if way >= ZERO else -TWO
        turns = [self.attitude_gains[axis] * sign * left[axis] + feed[axis] for axis in range(3)]
        return [min(max(turn, -FASTEST_TURN), FASTEST_TURN) for turn in turns]

    def _wishes(self, rates, turns):
        """Rate: angular accelerations that bring the rates to the turns, rad/s²."""
        if self.last is None:
            self.last = rates
        wishes = []
        for axis in range(3):
            error = turns[axis] - rates[axis]
            integral = self.integral[axis] + INTEGRAL[axis] * error * self.dt
            self.integral[axis] = min(max(integral, -MOST), MOST)
            slope = (rates[axis] - self.last[axis]) / self.dt
            self.slope[axis] = self.slope[axis] + SMOOTH * (slope - self.slope[axis])
            wishes.append(self.rate_gains[axis] * error + self.integral[axis] - DERIVATIVE[axis] * self.slope[axis])
        self.last = rates
        return wishes

    def _mix(self, thrust, moments) -> list[float]:
        """Thrust and moments as the squares of rotor speeds; roll and pitch come before thrust, and yaw last."""
        return list(mix(thrust, np.array(moments), self.parts, self.signs, self.most))


@njit(cache=True)
def estimate(attitude, offset, sample, dt):
    """A sample of Mahony's filter, which changes attitude and offset; the rates without the offset that it had."""
    w, x, y, z = attitude
    ax, ay, az = sample[3:]
    length = ax * ax + ay * ay + az * az
    rates = sample[:3] + offset
    p, q, r = rates
    if length > ZERO:
        scale = ONE / np.sqrt(length)
        ax, ay, az = ax * scale, ay * scale, az * scale
        ux, uy, uz = TWO * (x * z - w * y), TWO * (y * z + w * x), ONE - TWO * (x * x + y * y)
        ex, ey, ez = ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux
        offset[0] += LEARN * ex * dt
        offset[1] += LEARN * ey * dt
        offset[2] += LEARN * ez * dt
        p, q, r = p + TRUST * ex, q + TRUST * ey, r + TRUST * ez
    p, q, r = HALF * dt * p, HALF * dt * q, HALF * dt * r
    w, x, y, z = w - x * p - y * q - z * r, x + w * p + y * r - z * q, y + w * q - x * r + z * p, z + w * r + x * q - y * p
    scale = ONE / np.sqrt(w * w + x * x + y * y + z * z)
    attitude[0], attitude[1], attitude[2], attitude[3] = w * scale, x * scale, y * scale, z * scale
    return rates


@njit(cache=True)
def mix(thrust, moments, parts, signs, most):
    """The commands of four rotors."""
    base = thrust * parts[0]
    tilts, yaws = np.empty(4, np.float32), np.empty(4, np.float32)
    for rotor in range(4):
        roll, pitch, yaw = signs[rotor]
        tilts[rotor] = roll * moments[0] * parts[1] + pitch * moments[1] * parts[2]
        yaws[rotor] = yaw * moments[2] * parts[3]
    highest, lowest = max(tilts), min(tilts)
    base = min(max(base, -lowest), max(most - highest, -lowest))
    room = most
    for tilt in tilts:
        room = min(room, min(base + tilt, most - base - tilt))
    room = max(room, ZERO)
    speeds = np.empty(4, np.float32)
    for rotor in range(4):
        square = base + tilts[rotor] + min(max(yaws[rotor], -room), room)
        speeds[rotor] = np.sqrt(min(max(square, ZERO), most))
    return speeds
