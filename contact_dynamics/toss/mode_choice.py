# SPDX-License-Identifier: Apache-2.0
"""Selects the next contact mode of a body whose contacts touch and do not approach (lecture 26).

The present mode is tried first: sliding contacts continue to slide, and contacts at rest stick. If it is not
consistent, the forces of one consistent mode are computed (`cone_forces`), which determine the mode. If
friction at a contact could by itself lift the body or press it down (Painleve), several modes or none may be
consistent, and all of them are computed (`contact_modes`). The same is done if all contacts slide and their
forces may not be unique (`_several_forces`). If some stick, all modes are computed on request, provided that
friction may wedge the body between planes.

Contacts at rest stick if static friction can hold them, although the body could then also begin to slide.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STICKS
from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.tolerances import (
    BEGINNING_ROUNDING,
    BEGINNING_TURN,
    FORCE_ROUNDING,
    SAME_FORCES,
    SLIDING_STOPPED,
)
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.cone_forces import ConeForces
from contact_dynamics.toss.forces import HeldContacts, force_rounding, pushed_by_contacts
from contact_dynamics.toss.solid import Held, contacts_of, pose_of, properties_of, state_of

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Flat, Numbers, Pose, Solid, Touch
    from contact_dynamics.validation import FloatArray

Mode = tuple[Held, ...]

_MAX_CORRECTIONS: Final = 30
"""Largest number of corrections of a guessed mode. One to three are usual."""

_FEW_CORRECTIONS: Final = 8
"""Number of rounds after which all directions of incipient sliding are computed together."""


_MAX_TURNS: Final = 12
"""Largest number of Newton steps for these directions."""

_FARTHEST: Final = 0.5
"""rad. The largest turn of a step: a friction cone is round."""


_WEDGED_FROM: Final = 0.75
"""Cones that have this share of the angle between one normal and the other reversed are looked at. Among 3000
drawn rods at rest or moving, with two tips on two flats and frictions up to 2, all that had several modes had
more. With a share of 1, a fifth of those on a floor and a wall would be missed."""


class Choice(NamedTuple):
    """The consistent contact modes.

    Attributes:
        verdict: Verdict on the contact set.
        modes: Held contacts of each mode, without those that separate. The first mode is the default.
        pushed: Rates and forces in the first mode, or None if they were not computed.
    """

    verdict: ModeVerdict
    modes: list[Mode]
    pushed: HeldContacts | None = None

    def pushed_in(self, way: int, solid: Solid, y: Numbers) -> HeldContacts:
        """Return the rates and forces in a mode. ``y`` is the state for which the modes were computed."""
        if way == 0 and self.pushed is not None:
            return self.pushed
        return pushed_by_contacts(solid, y, self.modes[way])


def choose_mode(
    solid: Solid,
    y: Numbers,
    touching: list[Touch],
    thorough: bool = False,  # noqa: FBT001, FBT002  C has no keywords
) -> Choice:
    """Return the consistent modes of touching contacts that do not approach.

    With ``thorough``, all modes are computed if friction may wedge the body, which takes some 10 to 50 ms.
    """
    if not touching:
        return Choice(ModeVerdict.UNIQUE, [()])
    pose = pose_of(solid, y)
    guess, ways, paradox, all_slide = [], [], False, True
    choice = Choice(ModeVerdict.UNDECIDED, [])
    for touch in touching:
        surface, corner = touch
        flat, arm = solid.flats[surface], pose.arm(surface, corner)
        n = flat.normal
        t1, t2 = flat.tangents
        velocity = pose.velocity(arm)
        u, v = vec.dot(velocity, t1), vec.dot(velocity, t2)
        speed = math.sqrt(u * u + v * v)
        moves = speed > SLIDING_STOPPED
        slides = moves or flat.friction == 0.0  # nothing makes it stick
        all_slide = all_slide and slides
        d = (0.0, 0.0, 0.0)
        if slides:
            d = pose.sliding(arm, n, n)
        guess.append(Held(touch, slides, d))
        turning = vec.times(pose.inverse, vec.cross(arm, n))
        normal = 1.0 / solid.mass + vec.dot(vec.cross(arm, n), turning)
        coupling = vec.cross(turning, arm)
        p, q = vec.dot(coupling, t1), vec.dot(coupling, t2)
        across = math.sqrt(p * p + q * q)
        if slides:
            u, v = (u / speed, v / speed) if moves else (0.0, 0.0)
            across = p * u + q * v
        ways.append((u, v))
        paradox = paradox or flat.friction * across >= normal
    if paradox or (len(guess) > 1 and all_slide and _several_forces(solid, pose, guess)):
        paradox = True
        choice = _all_modes(solid, y, touching)
        if len(choice.modes) > 1:
            _put_first(choice.modes, guess)
            return choice
    mode, pushed = corrected(solid, y, tuple(guess))
    if mode is None:
        cones = _cones_of(solid, pose, guess, ways)
        if not cones.solve(1.0 / solid.mass, 0.0):
            return choice if paradox else _all_modes(solid, y, touching)
        mode = _read_off(solid, y, guess, cones)
    others, verdict = [], ModeVerdict.UNIQUE
    if thorough and not paradox and may_be_wedged(solid, touching):
        known = _all_modes(solid, y, touching)
        others = [other for other in known.modes if _letters(other) != _letters(mode)]
        verdict = known.verdict if others else verdict
    return Choice(verdict, [mode, *others], pushed)


def _cones_of(solid: Solid, pose: Pose, guess: list[Held], ways: list[tuple[float, float]]) -> ConeForces:
    """Return the contact problem. ``ways`` are the directions of sliding contacts along the two tangents."""
    cones = ConeForces(len(guess))
    for one, (u, v) in zip(guess, ways, strict=True):
        arm = pose.arm(one.flat, one.corner)
        moves = pose.acceleration(one.flat, arm, solid.gravity, pose.alpha)
        cones.add(pose, arm, solid.flats[one.flat], moves, 0.0)
        if one.slides:
            cones.slide(u, v)
    return cones


def _put_first(modes: list[Mode], guess: list[Held]) -> None:
    """Move the mode that continues the present motion to the front."""
    going_on = [(one.touch, one.slides) for one in guess]
    modes.sort(key=lambda mode: [(one.touch, one.slides) for one in mode] != going_on)


def _letters(mode: Mode) -> set[tuple[Touch, bool]]:
    return {(one.touch, one.slides) for one in mode}


def _several_forces(solid: Solid, pose: Pose, sliding: list[Held]) -> bool:
    """Return whether contacts that all slide may have several consistent sets of forces, or none.

    Normal forces f >= 0 and normal accelerations b + M f >= 0, of which one is zero at each contact, are
    unique for any b where all principal minors of M are positive (Cottle, Pang and Stone, The Linear
    Complementarity Problem, 3.3.7). Those of two and three contacts are looked at here, those of one by the
    caller. Flush contacts have minors of zero, which change forces, but hardly the motion.
    """
    per_mass, inverse = 1.0 / solid.mass, pose.inverse
    moments, forces = [], []
    for one in sliding:
        flat, arm = solid.flats[one.flat], pose.arm(one.flat, one.corner)
        n, d, mu = flat.normal, one.towards, flat.friction
        force = (n[0] - mu * d[0], n[1] - mu * d[1], n[2] - mu * d[2])
        moments.append((n, vec.cross(arm, n)))
        forces.append((force, vec.times(inverse, vec.cross(arm, force))))
    M = [
        [per_mass * vec.dot(n, force) + vec.dot(moment, turning) for force, turning in forces]
        for n, moment in moments
    ]
    sizes = [sum(map(abs, row)) for row in M]
    for i, j in combinations(range(len(M)), 2):
        if M[i][i] * M[j][j] - M[i][j] * M[j][i] < -SAME_FORCES * sizes[i] * sizes[j]:
            return True
    for i, j, k in combinations(range(len(M)), 3):
        volume = vec.dot(
            (M[i][i], M[i][j], M[i][k]),
            vec.cross((M[j][i], M[j][j], M[j][k]), (M[k][i], M[k][j], M[k][k])),
        )
        if volume < -SAME_FORCES * sizes[i] * sizes[j] * sizes[k]:
            return True
    return False


def _beginning(touch: Touch, towards: Vector3) -> Held:
    return Held(touch, True, towards, True)  # noqa: FBT003  C has no keywords


def corrected(solid: Solid, y: Numbers, guess: Mode) -> tuple[Mode, HeldContacts] | tuple[None, None]:
    """Return a consistent mode near a guess with its rates and forces, or None if corrections find none.

    In each round, a contact with a pulling force separates, one that approaches is held again, one whose
    friction exceeds the limit slides against its friction, and one that begins to slide does so along its
    acceleration, or sticks if the acceleration opposes its sliding.
    """
    held: list[Held | None] = list(guess)  # None where a contact separates
    for k in range(_MAX_CORRECTIONS):
        mode = tuple([one for one in held if one is not None])
        if k >= _FEW_CORRECTIONS:
            mode = _turned_along_accelerations(solid, y, mode)
            turned = {one.touch: one for one in mode}
            held = [turned.get(first.touch) for first in guess]
        pushed = pushed_by_contacts(solid, y, mode)
        after: list[Held | None] = []
        i = 0
        for first, one in zip(guess, held, strict=True):
            force = (0.0, 0.0, 0.0)
            if one is not None:
                force = pushed.force(i)
                i += 1
            after.append(_correction(solid, first, one, force, pushed))
        if after == held:
            return mode, pushed
        held = after
    return None, None


def _correction(
    solid: Solid, first: Held, one: Held | None, force: Vector3, pushed: HeldContacts
) -> Held | None:
    """Return the contact in the next round of corrections, or None if it separates.

    Args:
        solid: The body and the planes.
        first: The contact in the initial guess, which contains whether it slides already.
        one: The contact in this round, or None if it separates.
        force: Force at the contact, N, or zero.
        pushed: The held contacts of this round, with the accelerations.
    """
    flat = solid.flats[first.flat]
    n = flat.normal
    least = -force_rounding(solid)
    slowest = BEGINNING_ROUNDING * (1.0 + vec.norm(solid.gravity))
    if one is None:
        acceleration = pushed.accelerated(first.flat, first.corner)
        return first if vec.dot(n, acceleration) < -slowest else None
    pressing = vec.dot(force, n)
    if pressing < least:
        return None
    if not one.slides:
        across = vec.without(force, n)
        holds = flat.holding() * pressing - vec.norm(across) >= least
        return one if holds else _beginning(one.touch, vec.opposite(vec.normalised(across)))
    if not first.slides:
        begins = vec.without(pushed.accelerated(first.flat, first.corner), n)
        if vec.dot(begins, one.towards) < -slowest:
            return first
        if vec.norm(vec.cross(begins, one.towards)) > slowest:
            return _beginning(one.touch, vec.normalised(begins))
    return one


def _read_off(solid: Solid, y: Numbers, guess: list[Held], cones: ConeForces) -> Mode:
    """Return the mode that corresponds to a solution of the contact problem."""
    size = max([vec.norm(cones.alone(i)) for i in range(len(guess))])
    most = max([vec.norm(cones.push(i)) for i in range(len(guess))])
    idle: list[Held] = []
    held: list[Held] = []
    for i, one in enumerate(guess):
        motion = cones.motion(i)
        pressing = cones.push(i)[2] > FORCE_ROUNDING * most
        if not pressing and motion[2] > FORCE_ROUNDING * size:
            continue
        kept = one
        speed = math.sqrt(motion[0] * motion[0] + motion[1] * motion[1])
        if not one.slides and speed > FORCE_ROUNDING * size:
            t1, t2 = solid.flats[one.flat].tangents
            u, v = motion[0] / speed, motion[1] / speed
            d = (u * t1[0] + v * t2[0], u * t1[1] + v * t2[1], u * t1[2] + v * t2[2])
            kept = _beginning(one.touch, d)
        (held if pressing else idle).append(kept)
    everything = tuple(held + idle)
    if idle and pushed_by_contacts(solid, y, everything).least_left() >= 0.0:
        return everything
    return tuple(held)


def _all_modes(solid: Solid, y: Numbers, touching: list[Touch]) -> Choice:
    """Return all consistent modes (`contact_modes`)."""
    answer = spatial_contact_modes(
        SpatialContactProblem(
            body=properties_of(solid),
            state=state_of(y),
            contacts=contacts_of(solid, y, touching),
            force_W=solid.mass * np.array(solid.gravity),
            velocity_tolerance=SLIDING_STOPPED,
        )
    )
    pose = pose_of(solid, y)
    modes = []
    for one in answer.modes:
        mode = []
        for k, touch in enumerate(touching):
            letter = one.mode[k]
            if letter == SEPARATES:
                continue
            arm = pose.arm(touch[0], touch[1])
            velocity = pose.velocity(arm)
            n = solid.flats[touch[0]].normal
            x, yy, z = one.tangential_directions_W[k].tolist()
            direction = (x, yy, z)
            v_n = vec.dot(velocity, n)
            speed = math.sqrt(max(vec.dot(velocity, velocity) - v_n * v_n, 0.0))
            if speed > SLIDING_STOPPED:
                direction = pose.sliding(arm, n, n)
            slides = letter != STICKS and direction != (0.0, 0.0, 0.0)
            begins = slides and speed <= SLIDING_STOPPED
            slides = slides or solid.flats[touch[0]].friction == 0.0
            mode.append(Held(touch, slides, direction if slides else (0.0, 0.0, 0.0), begins))
        modes.append(tuple(mode))
    return Choice(answer.verdict, modes)


def _turned_along_accelerations(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> tuple[Held, ...]:
    """Return a mode in which contacts begin to slide along their accelerations, if one is found.

    Friction opposes the direction of sliding, so that the acceleration depends on it. A fixed-point iteration
    of the direction converges if the friction limit is far exceeded. If it is hardly exceeded, accelerations
    are small and depend strongly on the direction of friction, and the iteration cycles. This function finds
    all directions together by Newton's method.
    """
    which = [k for k, one in enumerate(mode) if one.begins]
    if not which:
        return mode
    enough = 0.1 * BEGINNING_ROUNDING * (1.0 + vec.norm(solid.gravity))

    def sideways(tried: tuple[Held, ...]) -> FloatArray:
        """Return the accelerations across the directions of sliding, m/s^2."""
        pushed, found = pushed_by_contacts(solid, y, tried), []
        for k in which:
            one = tried[k]
            across = vec.cross(solid.flats[one.flat].normal, one.towards)
            found.append(vec.dot(across, pushed.accelerated(one.flat, one.corner)))
        return np.array(found)

    for _ in range(_MAX_TURNS):
        off = sideways(mode)
        if np.abs(off).max() <= enough:
            break
        slopes = [(sideways(_turned(solid, mode, {k: BEGINNING_TURN})) - off) / BEGINNING_TURN for k in which]
        turns = np.linalg.lstsq(np.array(slopes).T, -off, rcond=None)[0]
        largest = float(np.abs(turns).max())
        if largest > _FARTHEST:
            turns *= _FARTHEST / largest
        mode = _turned(solid, mode, dict(zip(which, turns.tolist(), strict=True)))
    return mode


def _turned(solid: Solid, mode: tuple[Held, ...], turns: dict[int, float]) -> tuple[Held, ...]:
    """Return a mode with some directions of sliding turned about their normals, rad."""
    return tuple(
        Held(one.touch, one.slides, _about(solid.flats[one.flat].normal, one.towards, turns[k]), one.begins)
        if k in turns
        else one
        for k, one in enumerate(mode)
    )


def _about(n: Vector3, d: Vector3, angle: float) -> Vector3:
    e, c, s = vec.cross(n, d), math.cos(angle), math.sin(angle)
    return (c * d[0] + s * e[0], c * d[1] + s * e[1], c * d[2] + s * e[2])


def may_be_wedged(solid: Solid, touching: list[Touch]) -> bool:
    """Return whether friction at some two contacts on different flats may wedge the body between them.

    A body that touches two flats can be held by forces between the two contacts alone, as large as one likes,
    if the friction cone of one contact and the reversed one of the other share a line. So it may stick or
    fall, whatever the load (a rod between two walls). Some cases with weaker friction have several modes too.
    """
    flats = [solid.flats[surface] for surface in sorted({surface for surface, _ in touching})]
    return any(_cones_may_meet(one, other) for one, other in combinations(flats, 2))


def _cones_may_meet(one: Flat, other: Flat) -> bool:
    turned = vec.opposite(other.normal)
    between = math.atan2(vec.norm(vec.cross(one.normal, turned)), vec.dot(one.normal, turned))
    friction = math.atan(one.holding()) + math.atan(other.holding())
    return friction > 0.0 and friction >= _WEDGED_FROM * between
