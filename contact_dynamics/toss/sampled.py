# SPDX-License-Identifier: Apache-2.0
"""Samples of an uncertain toss, simulated through the next strikes or to rest.

The next strikes of all samples are computed first (`next_strikes`), which takes a few hundredths of a
millisecond each. With ``to_rest``, the simulation of each sample continues to rest (`to_rest`). This takes
far longer and can be shared by several processes. It is less accurate than a single toss: rebounds below
`SAMPLED_SETTLING_HEIGHT` are not resolved, and a body that only rattles on a face is laid flat (`laid_flat`).
From there on, samples have the world's gravity instead of their own. In recorded slides, no effect of the
gravity of the flight before is visible, and the scatter of sustained friction covers their differences.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import HORIZON
from contact_dynamics.contact.found import check_not_inside
from contact_dynamics.errors import TooLargeError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.numerics.vectors import dot
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, SAMPLED_SETTLING_HEIGHT
from contact_dynamics.toss.distinct_corners import with_distinct_corners
from contact_dynamics.toss.distribution import (
    FEWEST,
    Branch,
    BranchKind,
    EventRegions,
    Ghosts,
    TossDistribution,
    region_of_face,
    regions_of,
    rest_of,
)
from contact_dynamics.toss.impacts import check_laws
from contact_dynamics.toss.law_spread import LawSpread
from contact_dynamics.toss.next_strikes import ManyStrikes, SampleEnd, next_strikes
from contact_dynamics.toss.solid import solid_of
from contact_dynamics.toss.to_rest import check_processes, followed_to_rest
from contact_dynamics.toss.uncertainty import EXACT, MAX_SPREAD, TossUncertainty, draw, exact_inputs
from contact_dynamics.tumbling.motion import check_extent
from contact_dynamics.validation import (
    check_array,
    check_magnitude,
    check_positive,
    check_whole,
)
from contact_dynamics.validation_batches import check_covariance

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Solid
    from contact_dynamics.toss.to_rest import Followed
    from contact_dynamics.world import Body, SurfaceFrame, World

MAX_SAMPLES: Final = 2000
"""Largest number of samples."""

MAX_STRIKES: Final = 10
"""Largest depth of the tree of next strikes."""

MAX_GHOSTS: Final = 30
"""Number of samples whose poses are kept for visualization."""

_SAME_FACE: Final = 0.999  # cosine between normals of one face


def sampled_toss(
    body: Body,
    state: BodyState,
    world: World,
    *,
    covariance: ArrayLike | None = None,
    by_gravity: tuple[float, float] = (0.0, 0.0),
    uncertainty: TossUncertainty = EXACT,
    count: int = 200,
    strikes: int = 2,
    to_rest: bool = False,
    seed: int = 0,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    several_contacts_law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL,
    horizon: float = HORIZON,
    processes: int | Executor = 1,
    distance_tolerance: float = DISTANCE_TOLERANCE,
) -> TossDistribution:
    """Return the possible outcomes of a toss with an uncertain state, uncertain parameters or impacts.

    Args:
        body: Body with the best estimate of its parameters. Its shape has corners, which may be rounded.
        state: Best estimate of the state.
        world: Surfaces, which must be planes, and gravity. They may move as in `toss`.
        covariance: (12, 12), covariance of the state, or None if the state is exact. Rows and columns are
            position (m), rotation vector (rad, applied after the attitude), velocity of the centre of mass
            (m/s) and angular velocity (rad/s), each as x, y, z in world axes. `rigid_body.state_covariance`
            makes one from standard deviations.
        by_gravity: s^2 and s, derivatives of the estimated position and velocity with respect to gravity, as
            in `FitResult.by_gravity`. Use zeros for a state that does not depend on gravity.
        uncertainty: Uncertainty of friction, restitution, other parameters and the impact law. By default all
            of them are exact. The uncertainty of the state is ``covariance``.
        count: Number of samples, from 1 to `MAX_SAMPLES`. Standard errors of probabilities are at most 0.5 /
            sqrt(count), which is 0.035 for 200.
        strikes: Depth of the tree of next impacts, from 1 to `MAX_STRIKES`.
        to_rest: Whether to follow samples to rest. Otherwise, the result contains no resting face and
            position.
        seed: Seed of the samples, >= 0. The same seed yields the same samples.
        restitution_law: Law of restitution. ENERGETIC requires SEQUENTIAL.
        several_contacts_law: Law for several simultaneous impacts, as of a face that lands flat. In
            the tree, they are one impact of the corner that approaches fastest.
        horizon: s, > 0. Duration of the longest motion that is followed.
        processes: Number of processes that share the samples followed to rest, or an executor of
            `concurrent.futures`, which keeps its processes from toss to toss. The answer is the same bit for
            bit. Each process handles 100 samples at a time (`to_rest.PART`), so more processes than such
            parts have no effect. With a number, each call starts new processes, which takes about half a
            second. New processes import the main module, so put a program's work under
            ``if __name__ == "__main__":``, as with `multiprocessing`.
        distance_tolerance: m, >= 0. Largest initial penetration of a surface by the best state; 1e-6 m is
            always accepted. Samples may penetrate by more.

    Raises:
        NoContactError: the body has no shape that could touch anything.
        NotSupportedError: the shape has circular rims, a surface is an obstacle, or surfaces move differently
            or rotate.
        TooLargeError: there are more samples than `MAX_SAMPLES`, or the search for the end of a flight takes
            too many steps.
        InvalidFieldError: a number is out of range, the state's covariance is not positive semidefinite or
            exceeds `MAX_SPREAD` squared, the size of the parameters' covariance does not match the number of
            surfaces, the number of factors differs from the number of surfaces, ``processes`` is neither a
            whole number >= 1 nor an executor, or the body penetrates a surface by more than the tolerance.
        BrokenProcessPool: a process died, for example because the main module is not guarded as described
            above.

    Examples:
        >>> import contact_dynamics as cd
        >>> brick = cd.Body.box((0.15, 0.09, 0.05), mass=0.4)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.4
        ... )
        >>> thrown = cd.BodyState(
        ...     p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[1.5, 0, 2], w_WB_W=[0.5, 9, 0.3]
        ... )
        >>> covariance = cd.state_covariance(velocity=0.05, angular_velocity=0.5)
        >>> world = cd.World(surfaces=(floor,))
        >>> tosses = cd.sampled_toss(brick, thrown, world, covariance=covariance, count=50, to_rest=True)
        >>> for face, share in zip(tosses.faces_on_top, tosses.face_probabilities):
        ...     print(f"{face}: {share:.0%}")
        +z: 48%
        -z: 36%
        +y: 14%
        -y: 2%
    """
    shared_by = check_processes(processes)
    if check_whole("count", count, 1) > MAX_SAMPLES:
        raise TooLargeError("count", count, f"at most {MAX_SAMPLES}")
    strikes = check_whole("strikes", strikes, 1, MAX_STRIKES)
    horizon = check_positive("horizon", horizon)
    if covariance is not None:
        covariance = check_covariance("covariance", covariance)
    check_extent(state, world.gravity_W)
    world, frame = world.seen_from_surfaces("sampled_toss")
    state = state if frame is None else frame.seen(state)
    check_not_inside(body, state, world.surfaces, distance_tolerance=distance_tolerance)
    check_laws(restitution_law, several_contacts_law)
    body, indices = with_distinct_corners(body)
    solid = solid_of(body, world, indices=indices, settling=SAMPLED_SETTLING_HEIGHT)
    chance = np.random.default_rng(check_whole("seed", seed, 0))
    samples = draw(
        body,
        state,
        world,
        covariance=covariance,
        by_gravity=check_magnitude("by_gravity", check_array("by_gravity", by_gravity, (2,)), MAX_SPREAD),
        uncertainty=uncertainty,
        count=count,
        chance=chance,
    )
    spread = LawSpread(uncertainty, count, chance)
    many = next_strikes(
        solid,
        samples,
        law=restitution_law,
        together=several_contacts_law,
        spread=spread,
        depth=strikes,
        horizon=horizon,
        further=to_rest,
    )
    rests: dict[int, Followed] = {}
    if to_rest:
        followed = followed_to_rest(
            many,
            spread,
            law=restitution_law,
            several_contacts_law=several_contacts_law,
            horizon=horizon,
            processes=shared_by,
        )
        for i, one in followed.items():
            _add_strikes(many, i, one)
        rests = {i: one for i, one in followed.items() if one.rests}
    if frame is not None:
        _carry(many, rests, frame)
    rest, positions = None, np.array([each.y[:3] for each in rests.values()])
    faces = _faces([each.normal_B for each in rests.values()])
    if rests:
        rest = rest_of(np.array([each.seconds for each in rests.values()]), positions)
    marginals = tuple(_marginals(many, count))
    return TossDistribution(
        samples=count,
        strikes=marginals,
        branches=tuple(_branches(solid, many, marginals)),
        face_normals_B=np.array([normal for normal, _ in faces]).reshape(-1, 3),
        face_probabilities=np.array([len(which) / count for _, which in faces]),
        face_positions=tuple(region_of_face(positions[which]) for _, which in faces),
        rest=rest,
        ghosts=_ghosts(many, rests, count),
        to_rest=to_rest,
        exact=exact_inputs(uncertainty, covariance),
    )


def _add_strikes(many: ManyStrikes, i: int, followed: Followed) -> None:
    """Add the strikes of one sample that are missing in the tree."""
    k = int((many.corners[:, i] >= 0).sum())
    for seconds, touch, y in followed.strikes:
        many.seconds[k, i] = seconds
        many.surfaces[k, i], many.corners[k, i] = touch
        many.states[k, i] = y
        k += 1
    many.ends[i] = SampleEnd.FOLLOWED if k == len(many.seconds) else SampleEnd.ENDS


def _carry(many: ManyStrikes, rests: dict[int, Followed], frame: SurfaceFrame) -> None:
    """Transform strikes and states of rest from the frame of moving surfaces to the world."""
    many.states[:, :, :3] += frame.displacement(many.seconds)
    many.states[:, :, 7:10] += frame.velocity(many.seconds)
    for one in rests.values():
        one.y[:3] = (one.y[:3] + frame.displacement(one.seconds)).tolist()
        one.y[7:10] = (one.y[7:10] + frame.velocity(one.seconds)).tolist()


def _marginals(many: ManyStrikes, count: int) -> list[EventRegions]:
    found = []
    for k in range(len(many.seconds)):
        which = np.flatnonzero(many.corners[k] >= 0)
        if len(which) == 0:
            break
        found.append(_regions(many, k, which, count))
    return found


def _regions(many: ManyStrikes, k: int, which: NDArray[np.intp], count: int) -> EventRegions:
    y = many.states[k, which]
    return regions_of(
        len(which) / count, many.seconds[k, which], p=y[:, :3], q=y[:, 3:7], v=y[:, 7:10], w=y[:, 10:]
    )


def _branches(solid: Solid, many: ManyStrikes, marginals: tuple[EventRegions, ...]) -> list[Branch]:
    """Return the tree, strike after strike. ``marginals`` are the regions of all samples with each strike."""
    branches: list[Branch] = []
    count = len(many.now)
    level = [(-1, np.arange(count))]
    for k in range(len(many.seconds)):
        after = []
        # Keys >= 0 number the striking contact, and keys < 0 the reason why there is none.
        contacts = many.surfaces[k] * solid.count + many.corners[k]
        keys = np.where(many.corners[k] >= 0, contacts, -1 - many.ends)
        for parent, members in level:
            found = np.unique(keys[members], return_index=True, return_counts=True)
            ways = zip(*(each.tolist() for each in found), strict=True)
            for key, _, number in sorted(ways, key=lambda way: (-way[2], way[1])):
                which = members[keys[members] == key]
                strikes = key >= 0
                surface, corner = divmod(key, solid.count)
                regions = None
                if strikes:
                    after.append((len(branches), which))
                    if number == (many.corners[k] >= 0).sum():
                        regions = marginals[k]
                    elif number >= FEWEST:
                        regions = _regions(many, k, which, count)
                branches.append(
                    Branch(
                        parent=parent,
                        strike=k + 1,
                        kind=BranchKind.STRIKES if strikes else BranchKind(-1 - key),
                        surface=solid.flats[surface].name if strikes else "",
                        corner=solid.indices[corner] if strikes else -1,
                        probability=number / count,
                        regions=regions if number >= FEWEST else None,
                    )
                )
        level = after
    return branches


def _faces(rests: list[Vector3]) -> list[tuple[Vector3, list[int]]]:
    """Return the normals of resting faces with the indices of their samples, most frequent first."""
    faces: list[tuple[Vector3, list[int]]] = []
    for i, each in enumerate(rests):
        for normal, which in faces:
            if dot(normal, each) > _SAME_FACE:
                which.append(i)
                break
        else:
            faces.append((each, [i]))
    return sorted(faces, key=lambda face: -len(face[1]))


def _ghosts(many: ManyStrikes, rests: dict[int, Followed], count: int) -> Ghosts:
    rows = []
    for i in range(min(count, MAX_GHOSTS)):
        rows += [(i, k + 1, many.states[k, i]) for k in np.flatnonzero(many.corners[:, i] >= 0).tolist()]
        if i in rests:
            rows.append((i, 0, np.array(rests[i].y)))
    numbers = np.array([row for _, _, row in rows]).reshape(-1, 13)
    return Ghosts(
        samples=np.array([i for i, _, _ in rows], dtype=np.int64),
        strikes=np.array([k for _, k, _ in rows], dtype=np.int64),
        p_WB_W=numbers[:, :3],
        q_WB=numbers[:, 3:7] / np.linalg.norm(numbers[:, 3:7], axis=1, keepdims=True),
        v_WB_W=numbers[:, 7:10],
        w_WB_W=numbers[:, 10:],
    )
