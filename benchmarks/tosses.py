# SPDX-License-Identifier: Apache-2.0
"""How often measured tosses are in the regions that were predicted for them, and what predictions cost.

The recordings are the published cube tosses (`measured.cube_tosses`); the environment variable CUBE_TOSSES
names their `tosses.npz`. Parameters, their covariance and the law's own spread are calibrated on the tosses
``fit`` of `cube_split.json`. All that is printed is of those under ``test``, to which nothing was fitted.

Each toss is predicted from a fit to the first half of its first flight, before its first strike, under the
gravity of all tosses, with the noise of poses that the tosses under ``fit`` have (`measured_noise`).

What is measured at a strike comes from fits to both flights beside it. These are made under the gravity that
the toss itself shows. Under one gravity for all, they would share a quarter of the predictions' errors.

When and where the second strike comes is told by the flight before it alone (`_toss_strikes`). Few second
strikes have a flight after them, and which ones have depends on how the toss went. Among the tosses under
``fit``, with folds left out of the calibration, the regions of 90 % of the time held 11 of 16 of those, and
28 of the 29 others. Tosses for which samples have no flight between the strikes that a recording could show
are left out of that.
"""

from __future__ import annotations

import json
import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks._cube_engines import Given, Setting, engines
from benchmarks._flight_coverage import flown
from benchmarks._quotes import quote
from benchmarks._toss_strikes import Early, strikes
from benchmarks.calibration import observed_in
from contact_dynamics.calibration import calibrate_observed
from contact_dynamics.calibration.first_flights import gravity_and_center
from contact_dynamics.calibration.free import STANDARD
from contact_dynamics.calibration.model import Model
from contact_dynamics.calibration.toss_uncertainty import toss_uncertainty
from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.motion import StateNoise, fit_free_motion, measured_noise
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.toss import sampled_toss, toss
from contact_dynamics.world import World

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from concurrent.futures import Executor

    from contact_dynamics.calibration import Calibration
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.toss import TossDistribution, TossUncertainty
    from contact_dynamics.validation import FloatArray

FEWEST: Final = 6
"""Frames that a state is fitted to, at least."""

SAMPLES: Final = 200
RESTING: Final = 20
"""Tosses that are followed to rest."""

RESTING_SAMPLES: Final = 50
MANY: Final = 1000
"""Samples to rest that several processes share."""

PROCESSES: Final = 2
HORIZON: Final = 3.0


def run() -> None:
    """Print coverage and costs, or how to get the recordings."""
    path = Path(
        os.environ.get("CUBE_TOSSES", Path(__file__).parents[2] / "shared/data/cube_tosses/tosses.npz")
    )
    if not path.is_file():
        print("Tosses: set CUBE_TOSSES to the recordings' tosses.npz")
        return
    split = json.loads((Path(__file__).parent / "cube_split.json").read_text(encoding="utf-8"))
    seen = observed_in(path, split["fit"])
    free = STANDARD
    model = Model(seen[0].motion.body, seen[0].motion.surfaces)
    found = calibrate_observed(model, seen, free=free, with_paths=False)
    world = World(bodies=(found.body,), surfaces=found.surfaces, gravity_W=found.gravity_W)
    flights = list(flown(seen, found))
    noise = measured_noise(found.body.mass_properties, flights, gravity_W=found.gravity_W)
    early = _known_early(observed_in(path, split["test"]), found, noise)
    uncertainty = toss_uncertainty(found)
    strikes(early, world, partial(_predicted, world=world, uncertainty=uncertainty))
    (lasting,) = found.lasting_frictions
    print(
        f"\nfriction {world.surfaces[0].friction:.3f} in strikes, {lasting.friction:.3f} where contact lasts"
    )
    if found.gravity is not None:
        print(f"gravity scatters by {found.gravity.turning:.3f} m/s^2 sideways")
        quote("tosses.gravity.turning", found.gravity.turning, "m/s²", digits=3)
    quote("tosses.friction.strikes", world.surfaces[0].friction, digits=3)
    quote("tosses.friction.lasting", lasting.friction, digits=3)
    quote("tosses.friction.lasting_std", lasting.std, digits=1)
    quote("tosses.friction.scatter", lasting.scatter)
    resting = early[:: max(1, len(early) // RESTING)]
    _rests(resting, world, uncertainty, "rest")
    print("\nwith the friction of strikes alone:", end="")
    _rests(
        resting, world, replace(uncertainty, lasting_factors=(1.0,), lasting_factor_stds=()), "strikes_alone"
    )
    _costs(early[:10], world, uncertainty)


def _known_early(observed: Sequence[Observed], found: Calibration, noise: StateNoise) -> list[Early]:
    gravity, _ = gravity_and_center(observed, gravity_is_free=True)
    own = gravity.of(found.body.p_FB_F - observed[0].motion.body.p_FB_F)
    each = [_early(one, g_W, found, noise) for one, g_W in zip(observed, own, strict=True)]
    return [one for one in each if one is not None]


def _early(observed: Observed, gravity_W: FloatArray, found: Calibration, noise: StateNoise) -> Early | None:
    """Return what the first half of the first flight tells, if the toss strikes right after that flight."""
    if observed.first is None or not observed.strikes:
        return None
    flight, strike = observed.flights[0], observed.strikes[0]
    if not flight.start <= strike.frames_before.start < strike.frames_before.stop <= flight.stop:
        return None
    count = (strike.frames_before.stop - flight.start) // 2
    if count < FEWEST:
        return None
    motion = observed.motion
    states = [
        BodyState(
            p_WB_W=motion.p_WB_W[k],
            q_WB=motion.q_WB[k],
            v_WB_W=np.zeros(3),
            w_WB_W=np.zeros(3),
            stamp_ns=round(motion.times[k] * 1e9),
        )
        for k in range(flight.start, flight.start + count)
    ]
    states = [_about(state, found.body.p_FB_F) for state in states]
    fit = fit_free_motion(found.body.mass_properties, states, gravity_W=found.gravity_W, noise=noise)
    return Early(
        observed,
        gravity_W,
        fit.state,
        fit.covariance,
        fit.by_gravity or (0.0, 0.0),
        states[-1].stamp_ns * 1e-9,
    )


def _about(state: BodyState, centre: FloatArray) -> BodyState:
    """Return a state of the tracked origin as that of the mass centre, (3,), m, body axes."""
    offset = state.R_WB @ centre
    return BodyState(
        p_WB_W=state.p_WB_W + offset,
        q_WB=state.q_WB,
        v_WB_W=state.v_WB_W + np.cross(state.w_WB_W, offset),
        w_WB_W=state.w_WB_W,
        stamp_ns=state.stamp_ns,
    )


def _predicted(
    one: Early,
    world: World,
    uncertainty: TossUncertainty,
    *,
    count: int = SAMPLES,
    to_rest: bool = False,
    processes: int | Executor = 1,
) -> TossDistribution:
    return sampled_toss(
        world.bodies[0],
        one.state,
        world,
        covariance=one.covariance,
        by_gravity=one.by_gravity,
        uncertainty=uncertainty,
        count=count,
        to_rest=to_rest,
        restitution_law=RestitutionLaw.POISSON,
        horizon=HORIZON,
        processes=processes,
    )


def _rests(early: list[Early], world: World, uncertainty: TossUncertainty, name: str) -> None:
    """Print how often horizontal coordinates at rest are between the quantiles, and what the face had."""
    held, faces, off, best = [], [], [], 0
    begin = time.process_time()
    count = 0
    for one in early:
        if one.observed.rest is None:
            continue
        told = _predicted(one, world, uncertainty, count=RESTING_SAMPLES, to_rest=True)
        count += RESTING_SAMPLES
        if told.rest is None:
            continue
        state = _about(one.observed.rest.state, world.bodies[0].p_FB_F)
        place = state.p_WB_W[:2]
        low, quarter, _, three, high = told.rest.positions[:, :2]
        held += list(
            zip((quarter <= place) & (place <= three), (low <= place) & (place <= high), strict=True)
        )
        mean = told.rest.position.mean[:2]
        way = mean - one.state.p_WB_W[:2]
        off.append(float((mean - place) @ way / np.linalg.norm(way)))
        up_B = state.R_WB.T @ world.surfaces[0].normal_W
        shares = told.face_probabilities * (told.face_normals_B @ up_B > 0.9)  # cosine: it lies on that face
        faces.append(float(shares.sum()))
        best += int(shares[0] > 0.0)
    spent = 1e3 * (time.process_time() - begin) / max(count, 1)
    half, most = 100.0 * np.mean(held, axis=0)
    print(
        f"\nrest of {len(faces)} tosses: {half:.0f} and {most:.0f} % of the coordinates are between quantiles"
    )
    print("of 50 and 90 %; the face that they rest on had")
    print(f"{100 * np.mean(faces):.0f} % on average, and was the most probable one in {best}")
    print(f"samples go {100 * np.mean(off):.1f} cm farther than the cube on average")
    print(f"{spent:.0f} ms of processor time for each sample that is followed to rest")
    quote("tosses.rests", len(faces), "")
    quote(f"tosses.{name}.place.half", half, "%")
    quote(f"tosses.{name}.place.most", most, "%")
    quote(f"tosses.{name}.off", 100.0 * float(np.mean(off)), "cm")
    quote(f"tosses.{name}.face", 100.0 * float(np.mean(faces)), "%")
    quote(f"tosses.{name}.best", 100.0 * best / len(faces), "%")
    quote("tosses.cost.rest", spent, "ms")


def _costs(early: list[Early], world: World, uncertainty: TossUncertainty) -> None:
    """Print the processor time of the next two strikes, and of a single toss to rest."""
    for count in (100, 300, 1000):
        spent = [_spent(partial(_predicted, one, world, uncertainty, count=count)) for one in early]
        print(f"next two strikes of {count} samples: {np.median(spent):.0f} ms")
        quote(f"tosses.cost.{count}", float(np.median(spent)), "ms")
    body = world.bodies[0]
    for count in (100, 1000):
        if rollouts := _mujoco_rollouts(early, world, uncertainty, count):
            print(f"MuJoCo, {count} rollouts over the same time: {np.median(rollouts):.0f} ms")
            quote(f"tosses.cost.mujoco.{count}", float(np.median(rollouts)), "ms")
    spent = [_spent(partial(toss, body, one.state, world, max_alternatives=0)) for one in early]
    print(f"a single toss to rest: {np.median(spent):.0f} ms")
    quote("tosses.cost.single", float(np.median(spent)), "ms")
    _shared(early[0], world, uncertainty)


def _shared(one: Early, world: World, uncertainty: TossUncertainty) -> None:
    """Print how long many samples to rest take in one process and in several."""
    print(f"{MANY} samples to rest                   time    processor time")
    with ProcessPoolExecutor(PROCESSES, mp_context=get_context("spawn")) as executor:
        list(executor.map(_predicted, [one] * PROCESSES, [world] * PROCESSES, [uncertainty] * PROCESSES))
        for name, words, processes in (
            ("one", "in one process", 1),
            ("several", f"in {PROCESSES} processes", PROCESSES),
            ("running", f"in {PROCESSES} that run already", executor),
        ):
            begin, used = time.perf_counter(), sum(os.times()[:4])
            _predicted(one, world, uncertainty, count=MANY, to_rest=True, processes=processes)
            spent = time.perf_counter() - begin
            # The time of children counts once they have ended.
            worked = f"{sum(os.times()[:4]) - used:14.1f} s" if name != "running" else ""
            print(f"  {words:<32}{spent:6.1f} s{worked}")
            quote(f"tosses.cost.many.{name}", spent, "s")


def _mujoco_rollouts(
    early: list[Early], world: World, uncertainty: TossUncertainty, count: int
) -> list[float]:
    """Return the processor time of MuJoCo's rollouts until the second strike, ms, or nothing without MuJoCo.

    Each rollout takes the same time, wherever it starts, so that they all start from the fitted state.
    """
    body, floor = world.bodies[0], world.surfaces[0]
    given = Given(body.mass_properties, body.p_FB_F, world.gravity_W, float(floor.p_WS_W[2]))
    engine = engines(given).get("MuJoCo")
    if engine is None:
        return []
    setting = Setting(floor.friction, floor.restitution, engine.softness)

    def roll_out(state: BodyState, seconds: float) -> None:
        for _ in range(count):
            engine.poses(state, np.array([seconds]), setting)

    spent = []
    for one in early:
        strikes = _predicted(one, world, uncertainty).strikes
        if len(strikes) > 1:
            spent.append(_spent(partial(roll_out, one.state, float(strikes[1].seconds.mean[0]))))
    return spent


def _spent(work: Callable[[], object]) -> float:
    begin = time.process_time()
    work()
    return 1e3 * (time.process_time() - begin)
