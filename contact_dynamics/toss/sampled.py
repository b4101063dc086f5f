"""Samples of a toss that is not known exactly, followed through the next strikes or to rest.

The next strikes of all samples are found together (`strikes_of_many`), in a tenth of a millisecond each. If
rest is asked for, each sample goes on from there as a toss does (`following`), and has its flights, its
impacts and the steps of its sliding done in arrays with those of others (`together`). That takes far longer.
It is done less exactly than a single toss: rebounds below `SAMPLED_SETTLING_HEIGHT` are not followed, and
neither is a body that only rattles on a face until it rests (`laid_flat`). It then has the world's gravity,
and not its own: in recorded slides, the gravity of the flight before leaves no trace, and the scatter of
friction that lasts holds what slides differ by.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.numerics.vectors import dot, norm
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.tolerances import SAMPLED_PHASE_ERROR, SAMPLED_SETTLING_HEIGHT
from contact_dynamics.toss.distribution import (
    FEWEST,
    Branch,
    BranchKind,
    EventRegions,
    Ghosts,
    TossDistribution,
    regions_of,
    rest_of,
)
from contact_dynamics.toss.following import Following, Run
from contact_dynamics.toss.law_spread import LawSpread
from contact_dynamics.toss.result import TossEnd, TossEventKind
from contact_dynamics.toss.solid import as_rows, solid_of
from contact_dynamics.toss.strikes_of_many import ManyStrikes, SampleEnd, strikes_of_many
from contact_dynamics.toss.together import together
from contact_dynamics.toss.uncertainty import EXACT, Samples, TossUncertainty, draw

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.impact.law import RestitutionLaw
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Numbers, Solid
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

MOST_SAMPLES: Final = 2000
"""Most samples of one toss."""

MOST_STRIKES: Final = 10
"""Deepest tree of next strikes."""

MOST_GHOSTS: Final = 30
"""Samples whose poses are kept for pictures."""

_MOST_EVENTS: Final = 500
_SAME_FACE: Final = 0.999  # cosine between normals of one face


def sampled_toss(
    body: Body,
    state: BodyState,
    world: World,
    *,
    covariance: FloatArray | None = None,
    by_gravity: tuple[float, float] = (0.0, 0.0),
    uncertainty: TossUncertainty = EXACT,
    count: int,
    strikes: int = 2,
    to_rest: bool = False,
    seed: int = 0,
    law: RestitutionLaw,
    horizon: float,
) -> TossDistribution:
    """Return what can happen in a toss whose state, parameters or impacts are not known exactly.

    Args:
        body: The body with its best parameters. Its shape has corners, which may be rounded.
        state: The best state.
        world: Surfaces, which are flats, and gravity.
        covariance: (12, 12), of the state, in the order of `questions.UncertainState`, or None if the state
            is exact.
        by_gravity: s^2 and s, by how much the best position and velocity change with gravity, as
            `FitResult.by_gravity`. A state that does not depend on gravity has zeros.
        uncertainty: How uncertain parameters and law are.
        count: Number of samples.
        strikes: How many next strikes the tree has.
        to_rest: Whether samples are followed to rest.
        seed: Samples are drawn from it. The same seed draws the same ones.
        law: What the coefficients of restitution mean.
        horizon: s, how far samples are followed.

    Raises:
        NoContactError: the body has no shape that could touch anything.
        NotSupportedError: the shape has rims, or a surface is an obstacle.
        InvalidFieldError: the parameters' covariance has another size than the world's surfaces ask for, or
            there are not as many factors as surfaces.
    """
    solid = solid_of(body, world, settling=SAMPLED_SETTLING_HEIGHT)
    chance = np.random.default_rng(seed)
    samples = draw(
        body,
        state,
        world,
        covariance=covariance,
        by_gravity=by_gravity,
        uncertainty=uncertainty,
        count=count,
        chance=chance,
    )
    spread = LawSpread(uncertainty, count, chance)
    told = strikes_of_many(
        solid, samples, law=law, spread=spread, depth=strikes, horizon=horizon, further=to_rest
    )
    rests: dict[int, _Rest] = {}
    if to_rest:
        runs = {
            i: _begun(solid, samples, told, spread, i, law=law, horizon=horizon)
            for i in np.flatnonzero(told.now < horizon).tolist()
        }
        together([run.go() for run in runs.values()])
        for i, run in runs.items():
            _tell(told, i, run)
            if run.end == TossEnd.RESTS:
                rests[i] = _Rest(float(told.now[i]) + run.now, run.y, run.resting_normal_B())
    faces, shares = _faces([each.normal_B for each in rests.values()], count)
    rest = None
    if rests:
        times = np.array([each.seconds for each in rests.values()])
        rest = rest_of(times, np.array([each.y[:3] for each in rests.values()]))
    return TossDistribution(
        samples=count,
        strikes=tuple(_marginals(told, count)),
        branches=tuple(_branches(solid, told, count)),
        face_normals_B=faces,
        face_probabilities=shares,
        rest=rest,
        ghosts=_ghosts(told, rests, count),
    )


class _Rest(NamedTuple):
    """How a sample rests.

    Attributes:
        seconds: s, when it comes to rest.
        y: The 13 numbers of its state.
        normal_B: The normal of the flat under it, body axes.
    """

    seconds: float
    y: Numbers
    normal_B: Vector3


def _begun(
    solid: Solid,
    samples: Samples,
    told: ManyStrikes,
    spread: LawSpread,
    i: int,
    *,
    law: RestitutionLaw,
    horizon: float,
) -> Run:
    """Return the toss that one sample goes on with."""
    inertia, corners = samples.inertias_B[i], samples.corners_B[i]
    flats = tuple(
        flat._replace(friction=mu, restitution=e, strike_friction=struck)
        for flat, mu, e, struck in zip(
            solid.flats,
            samples.lasting_frictions[i].tolist(),
            samples.restitutions[i].tolist(),
            samples.frictions[i].tolist(),
            strict=True,
        )
    )
    points = tuple((x, y, z) for x, y, z in corners.tolist())
    mine = solid._replace(
        inertia=as_rows(inertia.tolist()),
        inverse=as_rows(np.linalg.inv(inertia).tolist()),
        corners=points,
        reach=max(map(norm, points)) + solid.rounding,
        flats=flats,
    )
    p, q, v, w = (rows[i] for rows in told.last)
    state = BodyState(p_WB_W=p, q_WB=q / np.linalg.norm(q), v_WB_W=v, w_WB_W=w)
    following = Following(
        mine,
        MassProperties(mass=solid.mass, I_B=inertia),
        ConvexShape(vertices=corners, rounding=solid.rounding),
        law,
        horizon=horizon - float(told.now[i]),
        most_events=_MOST_EVENTS,
        error=SAMPLED_PHASE_ERROR,
        kick=None if spread.is_none else spread.of_one(i),
        flat_after=len(told.seconds) - int((told.corners[:, i] >= 0).sum()),
        thorough=False,
        has_pieces=False,
    )
    return Run(following, state, ())


def _tell(told: ManyStrikes, i: int, run: Run) -> None:
    """Tell of the strikes of one sample that the tree still lacks."""
    k = int((told.corners[:, i] >= 0).sum())
    later = [event for event in run.events if event.kind == TossEventKind.STRIKES]
    for event in later[: len(told.seconds) - k]:
        told.seconds[k, i] = told.now[i] + event.seconds
        ((told.surfaces[k, i], told.corners[k, i]),) = event.touching
        told.p_WB_W[k, i], told.q_WB[k, i] = event.y[:3], event.y[3:7]
        told.v_WB_W[k, i], told.w_WB_W[k, i] = event.y[7:10], event.y[10:]
        k += 1
    told.ends[i] = SampleEnd.FOLLOWED if k == len(told.seconds) else SampleEnd.ENDS


def _marginals(told: ManyStrikes, count: int) -> list[EventRegions]:
    found = []
    for k in range(len(told.seconds)):
        which = np.flatnonzero(told.corners[k] >= 0)
        if len(which) == 0:
            break
        found.append(_regions(told, k, which, count))
    return found


def _regions(told: ManyStrikes, k: int, which: NDArray[np.intp], count: int) -> EventRegions:
    return regions_of(
        len(which) / count,
        told.seconds[k, which],
        p=told.p_WB_W[k, which],
        q=told.q_WB[k, which],
        v=told.v_WB_W[k, which],
        w=told.w_WB_W[k, which],
    )


def _branches(solid: Solid, told: ManyStrikes, count: int) -> list[Branch]:
    """Return the tree, strike after strike."""
    branches: list[Branch] = []
    level = [(-1, np.arange(count))]
    for k in range(len(told.seconds)):
        after = []
        for parent, members in level:
            keys = [
                (int(told.surfaces[k, i]), int(told.corners[k, i]))
                if told.corners[k, i] >= 0
                else (-1, -int(told.ends[i]))
                for i in members
            ]
            for key, number in Counter(keys).most_common():
                which = members[[each == key for each in keys]]
                strikes = key[0] >= 0
                if strikes:
                    after.append((len(branches), which))
                branches.append(
                    Branch(
                        parent=parent,
                        strike=k + 1,
                        kind=BranchKind.STRIKES if strikes else BranchKind(-key[1]),
                        surface=solid.flats[key[0]].name if strikes else "",
                        corner=key[1] if strikes else -1,
                        probability=number / count,
                        regions=_regions(told, k, which, count) if strikes and number >= FEWEST else None,
                    )
                )
        level = after
    return branches


def _faces(rests: list[Vector3], count: int) -> tuple[FloatArray, FloatArray]:
    """Return the normals, (n, 3), of the faces that samples rest on, and their shares, the largest first."""
    faces: list[tuple[Vector3, int]] = []
    for each in rests:
        for k, (normal, number) in enumerate(faces):
            if dot(normal, each) > _SAME_FACE:
                faces[k] = (normal, number + 1)
                break
        else:
            faces.append((each, 1))
    faces.sort(key=lambda face: -face[1])
    normals = np.array([normal for normal, _ in faces]).reshape(-1, 3)
    return normals, np.array([number / count for _, number in faces])


def _ghosts(told: ManyStrikes, rests: dict[int, _Rest], count: int) -> Ghosts:
    rows = []
    for i in range(min(count, MOST_GHOSTS)):
        for k in np.flatnonzero(told.corners[:, i] >= 0).tolist():
            at = (told.p_WB_W[k, i], told.q_WB[k, i], told.v_WB_W[k, i], told.w_WB_W[k, i])
            rows.append((i, k + 1, np.concatenate(at)))
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
