# SPDX-License-Identifier: Apache-2.0
"""Modes that hold narrowly: contacts that have just used up their friction begin to slide, however slowly.

The exact answers are those of a plate that turns about one of its edges, and of a box that is pushed.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties
from contact_dynamics.contact_modes import ModeVerdict, SpatialModeAnswer, contact_modes
from contact_dynamics.tolerances import NARROWLY
from contact_modes.evidence import spatial_problem

G = 9.81
THICK, WIDE, HIGH = 0.04, 0.1, 0.2
MASS = 0.5
SHARES = [10.0**exponent for exponent in range(-14, -2)]
BOX = MassProperties(mass=1.0, I_B=np.diag([0.0043, 0.0043, 0.0053]))
ROUNDING_OF_LOAD = 1e-14  # as a share of the weight: some 50 roundings, in the sum of four forces and a push
FEET = np.array([[x, y, 0.0] for x in (-0.1, 0.1) for y in (-0.1, 0.1)])


def turning_plate(share: float) -> SpatialModeAnswer:
    """Ask about a plate that turns about an edge, with a share more friction than keeps that edge still."""
    angle, spin = 0.6, 3.0  # rad from upright, towards +x, and rad/s about +y
    half = np.array([-0.5 * THICK, 0.5 * HIGH])  # the centre of mass beside the edge, upright
    x = half[0] * math.cos(angle) + half[1] * math.sin(angle)
    z = -half[0] * math.sin(angle) + half[1] * math.cos(angle)
    inertia = MASS / 12.0 * np.array([WIDE**2 + HIGH**2, THICK**2 + HIGH**2, THICK**2 + WIDE**2])
    alpha = MASS * G * x / (inertia[1] + MASS * (x * x + z * z))
    a_x, a_z = alpha * z - spin**2 * x, -alpha * x - spin**2 * z
    needed = abs(a_x) / (a_z + G)
    state = BodyState(
        p_WB_W=[x, 0.0, z],
        q_WB=[0.0, math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)],
        v_WB_W=[spin * z, 0.0, -spin * x],
        w_WB_W=[0.0, spin, 0.0],
    )
    corners = ContactSet(
        p_WC_W=[[0.0, -0.5 * WIDE, 0.0], [0.0, 0.5 * WIDE, 0.0]],
        normals_W=[0.0, 0.0, 1.0],
        frictions=needed * (1.0 + share),
    )
    return contact_modes(
        spatial_problem(
            MassProperties(mass=MASS, I_B=np.diag(inertia)), state, corners, [0.0, 0.0, -MASS * G]
        )
    )


def pushed_box(share: float, heading: float = 0.3) -> SpatialModeAnswer:
    """Ask about a box that is pushed through its centre of mass, by a share more than friction takes."""
    push = 0.3 * 9.8 * (1.0 + share) * np.array([math.cos(heading), math.sin(heading)])
    return contact_modes(
        spatial_problem(
            BOX,
            BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1]),
            ContactSet(p_WC_W=FEET, normals_W=[0.0, 0.0, 1.0], frictions=0.3),
            [*push, -9.8],
        )
    )


@pytest.mark.parametrize("share", SHARES)
def test_a_turning_plate_is_never_inconsistent_at_the_end_of_its_friction(share: float) -> None:
    sticks, slides = turning_plate(share), turning_plate(-share)
    assert (sticks.verdict, [mode.mode for mode in sticks.modes]) == (ModeVerdict.UNIQUE, ["ff"])
    letters = [mode.mode for mode in slides.modes]
    assert (slides.verdict, letters[0][0] * 2) == (ModeVerdict.UNIQUE, letters[0])
    if share > 100.0 * NARROWLY:
        assert letters == ["cc"]
        (mode,) = slides.modes
        assert mode.tangential_directions_W @ [-1.0, 0.0, 0.0] == pytest.approx([1.0, 1.0], abs=1e-12)


@pytest.mark.parametrize("share", SHARES)
def test_a_pushed_box_sticks_or_slides_at_the_end_of_its_friction(share: float) -> None:
    sticks, slides = pushed_box(-share), pushed_box(share)
    assert (sticks.verdict, [mode.mode for mode in sticks.modes]) == (ModeVerdict.UNIQUE, ["ffff"])
    assert slides.verdict == ModeVerdict.UNIQUE
    (mode,) = slides.modes
    assert mode.mode in {"ffff", "cccc"}
    if share > 10.0 * NARROWLY:
        assert mode.mode == "cccc"
        assert mode.acceleration_W[:2] == pytest.approx(
            0.3 * 9.8 * share * np.array([math.cos(0.3), math.sin(0.3)]), abs=1e-13 * 9.8
        )
        # The acceleration is a share of the load, which rounds: its direction cannot be known any better.
        assert mode.misdirection <= max(1e-8, ROUNDING_OF_LOAD / (0.3 * share))
