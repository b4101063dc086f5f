# SPDX-License-Identifier: Apache-2.0
"""How well unseen tosses are predicted after calibration on others, beside MuJoCo and Drake, and its time.

The recordings are the published cube tosses (`measured.cube_tosses`); the environment variable CUBE_TOSSES
names their `tosses.npz`. `cube_split.json` says once and for all which tosses parameters may be fitted to
(``fit``, and ``few`` of these), and on which errors are told (``test``). The engines get the calibrated body,
gravity and floor. Their contacts are fitted to tosses of the same half, by strikes for strikes and by whole
tosses for whole tosses.
"""

from __future__ import annotations

import importlib.util
import json
import os
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks._cube_engines import STRIKE_STEP, DrakeCube, Given, Setting
from benchmarks._cube_rests import compare
from benchmarks._impact_tosses import Strike, _by_engine, about_centre
from benchmarks._measured_errors import print_both, print_head, print_row
from benchmarks._quotes import quote
from contact_dynamics.calibration import Free, calibrate_observed
from contact_dynamics.calibration.free import STANDARD
from contact_dynamics.calibration.impacts import velocities_after
from contact_dynamics.calibration.model import Model
from contact_dynamics.calibration.observed import observe
from contact_dynamics.evaluation.recording import recording_of_toss
from contact_dynamics.measured.cube_tosses import BOARD, CUBE, read_cube_toss

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.calibration import Calibration
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, Surface

STRIKE: Final = "calibration.strike"

RECORDINGS: Final = Path(
    os.environ.get("CUBE_TOSSES", Path(__file__).parents[2] / "shared/data/cube_tosses/tosses.npz")
)
"""The published tosses of a cube, if they are there."""


def run() -> None:
    """Print errors and times, or how to get the recordings."""
    path = RECORDINGS
    if not path.is_file():
        print("Calibration: set CUBE_TOSSES to the recordings' tosses.npz")
        return
    split = json.loads((Path(__file__).parent / "cube_split.json").read_text(encoding="utf-8"))
    begin = time.process_time()
    tosses = {index: observed_in(path, [index]) for index in split["fit"]}
    finding = (time.process_time() - begin) / len(tosses)
    seen = [each for index in split["fit"] for each in tosses[index]]
    few = [each for index in split["few"] for each in tosses[index]]
    unseen = observed_in(path, split["test"])
    strikes = strikes_in(unseen)
    print(f"Errors on {len(strikes)} strikes of single corners in {len(split['test'])} unseen tosses\n")
    print_head()
    print_row("no impact", "", "", strikes, _velocity)
    published = predicts(CUBE, BOARD, np.zeros(3))
    print_row(
        "published", BOARD.friction, BOARD.restitution, strikes, published, quoted=f"{STRIKE}.published"
    )
    found = {}
    print(f"{1e3 * finding:.0f} ms of processor time find the events of a toss. With these:")
    for count, given in ((20, few), (60, seen[:60]), (180, seen), (300, [*seen, *seen[:120]])):
        begin = time.process_time()
        found[count] = calibrate_observed(
            Model(given[0].motion.body, given[0].motion.surfaces),
            given,
            free=[each for each in STANDARD if each is not Free.ROUNDING],
            with_paths=False,
        )
        seconds = time.process_time() - begin
        print(
            f"{count} tosses, {len(found[count].residuals)} strikes: {seconds + finding * len(given):.1f} s, "
            f"{seconds:.1f} s of them to fit"
        )
        quote(f"calibration.time.{count}", seconds + finding * len(given), "s", digits=3)
    _calibrated("calibrated on 20", found[20], strikes, quoted=f"{STRIKE}.few")
    _calibrated("calibrated on 180", found[180], strikes, quoted=f"{STRIKE}.ours")
    _engines(found[180], strikes_in(seen), strikes)
    compare(found[180], seen, unseen)


def _calibrated(name: str, found: Calibration, unseen: Sequence[Strike], *, quoted: str) -> None:
    body, surface, centre = found.body, found.surfaces[0], found.body.p_FB_F
    moved = [about_centre(strike, centre) for strike in unseen]
    predict = predicts(body, surface, centre)
    print_row(name, surface.friction, surface.restitution, moved, predict, quoted=quoted)


def _engines(found: Calibration, seen: Sequence[Strike], unseen: Sequence[Strike]) -> None:
    body, surface, centre = found.body.mass_properties, found.surfaces[0], found.body.p_FB_F
    training = [about_centre(strike, centre) for strike in seen[::2]]
    moved = [about_centre(strike, centre) for strike in unseen]
    nominal = (surface.friction, surface.restitution)
    for name, engine in (("MuJoCo", _by_engine(body, centre)), ("Drake", _by_drake(found))):
        if engine is None:
            print(f"{name:>28}  is not installed")
        else:
            print_both(name, training, moved, nominal, engine, quoted=f"{STRIKE}.{name.lower()}")


def _by_drake(found: Calibration) -> Callable[[Strike, float, float], FloatArray] | None:
    """Return a prediction by Drake, stepped until the cube has left the floor, or None without Drake."""
    if importlib.util.find_spec("pydrake") is None:
        return None
    given = Given(found.body.mass_properties, found.body.p_FB_F, found.gravity_W, 0.0)
    cube = DrakeCube(given, step=STRIKE_STEP)

    def predict(strike: Strike, friction: float, restitution: float) -> FloatArray:
        before = strike.before
        touching = replace(before, p_WB_W=before.p_WB_W - [0.0, 0.0, float(strike.corner[2]) - 1e-5])
        return cube.velocity_after(touching, Setting(friction, restitution, 1e-6))

    return predict


def observed_in(path: Path, tosses: Sequence[int]) -> list[Observed]:
    """Return what is found in some of the tosses of a file."""
    found = []
    for index in tosses:
        for motion in recording_of_toss(read_cube_toss(path, index=index)).motions:
            found += observe(str(index), motion)
    return found


def strikes_in(observed: Sequence[Observed]) -> list[Strike]:
    """Return the strikes with the corners, as configured, at the tracked origin."""
    strikes = []
    for each in observed:
        for strike in each.strikes:
            before, after = strike.before.state, strike.after.state
            corner = before.p_WB_W + before.R_WB @ CUBE.vertices_B[strike.corner]
            velocity = np.concatenate([after.v_WB_W, after.w_WB_W])
            strikes.append(Strike(int(each.name.partition(",")[0]), before, corner, velocity, np.zeros(2)))
    return strikes


def predicts(body: Body, surface: Surface, centre: FloatArray) -> Callable[[Strike], FloatArray]:
    """Return a prediction of velocities after, about a mass centre."""
    model = Model(body, [surface])
    described = model.describe(model.configured)

    def predict(strike: Strike) -> FloatArray:
        before = strike.before
        corner = int(
            np.argmin(np.linalg.norm(_corners(before.p_WB_W, before.R_WB, centre) - strike.corner, axis=1))
        )
        return velocities_after(
            [described],
            body.mass_properties.mass,
            q_WB=before.q_WB[None, None],
            velocities_W=before.v_WB_W[None, None],
            spins_W=before.w_WB_W[None, None],
            corners=np.array([corner]),
            surfaces=np.array([0]),
        )[0, 0]

    return predict


def _corners(p_WB_W: FloatArray, R_WB: FloatArray, centre: FloatArray) -> FloatArray:
    corners: FloatArray = p_WB_W + (CUBE.vertices_B - centre) @ R_WB.T
    return corners


def _velocity(strike: Strike) -> FloatArray:
    return np.concatenate([strike.before.v_WB_W, strike.before.w_WB_W])
