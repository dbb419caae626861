"""RotorPy's Crazyflie once more, in MuJoCo: the same drone in an independent simulator.

MuJoCo has the rigid body, the levers, the motion at each rotor, the integration in steps of 0.25 ms and the inertial
sensor. Thrust, rotor drag, inflow, yaw moments and the motors' lag are written anew, from RotorPy's description and with its
parameters. What RotorPy's and MuJoCo's flights have in common is the drone, and none of the equations of its motion.
"""

from __future__ import annotations

from math import exp, sqrt

import mujoco
import numpy as np
from numba import njit

from world import CRAZYFLIE, HOVER, World

from rotorpy.vehicles.crazyflie_params import quad_params as P

SUBSTEP = 0.25e-3
PLACES = [P["rotor_pos"][f"r{rotor}"] for rotor in (1, 2, 3, 4)]
#: Drag along the axes of a rotor, over its speed and that of the air, which also lessens thrust.
DRAG = (P["k_d"], P["k_d"], P["k_z"])
THRUST, YAW, WAYS = P["k_eta"], P["k_m"], P["rotor_directions"]
#: A body of the drone's mass. At each rotor a sensor of velocity, three forces, and a moment about the rotor's axis.
MODEL = """
<mujoco>
  <option gravity="0 0 -9.81"/>
  <worldbody>
    <body name="drone">
      <freejoint/>
      <inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/>
      <site name="sensor"/>
      {sites}
    </body>
  </worldbody>
  <actuator>{forces}</actuator>
  <sensor><gyro site="sensor"/><accelerometer site="sensor"/>{velocities}</sensor>
</mujoco>
"""


def model(mass: float) -> mujoco.MjModel:
    """The drone of this mass, in kg."""
    text = lambda numbers: " ".join(map(repr, map(float, numbers)))
    gears = ["1 0 0 0 0 0", "0 1 0 0 0 0", "0 0 1 0 0 0", "0 0 0 0 0 1"]
    made = mujoco.MjModel.from_xml_string(
        MODEL.format(
            mass=mass,
            sites="".join(f'<site name="{at}" pos="{text(place)}"/>' for at, place in enumerate(PLACES)),
            forces="".join(f'<general site="{at}" gear="{gear}"/>' for at in range(4) for gear in gears),
            velocities="".join(f'<velocimeter site="{at}"/>' for at in range(4)),
        )
    )
    # MuJoCo refuses them in the text: Izz is 1 % more than Ixx + Iyy, which no rigid body's can exceed.
    made.body_inertia[1] = P["Ixx"], P["Iyy"], P["Izz"]
    mujoco.mj_setConst(made, mujoco.MjData(made))
    return made


class Third(World):
    """A drone in the air. `mass` is a factor on the Crazyflie's, `weak` one on the thrust of its first motor."""

    drone = CRAZYFLIE

    def __init__(self, mass: float = 1.0, weak: float = 1.0):
        self.model = model(P["mass"] * mass)
        self.data = mujoco.MjData(self.model)
        # Windows on MuJoCo's own memory: the rotors' velocities, the body's turn, and the forces.
        self.places = self.data.sensordata[6:], self.data.xmat[1], self.data.ctrl
        self.weak, self.speeds = sqrt(weak), np.full(4, HOVER)
        self.wind = (0.0, 0.0, 0.0)
        self._see()

    def step(self, speeds: list[float], seconds: float) -> None:
        """Flies on with these commands to the rotors."""
        commands = np.clip(np.array(speeds, float), P["rotor_speed_min"], P["rotor_speed_max"])
        commands[0] *= self.weak
        count = round(seconds / SUBSTEP)
        self.model.opt.timestep = seconds / count
        # The motors' lag is solved exactly, to the middle of a step for its forces.
        half = exp(-seconds / count / 2 / P["tau_m"])
        for _ in range(count):
            self.speeds = commands + (self.speeds - commands) * half
            mujoco.mj_step1(self.model, self.data)
            self._push()
            mujoco.mj_step2(self.model, self.data)
            self.speeds = commands + (self.speeds - commands) * half
        self._see()

    def _push(self) -> None:
        """Tells MuJoCo the forces of the rotors at their speeds."""
        velocities, turn, forces = self.places
        push(velocities, turn, self.wind, self.speeds, forces)

    def _see(self) -> None:
        """Brings state and sensors up to now."""
        mujoco.mj_step1(self.model, self.data)
        self._push()
        mujoco.mj_forward(self.model, self.data)
        w, x, y, z = self.data.qpos[3:]
        velocity, rates = self.data.qvel[:3], self.data.qvel[3:]
        self.state = np.array([*self.data.qpos[:3], *velocity, x, y, z, w, *rates, *self.speeds])

    def feel(self) -> list[float]:
        """What an ideal inertial sensor at the centre feels: rates in rad/s, then specific force in m/s²."""
        return self.data.sensordata[:6].tolist()


@njit(cache=True)
def push(velocities, turn, wind, speeds, forces):
    """Sets each rotor's forces along the body's axes and its moment, by its speed and that of the air at it."""
    for rotor in range(4):
        speed = speeds[rotor]
        for axis in range(3):
            wind_here = turn[axis] * wind[0] + turn[3 + axis] * wind[1] + turn[6 + axis] * wind[2]
            forces[4 * rotor + axis] = -speed * DRAG[axis] * (velocities[3 * rotor + axis] - wind_here)
        forces[4 * rotor + 2] += THRUST * speed * speed
        forces[4 * rotor + 3] = WAYS[rotor] * YAW * speed * speed
