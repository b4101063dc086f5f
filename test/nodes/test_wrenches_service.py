# SPDX-License-Identifier: Apache-2.0
"""Margins, wrench sets and statics over the service beside closed forms: a block, a tray, a grasp, a peg."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from contact_dynamics_interfaces.srv import PredictContactMode
from running_server import Client

MASS, G = 2.0, 9.80665
WEIGHT = MASS * G
HALF_BASE, HEIGHT, MU = 0.5, 0.25, 0.5  # of the block: its centre of mass is that high
UP, DOWN, RIGHT, LEFT = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)


def touching(contacts: Sequence[tuple[float, float, tuple[float, ...]]], mu: float = MU) -> Any:
    """A body at the origin that touches the world at points of the plane of x and z."""
    request = PredictContactMode.Request(problem=PredictContactMode.Request.PLANAR)
    request.inertia.m = MASS
    request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 0.5
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.contacts.positions = [number for x, z, _ in contacts for number in (x, 0.0, z)]
    request.contacts.normals = [number for _, _, normal in contacts for number in normal]
    request.contacts.frictions = [mu] * len(contacts)
    request.contacts.restitutions = [0.0] * len(contacts)
    request.plane_normal.y = -1.0
    return request


def block() -> Any:
    return touching([(-HALF_BASE, -HEIGHT, UP), (HALF_BASE, -HEIGHT, UP)])


def tray(mu: float = 0.25) -> Any:
    """Two points on the floor and one at each wall, the right one higher, so that turning lifts that side."""
    return touching([(-1.0, -0.2, UP), (1.0, -0.2, UP), (-1.2, 0.2, RIGHT), (1.2, 0.4, LEFT)], mu)


def apply(request: Any, wrench: np.ndarray) -> Any:
    force, torque = request.applied_wrench.force, request.applied_wrench.torque
    force.x, force.y, force.z, torque.x, torque.y, torque.z = wrench.tolist()
    return request


def found(answer: Any) -> list[str]:
    assert answer.status == answer.OK, answer.message
    return [mode.mode for mode in answer.modes]


# ---------------------------------------------------------------------------------------------- margins


@pytest.mark.parametrize(
    ("length", "margin", "beyond"),
    [
        # A torque costs next to nothing: the block tips at the torque of its weight about a foot.
        (1e3, WEIGHT * HALF_BASE / 1e3, {"fs", "sf"}),
        # It costs all there is: the block slides, at right angles to the edge of its friction cone.
        (1e-3, WEIGHT * MU / math.hypot(1.0, MU), {"ll", "rr"}),
    ],
)
def test_margins_of_a_block_to_tipping_and_sliding(
    client: Client, length: float, margin: float, beyond: set[str]
) -> None:
    request = block()
    request.include_margins, request.margin_length = True, length
    (mode,) = client.ask(request).modes
    assert mode.mode == "ff"
    assert mode.margin == pytest.approx(margin, rel=1e-4)  # the other way out costs a little, not nothing
    assert mode.margin_length == length
    assert {*mode.margin_modes} <= beyond
    assert len(mode.margin_modes) == 1


@pytest.mark.parametrize("seed", range(6))
def test_every_margin_in_a_tray_leads_to_the_modes_that_it_foretells(client: Client, seed: int) -> None:
    """The walls of so slippery a tray do not wedge the body, so that every mode has an end."""
    chance = np.random.default_rng(seed)
    pushed = chance.uniform(-15.0, 15.0, 6) * [1.0, 0.0, 1.0, 0.0, 1.0, 0.0]
    request = apply(tray(0.05), pushed)
    request.include_margins = True
    answer = client.ask(request)
    assert found(answer)
    for mode in answer.modes:
        change = np.array(mode.margin_wrench)
        size = math.hypot(*change[:3], float(np.linalg.norm(change[3:])) / mode.margin_length)
        assert 0.0 < mode.margin == pytest.approx(size, rel=1e-9)
        assert mode.mode in found(client.ask(apply(tray(0.05), pushed + 0.9999 * change)))
        beyond = client.ask(apply(tray(0.05), pushed + 1.0001 * change))
        assert found(beyond) == list(mode.margin_modes)
        assert mode.mode not in found(beyond)
        assert beyond.verdict == mode.margin_verdict


def test_a_wedged_body_has_no_margin_to_lose(client: Client) -> None:
    request = tray()
    request.include_margins = True
    by_mode = {mode.mode: mode for mode in client.ask(request).modes}
    assert math.isinf(by_mode["ffff"].margin)
    np.testing.assert_array_equal(by_mode["ffff"].margin_wrench, 0.0)


# ------------------------------------------------------------------------------------------ wrench sets


def test_the_tray_has_a_map_of_its_modes(client: Client) -> None:
    """What the generators of each mode make brings it about: lecture 26's `rsrs` among them."""
    request = tray()
    request.gravity = request.GRAVITY_NONE
    request.include_wrenches = True
    answer = client.ask(request)
    assert [one.mode for one in answer.wrench_sets] == sorted(answer.kinematic_modes)
    assert {"ffff", "rsrs", "ssss"} <= set(answer.kinematic_modes)
    assert len(answer.wrench_sets) <= 4 * 4 + 2
    for one in answer.wrench_sets:
        generators = np.array(one.generators).reshape(-1, 6)
        wrench = (generators / np.linalg.norm(generators, axis=1)[:, None]).sum(axis=0)
        asked = apply(tray(), wrench)
        asked.gravity = asked.GRAVITY_NONE
        assert one.mode in found(client.ask(asked))


def test_the_blocks_set_of_holding_wrenches_is_that_of_its_feet(client: Client) -> None:
    """Fixed: F_z <= 0, |F_x| <= mu |F_z|, and the line of force meets the floor between the feet."""
    request = block()
    request.include_wrenches = True
    answer = client.ask(request)
    (held,) = [one for one in answer.wrench_sets if one.mode == "ff"]
    sides = np.array(held.half_spaces).reshape(-1, 7)
    np.testing.assert_allclose(sides[:, 6], 0.0, atol=1e-12)
    # The moment in the plane is -M_y, as its normal is -y. About the right foot, b aside and h below, it is
    # -M_y - b F_z - h F_x, and must not tip the block over it.
    expected = [
        (1.0, 0.0, MU, 0.0, 0.0, 0.0),
        (-1.0, 0.0, MU, 0.0, 0.0, 0.0),
        (HEIGHT, 0.0, HALF_BASE, 0.0, 1.0, 0.0),
        (-HEIGHT, 0.0, HALF_BASE, 0.0, -1.0, 0.0),
    ]
    units = {tuple(np.round(row / np.linalg.norm(row), 9) + 0.0) for row in sides[:, :6]}
    assert units == {tuple(np.round(row / np.linalg.norm(row), 9) + 0.0) for row in np.array(expected)}


def brick_in_space() -> Any:
    """The configured brick, flat on the configured floor, pushed askew to its axes so that it slides."""
    request = PredictContactMode.Request(body_name="brick", include_wrenches=True)
    request.state_source, request.state.pose.position.z = request.STATE_EXPLICIT, 0.025
    request.applied_wrench.force.x = request.applied_wrench.force.y = 1.0
    return request


def test_a_brick_pushed_askew_has_a_map_in_space(client: Client) -> None:
    """The applied wrench is inside a set of the mode that it brings about, which slides along the push."""
    answer = client.ask(brick_in_space())
    assert (answer.status, answer.problem) == (answer.OK, PredictContactMode.Request.SPATIAL), answer.message
    assert (answer.friction_facets, answer.wrench_facets) == (8, 4)
    weight = 0.4 * G
    wrench = np.array([1.0, 1.0, -weight, 0.0, 0.0, 0.0])
    holding = []
    for one in answer.wrench_sets:
        sides = np.array(one.half_spaces).reshape(-1, 7)
        ranges = np.array(one.sliding_from).reshape(-1, 3), np.array(one.sliding_to).reshape(-1, 3)
        assert ranges[0].shape == ranges[1].shape == (4, 3)
        made = np.array(one.generators).reshape(-1, 6).sum(axis=0)
        assert (sides[:, :6] @ made <= sides[:, 6] + 1e-9 * np.abs(made).max()).all()
        if (sides[:, :6] @ wrench < sides[:, 6] - 1e-6).all():
            holding.append((one.mode, ranges))
    assert [mode for mode, _ in holding] == ["cccc"]
    (low, high) = holding[0][1]
    push = np.array([math.sqrt(0.5), math.sqrt(0.5), 0.0])
    turn = math.pi / 4.0  # half a sector of a pyramid of four edges, the first of which opposes the push
    np.testing.assert_allclose(low @ push, math.cos(turn), atol=1e-9)
    np.testing.assert_allclose(np.cross(low, high)[:, 2], math.sin(2.0 * turn), atol=1e-9)
    assert {one.mode for one in answer.wrench_sets} >= {"ssss", "ffff", "cccc", "ssff"}


def test_facets_of_a_map_in_space_are_those_asked_for_and_too_many_are_refused(client: Client) -> None:
    request = brick_in_space()
    request.friction_facets = 3
    answer = client.ask(request)
    assert (answer.status, answer.friction_facets, answer.wrench_facets) == (answer.OK, 3, 3)
    request.friction_facets = 16
    answer = client.ask(request)
    assert answer.status == answer.TOO_LARGE
    assert "fewer friction_facets" in answer.message


# ---------------------------------------------------------------------------------------------- statics


def statics(client: Client, request: Any) -> Any:
    request.include_statics = True
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    return answer


def test_a_block_is_stable_against_disturbances_up_to_a_size(client: Client) -> None:
    """Pushed at its centre by F: distances to tipping over the far foot and to sliding, in closed form."""
    length, push = 0.4, 3.0
    request = apply(block(), np.array([push, 0.0, 0.0, 0.0, 0.0, 0.0]))
    request.margin_length = length
    answer = statics(client, request)
    assert (answer.equilibrium, answer.jammed, answer.wedged) == (
        answer.CERTAIN,
        answer.CERTAIN,  # without friction it would slide off
        answer.NO,
    )
    to_sliding = (MU * WEIGHT - push) / math.hypot(1.0, MU)
    to_tipping = (HALF_BASE * WEIGHT - HEIGHT * push) / math.hypot(HALF_BASE, HEIGHT, length)
    # The metric |f|^2 + (M / L)^2: a row's moment part weighs L.
    to_tipping *= math.hypot(HALF_BASE, HEIGHT, length) / math.sqrt(HALF_BASE**2 + HEIGHT**2 + length**2)
    assert answer.stable_disturbance == pytest.approx(min(to_sliding, to_tipping), rel=1e-9)


def test_a_block_without_a_push_needs_no_friction_and_one_pushed_too_hard_is_not_held(client: Client) -> None:
    at_rest = statics(client, block())
    assert (at_rest.equilibrium, at_rest.jammed) == (at_rest.CERTAIN, at_rest.NO)
    pushed = statics(client, apply(block(), np.array([1.001 * MU * WEIGHT, 0.0, 0.0, 0.0, 0.0, 0.0])))
    assert (pushed.equilibrium, pushed.jammed) == (pushed.NO, pushed.NO)
    assert math.isnan(pushed.stable_disturbance)


@pytest.mark.parametrize("offset", [0.99, 1.01])
def test_two_fingers_wedge_a_body_within_both_cones(client: Client, offset: float) -> None:
    """Nguyen: the line between the fingers lies in both cones, at an offset below mu times their distance."""
    rise = offset * MU
    answer = statics(client, touching([(-1.0, -rise, RIGHT), (1.0, rise, LEFT)]))
    holds = offset < 1.0
    assert answer.wedged == (answer.POSSIBLE if holds else answer.NO)
    assert math.isinf(answer.stable_disturbance) == holds
    assert (answer.equilibrium != answer.NO) == holds
    if holds:
        assert answer.jammed == answer.equilibrium, "its weight hangs on friction alone"


@pytest.mark.parametrize("part", [0.999, 1.001])
def test_a_peg_jams_at_whitneys_line(client: Client, part: float) -> None:
    """Two-point contact at depth l: held from M / (r F_z) = -lambda on, pushed down along its axis."""
    radius, depth, push = 1.0, 3.0, 10.0
    ratio = depth / (2.0 * radius * MU)
    request = touching([(-radius, 0.0, RIGHT), (radius, depth, LEFT)])
    request.gravity = request.GRAVITY_NONE
    # The moment in the plane, seen along +y, is -M_y.
    wrench = np.array([0.0, 0.0, -push, 0.0, part * ratio * radius * push, 0.0])
    answer = statics(client, apply(request, wrench))
    assert (answer.equilibrium != answer.NO) == (part > 1.0)
    assert answer.jammed == answer.equilibrium
    assert answer.wedged == answer.NO
