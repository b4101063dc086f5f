# SPDX-License-Identifier: Apache-2.0
"""The published cube in MuJoCo and in Drake: rollouts of whole tosses, and strikes of a corner in Drake.

Both engines get the body that was calibrated, its gravity and the height of its floor. What is their own is
the contact: friction, how much of the approach comes back, and how soft the contact is. Neither engine has a
coefficient of restitution. It is written as e here and becomes the damping that would leave e of an approach:
of a spring against a wall in MuJoCo, and of an approach with 1 m/s in Drake, to the first order.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, NamedTuple, Protocol

import numpy as np

from contact_dynamics.measured.cube_tosses import CUBE, HALF_SIDE, RATE
from contact_dynamics.rotations.one import rotation_matrix

if TYPE_CHECKING:
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

ROLL_STEP: Final = 1.0 / (8.0 * RATE)
"""s, 0.84 ms. Step of the rollouts, so that each frame falls on a step."""

STRIKE_STEP: Final = 1e-4
"""s. Step of Drake in a strike, as that of MuJoCo."""

LONGEST_STRIKE: Final = 0.03
"""s. By then a strike of a corner is over, or it is none."""

CORNER_BALL: Final = 1e-3
"""m. Radius of the balls that are the cube's corners in Drake, whose boxes touch a floor in one point."""


class Setting(NamedTuple):
    """Contact parameters of an engine."""

    friction: float
    restitution: float
    softness: float
    """MuJoCo: s, time constant. Drake: m/N, compliance."""


class Given(NamedTuple):
    """What the engines are given."""

    body: MassProperties
    centre: FloatArray  # (3,), m, in the cube's axes
    gravity_W: FloatArray
    height: float  # m, of the floor


class CubeEngine(Protocol):
    """An engine that rolls a cube out."""

    @property
    def softness(self) -> float:
        """The softness from which its contact is fitted."""

    def poses(self, state: BodyState, times: FloatArray, setting: Setting) -> tuple[FloatArray, FloatArray]:
        """Return the centres of mass, (n, 3), and attitudes, (n, 4), at times after a state."""


class MujocoCube:
    """MuJoCo with the cube on a floor."""

    softness: Final = 0.004

    def __init__(self, mujoco: Any, given: Given) -> None:
        """Build the model."""
        x, y, z = -given.centre
        side, g = HALF_SIDE, given.gravity_W
        inertia = " ".join(str(x) for x in np.diag(given.body.I_B))
        self._mujoco = mujoco
        self._model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <option timestep="{ROLL_STEP}" integrator="implicitfast" cone="elliptic" impratio="10"
                gravity="{g[0]} {g[1]} {g[2]}"/>
              <worldbody>
                <geom type="plane" size="5 5 1" pos="0 0 {given.height}"/>
                <body>
                  <freejoint/>
                  <inertial pos="0 0 0" mass="{given.body.mass}" diaginertia="{inertia}"/>
                  <geom type="box" pos="{x} {y} {z}" size="{side} {side} {side}"/>
                </body>
              </worldbody>
            </mujoco>""")
        self._data = mujoco.MjData(self._model)

    def poses(self, state: BodyState, times: FloatArray, setting: Setting) -> tuple[FloatArray, FloatArray]:
        """Roll a toss out."""
        model, data = self._model, self._data
        logarithm = math.log(max(setting.restitution, 1e-3))
        model.geom_friction[:, 0] = setting.friction
        model.geom_solref[:] = (
            max(setting.softness, 2.0 * ROLL_STEP),
            -logarithm / math.hypot(math.pi, logarithm),
        )
        self._mujoco.mj_resetData(model, data)
        data.qpos[:] = np.concatenate([state.p_WB_W, np.roll(state.q_WB, 1)])
        data.qvel[:] = np.concatenate([state.v_WB_W, state.R_WB.T @ state.w_WB_W])
        rows, done = [], 0
        for step in np.round(times / ROLL_STEP).astype(int).tolist():
            if step > done:
                self._mujoco.mj_step(model, data, nstep=step - done)
                done = step
            rows.append(data.qpos.copy())
        found = np.array(rows)
        return found[:, :3], np.roll(found[:, 3:], -1, axis=1)


class DrakeCube:
    """Drake with the cube's corners on a floor, in discrete time."""

    softness: Final = 1e-5

    def __init__(self, given: Given, *, step: float = ROLL_STEP) -> None:
        """Take what is given. A model is built for each setting."""
        self._given, self._step = given, step
        self._setting: Setting | None = None

    def poses(self, state: BodyState, times: FloatArray, setting: Setting) -> tuple[FloatArray, FloatArray]:
        """Roll a toss out."""
        self._start(state, setting)
        rows = []
        for time in times.tolist():
            self._simulator.AdvanceTo(time)
            rows.append(self._plant.GetPositions(self._context).copy())
        found = np.array(rows)
        return found[:, 4:], np.roll(found[:, :4], -1, axis=1)

    def velocity_after(self, state: BodyState, setting: Setting) -> FloatArray:
        """Return the velocities, (6,), after a strike, when no corner touches any more."""
        self._start(state, setting)
        arms = CUBE.vertices_B - self._given.centre
        time, touched = 0.0, False
        while time < LONGEST_STRIKE:
            time += 5.0 * self._step
            self._simulator.AdvanceTo(time)
            q = self._plant.GetPositions(self._context)
            lowest = float((arms @ rotation_matrix(np.roll(q[:4], -1)).T)[:, 2].min() + q[6])
            if touched and lowest > self._given.height:
                break
            touched = touched or lowest < self._given.height
        v = self._plant.GetVelocities(self._context)
        return np.concatenate([v[3:], v[:3]])

    def _start(self, state: BodyState, setting: Setting) -> None:
        if setting != self._setting:
            self._build(setting)
        root = self._simulator.get_mutable_context()
        root.SetTime(0.0)
        self._plant.SetPositions(self._context, np.concatenate([np.roll(state.q_WB, 1), state.p_WB_W]))
        self._plant.SetVelocities(self._context, np.concatenate([state.w_WB_W, state.v_WB_W]))
        self._simulator.Initialize()

    def _build(self, setting: Setting) -> None:
        from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties, Sphere
        from pydrake.math import RigidTransform
        from pydrake.multibody.plant import (
            AddMultibodyPlantSceneGraph,
            CoulombFriction,
            DiscreteContactApproximation,
        )
        from pydrake.multibody.tree import SpatialInertia, UnitInertia
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=self._step)
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kLagged)
        given, mass = self._given, self._given.body.mass
        unit = UnitInertia(*(np.diag(given.body.I_B) / mass))
        cube = plant.AddRigidBody("cube", SpatialInertia(mass, np.zeros(3), unit))
        material = ProximityProperties()
        AddContactMaterial(
            dissipation=-1.5 * math.log(max(setting.restitution, 1e-6)),
            point_stiffness=1.0 / setting.softness,
            friction=CoulombFriction(setting.friction, setting.friction),
            properties=material,
        )
        floor = RigidTransform(np.array([0.0, 0.0, given.height]))
        plant.RegisterCollisionGeometry(plant.world_body(), floor, HalfSpace(), "floor", material)
        for i, corner in enumerate(CUBE.vertices_B):
            inner = corner - CORNER_BALL * np.sign(corner) - given.centre
            plant.RegisterCollisionGeometry(
                cube, RigidTransform(inner), Sphere(CORNER_BALL), f"corner{i}", material
            )
        plant.mutable_gravity_field().set_gravity_vector(given.gravity_W)
        plant.Finalize()
        self._simulator = Simulator(builder.Build())
        self._plant, self._setting = plant, setting
        self._context = plant.GetMyMutableContextFromRoot(self._simulator.get_mutable_context())


def engines(given: Given) -> dict[str, CubeEngine]:
    """Return the engines that are installed."""
    found: dict[str, CubeEngine] = {}
    try:
        import mujoco  # a peer, which need not be there

        found["MuJoCo"] = MujocoCube(mujoco, given)
    except ImportError:
        pass
    try:
        import pydrake  # noqa: F401  a peer, which need not be there

        found["Drake"] = DrakeCube(given)
    except ImportError:
        pass
    return found
