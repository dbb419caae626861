"""Two more controllers behind the same estimate and mixer: an LQR, and Betaflight's rate loop.

Both are for the drone that they are given. Mahony's filter, the limit on turns and the mixer are the cascade's.
"""

from __future__ import annotations

from math import exp, pi

import numpy as np
from scipy.linalg import solve_discrete_are

from control import ATTITUDE, Control, F
from world import CRAZYFLIE, Drone


class Lqr(Control):
    """A linear quadratic regulator of each axis, by the rules of the textbook: no gain is found by hand.

    Its state is the angle that is left, its integral, the rate, and the acceleration that the motors have by now, which is
    what they were told through their lag. The weights are one over the square of what is borne of each: 0.1 rad, 0.2 rad s,
    2 rad/s, and 60 rad/s² asked for; in yaw 15 rad/s².
    """

    BORNE = (0.1, 0.2, 2.0)
    ASKED = (60.0, 60.0, 15.0)

    def __init__(self, rate: int, drone: Drone = CRAZYFLIE):
        super().__init__(rate, drone)
        self.gains = [self._gains(1 / rate, drone.lag, asked) for asked in self.ASKED]
        self.stay = exp(-1 / (rate * drone.lag))
        self.left, self.feed = [0.0] * 3, [0.0] * 3
        self.sums, self.pushed = [0.0] * 3, [0.0] * 3

    @classmethod
    def _gains(cls, dt: float, lag: float, asked: float) -> list[float]:
        """The gains on angle, integral, rate and acceleration."""
        stay = exp(-dt / lag)
        a = np.array([[1, 0, -dt, 0], [dt, 1, 0, 0], [0, 0, 1, dt], [0, 0, 0, stay]])
        b = np.array([[0.0], [0], [0], [1 - stay]])
        weights = np.diag([1 / cls.BORNE[0] ** 2, 1 / cls.BORNE[1] ** 2, 1 / cls.BORNE[2] ** 2, 0])
        asks = np.array([[1 / asked**2]])
        cost = solve_discrete_are(a, b, weights, asks)
        return (-np.linalg.solve(asks + b.T @ cost @ b, b.T @ cost @ a))[0].tolist()

    def _turns(self, wanted, feed):
        turns = super()._turns(wanted, feed)
        self.feed = [float(own) for own in feed]
        # No more of an angle is seen than the cascade would turn for.
        self.left = [float((turn - lead) / gain) for turn, lead, gain in zip(turns, feed, ATTITUDE)]
        return turns

    def _wishes(self, rates, turns):
        wishes = []
        for axis in range(3):
            left, wrong = self.left[axis], float(rates[axis]) - self.feed[axis]
            self.sums[axis] = min(max(self.sums[axis] + left * float(self.dt), -0.5), 0.5)
            of_angle, of_sum, of_rate, of_push = self.gains[axis]
            wish = of_angle * left + of_sum * self.sums[axis] + of_rate * wrong + of_push * self.pushed[axis]
            wish = min(max(wish, -400.0), 400.0)
            self.pushed[axis] = self.stay * self.pushed[axis] + (1 - self.stay) * wish
            wishes.append(F(wish))
        return wishes


class Betaflight(Control):
    """The rate loop that Betaflight 4 publishes (`pid.c`), with its scales and default gains times `SLIDER`, D once
    more times `DAMPING`.

    P on the error, I on the error with `iterm_relax` in roll and pitch, D on the gyroscope behind two filters of first order
    at 75 and 150 Hz, feed-forward on the set-point's change. Its sum is in thousandths of what the motors have; 1000 is here
    the moment of two rotors at full thrust against two at none. The defaults are for motors that follow three times as fast
    as a Crazyflie's, hence these two sliders, which its configurator has too. Angles come to it as to the cascade's rate loop.
    """

    SLIDER, DAMPING = 0.4, 1.75
    #: Roll, pitch, yaw: P, I, D, F of Betaflight 4.5.
    GAINS = ((45, 80, 30, 120), (47, 84, 34, 125), (45, 80, 0, 120))
    #: The firmware's scales of P, I, D and F, for degrees a second.
    SCALES = (0.032029, 0.244381, 0.000529, 0.013754 / 100)
    #: The integral stops here.
    MOST = 400.0
    #: Set-points that change faster than this do not wind it up: Hz, degrees a second.
    RELAX, RELAX_FROM = 15.0, 40.0

    def __init__(self, rate: int, drone: Drone = CRAZYFLIE):
        super().__init__(rate, drone)
        lever = abs(drone.arm[0][0])
        pull = drone.k_eta * drone.fastest**2
        whole = (4 * lever * pull / 2, 4 * lever * pull / 2, 4 * drone.k_m * drone.fastest**2 / 2)
        self.worth = [moment / inertia / 500 for moment, inertia in zip(whole, drone.inertia)]
        self.low = [1 / (1 + rate / (2 * pi * corner)) for corner in (75, 150)]
        self.relax = 1 / (1 + rate / (2 * pi * self.RELAX))
        self.sums, self.slow = [0.0] * 3, [0.0] * 3
        self.before: list[list[float]] | None = None
        self.last_turns: list[float] | None = None

    def _wishes(self, rates, turns):
        rates, turns = ([float(own) * 180 / pi for own in all_] for all_ in (rates, turns))
        if self.before is None:
            self.before, self.last_turns = [[rate, rate] for rate in rates], turns
            self.slow = list(turns)
        dt, wishes = float(self.dt), []
        for axis in range(3):
            p, i, d, f = (self.SLIDER * gain * scale for gain, scale in zip(self.GAINS[axis], self.SCALES))
            error = turns[axis] - rates[axis]
            self.slow[axis] += self.relax * (turns[axis] - self.slow[axis])
            fast = abs(turns[axis] - self.slow[axis])
            wound = error if axis == 2 else error * max(0.0, 1 - fast / self.RELAX_FROM)
            wound = self.sums[axis] + i * wound * dt
            self.sums[axis] = min(max(wound, -self.MOST), self.MOST)
            first, second = self.before[axis]
            new_first = first + self.low[0] * (rates[axis] - first)
            new_second = second + self.low[1] * (new_first - second)
            slope = (new_second - second) / dt
            self.before[axis] = [new_first, new_second]
            lead = (turns[axis] - self.last_turns[axis]) / dt
            whole = p * error + self.sums[axis] - self.DAMPING * d * slope + f * lead
            wishes.append(F(self.worth[axis] * min(max(whole, -500.0), 500.0)))
        self.last_turns = turns
        return wishes


#: All three, by name.
CONTROLLERS = {"cascade": Control, "LQR": Lqr, "Betaflight": Betaflight}
