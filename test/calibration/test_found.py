# SPDX-License-Identifier: Apache-2.0
"""One calibration of made tosses: its estimates, report, content, parameters for the server, and pictures."""

from __future__ import annotations

import importlib
import importlib.util
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.made_tosses import BRICK, Truth, made_tosses, true_standard
from contact_dynamics.calibration import Calibration, calibrate
from contact_dynamics.calibration.estimation import extra_spread
from contact_dynamics.calibration.plots import write_plots
from contact_dynamics.calibration.report import content_of, report, server_parameters
from contact_dynamics.calibration.result import Outlier
from contact_dynamics.calibration.toss_uncertainty import toss_uncertainty
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameters import read_server_parameters

TRUTH = Truth()

needs_yaml = pytest.mark.skipif(
    importlib.util.find_spec("yaml") is None, reason="PyYAML of requirements/test.txt is not installed"
)


@pytest.fixture(scope="module")
def found() -> Calibration:
    """Both ways, from twelve tosses with the default truth."""
    return calibrate(made_tosses(TRUTH, 12, 0))


def test_it_finds_what_the_tosses_were_made_with(found: Calibration) -> None:
    assert [each.name for each in found.estimates] == [
        "center_of_mass.x",
        "center_of_mass.y",
        "center_of_mass.z",
        "inertia",
        "rounding",
        "friction.floor",
        "restitution.floor",
        "surface_height.floor",
    ]
    # 99.9 % of estimates lie within: a wrong law, frame or sign misses by hundreds of standard deviations
    assert found.distance(true_standard(TRUTH)) < found.region(0.999)
    assert not found.problems
    assert not found.undetermined


def test_tosses_are_sampled_with_the_covariance_that_was_found(found: Calibration) -> None:
    """Friction, restitution, mass centre, inertia: in another order, and the inertia as a relative change."""
    uncertainty = toss_uncertainty(found)
    names = ["friction.floor", "restitution.floor", *(f"center_of_mass.{axis}" for axis in "xyz")]
    for k, name in enumerate(names):
        assert math.sqrt(uncertainty.covariance[k, k]) == pytest.approx(found.estimate(name).std, rel=1e-9)
    inertia = found.estimate("inertia")
    assert math.sqrt(uncertainty.covariance[5, 5]) == pytest.approx(inertia.std / inertia.value, rel=1e-9)
    at = [each.name for each in found.estimates].index("friction.floor")
    assert uncertainty.covariance[0, 2] == pytest.approx(found.covariance[at, 0], rel=1e-9)
    assert uncertainty.velocity == found.spread.velocity
    assert found.gravity is not None
    np.testing.assert_array_equal(uncertainty.covariance[6:, 6:], found.gravity.covariance_W)
    sideways = math.hypot(found.gravity.turning, found.gravity.mean_std)
    assert math.sqrt(uncertainty.covariance[6, 6]) == pytest.approx(sideways, rel=1e-3)


def test_both_ways_find_it_and_agree(found: Calibration) -> None:
    for each, truth in zip(found.estimates, true_standard(TRUTH), strict=True):
        # sharp corners are the least rounding, at which it has no deviation
        assert abs(each.by_paths - truth) <= 5.0 * each.by_paths_std, each.name
        assert each.disagreement < 4.0, each.name
    assert max(each.by_paths_std / each.std for each in found.estimates) < 1.5


def test_gravity_is_found_toss_by_toss_with_its_tilt(found: Calibration) -> None:
    assert found.gravity is not None
    assert found.gravity.size == pytest.approx(TRUTH.gravity, abs=5.0 * found.gravity.size_std)
    assert found.gravity.tilt == pytest.approx(TRUTH.tilt, rel=0.3)
    assert found.gravity.expected_tilt < 0.5 * TRUTH.tilt
    # A tilt of one size in any direction: each component has 1 / sqrt(2) of it, or 1 / 1.18 by the median.
    assert 0.55 < found.gravity.turning / (TRUTH.gravity * TRUTH.tilt) < 1.0
    assert found.gravity.changing < 0.3 * found.gravity.turning


def test_configured_values_that_are_contradicted_are_said(found: Calibration) -> None:
    text = "\n".join(found.warnings)
    assert "friction.floor: configured as 0.3, estimated as 0.2" in text
    assert "restitution.floor: configured as 0.4" in text


def test_the_calibrated_body_and_surface_have_the_estimates(found: Calibration) -> None:
    assert found.body.p_FB_F == pytest.approx(np.array(TRUTH.center), abs=2e-4)
    # rounded corners keep their outer faces
    faces = found.body.shape.vertices + found.body.p_FB_F
    assert np.allclose(faces + np.sign(faces) * found.body.shape.rounding, BRICK.shape.vertices)
    assert found.surfaces[0].friction == found.estimate("friction.floor").value
    assert found.body.mass_properties.I_B[0, 0] / BRICK.mass_properties.I_B[0, 0] == pytest.approx(
        found.estimate("inertia").value
    )


@needs_yaml
def test_the_server_takes_the_parameters_as_they_are(found: Calibration, tmp_path: Path) -> None:
    """Read by the server's own reading, they describe the calibrated body and surface to the last bit."""
    path = tmp_path / "calibrated.yaml"
    found = replace(found, surfaces=(replace(found.surfaces[0], lasting_factor=1.4, lasting_speed=0.3),))
    path.write_text(server_parameters(found), encoding="utf-8")
    world = read_server_parameters(ParameterFile(path)).world
    body = world.body("brick")
    assert body.p_FB_F.tolist() == found.body.p_FB_F.tolist()
    assert body.mass_properties.I_B.tolist() == found.body.mass_properties.I_B.tolist()
    # the corners go through the body's frame and back, which rounds
    assert body.shape.vertices == pytest.approx(found.body.shape.vertices, abs=1e-15)
    assert world.gravity_W.tolist() == found.gravity_W.tolist()
    floor = world.surfaces[0]
    calibrated = found.surfaces[0]
    for field in ("name", "friction", "restitution", "lasting_factor", "lasting_speed"):
        assert getattr(floor, field) == getattr(calibrated, field), field


def test_the_report_says_what_was_used_found_and_contradicted(found: Calibration) -> None:
    text = report(found)
    assert f"first flights long enough, {len(found.residuals)} impacts of a single corner" in text
    assert "length scale x (clock rate)^2 is 0.9" in text
    assert "Warning: restitution.floor: configured as 0.4" in text


def test_the_content_is_plain_json_without_nan(found: Calibration) -> None:
    content = json.loads(json.dumps(content_of(found), allow_nan=False))
    assert [each["name"] for each in content["estimates"]] == [each.name for each in found.estimates]
    assert np.allclose(content["covariance"], found.covariance)
    assert len(content["strikes"]) == len(found.residuals) > 5


def test_pictures_are_drawn(found: Calibration, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    written = write_plots(tmp_path, found)
    assert [path.name for path in written] == ["residuals.png", "estimates.png"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written)


@pytest.fixture
def picture() -> Any:
    """The part that draws in rerun."""
    pytest.importorskip("rerun", reason="NOT TESTED: rerun is not installed")
    return importlib.import_module("contact_dynamics.calibration.picture")


def with_one_left_out(picture: Any, found: Calibration) -> Calibration:
    """The calibration as if its best strike had been left out."""
    best = picture.drawn_strikes(found)[-1]
    outlier = Outlier(
        recording=best.toss.name, kind="velocities after impacts", time=best.strike.time, size=9.0
    )
    return replace(found, outliers=(outlier,))


def test_strikes_that_were_left_out_come_first_and_then_the_worst(picture: Any, found: Calibration) -> None:
    rows = picture.drawn_strikes(with_one_left_out(picture, found))
    assert [row.rejected for row in rows] == [True] + [False] * (len(found.residuals) - 1)
    sizes = [float(row.deviations.max()) for row in rows[1:]]
    assert sizes == sorted(sizes, reverse=True)
    assert rows[0].deviations.max() <= min(sizes)


def test_velocities_are_those_of_the_calibrated_mass_centre(picture: Any, found: Calibration) -> None:
    """The mass centre is 5 mm off: at 5 rad/s its velocity is 25 mm/s off, far more than residuals are."""
    for row in picture.drawn_strikes(found):
        state = row.strike.after.state
        arm = state.R_WB @ (found.body.p_FB_F - row.toss.motion.body.p_FB_F)
        assert row.measured[:3] == pytest.approx(state.velocity_of_point(state.p_WB_W + arm))
        # the noise is 3 mm/s; five standard deviations
        assert float(np.abs(row.predicted[:3] - row.measured[:3]).max()) < 0.015


def test_the_file_has_each_strike_with_both_velocities_and_marks_what_was_left_out(
    picture: Any, found: Calibration, tmp_path: Path
) -> None:
    path = tmp_path / "strikes.rrd"
    marked = with_one_left_out(picture, found)
    assert picture.write_picture(path, marked) == len(found.residuals)
    from viewing.drawn import read_drawn

    entities = read_drawn(path).entities
    for kind in ("velocity_after", "spin_after"):
        for name in ("measured", "predicted"):
            assert sum(each.endswith(f"/{kind}/{name}") for each in entities) == len(found.residuals)
    assert picture.table_of(picture.drawn_strikes(marked)).count("excluded") == 1


def test_the_spread_beside_the_noise_is_found_though_a_tenth_is_far_off() -> None:
    random = np.random.default_rng(0)
    residuals = np.hypot(0.2, 0.3) * random.standard_normal((2000, 3))
    residuals[:200] *= 100.0
    # a tenth far off moves the median to the 55th of 100, by 8 % of the size
    found = extra_spread(residuals, np.broadcast_to(0.04 * np.eye(3), (2000, 3, 3)))
    assert found == pytest.approx(0.3, rel=0.15)


def test_there_is_none_where_the_noise_explains_all() -> None:
    residuals = 0.1 * np.random.default_rng(1).standard_normal((50, 3))
    assert extra_spread(residuals, np.broadcast_to(0.04 * np.eye(3), (50, 3, 3))) == 0.0
    assert extra_spread(np.zeros((0, 3)), np.zeros((0, 3, 3))) == 0.0
