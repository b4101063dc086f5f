# SPDX-License-Identifier: Apache-2.0
"""Random answers about contact modes, and their parts."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from hypothesis import strategies as st

from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact_modes.result import (
    BodiesMode,
    BodyStatics,
    Certainty,
    GeometryMargin,
    ModeProbability,
    ModeVerdict,
    Refusal,
    RefusedMode,
    ResponseMode,
    SpatialMode,
    VerdictsWithin,
)
from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
from contact_dynamics.questions import (
    BodiesContactModeAnswer,
    ContactModeAnswer,
    NamedState,
    Problem,
    SettledImpact,
)
from message_values.impact import resolved_impacts
from message_values.shared import (
    NAMES,
    NO_OFFSET,
    arrays,
    contact_sets,
    flags,
    indices,
    not_negative,
    numbers,
    odd_numbers,
    planes,
    positive,
    some,
    states,
    texts,
    tuples_of,
    warnings,
)


@st.composite
def modes_of(draw: st.DrawFn, count: int) -> SpatialMode:
    """A mode of so many contacts, with sliding directions and without."""
    return SpatialMode(
        mode="".join(draw(tuples_of(st.sampled_from("slrfc"), count))),
        acceleration_W=draw(arrays(3)),
        angular_acceleration_W=draw(arrays(3)),
        contact_forces_W=draw(arrays(count, 3)),
        contact_accelerations_W=draw(arrays(count, 3)),
        tangential_directions_W=draw(arrays(count if draw(flags) else 0, 3)),
        misdirection=draw(positive),
        forces_unique=draw(flags),
        motion_unique=draw(flags),
    )


def margins_of(mode: str) -> st.SearchStrategy[SpatialModeMargin]:
    """Finite, infinite and unknown ones."""
    return st.builds(
        SpatialModeMargin,
        mode=st.just(mode),
        margin=odd_numbers,
        length=positive,
        change_W=arrays(6),
        verdict_beyond=st.sampled_from(ModeVerdict),
        modes_beyond=st.lists(texts, max_size=2).map(tuple),
    )


@st.composite
def modes_and_margins(draw: st.DrawFn) -> tuple[SpatialMode, SpatialModeMargin | None]:
    """A mode of up to three contacts."""
    mode = draw(modes_of(draw(st.integers(0, 3))))
    return mode, draw(some(margins_of(mode.mode)))


@st.composite
def wrench_sets(draw: st.DrawFn, mode: str = "sf") -> SpatialWrenchSet:
    """The sets have any number of vertices, generators and half-spaces, in space and in a plane."""
    v, g, h = (draw(st.integers(0, 3)) for _ in range(3))
    sliding = len(mode) if draw(flags) else 0
    return SpatialWrenchSet(
        mode=mode,
        sliding_from_W=draw(arrays(sliding, 3)),
        sliding_to_W=draw(arrays(sliding, 3)),
        vertices=draw(arrays(v, 6)),
        generators=draw(arrays(g, 6)),
        half_spaces=draw(arrays(h, 7)),
    )


static_answers = st.builds(
    BodyStatics,
    equilibrium=st.sampled_from(Certainty),
    jammed=st.sampled_from(Certainty),
    wedged=st.sampled_from([True, False, None]),
    stable_disturbance=odd_numbers,
    margin_length=st.just(math.nan),  # no message tells it
)
refused_modes = st.builds(
    RefusedMode, mode=texts, refusal=st.sampled_from(Refusal), contact=st.integers(-1, 9), amount=numbers
)


@st.composite
def settled_impacts(draw: st.DrawFn, count: int) -> SettledImpact:
    """An impact at one instant, and modes after it."""
    return SettledImpact(
        impact=draw(resolved_impacts(count, in_time=False)),
        verdict=draw(st.sampled_from(ModeVerdict)),
        modes=draw(st.lists(modes_of(count), max_size=2).map(tuple)),
    )


@st.composite
def uncertainties(draw: st.DrawFn) -> ContactUncertainty:
    """One number for all contacts, or one for each of two or three."""
    count = draw(st.sampled_from([2, 3]))
    small = st.floats(1e-300, 1.5)
    each = st.one_of(st.just(0.0), small, st.lists(small, min_size=count, max_size=count).map(tuple))
    return ContactUncertainty(points=draw(each), normals=draw(each), frictions=draw(each))


@st.composite
def verdicts_within(draw: st.DrawFn) -> VerdictsWithin:
    """With one verdict at least, since the first is that on the problem itself."""
    return VerdictsWithin(
        uncertainty=draw(uncertainties()),
        verdicts=draw(st.lists(st.sampled_from(ModeVerdict), min_size=1, max_size=3).map(tuple)),
        modes=draw(st.lists(texts, max_size=3).map(tuple)),
        certain=draw(flags),
        samples=draw(indices),
    )


geometry_margins = st.builds(
    GeometryMargin,
    kind=st.sampled_from(["points", "normals", "frictions"]),
    holds_within=not_negative,
    changes_at=odd_numbers,
    verdict_beyond=st.sampled_from(ModeVerdict),
    modes_beyond=st.lists(texts, max_size=2).map(tuple),
)


probabilities = st.builds(ModeProbability, mode=texts, probability=positive)


@st.composite
def contact_mode_answers(draw: st.DrawFn, p_FB_F: np.ndarray = NO_OFFSET) -> ContactModeAnswer:
    """With no mode and several, and with all that can be asked for besides or not."""
    contacts = draw(contact_sets())
    n, plane = len(contacts), draw(planes)
    modes = draw(st.lists(modes_of(n), max_size=2).map(tuple))
    margins = tuple(draw(margins_of(mode.mode)) for mode in modes) if draw(flags) else ()
    sets = draw(st.lists(wrench_sets(), max_size=2).map(tuple))
    return ContactModeAnswer(
        warnings=draw(warnings),
        body_name=draw(st.sampled_from(NAMES)) if not p_FB_F.any() else "brick",
        p_FB_F=p_FB_F,
        state=draw(states),
        contacts=contacts,
        verdict=draw(st.sampled_from(ModeVerdict)),
        modes=modes,
        margins=margins or None,
        approaching=draw(st.lists(indices, max_size=2).map(tuple)),
        contact_velocities_W=draw(arrays(n, 3)),
        refused=draw(st.lists(refused_modes, max_size=2).map(tuple)),
        kinematic_modes=draw(st.lists(texts, max_size=2).map(tuple)),
        wrench_sets=sets or None,
        statics=draw(some(static_answers)),
        settled=draw(some(settled_impacts(n))),
        problem=Problem.SPATIAL if plane is None else Problem.PLANAR,
        plane=plane,
        out_of_plane=draw(odd_numbers),
        out_of_plane_reason=draw(texts),
        velocity_tolerance=draw(positive),
        acceleration_tolerance=draw(odd_numbers),
        distance_tolerance=draw(positive),
        friction_facets=draw(indices),
        wrench_facets=draw(indices),
        undecided_modes=draw(st.lists(texts, max_size=2).map(tuple)),
        within=draw(some(verdicts_within())),
        geometry_margins=draw(st.lists(geometry_margins, max_size=3).map(tuple)) or None,
        probabilities=draw(st.lists(probabilities, max_size=3).map(tuple)) or None,
    )


@st.composite
def bodies_modes(draw: st.DrawFn, bodies: int, contacts: int) -> BodiesMode:
    """A mode with these numbers of bodies and contacts."""
    of_contacts = draw(modes_of(contacts))
    return BodiesMode(
        accelerations_W=draw(arrays(bodies, 3)),
        angular_accelerations_W=draw(arrays(bodies, 3)),
        **{field.name: getattr(of_contacts, field.name) for field in dataclasses.fields(ResponseMode)},
    )


@st.composite
def bodies_contact_mode_answers(draw: st.DrawFn) -> BodiesContactModeAnswer:
    """Of up to three bodies with different names, which touch each other and the world."""
    names = draw(st.lists(st.sampled_from(["brick", "bat", "ü"]), min_size=1, max_size=3, unique=True))
    contacts, k = draw(contact_sets()), len(names)
    others = st.one_of(st.none(), st.integers(1, k - 1)) if k > 1 else st.none()
    pairs = draw(tuples_of(st.tuples(st.integers(0, k - 1), others), len(contacts)))
    return BodiesContactModeAnswer(
        bodies=tuple(NamedState(name=name, p_FB_F=NO_OFFSET, state=draw(states)) for name in names),
        contacts=contacts,
        pairs=tuple((first, None if ahead is None else (first + ahead) % k) for first, ahead in pairs),
        verdict=draw(st.sampled_from(ModeVerdict)),
        modes=draw(st.lists(bodies_modes(k, len(contacts)), max_size=2).map(tuple)),
        approaching=draw(st.lists(indices, max_size=2).map(tuple)),
        undecided_modes=draw(st.lists(texts, max_size=2).map(tuple)),
        velocity_tolerance=draw(positive),
        warnings=draw(warnings),
    )
