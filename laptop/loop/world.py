"""The world: RotorPy's multirotor with its parameters of a Crazyflie, in steps of fixed length.

RotorPy's derivative takes some 100 µs, most of them in NumPy calls on arrays of three numbers. Here the same equations
are written out and compiled; :func:`check` holds them against RotorPy's own at every start of a program.
"""

from __future__ import annotations

import copy
import os
from dataclasses import dataclass
from math import sqrt

# The second world's package insists on it before anything imports SciPy.
os.environ.setdefault("SCIPY_ARRAY_API", "1")

import numpy as np
from numba import njit
from rotorpy.vehicles.crazyflie_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor

GRAVITY = 9.81


@dataclass(frozen=True)
class Drone:
    """The constants of a drone that its controller knows."""

    mass: float
    inertia: tuple[float, float, float]
    #: Each rotor's place and sense of rotation.
    arm: list[tuple[float, float, float]]
    turns: list[int]
    #: Thrust and yaw moment of a rotor at a command of 1; both grow as its square.
    k_eta: float
    k_m: float
    #: The largest command.
    fastest: float
    #: The rotors' time constant, s.
    lag: float
    #: A rotor's speed in hover, rad/s.
    hover: float


K_ETA, K_M, K_D, K_Z = (float(quad_params[name]) for name in ("k_eta", "k_m", "k_d", "k_z"))
TAU, FASTEST, HOVER = quad_params["tau_m"], quad_params["rotor_speed_max"], sqrt(quad_params["mass"] * GRAVITY / 4 / K_ETA)
CRAZYFLIE = Drone(
    mass=float(quad_params["mass"]),
    inertia=tuple(quad_params[name] for name in ("Ixx", "Iyy", "Izz")),
    arm=[tuple(float(part) for part in quad_params["rotor_pos"][f"r{rotor}"]) for rotor in (1, 2, 3, 4)],
    turns=[int(way) for way in quad_params["rotor_directions"]],
    k_eta=K_ETA,
    k_m=K_M,
    fastest=FASTEST,
    lag=TAU,
    hover=HOVER,
)
ARM, TURNS, INERTIA = np.array(CRAZYFLIE.arm), np.array(CRAZYFLIE.turns), CRAZYFLIE.inertia


class World:
    """A drone in the air. `mass` is a factor on the Crazyflie's, `weak` one on the thrust of its first motor."""

    drone = CRAZYFLIE

    def __init__(self, mass: float = 1.0, weak: float = 1.0):
        self.mass = quad_params["mass"] * mass
        self.weak = weak
        # Position, velocity, quaternion (x, y, z, w), body rates, rotor speeds: RotorPy's order, without its wind.
        self.state = np.array([0.0] * 9 + [1.0] + [0.0] * 3 + [HOVER] * 4)
        self.wind = (0.0, 0.0, 0.0)

    def step(self, speeds: list[float], seconds: float) -> None:
        """Flies on with these commands to the rotors, one step of Runge and Kutta's fourth order."""
        commands = [min(max(float(speed), 0.0), FASTEST) for speed in speeds]
        commands[0] *= sqrt(self.weak)
        self.state = advance(self.state, np.array(commands), self.wind, self.mass, seconds)

    def derivative(self, state: np.ndarray, commands: np.ndarray) -> tuple[np.ndarray, tuple]:
        """The derivative of a state, and the force that the drone feels."""
        return derivative(np.asarray(state, float), np.asarray(commands, float), self.wind, self.mass)

    def feel(self) -> list[float]:
        """What an ideal inertial sensor at the centre feels: rates in rad/s, then specific force in m/s²."""
        _, force = self.derivative(self.state, self.state[13:])
        return [*self.state[10:13].tolist(), *[part / self.mass for part in force]]

    def rotors(self) -> np.ndarray:
        """The speeds of the rotors, in parts of that in hover."""
        return self.state[13:] / HOVER

    def up(self) -> tuple[float, float, float]:
        """The direction of the drone's thrust, in the world."""
        qx, qy, qz, qw = self.state[6:10].tolist()
        return 2 * (qx * qz + qy * qw), 2 * (qy * qz - qx * qw), 1 - 2 * (qx * qx + qy * qy)


@njit(cache=True)
def derivative(s, commands, wind, mass):
    """RotorPy's `_s_dot_fn` for a Crazyflie: thrust, rotor drag, inflow, yaw moments, rigid body, motors."""
    vx, vy, vz, qx, qy, qz, qw, p, q, r = s[3], s[4], s[5], s[6], s[7], s[8], s[9], s[10], s[11], s[12]
    norm = qx * qx + qy * qy + qz * qz + qw * qw
    two = 2 / norm
    xx, xy, xz = 1 - two * (qy * qy + qz * qz), two * (qx * qy - qz * qw), two * (qx * qz + qy * qw)
    yx, yy, yz = two * (qx * qy + qz * qw), 1 - two * (qx * qx + qz * qz), two * (qy * qz - qx * qw)
    zx, zy, zz = two * (qx * qz - qy * qw), two * (qy * qz + qx * qw), 1 - two * (qx * qx + qy * qy)
    ux, uy, uz = vx - wind[0], vy - wind[1], vz - wind[2]
    ax, ay, az = xx * ux + yx * uy + zx * uz, xy * ux + yy * uy + zy * uz, xz * ux + yz * uy + zz * uz

    fx = fy = fz = mx = my = mz = 0.0
    for rotor in range(4):
        rx, ry, rz = ARM[rotor]
        speed = s[13 + rotor]
        hx = -speed * K_D * (ax + q * rz - r * ry)
        hy = -speed * K_D * (ay + r * rx - p * rz)
        hz = K_ETA * speed * speed - speed * K_Z * (az + p * ry - q * rx)
        fx, fy, fz = fx + hx, fy + hy, fz + hz
        mx, my = mx + ry * hz - rz * hy, my + rz * hx - rx * hz
        mz += rx * hy - ry * hx + TURNS[rotor] * K_M * speed * speed

    m = mass
    ix, iy, iz = INERTIA
    out = np.empty(17)
    out[0], out[1], out[2] = vx, vy, vz
    out[3] = (xx * fx + xy * fy + xz * fz) / m
    out[4] = (yx * fx + yy * fy + yz * fz) / m
    out[5] = (zx * fx + zy * fy + zz * fz) / m - GRAVITY
    out[6] = 0.5 * (qw * p - qz * q + qy * r)
    out[7] = 0.5 * (qz * p + qw * q - qx * r)
    out[8] = 0.5 * (-qy * p + qx * q + qw * r)
    out[9] = 0.5 * (-qx * p - qy * q - qz * r)
    out[10] = (mx - (iz - iy) * q * r) / ix
    out[11] = (my - (ix - iz) * r * p) / iy
    out[12] = (mz - (iy - ix) * p * q) / iz
    out[13:] = (commands - s[13:]) / TAU
    return out, (fx, fy, fz)


@njit(cache=True)
def advance(s, commands, wind, mass, h):
    """A step of Runge and Kutta's fourth order."""
    a = derivative(s, commands, wind, mass)[0]
    b = derivative(s + h / 2 * a, commands, wind, mass)[0]
    c = derivative(s + h / 2 * b, commands, wind, mass)[0]
    d = derivative(s + h * c, commands, wind, mass)[0]
    s = s + h / 6 * (a + 2 * b + 2 * c + d)
    s[6:10] /= sqrt(s[6] * s[6] + s[7] * s[7] + s[8] * s[8] + s[9] * s[9])
    return s


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
            own, _ = ours.derivative(state, commands)
            worst = max(worst, float(np.max(np.abs(own - expected) / np.maximum(1, np.abs(expected)))))
    if worst > 1e-9:
        raise AssertionError(f"the world is not RotorPy's: {worst}")
    return worst


check()
