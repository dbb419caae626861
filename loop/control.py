"""The drone's controller: Mahony's filter, then attitude, rate and mixer. The same for every code, and it knows of none.

All of it is in single precision and in the order in which it stands, so that a flight controller has the same bits: no
sum is left to a library. It decides nothing by a code's name; what it hears is six values a sample.
"""

from __future__ import annotations

import numpy as np

from world import ARM, FASTEST, GRAVITY, INERTIA, K_ETA, K_M, TURNS

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
    """From a sample of six channels to the speeds of four rotors."""

    def __init__(self, rate: int):
        self.dt = F(1) / F(rate)
        self.q = [ONE, ZERO, ZERO, ZERO]  # w, x, y, z
        self.offset = [ZERO] * 3
        self.integral = [ZERO] * 3
        self.last = None
        self.slope = [ZERO] * 3
        self.inertia = [F(own) for own in INERTIA]
        self.most = F(FASTEST * FASTEST)
        lever = 4 * abs(ARM[0][0])
        self.parts = [F(1 / (4 * K_ETA)), F(1 / (lever * K_ETA)), F(1 / (lever * K_ETA)), F(1 / (4 * K_M))]
        self.signs = [(ONE if y > 0 else -ONE, -ONE if x > 0 else ONE, F(way)) for (x, y, _), way in zip(ARM, TURNS)]

    def step(self, sample, wanted, thrust: float, feed=(0.0, 0.0, 0.0)) -> list[float]:
        """The speeds for a `wanted` attitude (w, x, y, z), a thrust in N and the rate at which what is wanted turns."""
        gx, gy, gz, ax, ay, az = (F(own) for own in sample)
        rates = self._estimate(gx, gy, gz, ax, ay, az)
        turns = self._turns([F(own) for own in wanted], [F(own) for own in feed])
        moments = [inertia * wish for inertia, wish in zip(self.inertia, self._wishes(rates, turns))]
        return self._mix(F(thrust), moments)

    def _estimate(self, gx, gy, gz, ax, ay, az):
        """Mahony's filter; the rates without the offset that it has learnt."""
        w, x, y, z = self.q
        length = ax * ax + ay * ay + az * az
        rates = [gx + self.offset[0], gy + self.offset[1], gz + self.offset[2]]
        turned = rates
        if length > ZERO:
            scale = ONE / np.sqrt(length)
            ax, ay, az = ax * scale, ay * scale, az * scale
            ux, uy, uz = TWO * (x * z - w * y), TWO * (y * z + w * x), ONE - TWO * (x * x + y * y)
            error = [ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux]
            for axis in range(3):
                self.offset[axis] = self.offset[axis] + LEARN * error[axis] * self.dt
            turned = [rates[axis] + TRUST * error[axis] for axis in range(3)]
        p, q, r = (HALF * self.dt * own for own in turned)
        w, x, y, z = (
            w - x * p - y * q - z * r,
            x + w * p + y * r - z * q,
            y + w * q - x * r + z * p,
            z + w * r + x * q - y * p,
        )
        scale = ONE / np.sqrt(w * w + x * x + y * y + z * z)
        self.q = [w * scale, x * scale, y * scale, z * scale]
        return rates

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
        turns = [ATTITUDE[axis] * sign * left[axis] + feed[axis] for axis in range(3)]
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
            wishes.append(RATE[axis] * error + self.integral[axis] - DERIVATIVE[axis] * self.slope[axis])
        self.last = rates
        return wishes

    def _mix(self, thrust, moments) -> list[float]:
        """Thrust and moments as the squares of rotor speeds; roll and pitch come before thrust, and yaw last."""
        base = thrust * self.parts[0]
        squares = []
        for roll, pitch, yaw in self.signs:
            tilt = roll * moments[0] * self.parts[1] + pitch * moments[1] * self.parts[2]
            squares.append((tilt, yaw * moments[2] * self.parts[3]))
        highest, lowest = max(own[0] for own in squares), min(own[0] for own in squares)
        base = min(max(base, -lowest), max(self.most - highest, -lowest))
        room = min(min(base + tilt, self.most - base - tilt) for tilt, _ in squares)
        room = max(room, ZERO)
        speeds = []
        for tilt, yaw in squares:
            square = base + tilt + min(max(yaw, -room), room)
            speeds.append(np.sqrt(min(max(square, ZERO), self.most)))
        return [float(own) for own in speeds]


def level_thrust(mass: float) -> float:
    """The thrust that carries this mass."""
    return mass * GRAVITY
