# SPDX-License-Identifier: Apache-2.0
"""Mode letters come with words, verdicts with their modes, and enumerations with help for each member."""

from __future__ import annotations

import inspect
import math
import pydoc

import numpy as np
import pytest

import contact_dynamics as cd
from contact_dynamics.contact_modes import Certainty
from contact_dynamics.contact_modes.letters import margin_in_words, mode_in_words
from contact_dynamics.errors import InvalidFieldError

CRATE = cd.Body.box((0.4, 0.3, 0.3), mass=5.0)
RESTING = cd.BodyState(p_WB_W=[0, 0, 0.15], q_WB=[0, 0, 0, 1])


def answer(push: float, height: float, friction: float) -> cd.contact_modes.SpatialModeAnswer:
    floor = cd.Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=friction, restitution=0)
    feet = cd.find_contacts(CRATE, RESTING, cd.World(surfaces=(floor,)))
    return cd.contact_modes(
        cd.SpatialContactProblem(
            body=CRATE, state=RESTING, contacts=feet, force_W=[push, 0, -49.0], torque_W=[0, push * height, 0]
        )
    )


@pytest.mark.parametrize(
    ("push", "height", "friction", "words", "short"),
    [
        (1.0, 0.0, 0.4, {"stays fixed"}, "UNIQUE, ffff: it stays fixed"),
        (40.0, 0.0, 0.1, {"slides"}, "UNIQUE, cccc: it slides"),
        (
            45.0,
            0.15,
            5.0,
            {"separates", "stays fixed"},
            "UNIQUE, ssff: it tips (2 contacts separate, 2 stay fixed)",
        ),
    ],
)
def test_a_spatial_mode_says_what_each_contact_does(
    push: float, height: float, friction: float, words: set[str], short: str
) -> None:
    found = answer(push, height, friction)
    assert {*found.modes[0].words} == words
    assert len(found.modes[0].words) == 4
    (mode,) = found.modes
    shared = f"; the contact forces of {mode.mode} are not unique"
    assert found.in_short() == f"SpatialModeAnswer: {short}{shared}"
    assert mode.in_short().endswith(short.split(": ")[1] + shared)


@pytest.mark.parametrize(
    ("off_centre", "words"), [(0.0, "it stays fixed"), (0.02, "it turns (2 contacts stay fixed)")]
)
def test_a_body_between_two_fingers_turns_about_them_unless_they_hold_its_centre(
    off_centre: float, words: str
) -> None:
    """By hand, it falls about the line of the fingers with m g d / (I + m d^2). It does not rest."""
    box = cd.Body.box((0.06, 0.1, 0.06), mass=0.5)
    fingers = cd.ContactSet(
        p_WC_W=[[-0.03, off_centre, 0], [0.03, off_centre, 0]],
        normals_W=[[1, 0, 0], [-1, 0, 0]],
        frictions=0.5,
    )
    state = cd.BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    problem = cd.SpatialContactProblem(body=box, state=state, contacts=fingers, force_W=[0, 0, -4.9])
    found = cd.contact_modes(problem)
    held = next(mode for mode in found.modes if mode.mode == "ff")
    falls = 4.9 * off_centre / (box.mass_properties.I_B[0, 0] + 0.5 * off_centre**2)
    np.testing.assert_allclose(held.angular_acceleration_W, [falls, 0, 0], atol=1e-9 * 127.8)  # rounding
    assert f"ff: {words}" in found.in_short()
    assert f"ff: {words}" in held.in_short()
    if off_centre:
        with pytest.raises(InvalidFieldError, match="one of a body that stays fixed without the additional"):
            cd.largest_load(problem, force_W=[0, 0, -1])
    else:
        beyond = cd.largest_load(problem, force_W=[0, 0, -1], at_W=[0, 0.01, 0]).in_short()
        assert "then it turns (2 contacts stay fixed)" in beyond


def test_a_planar_mode_says_to_which_side_it_slides() -> None:
    block, foot = (
        cd.PlanarBody(mass=1.0, inertia=0.1),
        cd.PlanarContact(r=(0.0, -0.1), normal=(0.0, 1.0), friction=0.1),
    )
    for push, words in ((-5.0, "slides left"), (5.0, "slides right"), (0.5, "stays fixed")):
        push_at_foot = cd.PlanarWrench(f=(push, -9.8), moment=0.1 * push)
        found = cd.contact_modes(cd.PlanarContactProblem(body=block, contacts=(foot,), wrench=push_at_foot))
        assert found.modes[0].words == (words,)
        assert words in str(found.modes[0]).splitlines()[0]
        assert "not unique" not in found.in_short()


@pytest.mark.parametrize("kind", [cd.ModeVerdict, cd.RestitutionLaw, Certainty])
def test_help_lists_every_member_with_its_text(kind: type) -> None:
    for text in (inspect.getdoc(kind) or "", pydoc.plain(pydoc.render_doc(kind))):
        for member in kind:  # type: ignore[attr-defined]
            assert f"{member.name}: " in text
    assert "UNIQUE: One mode is consistent." in (inspect.getdoc(cd.ModeVerdict) or "")


@pytest.mark.parametrize("mode", ["xx", "FFFF", "ff "])
def test_letters_that_there_are_not_are_an_error(mode: str) -> None:
    with pytest.raises(InvalidFieldError, match="mode must be letters of s, l, r, f, c, got"):
        mode_in_words(mode)


def test_a_margin_that_is_no_number_is_told_in_words() -> None:
    assert (
        margin_in_words("ff", math.inf, ())
        == "every contact stays fixed, and no change of the wrench ends that"
    )
    assert (
        margin_in_words("ff", math.nan, (), "it is dark")
        == "every contact stays fixed, and its margin is unknown: it is dark"
    )
    assert margin_in_words("ff", 1.0, ()).endswith(" up to a change of 1 N, then no mode is consistent")
