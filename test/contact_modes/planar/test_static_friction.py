# SPDX-License-Identifier: Apache-2.0
"""Static friction in the plane: closed forms of rest and of the beginning of sliding, and errors by name."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from contact_dynamics import (
    Body,
    BodyState,
    Contact,
    ContactSet,
    ModeVerdict,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarWrench,
    SpatialContactProblem,
    Surface,
    planar_impact,
)
from contact_dynamics.contact import ContactUncertainty
from contact_dynamics.contact_modes import contact_modes, geometry_margins, mode_margins, statics, wrench_sets
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.plane.types import PlanarVelocity
from contact_dynamics.shapes import Obstacle, box_vertices

KINETIC, STATIC = 0.3, 0.5
G = 9.81
EXACT = 1e-12


def block(
    *, force: tuple[float, float], half: float = 0.2, high: float = 0.1, at: float = 0.0
) -> PlanarContactProblem:
    """Return a block of 1 kg on a floor under a force that acts at a height above its centre, m."""
    feet = [
        PlanarContact(r=(x, -high), normal=(0.0, 1.0), friction=KINETIC, static_friction=STATIC)
        for x in (-half, half)
    ]
    inertia = (half**2 + high**2) / 3.0
    wrench = PlanarWrench(f=force, moment=-at * force[0])
    return PlanarContactProblem(body=PlanarBody(mass=1.0, inertia=inertia), contacts=feet, wrench=wrench)


def on_incline(slope: float) -> PlanarContactProblem:
    return block(force=(G * math.sin(slope), -G * math.cos(slope)))


@pytest.mark.parametrize(
    ("tangent", "modes"),
    [(0.29, {"ff"}), (0.31, {"ff", "rr"}), (0.49, {"ff", "rr"}), (0.51, {"rr"})],
)
def test_a_block_on_an_incline(tangent: float, modes: set[str]) -> None:
    slope = math.atan(tangent)
    problem = on_incline(slope)
    answer = contact_modes(problem)
    assert {mode.mode for mode in answer.modes} == modes
    assert (answer.verdict == ModeVerdict.INDETERMINATE) == (len(modes) == 2)
    for mode in answer.modes:
        slides = mode.mode == "rr"
        expected = G * (math.sin(slope) - KINETIC * math.cos(slope)) if slides else 0.0
        assert mode.acceleration == pytest.approx((expected, 0.0), abs=EXACT)
    equilibrium = {1: "CERTAIN" if modes == {"ff"} else "NO", 2: "POSSIBLE"}[len(modes)]
    assert statics(problem).equilibrium.name == equilibrium


def test_margins_of_rest_and_of_sliding_are_the_distances_to_their_own_cones() -> None:
    """Both contacts bear load whichever way the wrench changes by so little, so that forces alone count."""
    push = 0.4 * G
    problem = block(force=(push, -G), half=0.4, high=0.02, at=-0.02)
    margins = {one.mode: one for one in mode_margins(problem, margin_length=1e-3)}
    resting = (STATIC * G - push) / math.hypot(1.0, STATIC)
    sliding = (push - KINETIC * G) / math.hypot(1.0, KINETIC)
    assert margins["ff"].margin == pytest.approx(resting, rel=1e-9)
    assert margins["ff"].modes_beyond == ("rr",)
    assert margins["rr"].margin == pytest.approx(sliding, rel=1e-9)
    assert margins["rr"].modes_beyond == ("ff",)
    inside = {one.mode for one in wrench_sets(problem) if one.depth(problem.wrench, 0.1) > 0.0}
    assert inside == {"ff", "rr"}


def test_a_high_box_tips_where_a_low_one_may_slide() -> None:
    """Pushed at its centre with 0.45 of its weight, it tips if half its width is less than 0.45 of h / 2."""
    low = contact_modes(block(force=(0.45 * G, -G), half=0.2, high=0.2))
    assert {mode.mode for mode in low.modes} == {"ff", "rr"}
    # A high box cannot rest. It tips about its front foot, which sticks with static friction alone.
    high = contact_modes(block(force=(0.45 * G, -G), half=0.2, high=0.5))
    assert "sf" in {mode.mode for mode in high.modes}
    assert "ff" not in {mode.mode for mode in high.modes}
    kinetic = [replace(one, static_friction=None) for one in high.problem.contacts]
    without = contact_modes(replace(high.problem, contacts=kinetic))
    assert {mode.mode for mode in high.modes} - {mode.mode for mode in without.modes} == {"sf"}


@pytest.mark.parametrize(
    ("cotangent", "modes"), [(0.59, {"ff"}), (0.61, {"ff", "ll"}), (0.99, {"ff", "ll"}), (1.01, {"ll"})]
)
def test_a_ladder_against_a_smooth_wall(cotangent: float, modes: set[str]) -> None:
    """Its foot rests up to a cotangent of 2 mu_s, and can begin to slide from one of 2 mu_k on."""
    angle = math.atan2(1.0, cotangent)
    arm = (math.cos(angle), math.sin(angle))  # m, of a uniform ladder of 2 m
    foot = PlanarContact(r=(-arm[0], -arm[1]), normal=(0.0, 1.0), friction=KINETIC, static_friction=STATIC)
    top = PlanarContact(r=arm, normal=(-1.0, 0.0), friction=0.0)
    problem = PlanarContactProblem(
        body=PlanarBody(mass=1.0, inertia=1.0 / 3.0), contacts=[foot, top], wrench=PlanarWrench(f=(0.0, -G))
    )
    assert {mode.mode for mode in contact_modes(problem).modes} == modes


def test_errors_of_contacts_move_both_coefficients() -> None:
    for friction, certain in ((0.02, True), (0.11, False)):
        uncertain = ContactUncertainty(frictions=friction)
        within = contact_modes(replace(block(force=(0.4 * G, -G)), uncertainty=uncertain)).within
        assert within is not None
        assert within.certain == certain
        assert set(within.verdicts) >= {ModeVerdict.INDETERMINATE}
    frictions = geometry_margins(block(force=(0.4 * G, -G)))[2]
    assert frictions.holds_within <= 0.1 <= frictions.changes_at


def test_impacts_have_kinetic_friction() -> None:
    tip = PlanarContact(r=(-0.3, -0.4), normal=(0.0, 1.0), friction=KINETIC, restitution=0.5)
    velocity, rod = PlanarVelocity(v=(0.5, -1.0), w=0.3), PlanarBody(mass=1.0, inertia=0.2)
    one, other = (planar_impact(rod, velocity, each) for each in (tip, replace(tip, static_friction=STATIC)))
    assert one == other


FLOOR = {"name": "floor", "normal_W": [0, 0, 1], "p_WS_W": [0, 0, 0], "friction": 0.3, "restitution": 0.0}
TABLE = {"name": "table", "vertices_W": box_vertices((1, 1, 1)), "friction": 0.3, "restitution": 0.0}
POINT = {"p_WC_W": [0, 0, 0], "normal_W": [0, 0, 1], "friction": 0.3}
PLANAR = {"r": (0.0, -1.0), "normal": (0.0, 1.0), "friction": 0.3}
SET = {"p_WC_W": [[0, 0, 0], [1, 0, 0]], "normals_W": [0, 0, 1], "frictions": [0.2, 0.3]}


@pytest.mark.parametrize(
    ("made", "fields"), [(Surface, FLOOR), (Obstacle, TABLE), (Contact, POINT), (PlanarContact, PLANAR)]
)
@pytest.mark.parametrize("value", [math.nan, math.inf, -0.1, 0.29])
def test_static_friction_that_is_no_number_or_too_small_is_refused_by_name(
    made: type, fields: dict[str, object], value: float
) -> None:
    with pytest.raises(ContactDynamicsError, match=r"^static_friction must be "):
        made(**fields, static_friction=value)
    assert made(**fields, static_friction=0.3).static_friction == 0.3
    assert made(**fields).static_friction is None


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ([0.3, 0.29], r"static_frictions\[1\] must be at least frictions\[1\], which is 0.3, got 0.29"),
        ([0.3, math.nan], r"static_frictions"),
        ([0.3], r"static_frictions must be of shape \(2,\)"),
        (-1.0, r"static_frictions\[0\] must be at least frictions\[0\], which is 0.2, got -1"),
    ],
)
def test_static_frictions_of_a_set_are_checked_each(values: object, words: str) -> None:
    with pytest.raises(ContactDynamicsError, match=words):
        ContactSet(**SET, static_frictions=values)


def test_a_set_and_its_contacts_have_the_same_coefficients() -> None:
    contacts = ContactSet(**SET, static_frictions=0.5)
    assert contacts.holding_frictions.tolist() == contacts.static_frictions.tolist() == [0.5, 0.5]
    assert [one.static_friction for one in contacts] == [0.5, 0.5]
    assert ContactSet.of(list(contacts)).static_frictions.tolist() == [0.5, 0.5]
    assert contacts.subset([1]).static_frictions.tolist() == [0.5]
    mixed = ContactSet.of([Contact(**POINT), Contact(**POINT, static_friction=0.4)])
    assert mixed.static_frictions.tolist() == [0.3, 0.4]
    assert ContactSet(**SET).static_frictions is None
    assert ContactSet(**SET).holding_frictions.tolist() == [0.2, 0.3]


def test_a_problem_in_space_has_the_modes_of_the_plane() -> None:
    """Four feet of a block are seen as the two in its plane of motion."""
    body = Body.box((0.4, 0.2, 0.2), mass=1.0)
    feet = ContactSet(
        p_WC_W=[[x, y, -0.1] for x in (-0.2, 0.2) for y in (-0.1, 0.1)],
        normals_W=[0, 0, 1],
        frictions=KINETIC,
        static_frictions=STATIC,
    )
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    problem = SpatialContactProblem(body=body, state=state, contacts=feet, force_W=[0.4 * G, 0, -G])
    assert {mode.mode for mode in contact_modes(problem).modes} == {"ffff", "cccc"}
