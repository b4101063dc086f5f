"""Margins in space: closed forms, and the margin's own meaning put to the test."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    ModeVerdict,
    SpatialContactProblem,
    SpatialWrenchSet,
    contact_modes,
    mode_margins,
    wrench_sets,
)
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.rigid_body.body import BodyState, MassProperties

WEIGHT = 20.0
BODY = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
SHORT = 1e-3  # m: with it torques are dear, and the nearest boundary is reached by a force
DOWN = (0.0, 0.0, -WEIGHT)


def state(v: tuple[float, ...] = (0, 0, 0), w: tuple[float, ...] = (0, 0, 0)) -> BodyState:
    return BodyState(
        p_WB_W=np.zeros(3), q_WB=np.array([0.0, 0.0, 0.0, 1.0]), v_WB_W=np.array(v), w_WB_W=np.array(w)
    )


def feet(height: float, friction: float) -> ContactSet:
    corners = [(-1.0, -0.5), (1.0, -0.5), (1.0, 0.5), (-1.0, 0.5)]
    return ContactSet(
        p_WC_W=np.array([(x, y, -height) for x, y in corners]),
        normals_W=np.tile([0.0, 0.0, 1.0], (4, 1)),
        frictions=np.full(4, friction),
        restitutions=np.zeros(4),
    )


@pytest.mark.parametrize("facets", [4, 8, 16])
def test_a_block_at_rest_slips_at_the_edge_of_its_friction_cone(facets: int) -> None:
    (margin,) = mode_margins(
        SpatialContactProblem(
            body=BODY, state=state(), contacts=feet(0.2, 0.4), force_W=DOWN, friction_facets=facets
        ),
        margin_length=SHORT,
    )
    # The nearest point of a pyramid whose sides are mu cos(pi / facets) from its axis.
    slope = math.atan(0.4 * math.cos(math.pi / facets))
    assert margin.mode == "ffff"
    assert margin.margin == pytest.approx(WEIGHT * math.sin(slope), rel=1e-9)
    assert margin.length == SHORT
    np.testing.assert_allclose(np.linalg.norm(margin.change_W[:3]), margin.margin, rtol=1e-6)
    assert margin.modes_beyond == ("cccc",)
    assert margin.verdict_beyond == ModeVerdict.UNIQUE


def test_a_tall_block_tips_over_its_nearer_edge() -> None:
    (margin,) = mode_margins(
        SpatialContactProblem(
            body=BODY, state=state(), contacts=feet(1.0, 2.0), force_W=DOWN, friction_facets=16
        ),
        margin_length=SHORT,
    )
    assert margin.margin == pytest.approx(WEIGHT * math.sin(math.atan(0.5)), rel=1e-6)
    assert margin.modes_beyond in (("ssff",), ("ffss",))
    # Pushed to the limit there is none left, and a torque about the edge is worth its lever.
    (limit,) = mode_margins(
        SpatialContactProblem(
            body=BODY,
            state=state(),
            contacts=feet(1.0, 2.0),
            force_W=(0.0, 0.5 * WEIGHT, -WEIGHT),
            friction_facets=16,
        ),
        margin_length=SHORT,
    )
    assert limit.margin == pytest.approx(0.0, abs=1e-9)
    (by_torque,) = mode_margins(
        SpatialContactProblem(
            body=BODY, state=state(), contacts=feet(1.0, 2.0), force_W=DOWN, friction_facets=16
        ),
        margin_length=1e3,
    )
    assert by_torque.margin == pytest.approx(WEIGHT * 0.5 / 1e3, rel=1e-5)


def test_a_sliding_block_tips_forward_or_lifts_off() -> None:
    # It slides along x with friction at its feet, which the load has to balance about the centre of mass:
    # it moves forward by mu h = 0.2 of the half-length 1.
    (margin,) = mode_margins(
        SpatialContactProblem(
            body=BODY,
            state=state(v=(2.0, 0.0, 0.0)),
            contacts=feet(0.5, 0.4),
            force_W=DOWN,
            friction_facets=16,
        ),
        margin_length=1e3,
    )
    # By torque alone: sideways WEIGHT * 0.5, forward WEIGHT * (1 - 0.2); sideways is nearer.
    assert margin.mode == "cccc"
    assert margin.margin == pytest.approx(WEIGHT * 0.5 / 1e3, rel=1e-5)
    lifts = mode_margins(
        SpatialContactProblem(
            body=BODY,
            state=state(v=(2.0, 0.0, 0.0)),
            contacts=feet(0.0, 0.4),
            force_W=DOWN,
            friction_facets=16,
        ),
        margin_length=SHORT,
    )
    assert lifts[0].margin == pytest.approx(WEIGHT, rel=1e-5)  # only lifting, and a little torque


def turning_case(seed: int) -> tuple[BodyState, ContactSet, np.ndarray]:
    """Return a body that turns about an axis which the normals of its two contacts meet."""
    chance = np.random.default_rng(seed)
    centre, w = 0.3 * chance.normal(size=3), chance.normal(size=3)
    points = np.array([centre + chance.normal(size=3) for _ in range(2)])
    normals = np.array([centre + w * chance.normal() - point for point in points])
    contacts = ContactSet(
        p_WC_W=points,
        normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
        frictions=np.full(2, 0.4),
        restitutions=np.zeros(2),
    )
    return state(tuple(-np.cross(w, centre)), tuple(w)), contacts, 3.0 * chance.normal(size=6)


@pytest.mark.parametrize("seed", range(12))
def test_no_smaller_change_ends_a_mode_and_the_stated_one_does(seed: int) -> None:
    now, contacts, wrench = turning_case(seed)
    chance = np.random.default_rng(seed + 100)
    margins = mode_margins(
        SpatialContactProblem(
            body=BODY,
            state=now,
            contacts=contacts,
            force_W=wrench[:3],
            torque_W=wrench[3:],
            friction_facets=16,
        ),
        margin_length=0.5,
    )
    metric = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    for margin in margins:
        assert 0.0 <= margin.margin < math.inf
        for part, stays in ((0.999, True), (1.001, False)):
            changed = wrench + part * margin.change_W
            there = contact_modes(
                SpatialContactProblem(
                    body=BODY, state=now, contacts=contacts, force_W=changed[:3], torque_W=changed[3:]
                )
            )
            assert (margin.mode in [mode.mode for mode in there.modes]) == stays
        for _ in range(6):
            way = chance.normal(size=6)
            changed = wrench + 0.999 * margin.margin * way / np.linalg.norm(way) * metric
            there = contact_modes(
                SpatialContactProblem(
                    body=BODY, state=now, contacts=contacts, force_W=changed[:3], torque_W=changed[3:]
                )
            )
            assert margin.mode in [mode.mode for mode in there.modes]


def test_modes_without_a_margin_and_without_an_end() -> None:
    (free,) = mode_margins(
        SpatialContactProblem(
            body=BODY, state=state(v=(0, 0, 1.0)), contacts=feet(0.2, 0.4), force_W=DOWN, friction_facets=16
        )
    )
    assert (free.mode, free.margin, free.modes_beyond) == ("ssss", math.inf, ("ssss",))
    np.testing.assert_array_equal(free.change_W, np.zeros(6))
    assert (
        mode_margins(
            SpatialContactProblem(
                body=BODY,
                state=state(v=(0, 0, -1.0)),
                contacts=feet(0.2, 0.4),
                force_W=DOWN,
                friction_facets=16,
            )
        )
        == ()
    )


@pytest.mark.parametrize(("push", "facets"), [((9.0, 0.0), 4), ((10.0, 2.0), 8), ((-7.0, 7.0), 8)])
def test_a_block_that_begins_to_slide_stops_at_the_edge_of_its_cone(
    push: tuple[float, float], facets: int
) -> None:
    # The first edge of each pyramid opposes the push, so that the way back to the cone is exact.
    (margin,) = mode_margins(
        SpatialContactProblem(
            body=BODY,
            state=state(),
            contacts=feet(0.2, 0.4),
            force_W=(*push, -WEIGHT),
            friction_facets=facets,
        ),
        margin_length=SHORT,
    )
    assert margin.mode == "cccc"
    assert margin.margin == pytest.approx((math.hypot(*push) - 0.4 * WEIGHT) / math.hypot(1.0, 0.4), rel=1e-4)
    assert margin.modes_beyond == ("ffff",)
    np.testing.assert_allclose(margin.change_W[2], -0.4 / math.hypot(1.0, 0.4) * margin.margin, rtol=1e-2)


@pytest.mark.parametrize("seed", range(8))
def test_margins_of_a_foot_that_begins_to_slide_beside_the_whole_map(seed: int) -> None:
    """Up to the margin, sets of the mode contain the wrench, however it changes. Behind it none does."""
    chance = np.random.default_rng(seed)
    foot = ContactSet(
        p_WC_W=chance.normal(size=(1, 3)),
        normals_W=np.array([[0.0, 0.0, 1.0]]),
        frictions=np.array([0.3]),
        restitutions=np.zeros(1),
    )
    wrench = np.append(chance.normal(size=3) * 5.0 - [0.0, 0.0, WEIGHT], chance.normal(size=3))
    asked = {"force_W": wrench[:3], "torque_W": wrench[3:], "friction_facets": 6}
    length = float(chance.choice([0.1, 0.45, 2.0]))
    metric = np.array([1.0, 1.0, 1.0, length, length, length])
    for margin in mode_margins(
        SpatialContactProblem(body=BODY, state=state(), contacts=foot, **asked), margin_length=length
    ):
        assert 0.0 < margin.margin < math.inf
        assert np.linalg.norm(margin.change_W / metric) == pytest.approx(margin.margin, rel=1e-9)
        sets = wrench_sets(
            SpatialContactProblem(body=BODY, state=state(), contacts=foot, **asked), modes=[margin.mode]
        )

        def depth(change: np.ndarray, sets: tuple[SpatialWrenchSet, ...] = sets) -> float:
            return max(one.depth(wrench + change, 0.45) for one in sets)

        nearby = 1e-2 * margin.margin * chance.normal(size=(200, 6)) * metric
        assert min(depth(margin.change_W + change) for change in nearby) < 0.0
        assert margin.mode not in margin.modes_beyond
        for way in chance.normal(size=(200, 6)):
            assert depth(0.999 * margin.margin * way / np.linalg.norm(way) * metric) > -1e-9 * WEIGHT


@pytest.mark.parametrize("seed", [1, 8, 11])
def test_a_box_that_begins_to_turn_while_it_slides_has_a_margin(seed: int) -> None:
    """Its way to the boundary leads through many cones, more than a search for each of them allows."""
    chance = np.random.default_rng(seed)
    friction, heading = float(chance.choice([0.3, 0.5, 0.8])), chance.uniform(0.0, 2.0 * math.pi)
    push = 9.8 * friction * chance.uniform(1.0, 1.3) * np.array([math.cos(heading), math.sin(heading)])
    torque = chance.normal(size=3) * [0.02, 0.02, 0.1]
    box = MassProperties(mass=1.0, I_B=np.diag([0.0043, 0.0043, 0.0053]))
    corners = ContactSet(
        p_WC_W=np.array([(x, y, -0.1) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]),
        normals_W=[0.0, 0.0, 1.0],
        frictions=friction,
    )
    asked = SpatialContactProblem(
        body=box,
        state=state(),
        contacts=corners,
        force_W=(*push, -9.8),
        torque_W=torque,
        friction_facets=int(chance.choice([8, 16])),
    )
    (margin,) = mode_margins(asked)
    assert 0.1 < margin.margin < 1.0
    assert "cccc" not in margin.modes_beyond
    rho = margin.length
    for way in [margin.change_W / np.array([1.0, 1.0, 1.0, rho, rho, rho]), *chance.normal(size=(6, 6))]:
        # Friction pyramids that turn with the wrench lack at most 8 % of friction, and more of the margin.
        change = 0.8 * margin.margin * way / np.linalg.norm(way) * [1.0, 1.0, 1.0, rho, rho, rho]
        there = contact_modes(
            replace(asked, force_W=asked.force_W + change[:3], torque_W=asked.torque_W + change[3:])
        )
        assert "cccc" in [mode.mode for mode in there.modes]


def test_what_is_not_known_of_a_mode_that_begins_to_slide_is_not_told() -> None:
    angles = np.arange(6) * math.pi / 3.0
    ring = ContactSet(
        p_WC_W=np.column_stack([np.cos(angles), np.sin(angles), np.full(6, -0.1)]),
        normals_W=np.tile([0.0, 0.0, 1.0], (6, 1)),
        frictions=np.full(6, 0.4),
        restitutions=np.zeros(6),
    )
    (margin,) = mode_margins(
        SpatialContactProblem(
            body=BODY, state=state(), contacts=ring, force_W=(10.0, 0.0, -WEIGHT), friction_facets=4
        )
    )
    assert margin.mode == "cccccc"
    assert math.isnan(margin.margin)
    assert margin.modes_beyond == ("cccccc",)


def test_ways_of_sliding_that_are_too_many_leave_the_margin_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    def given_up(*_: object) -> None:
        raise TooLargeError("contacts", "many", "fewer")

    monkeypatch.setattr("contact_dynamics.contact_modes.spatial.margins_of_sliding.search_of", given_up)
    (margin,) = mode_margins(
        SpatialContactProblem(
            body=BODY,
            state=state(),
            contacts=feet(0.2, 0.4),
            force_W=(10.0, 0.0, -WEIGHT),
            friction_facets=16,
        )
    )
    assert (margin.mode, math.isnan(margin.margin)) == ("cccc", True)


def test_misuse_is_refused_by_name() -> None:
    with pytest.raises(InvalidFieldError, match="margin_length"):
        mode_margins(
            SpatialContactProblem(
                body=BODY, state=state(), contacts=feet(0.2, 0.4), force_W=DOWN, friction_facets=16
            ),
            margin_length=0.0,
        )
    with pytest.raises(TooLargeError, match="edges"):
        mode_margins(
            SpatialContactProblem(
                body=BODY, state=state(), contacts=feet(0.2, 0.4), force_W=DOWN, friction_facets=40
            )
        )
