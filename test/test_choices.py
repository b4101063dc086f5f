# SPDX-License-Identifier: Apache-2.0
"""Every argument that is one of an enumeration refuses what is not, by its own name."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Callable
from enum import Enum
from typing import Any

import numpy as np
import pytest

import contact_dynamics
from contact_dynamics import contact_modes, impact, motion, tumbling
from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.errors import InvalidFieldError, WrongTypeError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw, StrikingBodies
from contact_dynamics.motion import PropagationMethod, WrenchAxes
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import Precision
from contact_dynamics.world import Body, Surface, World, box_vertices

PLANAR_BODY = PlanarBody(mass=1.0, inertia=0.1)
FALLING = PlanarVelocity(v=(0.3, -1.0), w=0.2)
CONTACT = PlanarContact(r=(0.1, -0.5), normal=(0.0, 1.0), friction=0.3, restitution=0.5)
BODY = MassProperties(mass=1.0, I_B=0.1 * np.eye(3))
STATE = BodyState(p_WB_W=[0.0, 0.0, 0.5], q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=[0.3, 0.0, -1.0])
CONTACTS = ContactSet(
    p_WC_W=[[0.1, 0.0, 0.0]], normals_W=[[0.0, 0.0, 1.0]], frictions=[0.3], restitutions=[0.5]
)
FLOOR = Surface(name="floor", p_WS_W=np.zeros(3), normal_W=[0.0, 0.0, 1.0], friction=0.3, restitution=0.5)
BOX = Body(name="box", mass_properties=BODY, vertices_B=box_vertices((1.0, 1.0, 1.0)))
WORLD = World(bodies=(BOX,), surfaces=(FLOOR,), gravity_W=[0.0, 0.0, -9.81])
AT = Contact(p_WC_W=[0.1, 0.0, 0.0], normal_W=[0.0, 0.0, 1.0], friction=0.3, restitution=0.5)
STRIKING = StrikingBodies(
    masses=1.0,
    inertias_B=0.1 * np.eye(3),
    q_WB=STATE.q_WB,
    v_WB_W=STATE.v_WB_W,
    w_WB_W=STATE.w_WB_W,
    r_W=[0.1, 0.0, -0.5],
)
TABLE = {"normals_W": (0.0, 0.0, 1.0), "frictions": 0.3, "restitutions": 0.5}
STILL = PlanarVelocity(v=(0.0, 0.0), w=0.0)
RESTING = BodyState(p_WB_W=-STATE.p_WB_W, q_WB=STATE.q_WB)

CALLS: dict[str, Callable[..., Any]] = {
    "planar_impact": lambda **law: impact.planar_impact(PLANAR_BODY, FALLING, CONTACT, **law),
    "planar_pair_impact": lambda **law: impact.planar_pair_impact(
        PLANAR_BODY, FALLING, PLANAR_BODY, STILL, CONTACT, other_r=(0.1, 0.5), **law
    ),
    "planar_impacts": lambda **law: impact.planar_impacts(
        masses=1.0,
        inertias=0.1,
        v=(0.3, -1.0),
        w=0.2,
        r=(0.1, -0.5),
        normals=(0.0, 1.0),
        frictions=0.3,
        restitutions=0.5,
        **law,
    ),
    "planar_impact_distribution": lambda **law: impact.planar_impact_distribution(
        PLANAR_BODY, FALLING, CONTACT, covariance=1e-6 * np.eye(3), samples=4, **law
    ),
    "planar_several_impact": lambda **law: impact.planar_several_impact(
        PLANAR_BODY, FALLING, [CONTACT], **law
    ),
    "spatial_impact": lambda **law: impact.spatial_impact(BODY, STATE, AT, **law),
    "response_impact": lambda **law: impact.response_impact(np.eye(3), [0.3, 0.0, -1.0], AT, **law),
    "response_impacts": lambda **law: impact.response_impacts(np.eye(3), [0.3, 0.0, -1.0], **TABLE, **law),
    "spatial_pair_impact": lambda **law: impact.spatial_pair_impact(BODY, STATE, BODY, RESTING, AT, **law),
    "spatial_impacts": lambda **law: impact.spatial_impacts(STRIKING, **TABLE, **law),
    "spatial_impact_distribution": lambda **law: impact.spatial_impact_distribution(
        BODY, STATE, AT, covariance=1e-6 * np.eye(12), samples=4, **law
    ),
    "several_impact": lambda **law: impact.several_impact(BODY, STATE, CONTACTS, **law),
    "outcomes_over_orders": lambda **law: impact.outcomes_over_orders(BODY, STATE, CONTACTS, **law),
    "outcomes_at_once": lambda **law: impact.outcomes_at_once(BODY, STATE, CONTACTS, **law),
    "bodies_impact": lambda **law: impact.bodies_impact([BODY], [STATE], CONTACTS, [(0, None)], **law),
    "impact_sequence": lambda **law: impact.impact_sequence(BOX, STATE, WORLD, **law),
    "impact_sequence_of": lambda **law: impact.impact_sequence_of(BODY, STATE, CONTACTS, **law),
    "free_motion": lambda **law: tumbling.free_motion(BODY, STATE, **law),
    "propagate_covariance": lambda **law: motion.propagate_covariance(
        BODY, STATE, 1e-6 * np.eye(12), [0.1], **law
    ),
    "covariance_along": lambda **law: motion.covariance_along(
        tumbling.free_motion(BODY, STATE), 1e-6 * np.eye(12), [0.1], **law
    ),
    "ConstantWrench": motion.ConstantWrench,
}
WITHOUT_A_FORM = {
    ("outcomes_at_once", law)
    for law in RestitutionLaw
    if law not in {RestitutionLaw.POISSON, RestitutionLaw.NEWTON}
}
"""Members that a function refuses by name, because there is no such law."""

CHOICES = [
    *[
        (name, "restitution_law", RestitutionLaw)
        for name in CALLS
        if name.startswith(("planar_i", "planar_p"))
    ],
    *[
        (name, "restitution_law", RestitutionLaw)
        for name in CALLS
        if name in {"response_impact", "spatial_impact", "spatial_pair_impact"}
    ],
    ("spatial_impact_distribution", "restitution_law", RestitutionLaw),
    ("spatial_impacts", "restitution_laws", RestitutionLaw),
    ("response_impacts", "restitution_laws", RestitutionLaw),
    *[
        (name, "several_contacts_law", SeveralContactsLaw)
        for name in ("several_impact", "planar_several_impact", "bodies_impact")
    ],
    *[
        (name, "restitution_law", RestitutionLaw)
        for name in ("several_impact", "planar_several_impact", "bodies_impact", "outcomes_over_orders")
    ],
    ("outcomes_at_once", "restitution_law", RestitutionLaw),
    *[(name, "restitution_law", RestitutionLaw) for name in ("impact_sequence", "impact_sequence_of")],
    ("free_motion", "precision", Precision),
    ("propagate_covariance", "method", PropagationMethod),
    ("covariance_along", "method", PropagationMethod),
    ("ConstantWrench", "axes", WrenchAxes),
]


def public_choices() -> set[tuple[str, str]]:
    """The functions that the package offers, with their arguments that are typed as an enumeration."""
    found = set()
    for module in (contact_dynamics, impact, contact_modes, tumbling, motion):
        for name in getattr(module, "__all__", vars(module)):
            function = getattr(module, name)
            if not inspect.isfunction(function) or name.startswith("_"):
                continue
            for argument, text in inspect.get_annotations(function).items():
                kind = vars(typing.cast("Any", inspect.getmodule(function))).get(text)
                if argument != "return" and isinstance(kind, type) and issubclass(kind, Enum):
                    found.add((name, argument))
    return found


def test_no_argument_is_forgotten() -> None:
    arrays_and_fields = {
        ("spatial_impacts", "restitution_laws"),
        ("response_impacts", "restitution_laws"),
        ("ConstantWrench", "axes"),
    }
    assert public_choices() == {(name, argument) for name, argument, _ in CHOICES} - arrays_and_fields


@pytest.mark.parametrize(("name", "argument", "kind"), CHOICES)
def test_members_are_taken_and_all_else_is_refused_by_name(
    name: str, argument: str, kind: type[Enum]
) -> None:
    for member in kind:
        if (name, member) not in WITHOUT_A_FORM:
            CALLS[name](**{argument: member})
    other = SeveralContactsLaw.SIMULTANEOUS if kind is RestitutionLaw else RestitutionLaw.NEWTON
    for wrong, shown in (
        ("newton", "'newton'"),
        (None, "None"),
        (True, "True"),
        (other, f"{type(other).__name__}.{other.name}"),
    ):
        with pytest.raises(WrongTypeError) as raised:
            CALLS[name](**{argument: wrong})
        text = str(raised.value)
        assert text.startswith(f"{argument} must be ")
        assert f", got {shown}" in text
        assert all(member.name in text for member in kind)
    with pytest.raises(InvalidFieldError, match=rf"^{argument}(\[0\])? must be .* got 7"):
        CALLS[name](**{argument: 7})


@pytest.mark.parametrize(
    ("laws", "row"),
    [
        ([RestitutionLaw.NEWTON, "newton"], 1),
        ([RestitutionLaw.NEWTON, SeveralContactsLaw.SIMULTANEOUS], 1),
        (np.array(["poisson"]), 0),
        (np.array([0.0, 1.0, float(len(RestitutionLaw))]), 2),
        ([None], 0),
    ],
)
def test_a_list_of_laws_names_the_row(laws: Any, row: int) -> None:
    with pytest.raises(InvalidFieldError, match=rf"^restitution_laws\[{row}\](:| must be).*NEWTON"):
        impact.spatial_impacts(STRIKING, **TABLE, restitution_laws=laws)


def test_a_list_of_laws_may_hold_members_or_values() -> None:
    by_member = impact.spatial_impacts(
        STRIKING, **TABLE, restitution_laws=[RestitutionLaw.NEWTON, RestitutionLaw.POISSON]
    )
    by_value = impact.spatial_impacts(STRIKING, **TABLE, restitution_laws=np.array([1, 0]))
    assert by_member.restitution_laws.tolist() == by_value.restitution_laws.tolist() == [1, 0]
    assert np.array_equal(by_member.impulses_W, by_value.impulses_W)
