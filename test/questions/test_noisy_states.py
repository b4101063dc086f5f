# SPDX-License-Identifier: Apache-2.0
"""Contact modes of a brick on a floor whose state is measured with noise, drawn many times."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2, ncx2

from contact_dynamics import Body, BodyState, ModeVerdict, Surface, World
from contact_dynamics.contact.noise import REST_LEVEL
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions import ContactModeAnswer, ContactModeQuestion, Context, UncertainState, ask
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from contact_dynamics.questions.many_contact_modes import answer as answer_many

WEIGHT, FRICTION = 0.4 * 9.80665, 0.3  # N
BRICK = Body.box((0.15, 0.09, 0.05), mass=0.4, name="brick")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=FRICTION, restitution=0.45)
CONTEXT = Context(world=World(bodies=(BRICK,), surfaces=(FLOOR,)))
MOTION_CAPTURE = np.array([2e-4, 2e-3, 0.02, 0.2])  # m, rad, m/s, rad/s


def measured(chance: np.random.Generator, *, scale: float, speed: float = 0.0) -> UncertainState:
    """Return a state of a brick that lies on the floor, or slides on it in some direction."""
    deviations = np.repeat(scale * MOTION_CAPTURE, 3)
    error, yaw, azimuth = chance.normal(size=12) * deviations, *chance.uniform(-3.0, 3.0, size=2)
    turn = Rotation.from_rotvec(error[3:6]) * Rotation.from_rotvec([0.0, 0.0, yaw])
    state = BodyState(
        p_WB_W=np.array([0.1, 0.2, 0.025]) + error[:3],
        q_WB=turn.as_quat(),
        v_WB_W=speed * np.array([np.cos(azimuth), np.sin(azimuth), 0.0]) + error[6:9],
        w_WB_W=error[9:],
    )
    return UncertainState(state=state, covariance=np.diag(deviations**2))


def modes_of(answer: ContactModeAnswer) -> list[str]:
    return [mode.mode for mode in answer.modes]


def wrong_at_rest(draws: int, scale: float, push: float) -> int:
    """Return in how many draws a brick at rest, pushed with a share of what friction holds, does not rest."""
    chance, wrong = np.random.default_rng(3), 0
    for _ in range(draws):
        azimuth = chance.uniform(-3.0, 3.0)
        force_W = push * FRICTION * WEIGHT * np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        question = ContactModeQuestion(body="brick", state=measured(chance, scale=scale), force_W=force_W)
        found = ask(question, CONTEXT)
        wrong += (found.verdict, modes_of(found)) != (ModeVerdict.UNIQUE, ["ffff"])
    return wrong


@pytest.mark.parametrize(("scale", "push"), [(1.0, 0.0), (1.0, 0.5), (0.01, 0.0)])
def test_a_brick_at_rest_rests(scale: float, push: float) -> None:
    """The test of each hypothesis rejects one of a thousand."""
    assert wrong_at_rest(30, scale, push) <= 1


@pytest.mark.slow
@pytest.mark.parametrize("push", [0.0, 0.5])
@pytest.mark.parametrize("scale", [0.01, 0.1, 1.0, 3.0])
def test_many_bricks_at_rest_rest(scale: float, push: float) -> None:
    """Four conditions are tested: three on the pose, and one on all velocities."""
    assert wrong_at_rest(500, scale, push) <= 8


def test_a_sliding_brick_slides_on_all_its_feet() -> None:
    chance, right = np.random.default_rng(4), 0
    for _ in range(20):
        question = ContactModeQuestion(body="brick", state=measured(chance, scale=1.0, speed=0.4))
        right += modes_of(ask(question, CONTEXT)) == ["cccc"]
    assert right >= 19


def test_without_its_noise_the_same_states_are_hardly_ever_at_rest() -> None:
    """A tolerance of the size of the noise does not help."""
    chance, right = np.random.default_rng(5), 0
    for _ in range(20):
        state = measured(chance, scale=1.0).state
        tolerances = {"velocity_tolerance": MOTION_CAPTURE[2], "distance_tolerance": 1e-3}
        right += modes_of(ask(ContactModeQuestion(body="brick", state=state, **tolerances), CONTEXT)) == [
            "ffff"
        ]
    assert right < 4


def test_the_answer_has_the_state_that_it_is_about() -> None:
    noisy = measured(np.random.default_rng(6), scale=1.0)
    found = ask(ContactModeQuestion(body="brick", state=noisy), CONTEXT)
    assert np.abs(found.state.v_WB_W).max() < 1e-15
    np.testing.assert_allclose(found.contacts.p_WC_W[:, 2], 0.0, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(found.state.p_WB_W, noisy.state.p_WB_W, rtol=0.0, atol=4 * MOTION_CAPTURE[0])
    again = ask(ContactModeQuestion(body="brick", state=found.state), CONTEXT)
    assert modes_of(again) == modes_of(found)


@pytest.mark.parametrize("deviations_off", [0.0, 2.5, 4.0, 5.0, 7.0])
def test_the_probability_of_rest_is_that_of_chi_squared(deviations_off: float) -> None:
    """For a velocity that is off by so many deviations the squared size of a repeat is noncentral."""
    deviations = np.repeat(MOTION_CAPTURE, 3)
    state = BodyState(p_WB_W=[0.1, 0.2, 0.025], q_WB=[0, 0, 0, 1], v_WB_W=[deviations_off * 0.02, 0, 0])
    noisy = UncertainState(state=state, covariance=np.diag(deviations**2))
    found = ask(ContactModeQuestion(body="brick", state=noisy, include_probabilities=True), CONTEXT)
    assert found.probabilities is not None
    shares = {each.mode: each.probability for each in found.probabilities}
    expected = ncx2.cdf(chi2.ppf(REST_LEVEL, 6), 6, deviations_off**2)
    assert shares.get("ffff", 0.0) == pytest.approx(expected, abs=0.05)  # three deviations of 1000 draws
    assert max(shares, key=lambda mode: shares[mode]) == modes_of(found)[0]
    if 0.1 < expected < 0.9:
        assert sum(share for mode, share in shares.items() if set(mode) <= set("clr")) > 0.05


def test_probabilities_need_a_covariance() -> None:
    exact = measured(np.random.default_rng(8), scale=0.0).state
    with pytest.raises(InvalidFieldError, match=r"state\.covariance must be .*, got none"):
        ask(ContactModeQuestion(body="brick", state=exact, include_probabilities=True), CONTEXT)


@pytest.mark.parametrize("counts", [(), (4, 4)])
def test_candidates_have_the_answers_of_single_questions(counts: tuple[int, ...]) -> None:
    noisy = measured(np.random.default_rng(7), scale=1.0)
    single = ContactModeQuestion(body="brick", state=noisy)
    if counts:
        feet = ask(single, CONTEXT).contacts
        single = replace(single, contacts=feet)
    forces = np.array([[0.3, 0.1, 0.0], [0.5, -0.4, 0.0]])
    asked = single if not counts else replace(single, contacts=feet.subset([0, 1, 2, 3, 0, 1, 2, 3]))
    many = answer_many(
        ManyContactModesQuestion(
            asked=asked, forces_W=forces, torques_W=np.zeros((2, 3)), contact_counts=counts
        ),
        CONTEXT,
    )
    alone = [ask(replace(single, force_W=force), CONTEXT) for force in forces]
    assert list(many.modes) == [mode for each in alone for mode in modes_of(each)] == ["ffff", "ffff"]
