# SPDX-License-Identifier: Apache-2.0
"""Tosses and impacts have the same bits with the compiled core as with the Python that it comes from."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import numpy as np

import contact_dynamics
from contact_dynamics import Body, BodyState, Contact, ContactSet, Surface, World, inertia
from contact_dynamics.impact import (
    RestitutionLaw,
    StrikingBodies,
    impact_sequence,
    planar_impacts,
    response_impacts,
    several_impact,
    spatial_impact,
    spatial_impacts,
    spatial_pair_impact,
)
from contact_dynamics.shapes import ConvexShape, box
from contact_dynamics.toss import Toss, TossUncertainty, sampled_toss, toss

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
    return [*found, sampled_bits(body, state), impact_bits(body)]


def sampled_bits(body: Body, state: BodyState) -> object:
    """Return the bits of samples that are followed to rest, and laid flat on the way."""
    world, covariance = World(surfaces=(FLOOR,), gravity_W=[0, 0, -9.81]), np.diag([1e-4] * 12)
    spread = TossUncertainty(velocity=0.05, spin=0.5)
    found = sampled_toss(
        body, state, world, covariance=covariance, uncertainty=spread, count=20, to_rest=True
    )
    return found.to_dict()


def impact_bits(body: Body) -> list[object]:
    """Return the bits of impacts with every law: many at once, each alone, at several contacts, in time."""
    rng = np.random.default_rng(8)
    n, up = 30, [0.0, 0.0, 1.0]
    q, v = rng.normal(size=(n, 4)), rng.normal(size=(n, 3)) - [0.0, 0.0, 3.0]
    q, w = q / np.linalg.norm(q, axis=1)[:, None], rng.normal(size=(n, 3))
    points, mass = 0.2 * rng.normal(size=(n, 3)), body.mass_properties
    striking = StrikingBodies.of(body, p_WC_W=points, p_WB_W=np.zeros((n, 3)), q_WB=q, v_WB_W=v, w_WB_W=w)
    lands = BodyState(p_WB_W=[0, 0, 0.03], q_WB=[0, 0, 0, 1], v_WB_W=[1, 0.5, -1], w_WB_W=[0.4, 1, 2])
    corners = np.array([[x, y, 0.0] for x in (-0.075, 0.075) for y in (-0.05, 0.05)])
    contacts = ContactSet(p_WC_W=corners, normals_W=up, frictions=0.3, restitutions=0.5)
    ways = rng.normal(size=(n, 3, 3)) * (np.arange(3) <= np.arange(n)[:, None] % 3)[:, None, :]
    points_slide = np.einsum("ijk,ik->ij", ways, rng.normal(size=(n, 3)))  # of one to three freedoms
    falls = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0.6, 0, 0, 0.8], v_WB_W=[1, 0.5, -1], w_WB_W=[0.4, 1, 2])
    world = World(surfaces=(FLOOR,), gravity_W=[0, 0, -9.81])
    found: list[object] = []
    for law in RestitutionLaw:
        many = spatial_impacts(
            striking,
            normals_W=up,
            frictions=0.3,
            restitutions=0.5,
            restitution_laws=law,
            skip_separating=True,
        )
        planar = planar_impacts(
            masses=1.0,
            inertias=0.3,
            v=np.minimum(v[:, 1:], -1.0),
            w=0.1 * w[:, 0],
            r=[0.3, -1.0],
            normals=[0, 1],
            frictions=0.3,
            restitutions=0.5,
            restitution_law=law,
        )
        mechanisms = response_impacts(
            ways @ ways.transpose(0, 2, 1),
            points_slide,
            normals_W=up,
            frictions=0.3,
            restitutions=np.where(np.arange(n) % 3 == 2, 0.5, 0.0),  # others may wedge
            restitution_laws=law,
            skip_separating=True,
        )
        found += [many.to_dict(), planar.to_dict(), mechanisms.to_dict()]
        for i in np.flatnonzero(many.velocities_before_W[:, 2] < 0.0):
            state = BodyState(p_WB_W=[0, 0, 0], q_WB=q[i], v_WB_W=v[i], w_WB_W=w[i])
            contact = Contact(p_WC_W=points[i], normal_W=up, friction=0.3, restitution=0.5)
            found.append(spatial_impact(mass, state, contact, restitution_law=law).to_dict())
            under = BodyState(p_WB_W=points[i] - [0, 0, 0.1], q_WB=q[i - 1])
            pair = spatial_pair_impact(mass, state, mass, under, contact, restitution_law=law)
            found.append(pair.to_dict())
        found.append(several_impact(mass, lands, contacts, restitution_law=law).to_dict())
        found.append(impact_sequence(body, falls, world, restitution_law=law, window=0.2).to_dict())
    return found


def test_the_suite_runs_with_the_compiled_core() -> None:
    package = Path(contact_dynamics.__file__).parent
    for source in package.rglob("*.pxd"):
        name = ".".join(source.relative_to(package.parent).with_suffix("").parts)
        assert (importlib.import_module(name).__file__ or "").endswith(EXTENSION_SUFFIXES[0])


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
