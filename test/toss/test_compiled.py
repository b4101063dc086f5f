# SPDX-License-Identifier: Apache-2.0
"""The compiled core of tosses gives the same bits as the Python that it comes from."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import numpy as np

from contact_dynamics import Body, BodyState, Surface, World, inertia
from contact_dynamics.shapes import box
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.toss import Toss, TossUncertainty, sampled_toss, solid, toss

SIZE = (0.15, 0.1, 0.06)
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.3)
RAMP = Surface(name="ramp", p_WS_W=[-0.2, 0, 0], normal_W=[0.6, 0, 0.8], friction=0.5, restitution=0.1)


def bits(went: Toss) -> list[object]:
    """Return all events of a toss, and its motion between them."""
    found: list[object] = [went.end.name]
    for event in went.events:
        state = event.state
        found += [event.seconds, event.kind.name, event.mode, event.corners, event.impulse_W.tolist()]
        found += [state.p_WB_W.tolist(), state.q_WB.tolist(), state.v_WB_W.tolist(), state.w_WB_W.tolist()]
    return [*found, went.at(np.linspace(0.0, went.seconds, 20)).p_WB_W.tolist()]


def drawn() -> list[object]:
    """Return the bits of tosses of a box with sharp corners and with round ones, onto one flat and two."""
    rng = np.random.default_rng(6)
    found: list[object] = []
    for rounding in (0.0, 0.01):
        shape = ConvexShape(vertices=(1.0 - 20.0 * rounding) * box(size=SIZE).vertices, rounding=rounding)
        mass = inertia.box(size=SIZE, mass=0.4).mass_properties
        for surfaces in ((FLOOR,), (FLOOR, RAMP)):
            q = rng.normal(size=4)
            state = BodyState(
                p_WB_W=[0, 0, 0.3],
                q_WB=q / np.linalg.norm(q),
                v_WB_W=rng.normal(size=3),
                w_WB_W=6.0 * rng.normal(size=3),
            )
            body = Body(name="box", mass_properties=mass, shape=shape)
            found += bits(toss(body, state, World(surfaces=surfaces, gravity_W=[0, 0, -9.81])))
    return [*found, sampled_bits(body, state)]


def sampled_bits(body: Body, state: BodyState) -> object:
    """Return the bits of samples that are followed to rest, and laid flat on the way."""
    world, covariance = World(surfaces=(FLOOR,), gravity_W=[0, 0, -9.81]), np.diag([1e-4] * 12)
    spread = TossUncertainty(velocity=0.05, spin=0.5)
    found = sampled_toss(
        body, state, world, covariance=covariance, uncertainty=spread, count=20, to_rest=True
    )
    return found.to_dict()


def test_tosses_run_with_the_compiled_core() -> None:
    for source in Path(solid.__file__ or "").parent.glob("*.pxd"):
        module = sys.modules[f"contact_dynamics.toss.{source.stem}"]
        assert (module.__file__ or "").endswith(EXTENSION_SUFFIXES[0])


def test_compiled_and_plain_give_the_same_bits() -> None:
    plain = subprocess.run(
        [sys.executable, Path(__file__)],
        env={
            **os.environ,
            "CONTACT_DYNAMICS_PLAIN": "1",
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        },
        capture_output=True,
        text=True,
        check=True,
    )
    assert plain.stdout == f"{drawn()}\n"


if __name__ == "__main__":
    sys.stdout.write(f"{drawn()}\n")
