"""The world: RotorPy's multirotor with its parameters of a Crazyflie, in steps of fixed length.

RotorPy's derivative takes some 100 µs, most of them in NumPy calls on arrays of three numbers. Here the same equations
are written out in plain numbers; :func:`check` holds them against RotorPy's own at every start of a program.
"""

from __future__ import annotations

import copy
from math import sqrt

import numpy as np
from rotorpy.vehicles.crazyflie_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor

GRAVITY = 9.81
#: The speed of a rotor at rest in the air, rad/s.
HOVER = sqrt(quad_params["mass"] * GRAVITY / 4 / quad_params["k_eta"])
#: Where each rotor stands, and which way it turns.
ARM = [tuple(float(part) for part in quad_params["rotor_pos"][f"r{rotor}"]) for rotor in (1, 2, 3, 4)]
TURNS = [int(way) for way in quad_params["rotor_directions"]]

K_ETA, K_M, K_D, K_Z = (float(quad_params[name]) for name in ("k_eta", "k_m", "k_d", "k_z"))
INERTIA = tuple(quad_params[name] for name in ("Ixx", "Iyy", "Izz"))
TAU, FASTEST = quad_params["tau_m"], quad_params["rotor_speed_max"]


class World:
    """A drone in the air. `mass` is a factor on the Crazyflie's, `weak` one on the thrust of its first motor."""

    def __init__(self, mass: float = 1.0, weak: float = 1.0):
        self.mass = quad_params["mass"] * mass
        self.weak = weak
        # Position, velocity, quaternion (x, y, z, w), body rates, rotor speeds: RotorPy's order, without its wind.
        self.state = [0.0] * 9 + [1.0] + [0.0] * 3 + [HOVER] * 4
        self.wind = (0.0, 0.0, 0.0)
        self.force = (0.0, 0.0, 0.0)

    def step(self, speeds: list[float], seconds: float) -> None:
        """Flies on with these commands to the rotors, one step of Runge and Kutta's fourth order."""
        commands = [min(max(speed, 0.0), FASTEST) for speed in speeds]
        commands[0] *= sqrt(self.weak)
        s, h = self.state, seconds
        a = self.derivative(s, commands)
        b = self.derivative([x + h / 2 * d for x, d in zip(s, a)], commands)
        c = self.derivative([x + h / 2 * d for x, d in zip(s, b)], commands)
        d = self.derivative([x + h * d for x, d in zip(s, c)], commands)
        s = [x + h / 6 * (p + 2 * q + 2 * r + t) for x, p, q, r, t in zip(s, a, b, c, d)]
        norm = sqrt(sum(part * part for part in s[6:10]))
        s[6:10] = [part / norm for part in s[6:10]]
        self.state = s

    def derivative(self, s: list[float], commands: list[float]) -> list[float]:
        """RotorPy's `_s_dot_fn` for a Crazyflie: thrust, rotor drag, inflow, yaw moments, rigid body, motors."""
        _, _, _, vx, vy, vz, qx, qy, qz, qw, p, q, r, *rotors = s
        norm = qx * qx + qy * qy + qz * qz + qw * qw
        two = 2 / norm
        xx, xy, xz = 1 - two * (qy * qy + qz * qz), two * (qx * qy - qz * qw), two * (qx * qz + qy * qw)
        yx, yy, yz = two * (qx * qy + qz * qw), 1 - two * (qx * qx + qz * qz), two * (qy * qz - qx * qw)
        zx, zy, zz = two * (qx * qz - qy * qw), two * (qy * qz + qx * qw), 1 - two * (qx * qx + qy * qy)
        ux, uy, uz = vx - self.wind[0], vy - self.wind[1], vz - self.wind[2]
        ax, ay, az = xx * ux + yx * uy + zx * uz, xy * ux + yy * uy + zy * uz, xz * ux + yz * uy + zz * uz

        fx = fy = fz = mx = my = mz = 0.0
        for (rx, ry, rz), way, speed in zip(ARM, TURNS, rotors):
            hx = -speed * K_D * (ax + q * rz - r * ry)
            hy = -speed * K_D * (ay + r * rx - p * rz)
            hz = K_ETA * speed * speed - speed * K_Z * (az + p * ry - q * rx)
            fx, fy, fz = fx + hx, fy + hy, fz + hz
            mx, my = mx + ry * hz - rz * hy, my + rz * hx - rx * hz
            mz += rx * hy - ry * hx + way * K_M * speed * speed
        self.force = fx, fy, fz

        m, (ix, iy, iz) = self.mass, INERTIA
        return [
            vx,
            vy,
            vz,
            (xx * fx + xy * fy + xz * fz) / m,
            (yx * fx + yy * fy + yz * fz) / m,
            (zx * fx + zy * fy + zz * fz) / m - GRAVITY,
            0.5 * (qw * p - qz * q + qy * r),
            0.5 * (qz * p + qw * q - qx * r),
            0.5 * (-qy * p + qx * q + qw * r),
            0.5 * (-qx * p - qy * q - qz * r),
            (mx - (iz - iy) * q * r) / ix,
            (my - (ix - iz) * r * p) / iy,
            (mz - (iy - ix) * p * q) / iz,
            *[(command - speed) / TAU for command, speed in zip(commands, rotors)],
        ]

    def feel(self) -> list[float]:
        """What an ideal inertial sensor at the centre feels: rates in rad/s, then specific force in m/s²."""
        self.derivative(self.state, self.state[13:])
        return [*self.state[10:13], *[part / self.mass for part in self.force]]

    def up(self) -> tuple[float, float, float]:
        """The direction of the drone's thrust, in the world."""
        qx, qy, qz, qw = self.state[6:10]
        return 2 * (qx * qz + qy * qw), 2 * (qy * qz - qx * qw), 1 - 2 * (qx * qx + qy * qy)


def check() -> float:
    """The largest difference from RotorPy's derivative on random states, in parts of the largest entry."""
    random, worst = np.random.default_rng(1), 0.0
    for mass in (1.0, 1.2):
        parameters = copy.deepcopy(quad_params)
        parameters["mass"] *= mass
        theirs, ours = Multirotor(parameters), World(mass)
        for _ in range(50):
            state = random.normal(size=17) * ([1] * 10 + [8] * 3 + [0] * 4)
            state[6:10] /= np.linalg.norm(state[6:10])
            state[13:], commands = random.uniform(0, FASTEST, (2, 4))
            ours.wind = tuple(random.normal(size=3) * 3)
            whole = np.concatenate([state[:13], ours.wind, state[13:]])
            expected = np.delete(theirs._s_dot_fn(0, whole, commands), slice(13, 16))
            own = np.array(ours.derivative(list(state), list(commands)))
            worst = max(worst, float(np.max(np.abs(own - expected) / np.maximum(1, np.abs(expected)))))
    if worst > 1e-9:
        raise AssertionError(f"the world is not RotorPy's: {worst}")
    return worst


check()
