# SPDX-License-Identifier: Apache-2.0
"""Whole tosses of the published cube, from the end of the first flight to rest: predicted and measured poses.

A state is fitted to the poses of the first flight, as far as the calibration takes it, and the prediction
begins at its last frame. So nothing is known of what follows. Errors are those of the tracked frame, in
shares of the cube's width and in degrees: at the last frame, and their mean over all frames.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from scipy.optimize import minimize

from benchmarks._cube_engines import CubeEngine, Given, Setting, engines
from benchmarks._quotes import quote
from contact_dynamics.measured.cube_tosses import BOARD, CUBE, GRAVITY, HALF_SIDE
from contact_dynamics.measured.flight_fit import fit_flight
from contact_dynamics.rotations.many import matrices_of, rotation_vectors
from contact_dynamics.tolerances import TOUCHING_GAP
from contact_dynamics.toss import TossEnd, toss
from contact_dynamics.world import World

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import TypeAlias

    from contact_dynamics.calibration import Calibration
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, Surface

    Roll: TypeAlias = "Callable[[BodyState, FloatArray], tuple[FloatArray, FloatArray]]"

FITTED_TO: Final = 40
"""Tosses that the engines' contacts are fitted to, of the half that may be fitted to."""

MAX_FITS: Final = {2: 20, 3: 45}
"""Settings that are tried, by the number of those that are free."""

REST: Final = "calibration.rest"


class Case(NamedTuple):
    """One toss."""

    state: BodyState  # the state of the centre of mass
    times: FloatArray  # (n,), s after it
    p_W: FloatArray  # (n, 3), m, the tracked origin
    q_WB: FloatArray  # (n, 4)


def compare(found: Calibration, seen: Sequence[Observed], unseen: Sequence[Observed]) -> None:
    """Print the errors of this package and of the engines, and offer them to the documents."""
    body, surface, gravity_W = found.body, found.surfaces[0], found.gravity_W
    test = _cases(unseen, body, gravity_W)
    print(f"\nWhole tosses: {len(test)} unseen ones, from the end of the first flight to rest")
    print(
        f"{'':>28} {'place at rest, %':>18} {'attitude, degrees':>18} {'over frames':>18} {'ms a toss':>10}"
    )
    print(f"{'':>28} {'median':>9}{'mean':>9} {'median':>9}{'mean':>9} {'%':>9}{'degrees':>9}")
    published_g = np.array([0.0, 0.0, -GRAVITY])
    as_published = _cases(unseen, CUBE, published_g)
    as_is = _ours(CUBE, BOARD, published_g)
    _row("published", as_published, np.zeros(3), as_is, quoted=f"{REST}.published")
    _row("calibrated", test, body.p_FB_F, _ours(body, surface, gravity_W), quoted=f"{REST}.ours")
    strikes_alone = _ours(body, replace(surface, lasting_factor=1.0), gravity_W)
    _row("with one friction", test, body.p_FB_F, strikes_alone, quoted=f"{REST}.one_friction")
    training = _cases(seen, body, gravity_W)[:FITTED_TO]
    start = Setting(surface.friction, max(surface.restitution, 0.02), 1.0)

    def ours(setting: Setting) -> Roll:
        fitted = replace(surface, friction=setting.friction, restitution=min(setting.restitution, 1.0))
        return _ours(body, fitted, gravity_W)

    _fitted("calibrated, fitted", (training, test), body.p_FB_F, start, ours, quoted=f"{REST}.fitted")
    given = Given(body.mass_properties, body.p_FB_F, gravity_W, float(surface.p_WS_W[2]))
    for name, engine in engines(given).items():

        def theirs(setting: Setting, engine: CubeEngine = engine) -> Roll:
            return lambda state, times: engine.poses(state, times, setting)

        softer = start._replace(softness=engine.softness)
        _fitted(name, (training, test), body.p_FB_F, softer, theirs, quoted=f"{REST}.{name.lower()}")


def _fitted(
    name: str,
    cases: tuple[Sequence[Case], Sequence[Case]],
    centre: FloatArray,
    start: Setting,
    roll_with: Callable[[Setting], Roll],
    *,
    quoted: str,
) -> None:
    """Print errors on the second set of tosses, with the contact that fits the first best.

    A softness of 1 is none, and stays.
    """
    training, test = cases
    free = 2 if start.softness == 1.0 else 3

    def setting(x: FloatArray) -> Setting:
        factors = np.exp(np.concatenate([x, np.zeros(3 - free)]))
        return Setting(*(np.array(start) * factors).tolist())

    def cost(x: FloatArray) -> float:
        errors = _errors(training, centre, roll_with(setting(x)))
        # the mean over frames, with a radian as half a side
        return float(np.mean(0.02 * errors[:, 2] + np.radians(errors[:, 3])))

    simplex = np.vstack([np.zeros(free), np.diag([0.1, -0.5, 0.7][:free])])
    options = {"maxfev": MAX_FITS[free], "initial_simplex": simplex, "xatol": 0.02, "fatol": 1e-3}
    best = setting(minimize(cost, np.zeros(free), method="Nelder-Mead", options=options).x)
    _row(name, test, centre, roll_with(best), quoted=quoted)
    print(f"{'':>28} fitted: mu {best.friction:.3f}, e {best.restitution:.3f}, softness {best.softness:.2g}")


def _cases(observed: Sequence[Observed], body: Body, gravity_W: FloatArray) -> list[Case]:
    found = []
    for each in observed:
        if each.first is None or each.rest is None:
            continue
        motion = each.motion
        moved = replace(
            motion,
            body=body,
            world=replace(motion.world, gravity_W=gravity_W),
            p_WB_W=motion.p_WB_W + matrices_of(motion.q_WB) @ body.p_FB_F,
        )
        last = each.first.stop - 1
        state = fit_flight(moved, each.first).at(float(motion.times[last])).state
        times = motion.times[last:] - motion.times[last]
        found.append(Case(state, times, motion.p_WB_W[last:], motion.q_WB[last:]))
    return found


def _ours(body: Body, surface: Surface, gravity_W: FloatArray) -> Roll:
    world = World(bodies=(body,), surfaces=(surface,), gravity_W=gravity_W)

    def roll(state: BodyState, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        went = toss(body, state, world, max_alternatives=0, distance_tolerance=TOUCHING_GAP)
        known = times if went.end == TossEnd.RESTS else np.minimum(times, went.seconds)
        path = went.at(known)
        return path.p_WB_W, path.q_WB

    return roll


def _errors(cases: Sequence[Case], centre: FloatArray, roll: Roll) -> FloatArray:
    """Return the errors of place, %, and attitude, degrees, of each toss: at the end, and over the frames."""
    rows = []
    for case in cases:
        p, q = roll(case.state, case.times)
        off = np.linalg.norm(p - matrices_of(q) @ centre - case.p_W, axis=1)
        place = 100.0 * off / (2.0 * HALF_SIDE)
        attitude = np.degrees(np.linalg.norm(rotation_vectors(q, case.q_WB), axis=1))
        rows.append([place[-1], attitude[-1], place.mean(), attitude.mean()])
    return np.array(rows)


def _row(name: str, cases: Sequence[Case], centre: FloatArray, roll: Roll, *, quoted: str = "") -> None:
    begin = time.process_time()
    errors = _errors(cases, centre, roll)
    each = 1e3 * (time.process_time() - begin) / len(cases)
    median, mean = np.median(errors, axis=0), errors.mean(axis=0)
    print(
        f"{name:>28} {median[0]:9.0f}{mean[0]:9.0f} {median[1]:9.1f}{mean[1]:9.1f} "
        f"{mean[2]:9.1f}{mean[3]:9.1f} {each:10.1f}",
        flush=True,
    )
    if quoted:
        for kind, value, unit, digits in (
            ("place_median", median[0], "%", 2),
            ("place", mean[0], "%", 2),
            ("attitude_median", median[1], "°", 3),
            ("attitude", mean[1], "°", 3),
            ("place_frames", mean[2], "%", 3),
            ("attitude_frames", mean[3], "°", 3),
            ("time", each, "ms", 2),
        ):
            quote(f"{quoted}.{kind}", float(value), unit, digits=digits)
