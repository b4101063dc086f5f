# SPDX-License-Identifier: Apache-2.0
"""The worked numbers of lectures 26 and 27 over the services; another process answers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from contact_dynamics_interfaces.msg import Impact
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact
from running_server import Client

ALPHA = math.radians(30.0)
THETA = math.radians(75.0)
ROD = np.array(
    [-4.0 * math.cos(THETA), 0.0, -4.0 * math.sin(THETA)]
)  # contact relative to the centre of mass
OUT_OF_PAGE = (0.0, -1.0, 0.0)  # seen from -y with z up, +x is to the right
PRINTED = 6e-8  # the worked numbers are printed with 7 digits


def planar_request(
    request: PredictContactMode.Request | PredictImpact.Request, r: np.ndarray, mu: float
) -> None:
    """Fill in a body of m = I = 1 at the origin, in the plane of x (right) and z (up), with a contact."""
    request.inertia.m = 1.0
    request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.state_source = request.STATE_EXPLICIT
    request.contact_source = request.CONTACTS_EXPLICIT
    request.contacts.positions = r.tolist()
    request.contacts.normals = [0.0, 0.0, 1.0]
    request.contacts.frictions = [mu]
    request.contacts.restitutions = [0.0]
    use_problem(request, "PLANAR")


def use_problem(request: Any, problem: str) -> None:
    """Ask in the plane of the page, or in space."""
    request.problem = getattr(request, problem)
    normal = OUT_OF_PAGE if problem == "PLANAR" else (0.0, 0.0, 0.0)
    request.plane_normal.x, request.plane_normal.y, request.plane_normal.z = normal


def test_1_inconsistent_rod(client: Client) -> None:
    request = PredictContactMode.Request()
    planar_request(request, ROD, math.tan(ALPHA))
    request.state.linear_velocity.x = -1.0
    answer = client.ask(request)
    assert (answer.status, answer.message) == (answer.OK, "")
    assert answer.verdict == answer.INCONSISTENT
    assert list(answer.modes) == []
    assert "l" in answer.refused_modes
    factor = answer.refusal_amounts[list(answer.refused_modes).index("l")]
    assert answer.refusals[list(answer.refused_modes).index("l")] == answer.NO_SOLUTION
    assert factor == pytest.approx(-0.2376043, abs=PRINTED)


def test_1_the_inconsistency_is_settled_as_an_impact_when_asked(client: Client) -> None:
    request = PredictContactMode.Request(include_impact=True)
    planar_request(request, ROD, math.tan(ALPHA))
    request.state.linear_velocity.x = -1.0
    answer = client.ask(request)
    assert answer.verdict == answer.INCONSISTENT
    (impact,) = answer.impact
    assert impact.jams
    assert impact.impulses[2] > 0.0
    assert impact.kinetic_energy_after < impact.kinetic_energy_before
    assert impact.contact_velocities_after[2] >= 0.0
    request.state.linear_velocity.x = 0.0  # at rest it is consistent, and there is nothing to settle
    assert list(client.ask(request).impact) == []


@pytest.mark.parametrize(("mu", "verdict"), [(0.5179492 - 1e-6, "l"), (0.5179492 + 1e-6, "")])
def test_1_threshold_of_friction(client: Client, mu: float, verdict: str) -> None:
    request = PredictContactMode.Request()
    planar_request(request, ROD, mu)
    request.state.linear_velocity.x = -1.0
    answer = client.ask(request)
    assert [mode.mode for mode in answer.modes] == ([verdict] if verdict else [])


@pytest.mark.parametrize(("mu", "modes"), [(math.tan(ALPHA), ["f", "l"]), (0.5, ["l"])])
def test_2_indeterminate_rod(client: Client, mu: float, modes: list[str]) -> None:
    request = PredictContactMode.Request()
    planar_request(request, ROD, mu)
    request.gravity = request.GRAVITY_NONE
    request.applied_wrench.force.x = -1.0
    answer = client.ask(request)
    assert sorted(mode.mode for mode in answer.modes) == modes
    assert answer.verdict == (answer.INDETERMINATE if len(modes) > 1 else answer.UNIQUE)
    by_letter = {mode.mode: mode for mode in answer.modes}
    np.testing.assert_allclose(by_letter["l"].contact_forces, 0.0, atol=1e-12)
    np.testing.assert_allclose(by_letter["l"].linear_acceleration, [-1.0, 0.0, 0.0], atol=1e-12)
    if "f" in by_letter:
        f_t, _, f_n = by_letter["f"].contact_forces
        assert f_n == pytest.approx(0.235294, abs=5e-7)  # printed with 6 digits
        assert f_t == pytest.approx(0.121870, abs=5e-7)
        assert f_t / f_n == pytest.approx(0.518, abs=5e-4)
    assert "s" in answer.refused_modes


# Rows of lecture 26's table: v_n, v_t; the applied f_t and f_n that make a_t and a_n; verdict, letter, f_t.
# A particle of mass 1 with mu = 0.5: without contact forces the acceleration is the applied force.
TABLE = [
    ("impact", -1.0, 0.0, 0.0, -1.0, "IMPACT", "", 0.0),
    ("leaves", 1.0, 0.0, 0.0, -1.0, "UNIQUE", "s", 0.0),
    ("is lifted", 0.0, 0.0, 0.0, 1.0, "UNIQUE", "s", 0.0),
    ("slides left", 0.0, -1.0, 0.0, -1.0, "UNIQUE", "l", 0.5),
    ("slides right", 0.0, 1.0, 0.0, -1.0, "UNIQUE", "r", -0.5),
    ("begins to slide left", 0.0, 0.0, -0.6, -1.0, "UNIQUE", "l", 0.5),
    ("begins to slide right", 0.0, 0.0, 0.6, -1.0, "UNIQUE", "r", -0.5),
    ("stays", 0.0, 0.0, 0.4, -1.0, "UNIQUE", "f", -0.4),
    ("skims without force", 0.0, 0.0, -1.0, 0.0, "UNIQUE", "l", 0.0),
]


@pytest.mark.parametrize("problem", ["PLANAR", "SPATIAL"])
@pytest.mark.parametrize("row", TABLE, ids=lambda row: row[0])
def test_every_row_of_the_lectures_table(
    client: Client, problem: str, row: tuple[str, float, float, float, float, str, str, float]
) -> None:
    _, v_n, v_t, f_t, f_n, verdict, letter, friction = row
    request = PredictContactMode.Request()
    planar_request(request, np.zeros(3), 0.5)
    use_problem(request, problem)
    request.gravity = request.GRAVITY_NONE
    request.state.linear_velocity.x, request.state.linear_velocity.z = v_t, v_n
    request.applied_wrench.force.x, request.applied_wrench.force.z = f_t, f_n
    answer = client.ask(request)
    assert answer.verdict == getattr(answer, verdict)
    sliding = {"l": "c", "r": "c"} if problem == "SPATIAL" else {}
    assert [mode.mode for mode in answer.modes] == ([sliding.get(letter, letter)] if letter else [])
    if letter in {"l", "r", "f"}:
        (mode,) = answer.modes
        np.testing.assert_allclose(mode.contact_forces, [friction, 0.0, -f_n], atol=1e-7)
    if letter in {"l", "r"} and problem == "SPATIAL":
        side = -1.0 if letter == "l" else 1.0
        np.testing.assert_allclose(mode.tangential_directions, [side, 0.0, 0.0], atol=1e-6)


def test_3_left_drifting_particle(client: Client) -> None:
    epsilon = 0.05
    request = PredictImpact.Request()
    planar_request(request, np.zeros(3), 3.0)
    request.state.linear_velocity.x, request.state.linear_velocity.z = -epsilon, -1.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    np.testing.assert_allclose(answer.impact.impulses, [epsilon, 0.0, 1.0], atol=1e-15)
    after = answer.impact.state_after.linear_velocity
    np.testing.assert_allclose([after.x, after.y, after.z], 0.0, atol=1e-15)


@pytest.mark.parametrize("problem", ["PLANAR", "SPATIAL"])
def test_4_sliding_rod(client: Client, problem: str) -> None:
    request = PredictImpact.Request()
    planar_request(request, np.array([-1.0, 0.0, -4.0]), math.tan(ALPHA))
    use_problem(request, problem)
    request.contacts.restitutions = [0.5]
    request.state.linear_velocity.x = -1.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    impact = answer.impact
    path = np.array(impact.path).reshape(-1, 3)
    events = list(impact.path_events)
    assert impact.outcome == Impact.STICKS_IN_COMPRESSION
    assert impact.jams
    assert path[events.index(Impact.SLIDING_STOPS), 2] == pytest.approx(0.1719704, abs=PRINTED)
    np.testing.assert_allclose(path[events.index(Impact.COMPRESSION_ENDS)], [1 / 9, 0.0, 2 / 9], atol=1e-12)
    np.testing.assert_allclose(impact.impulses, [0.1372549, 0.0, 0.3333333], atol=PRINTED)
    after = impact.state_after
    velocity = after.linear_velocity
    np.testing.assert_allclose(
        [velocity.x, velocity.y, velocity.z], [-0.8627451, 0.0, 0.3333333], atol=PRINTED
    )
    assert -after.angular_velocity.y == pytest.approx(0.2156863, abs=PRINTED)
    np.testing.assert_allclose(impact.contact_velocities_after, [0.0, 0.0, 0.1176471], atol=PRINTED)
    assert impact.kinetic_energy_before - impact.kinetic_energy_after == pytest.approx(0.0490196, abs=PRINTED)
