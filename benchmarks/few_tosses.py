# SPDX-License-Identifier: Apache-2.0
"""What calibrations from few tosses are worth: how often their intervals hold, and their largest errors.

Tosses are drawn from the half of `cube_split.json` that parameters may be fitted to. The intervals should
contain what all recordings say, and errors are those on the other half (`calibration`).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks._impact_tosses import about_centre
from benchmarks._quotes import quote
from benchmarks.calibration import RECORDINGS, observed_in, predicts, strikes_in
from contact_dynamics.calibration import calibrate_observed
from contact_dynamics.calibration.model import Model
from contact_dynamics.measured.cube_tosses import count_cube_tosses

if TYPE_CHECKING:
    from collections.abc import Sequence

    from benchmarks._impact_tosses import Strike
    from contact_dynamics.calibration import Calibration
    from contact_dynamics.calibration.observed import Observed

DRAWS: Final = 40
COUNTS: Final = (5, 10, 20, 60)
NORMAL: Final = 1.645
"""Standard deviations on each side of a 90 % interval."""


def run() -> None:
    """Print the table, or how to get the recordings."""
    if not RECORDINGS.is_file():
        print("Few tosses: set CUBE_TOSSES to the recordings' tosses.npz")
        return
    split = json.loads((Path(__file__).parent / "cube_split.json").read_text(encoding="utf-8"))
    tosses = {index: observed_in(RECORDINGS, [index]) for index in range(count_cube_tosses(RECORDINGS))}
    whole = _calibrated([each for found in tosses.values() for each in found])
    unseen = strikes_in([each for index in split["test"] for each in tosses[index]])
    print(f"{DRAWS} draws; intervals of 90 % against {len(tosses)} tosses; {len(unseen)} unseen strikes\n")
    print(f"{'tosses':>6} {'exit 0':>7} {'inside':>7} {'least':>6}   angular, rad/s: median, worst draw")
    for count in COUNTS:
        random = np.random.default_rng(count)
        drawn = [random.choice(split["fit"], count, replace=False).tolist() for _ in range(DRAWS)]
        found = [_calibrated([each for index in draw for each in tosses[index]]) for draw in drawn]
        _row(count, found, whole, unseen)


def _row(count: int, found: Sequence[Calibration], whole: Calibration, unseen: Sequence[Strike]) -> None:
    trusted = [each for each in found if not each.problems and not each.undetermined]
    name = f"few_tosses.{count}"
    share = 100.0 * len(trusted) / len(found)
    quote(f"{name}.trusted", share, "%")
    if not trusted:
        print(f"{count:>6} {share:6.0f} %")
        return
    held = np.array([_inside(each, whole) for each in trusted])
    errors = [_angular(each, unseen) for each in trusted]
    inside, least = 100.0 * float(np.nanmean(held)), 100.0 * float(np.nanmean(held, axis=0).min())
    quote(f"{name}.inside", inside, "%")
    quote(f"{name}.least", least, "%")
    quote(f"{name}.angular", float(np.median(errors)), "rad/s")
    quote(f"{name}.worst", max(errors), "rad/s")
    print(
        f"{count:>6} {share:6.0f}% {inside:6.0f}% {least:5.0f}%   {np.median(errors):.2f}, {max(errors):.2f}",
        flush=True,
    )


def _calibrated(given: Sequence[Observed]) -> Calibration:
    motion = given[0].motion
    return calibrate_observed(Model(motion.body, motion.surfaces), given, with_paths=False)


def _inside(found: Calibration, whole: Calibration) -> list[float]:
    """Return 1 where the interval contains the value of all tosses, 0 where not, NaN without an interval."""
    return [
        float(abs(each.value - there.value) <= NORMAL * each.std) if each.std > 0.0 else np.nan
        for each, there in zip(found.estimates, whole.estimates, strict=True)
    ]


def _angular(found: Calibration, unseen: Sequence[Strike]) -> float:
    """Return the median error of angular velocities after unseen strikes, rad/s."""
    centre = found.body.p_FB_F
    predict = predicts(found.body, found.surfaces[0], centre)
    moved = [about_centre(strike, centre) for strike in unseen]
    return float(np.median([np.linalg.norm((predict(each) - each.after)[3:]) for each in moved]))
