"""A second world: the Crazyflie Brushless as `drone-models` has it, in steps of 0.25 ms.

Another laboratory's model of another drone (first principles, `cf21B_500`: 43 g, motors that spin up otherwise than down,
thrust with a linear part, propellers with inertia, no inflow), with another integrator: semi-implicit Euler's. The equations
are written out and compiled; :func:`check` holds them against the package's own at every start of a program.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
from numba import njit

from world import Drone, World

from drone_models.core import load_params
from drone_models.first_principles import dynamics

MODEL = "cf21B_500"
SUBSTEP = 0.25e-3
_P = load_params("first_principles", MODEL)
_NAMES = ("mass", "L", "prop_inertia", "gravity_vec", "J", "J_inv", "rpm2thrust", "rpm2torque", "mixing_matrix")
PARAMETERS = {name: _P[name] for name in (*_NAMES, "drag_matrix", "rotor_dyn_coef")}

MASS, L, PROPELLER = float(_P["mass"]), float(_P["L"]), float(_P["prop_inertia"])
GRAVITY = -float(_P["gravity_vec"][2])
INERTIA = tuple(float(_P["J"][axis][axis]) for axis in range(3))
T0, T1, T2 = (float(own) for own in _P["rpm2thrust"])
Q0, Q1, Q2 = (float(own) for own in _P["rpm2torque"])
MIX = np.array(_P["mixing_matrix"], float)
DRAG = np.array(np.diag(_P["drag_matrix"]), float)
SPIN = np.array(_P["rotor_dyn_coef"], float)
RPM = 2 * pi / 60
#: The most that a motor pulls, N.
MOST = 0.2


def speed_of(thrust: float) -> float:
    """The speed at which a rotor pulls so much, in rotations a minute."""
    return (-T1 + sqrt(T1 * T1 + 4 * T2 * max(thrust - T0, 0.0))) / (2 * T2)


HOVER = speed_of(MASS * GRAVITY / 4)
#: A command is the root of a rotor's thrust.
BRUSHLESS = Drone(
    mass=MASS,
    inertia=INERTIA,
    arm=[(-L * way[1], L * way[0], 0.0) for way in MIX.T],
    turns=[int(way[2]) for way in MIX.T],
    k_eta=1.0,
    k_m=0.00593893393599368,
    fastest=sqrt(MOST),
    lag=1 / (SPIN[0] + 2 * SPIN[1] * HOVER),
    hover=HOVER * RPM,
)


class Brushless(World):
    """A drone in the air. `mass` is a factor on the Crazyflie's, `weak` one on the thrust of its first motor."""

    drone = BRUSHLESS

    def __init__(self, mass: float = 1.0, weak: float = 1.0):
        self.mass, self.weak = MASS * mass, weak
        # Position, velocity, quaternion (x, y, z, w), body rates, rotor speeds in rotations a minute.
        self.state = np.array([0.0] * 9 + [1.0] + [0.0] * 3 + [HOVER] * 4)
        self.wind = (0.0, 0.0, 0.0)
        self._felt = (0.0, 0.0, GRAVITY)

    def step(self, speeds: list[float], seconds: float) -> None:
        """Flies on with these commands to the rotors."""
        thrusts = [min(max(float(speed), 0.0), BRUSHLESS.fastest) ** 2 for speed in speeds]
        thrusts[0] *= self.weak
        commands = np.array([speed_of(thrust) for thrust in thrusts])
        count = round(seconds / SUBSTEP)
        self.state = advance(self.state, commands, self.wind, self.mass, seconds / count, count)

    def derivative(self, state: np.ndarray, commands: np.ndarray) -> tuple[np.ndarray, tuple]:
        """The derivative of a state but for its quaternion, and the force that the drone feels."""
        return derivative(np.asarray(state, float), np.asarray(commands, float), self.wind, self.mass)

    def rotors(self) -> np.ndarray:
        """The speeds of the rotors, in parts of that in hover."""
        return self.state[13:] / HOVER


@njit(cache=True)
def derivative(s, commands, wind, mass):
    """Drag along the axes, thrust, moments of rotors and of propellers that are turned or change their speed, motors."""
    qx, qy, qz, qw, p, q, r = s[6], s[7], s[8], s[9], s[10], s[11], s[12]
    xx, xy, xz = 1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw)
    yx, yy, yz = 2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw)
    zx, zy, zz = 2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy)
    ux, uy, uz = s[3] - wind[0], s[4] - wind[1], s[5] - wind[2]
    fx = DRAG[0] * (xx * ux + yx * uy + zx * uz)
    fy = DRAG[1] * (xy * ux + yy * uy + zy * uz)
    fz = DRAG[2] * (xz * ux + yz * uy + zz * uz)
    mx = my = mz = spin = spun = 0.0
    out = np.zeros(17)
    for rotor in range(4):
        speed, command = s[13 + rotor], commands[rotor]
        first = 0 if command > speed else 2
        change = SPIN[first] * (command - speed) + SPIN[first + 1] * (command * command - speed * speed)
        thrust, torque = T0 + T1 * speed + T2 * speed * speed, Q0 + Q1 * speed + Q2 * speed * speed
        fz += thrust
        mx, my, mz = mx + MIX[0, rotor] * L * thrust, my + MIX[1, rotor] * L * thrust, mz + MIX[2, rotor] * torque
        spin, spun = spin + MIX[2, rotor] * speed * RPM, spun + MIX[2, rotor] * change * RPM
        out[13 + rotor] = change
    mx, my, mz = mx - PROPELLER * q * spin, my - PROPELLER * p * spin, mz + PROPELLER * spun
    ix, iy, iz = INERTIA
    out[0], out[1], out[2] = s[3], s[4], s[5]
    out[3] = (xx * fx + xy * fy + xz * fz) / mass
    out[4] = (yx * fx + yy * fy + yz * fz) / mass
    out[5] = (zx * fx + zy * fy + zz * fz) / mass - GRAVITY
    out[10] = (mx - (iz - iy) * q * r) / ix
    out[11] = (my - (ix - iz) * r * p) / iy
    out[12] = (mz - (iy - ix) * p * q) / iz
    return out, (fx, fy, fz)


@njit(cache=True)
def advance(s, commands, wind, mass, h, count):
    """Steps of Euler's rule: first speeds, then with these places and attitude, which turns about the axis of the rates."""
    s = s.copy()
    for _ in range(count):
        change, _ = derivative(s, commands, wind, mass)
        s[3:6] += h * change[3:6]
        s[10:] += h * change[10:]
        s[:3] += h * s[3:6]
        p, q, r = s[10] * h / 2, s[11] * h / 2, s[12] * h / 2
        x, y, z, w = s[6], s[7], s[8], s[9]
        half = sqrt(p * p + q * q + r * r)
        part, whole = (np.sin(half) / half if half > 0 else 1.0), np.cos(half)
        p, q, r = p * part, q * part, r * part
        s[6] = x * whole + w * p + y * r - z * q
        s[7] = y * whole + w * q - x * r + z * p
        s[8] = z * whole + w * r + x * q - y * p
        s[9] = w * whole - x * p - y * q - z * r
        s[6:10] /= sqrt(s[6] * s[6] + s[7] * s[7] + s[8] * s[8] + s[9] * s[9])
    return s


def check() -> float:
    """The largest difference from the package's derivative on random states, in parts of the largest entry."""
    random, worst = np.random.default_rng(1), 0.0
    for _ in range(20):
        state = random.normal(size=17) * ([1] * 10 + [8] * 3 + [0] * 4)
        state[6:10] /= np.linalg.norm(state[6:10])
        state[13:], commands = random.uniform(0, speed_of(MOST), (2, 4))
        pos, quat, vel, rates, speeds = (state[part] for part in (slice(3), slice(6, 10), slice(3, 6), slice(10, 13), slice(13, 17)))
        parts = dynamics(pos, quat, vel, rates, commands, speeds, **PARAMETERS)
        expected = np.concatenate([parts[0], parts[2], parts[3], parts[4]])
        own, _ = Brushless().derivative(state, commands)
        own = np.delete(own, slice(6, 10))
        worst = max(worst, float(np.max(np.abs(own - expected) / np.maximum(1, np.abs(expected)))))
    if worst > 1e-9:
        raise AssertionError(f"the world is not that of drone-models: {worst}")
    return worst


check()
