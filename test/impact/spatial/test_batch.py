# SPDX-License-Identifier: Apache-2.0
"""Batches in space: the scalar numbers to the last bit, and refusals that name the row."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.contact.contact import Contact
from contact_dynamics.errors import InvalidFieldError, SeparatingContactError
from contact_dynamics.impact import (
    ImpactOutcome,
    RestitutionLaw,
    SpatialImpact,
    SpatialImpacts,
    StrikingBodies,
    spatial_impact,
    spatial_impacts,
    spatial_pair_impact,
)
from contact_dynamics.impact.spatial import batch as spatial_batch
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.world import Body

Case = tuple[MassProperties, BodyState, dict[str, object]]


def draw(rng: np.random.Generator, kind: int) -> Case:
    """Draw an approaching contact: of any body, of a sphere, in a plane, without friction, at rest."""
    second_moments = rng.uniform(0.05, 2.0, size=3)
    inertia = np.diag(second_moments.sum() - second_moments)
    q = rng.normal(size=4)
    arm, normal = rng.normal(size=3) * 10.0 ** rng.uniform(-1.0, 0.5), rng.normal(size=3)
    v, w = rng.normal(size=3) * 10.0 ** rng.uniform(-1.0, 0.5), rng.normal(size=3)
    friction = float(10.0 ** rng.uniform(-1.5, 0.7))
    if kind == 1:
        inertia, arm = 0.4 * np.eye(3), -normal / np.linalg.norm(normal)
    elif kind == 2:
        q, arm[1], normal, v[1], w = (
            np.array([0.0, 0.0, 0.0, 1.0]),
            0.0,
            np.array([0.0, 0.0, 1.0]),
            0.0,
            w * [0, 1, 0],
        )
    elif kind == 3:
        friction = 0.0
    elif kind == 4:
        # The lecture's sliding rod, turned about the normal; every other friction makes it jam.
        turn = rng.uniform(-math.pi, math.pi)
        c, s = math.cos(turn), math.sin(turn)
        q, inertia, normal = np.array([0.0, 0.0, 0.0, 1.0]), np.eye(3), np.array([0.0, 0.0, 1.0])
        arm, v, w = np.array([-c, -s, -4.0]), np.array([-c, -s, 0.0]), np.zeros(3)
    elif kind == 5:
        v = -np.cross(w, arm) - normal
    normal /= np.linalg.norm(normal)
    if normal @ (v + np.cross(w, arm)) > 0.0:
        normal = -normal
    return (
        MassProperties(mass=float(rng.uniform(0.5, 2.0)), I_B=inertia),
        BodyState(p_WB_W=rng.normal(size=3), q_WB=q / np.linalg.norm(q), v_WB_W=v, w_WB_W=w),
        {
            "arm": arm,
            "n_W": normal,
            "friction": friction,
            "restitution": float(rng.choice([0.0, 1.0, rng.uniform()])),
        },
    )


def drawn(count: int, seed: int = 0) -> list[Case]:
    rng = np.random.default_rng(seed)
    return [draw(rng, (i % 16) if i % 16 < 6 else 0) for i in range(count)]


def stacked(cases: list[Case]) -> StrikingBodies:
    bodies, states = [body for body, _, _ in cases], [state for _, state, _ in cases]
    return StrikingBodies(
        masses=np.array([body.mass for body in bodies]),
        inertias_B=np.array([body.I_B for body in bodies]),
        q_WB=np.array([state.q_WB for state in states]),
        v_WB_W=np.array([state.v_WB_W for state in states]),
        w_WB_W=np.array([state.w_WB_W for state in states]),
        r_W=np.array([contact["arm"] for _, _, contact in cases]),
    )


def contacts(cases: list[Case]) -> dict[str, np.ndarray]:
    return {
        f"{many}": np.array([contact[one] for _, _, contact in cases])
        for one, many in (("n_W", "normals_W"), ("friction", "frictions"), ("restitution", "restitutions"))
    }


def single(case: Case, law: RestitutionLaw) -> SpatialImpact:
    """Solve one case with its centre of mass at the origin, so that its arm is exact."""
    body, state, contact = case
    at_origin = replace(state, p_WB_W=np.zeros(3))
    return spatial_impact(body, at_origin, at(contact["arm"], contact), restitution_law=law)


def at(p_WC_W: np.ndarray, contact: dict[str, object]) -> Contact:
    """Return a drawn contact at a place."""
    return Contact(
        p_WC_W=p_WC_W,
        normal_W=contact["n_W"],
        friction=contact["friction"],
        restitution=contact["restitution"],
    )


def check_row(batch: SpatialImpacts, i: int, answer: SpatialImpact) -> None:
    assert batch.outcomes[i] == answer.outcome
    assert batch.v_WB_W[i].tolist() == answer.state.v_WB_W.tolist()
    assert batch.w_WB_W[i].tolist() == answer.state.w_WB_W.tolist()
    assert batch.impulses_W[i].tolist() == answer.impulse_W.tolist()
    assert batch.compressions_W[i].tolist() == answer.compression_W.tolist()
    assert batch.velocities_before_W[i].tolist() == answer.velocity_before_W.tolist()
    assert batch.velocities_after_W[i].tolist() == answer.velocity_after_W.tolist()


@pytest.mark.parametrize("law", RestitutionLaw)
def test_equals_the_scalar_call_to_the_last_bit(law: RestitutionLaw) -> None:
    cases = drawn(800)
    batch = spatial_impacts(stacked(cases), **contacts(cases), restitution_laws=law)
    assert set(batch.outcomes.tolist()) == set(ImpactOutcome)
    creates_energy = batch.creates_energy
    assert creates_energy.any() == (law is RestitutionLaw.NEWTON)
    for i, case in enumerate(cases):
        answer = single(case, law)
        check_row(batch, i, answer)
        assert creates_energy[i] == answer.creates_energy


@pytest.mark.parametrize("chunk", [1, 7, 200])
def test_chunks_and_the_few_that_go_on_alone_change_nothing(
    chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """How many go together decides who of them takes the scalar path; the answers do not show it."""
    cases = drawn(200, seed=1)
    whole = spatial_impacts(stacked(cases), **contacts(cases))
    monkeypatch.setattr(spatial_batch, "_CHUNK", chunk)
    parts = spatial_impacts(stacked(cases), **contacts(cases))
    assert parts.outcomes.tolist() == whole.outcomes.tolist()
    assert parts.v_WB_W.tolist() == whole.v_WB_W.tolist()
    assert parts.w_WB_W.tolist() == whole.w_WB_W.tolist()


def test_each_case_has_its_own_law() -> None:
    cases = drawn(120, seed=2)
    laws = np.arange(120) % 3
    batch = spatial_impacts(stacked(cases), **contacts(cases), restitution_laws=laws)
    assert batch.restitution_laws.tolist() == laws.tolist()
    for i, case in enumerate(cases):
        check_row(batch, i, single(case, RestitutionLaw(int(laws[i]))))


@pytest.mark.parametrize("law", RestitutionLaw)
def test_two_bodies_equal_the_scalar_call_to_the_last_bit(law: RestitutionLaw) -> None:
    cases, others = drawn(160, seed=3), drawn(160, seed=4)
    # The second bodies follow more slowly, so that all still approach.
    others = [
        (body, replace(state, v_WB_W=first.v_WB_W * 0.0, w_WB_W=first.w_WB_W * 0.0), contact)
        for (body, state, contact), (_, first, _) in zip(others, cases, strict=True)
    ]
    batch = spatial_impacts(stacked(cases), **contacts(cases), others=stacked(others), restitution_laws=law)
    assert batch.other_v_WB_W is not None
    assert batch.other_w_WB_W is not None
    for i, ((body, state, contact), (other, other_state, other_contact)) in enumerate(
        zip(cases, others, strict=True)
    ):
        answer = spatial_pair_impact(
            body,
            replace(state, p_WB_W=-contact["arm"]),
            other,
            replace(other_state, p_WB_W=-other_contact["arm"]),
            at(np.zeros(3), contact),
            restitution_law=law,
        )
        check_row(batch, i, answer)
        assert answer.other_state is not None
        assert batch.other_v_WB_W[i].tolist() == answer.other_state.v_WB_W.tolist()
        assert batch.other_w_WB_W[i].tolist() == answer.other_state.w_WB_W.tolist()
        assert batch.energy_changes[i] == answer.energy_change


def test_single_rows_stand_for_all() -> None:
    ball = StrikingBodies(
        masses=1.0,
        inertias_B=0.4 * np.eye(3),
        q_WB=[0.0, 0.0, 0.0, 1.0],
        v_WB_W=[[1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]],
        w_WB_W=np.zeros(3),
        r_W=[0.0, 0.0, -1.0],
    )
    batch = spatial_impacts(ball, normals_W=[0.0, 0.0, 1.0], frictions=0.1, restitutions=0.5)
    assert batch.v_WB_W.shape == (2, 3)
    # mu (1 + e) v_n = 0.15 of friction, at the arm 1 about I = 0.4.
    assert batch.v_WB_W == pytest.approx(np.array([[0.85, 0.0, 0.5], [-0.85, 0.0, 0.5]]), rel=1e-14)
    assert batch.w_WB_W[:, 1] == pytest.approx([0.375, -0.375], rel=1e-14)


GOOD_BODIES = {
    "masses": 1.0,
    "inertias_B": np.eye(3),
    "q_WB": [0.0, 0.0, 0.0, 1.0],
    "v_WB_W": [[0.0, 0.0, -1.0]] * 2,
    "w_WB_W": [0.0, 0.0, 0.0],
    "r_W": [0.0, 0.0, -1.0],
}
GOOD_CONTACTS = {"normals_W": [0.0, 0.0, 1.0], "frictions": [0.1, 0.2], "restitutions": 0.5}


@pytest.mark.parametrize(
    ("field", "value", "text"),
    [
        ("inertias_B", [np.eye(3), -np.eye(3)], r"inertias_B\[1\]"),
        ("inertias_B", np.diag([1.0, 1.0, 3.0]), r"inertias_B\[0\]"),
        ("r_W", [[0.0, 0.0, -1.0]] * 3, "lengths"),
    ],
)
def test_bad_rows_are_refused_by_name(field: str, value: object, text: str) -> None:
    bodies = {name: value if name == field else good for name, good in GOOD_BODIES.items()}
    rest = {**GOOD_CONTACTS, **({} if field in GOOD_BODIES else {field: value})}
    with pytest.raises(InvalidFieldError, match=text):
        spatial_impacts(StrikingBodies(**bodies), **rest)  # type: ignore[arg-type]


def test_a_separating_row_is_named() -> None:
    bodies = StrikingBodies(**{**GOOD_BODIES, "v_WB_W": [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]})  # type: ignore[arg-type]
    with pytest.raises(SeparatingContactError, match="case 1"):
        spatial_impacts(bodies, **GOOD_CONTACTS)  # type: ignore[arg-type]


def test_separating_rows_can_be_left_as_they_are() -> None:
    """The other rows get their answers, and those that separate keep their velocities to the last bit."""
    velocities = [[0.3, 0.0, -1.0], [0.1, 0.2, 1.0], [0.0, 0.0, -2.0]]
    answers = spatial_impacts(
        StrikingBodies(**{**GOOD_BODIES, "v_WB_W": velocities}),  # type: ignore[arg-type]
        normals_W=[0.0, 0.0, 1.0],
        frictions=0.2,
        restitutions=0.5,
        skip_separating=True,
    )
    alone = spatial_impacts(
        StrikingBodies(**{**GOOD_BODIES, "v_WB_W": [velocities[0], velocities[2]]}),  # type: ignore[arg-type]
        normals_W=[0.0, 0.0, 1.0],
        frictions=0.2,
        restitutions=0.5,
    )
    assert answers.outcomes[1] == ImpactOutcome.NO_IMPULSE
    assert answers.v_WB_W[1].tolist() == velocities[1]
    assert answers.impulses_W[1].tolist() == [0.0, 0.0, 0.0]
    assert answers.velocities_after_W[1].tolist() == velocities[1]
    assert np.array_equal(answers.v_WB_W[[0, 2]], alone.v_WB_W)
    assert np.array_equal(answers.outcomes[[0, 2]], alone.outcomes)


def test_one_body_in_many_states_needs_no_unpacking() -> None:
    rng = np.random.default_rng(6)
    body = Body.box((0.1, 0.2, 0.3), mass=0.7)
    states = [draw(rng, 0)[1] for _ in range(20)]
    columns = {
        name: [getattr(state, name) for state in states] for name in ("p_WB_W", "q_WB", "v_WB_W", "w_WB_W")
    }
    points = columns["p_WB_W"] + rng.normal(size=(20, 3))
    batch = spatial_impacts(
        StrikingBodies.of(body, p_WC_W=points, **columns),
        normals_W=[0, 0, 1],
        frictions=0.3,
        restitutions=0.5,
        skip_separating=True,
    )
    for i, (state, point) in enumerate(zip(states, points, strict=True)):
        contact = Contact(p_WC_W=point, normal_W=[0, 0, 1], friction=0.3, restitution=0.5)
        if state.velocity_of_point(point)[2] < 0.0:
            single = spatial_impact(body.mass_properties, state, contact)
            np.testing.assert_array_equal(batch.v_WB_W[i], single.state.v_WB_W)
    assert (batch.outcomes != ImpactOutcome.NO_IMPULSE).sum() >= 2
    with pytest.raises(InvalidFieldError, match="p_WC_W"):
        StrikingBodies.of(body, p_WC_W=points[:2], **columns)
