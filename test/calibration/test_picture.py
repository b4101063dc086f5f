# SPDX-License-Identifier: Apache-2.0
"""Strikes side by side in rerun: what is drawn of a calibration, in a real file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from contact_dynamics.calibration import Calibration
from contact_dynamics.calibration.result import Outlier

pytest.importorskip("rerun", reason="NOT TESTED: rerun is not installed")

from contact_dynamics.calibration.picture import drawn_strikes, table_of, write_picture
from viewing.drawn import read_drawn


def with_one_left_out(found: Calibration) -> Calibration:
    """The calibration as if its best strike had been left out."""
    best = drawn_strikes(found)[-1]
    outlier = Outlier(
        recording=best.toss.name, kind="velocities after strikes", time=best.strike.time, size=9.0
    )
    return replace(found, outliers=(outlier,))


def test_strikes_that_were_left_out_come_first_and_then_the_worst(found: Calibration) -> None:
    rows = drawn_strikes(with_one_left_out(found))
    assert [row.rejected for row in rows] == [True] + [False] * (len(found.residuals) - 1)
    sizes = [float(row.deviations.max()) for row in rows[1:]]
    assert sizes == sorted(sizes, reverse=True)
    assert rows[0].deviations.max() <= min(sizes)


def test_velocities_are_those_of_the_calibrated_mass_centre(found: Calibration) -> None:
    """The mass centre is 5 mm off: at 5 rad/s its velocity is 25 mm/s off, far more than residuals are."""
    for row in drawn_strikes(found):
        state = row.strike.after.state
        arm = state.R_WB @ (found.body.p_FB_F - row.toss.motion.body.p_FB_F)
        assert row.measured[:3] == pytest.approx(state.velocity_of_point(state.p_WB_W + arm))
        # the noise is 3 mm/s; five standard deviations
        assert float(np.abs(row.predicted[:3] - row.measured[:3]).max()) < 0.015


def test_the_file_has_each_strike_with_both_velocities_and_marks_what_was_left_out(
    found: Calibration, tmp_path: Path
) -> None:
    path = tmp_path / "strikes.rrd"
    marked = with_one_left_out(found)
    assert write_picture(path, marked) == len(found.residuals)
    entities = read_drawn(path).entities
    for kind in ("velocity_after", "spin_after"):
        for name in ("measured", "predicted"):
            assert sum(each.endswith(f"/{kind}/{name}") for each in entities) == len(found.residuals)
    assert table_of(drawn_strikes(marked)).count("left out") == 1
