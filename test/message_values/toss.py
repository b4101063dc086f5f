# SPDX-License-Identifier: Apache-2.0
"""Random answers about tosses, and their parts."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.questions import TossAnswer, TossPath
from contact_dynamics.toss import (
    Branch,
    BranchKind,
    EventRegions,
    Ghosts,
    Region,
    RestSpread,
    TossDistribution,
    TossEnd,
    TossEnergy,
    TossEvent,
    TossEventKind,
    Undecided,
    UndecidedReason,
)
from message_values.shared import (
    NAMES,
    NO_OFFSET,
    arrays,
    fits,
    flags,
    indices,
    many_states,
    numbers,
    some,
    states,
    texts,
    trajectories,
    tuples_of,
)


def region(values: np.ndarray) -> Region:
    """A region of one to three numbers, made of twelve or more."""
    k = 1 + len(values) % 3
    return Region(mean=values[:k], covariance=values[:9].reshape(3, 3)[:k, :k], radii=values[-2:])


regions = st.integers(37, 39).flatmap(arrays).map(region)
event_regions = arrays(75).map(
    lambda values: EventRegions(
        probability=float(values[0]),
        seconds=region(values[:12]),
        position=region(values[12:25]),
        q_WB=values[70:74],
        turn=region(values[25:39]),
        velocity=region(values[39:51]),
        spin=region(values[51:64]),
    )
)
branches = st.builds(
    Branch,
    parent=st.integers(-1, 9),
    strike=st.integers(1, 10),
    kind=st.sampled_from(BranchKind),
    surface=texts,
    corner=st.integers(-1, 9),
    probability=st.floats(0.0, 1.0),
    regions=some(event_regions),
)
rests = st.builds(RestSpread, seconds=arrays(5), positions=arrays(5, 3), position=regions)


@st.composite
def toss_distributions(draw: st.DrawFn) -> TossDistribution:
    """With up to one strike and branch and two faces and ghosts, at rest or not followed so far."""
    states, faces = draw(many_states(draw(st.integers(0, 2)))), draw(st.integers(0, 2))
    count = len(states)
    return TossDistribution(
        samples=draw(st.integers(1, 2000)),
        strikes=draw(tuples_of(event_regions, draw(st.integers(0, 1)))),
        branches=draw(tuples_of(branches, draw(st.integers(0, 1)))),
        face_normals_B=draw(arrays(faces, 3)),
        face_probabilities=draw(arrays(faces)),
        face_positions=draw(tuples_of(regions, faces)),
        to_rest=draw(st.booleans()),
        rest=draw(some(rests)),
        ghosts=Ghosts(
            samples=np.array(draw(tuples_of(indices, count)), dtype=np.int64),
            strikes=np.array(draw(tuples_of(indices, count)), dtype=np.int64),
            p_WB_W=states.p_WB_W,
            q_WB=states.q_WB,
            v_WB_W=states.v_WB_W,
            w_WB_W=states.w_WB_W,
        ),
    )


@st.composite
def toss_events(draw: st.DrawFn) -> TossEvent:
    """At up to two contacts."""
    n = draw(st.integers(0, 2))
    return TossEvent(
        seconds=draw(numbers),
        kind=draw(st.sampled_from(TossEventKind)),
        surfaces=draw(tuples_of(texts, n)),
        corners=draw(tuples_of(indices, n)),
        p_WC_W=draw(arrays(n, 3)),
        impulse_W=draw(arrays(3)),
        outcome=draw(some(st.sampled_from(ImpactOutcome))),
        mode=draw(st.sampled_from(["", "f", "cf"])),
        state=draw(states),
    )


@st.composite
def toss_paths(draw: st.DrawFn) -> TossPath:
    """With up to two events and undecided points."""
    undecided = st.builds(
        Undecided, seconds=numbers, reason=st.sampled_from(UndecidedReason), options=indices, taken=indices
    )
    energy = st.builds(
        TossEnergy, first=numbers, lost_in_strikes=numbers, lost_in_contact=numbers, left=numbers
    )
    return TossPath(
        end=draw(st.sampled_from(TossEnd)),
        seconds=draw(numbers),
        trajectory=draw(trajectories()),
        events=draw(tuples_of(toss_events(), draw(st.integers(0, 2)))),
        resting_corners=draw(tuples_of(indices, draw(st.integers(0, 4)))),
        resting_normal_B=draw(arrays(3)),
        energy=draw(energy),
        undecided=draw(tuples_of(undecided, draw(st.integers(0, 2)))),
    )


@st.composite
def toss_answers(draw: st.DrawFn) -> TossAnswer:
    """With and without alternatives, fit and distribution."""
    return TossAnswer(
        body_name=draw(st.sampled_from(NAMES)),
        p_FB_F=NO_OFFSET,
        state=draw(states),
        fit=draw(some(fits)),
        toss=draw(toss_paths()),
        alternatives=draw(tuples_of(toss_paths(), draw(st.integers(0, 1)))),
        all_followed=draw(flags),
        distribution=draw(some(toss_distributions())),
    )
