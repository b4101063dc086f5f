# SPDX-License-Identifier: Apache-2.0
"""Calibration of made tosses, whose every parameter is known."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from calibration.made_tosses import BRICK, FLOOR, RATE, SIZE, Truth, made_tosses, true_standard, true_values
from contact_dynamics.calibration import Calibration, Free, calibrate
from contact_dynamics.calibration.free import GEOMETRY, STANDARD
from contact_dynamics.calibration.model import Model
from contact_dynamics.calibration.observed import observe
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.measured.motion import COLUMNS
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.shapes import box, cylinder, union

TRUTH = Truth()
NOISY = Truth(law_velocity=0.01, law_spin=0.1)
"""With errors of the law beside those of the measurement."""


SHARP = [each for each in STANDARD if each not in GEOMETRY]
"""What strikes of a body determine whose shape and floor are known."""


def test_the_laws_own_spread_is_found_beside_the_noise() -> None:
    spread = calibrate(
        made_tosses(Truth(law_velocity=0.03, law_spin=0.4), 12, 1), free=SHARP, with_paths=False
    ).spread
    # 12 strikes have 36 components, whose robust spread is known to some 17 %
    assert spread.velocity == pytest.approx(0.03, rel=0.35)
    assert spread.spin == pytest.approx(0.4, rel=0.35)


def test_a_start_at_which_every_corner_sticks_still_finds_the_friction() -> None:
    found = calibrate(made_tosses(TRUTH, 6, 6), with_paths=False)
    assert found.estimate("friction.floor").value == pytest.approx(TRUTH.friction, abs=0.01)


def test_a_few_tosses_are_called_too_few_and_have_larger_errors() -> None:
    found = calibrate(made_tosses(NOISY, 4, 11), with_paths=False)
    assert any("The 4 impacts of single corners are in 4 tosses" in text for text in found.problems)
    assert not found.by_cluster
    # Student's t of four: 90 % lie within 2.35 deviations, as 1.645 stated ones
    assert found.distance(true_standard(NOISY)) < found.region(0.9)


def test_an_estimate_at_its_bound_is_a_problem() -> None:
    """Without friction, errors of the law push it below zero as often as above."""
    found = calibrate(made_tosses(replace(NOISY, friction=0.0), 8, 15), free=SHARP, with_paths=False)
    friction = found.estimate("friction.floor")
    assert friction.at_bound
    assert friction.value == 0.0
    assert math.isnan(friction.std)
    assert any(text.startswith("friction.floor is at the end of its range") for text in found.problems)


def test_no_corners_are_looked_for_that_are_rounder_than_half_of_what_fits_into_the_body() -> None:
    (rounding,) = [each for each in Model(BRICK, [FLOOR]).parameters if each.name == "rounding"]
    assert rounding.upper == pytest.approx(0.25 * SIZE[2])


def test_recordings_with_renamed_axes_are_named() -> None:
    """Half a turn about z leaves the brick's corners where they were, but not its centre of mass."""
    motions = made_tosses(TRUTH, 12, 0)
    half_turn = Rotation.from_euler("z", math.pi)
    for k in (2, 7):
        motions[k] = replace(motions[k], q_WB=(Rotation.from_quat(motions[k].q_WB) * half_turn).as_quat())
    found = calibrate(motions, free=SHARP, with_paths=False)
    (text,) = [text for text in found.problems if "axes of the body" in text]
    assert "renamed: motion 2, motion 7." in text


def test_a_recording_that_disagrees_with_the_others_is_a_problem() -> None:
    motions = made_tosses(TRUTH, 7, 0)
    motions += made_tosses(replace(TRUTH, restitution=0.2), 1, 3)
    found = calibrate(motions, free=SHARP, with_paths=False)
    assert any(text.startswith("1 of 8 tosses contain outliers") for text in found.problems)
    assert any("motion 7" in text for text in found.problems)


def test_heights_that_the_shape_does_not_explain_are_a_problem() -> None:
    larger = box(size=1.3 * SIZE)
    body = replace(BRICK, shape=larger, vertices_B=np.zeros((0, 3)))
    found = calibrate(
        [replace(motion, body=body) for motion in made_tosses(TRUTH, 6, 12)], free=SHARP, with_paths=False
    )
    assert any("Touching corners are" in text for text in found.problems)


def test_errors_include_that_the_surface_may_be_lower_instead_of_the_body_smaller() -> None:
    """The floor is 2 mm lower than configured, but the size is free. By scatter, it is 33 errors off."""
    motions = [replace(m, p_WB_W=m.p_WB_W - [0.0, 0.0, 2e-3]) for m in made_tosses(TRUTH, 12, 1)]
    found = calibrate(motions, free=[*SHARP, Free.SIZE], with_paths=False)
    for name, truth in (("size", 1.0), ("inertia", TRUTH.inertia)):
        each = found.estimate(name)
        assert abs(each.value - truth) < 3.0 * each.std, name


def test_ratios_of_moments_far_from_the_configured_ones_are_found() -> None:
    """Flights alone. The configured moment about z is 30 % too large, nearly as large as those of a plate."""
    motions = [motion.part(0, 38) for motion in made_tosses(replace(TRUTH, inertia=1.0), 3, 4)]
    E = np.diag([1.0, 1.0, math.sqrt(1.3)])
    properties = MassProperties(mass=BRICK.mass_properties.mass, I_B=E @ BRICK.mass_properties.I_B @ E)
    found = calibrate(
        [replace(motion, body=replace(BRICK, mass_properties=properties)) for motion in motions],
        free=[Free.INERTIA_RATIOS, Free.CENTER_OF_MASS, Free.GRAVITY],
        with_paths=False,
    )
    y, z = found.estimate("inertia_ratio.y"), found.estimate("inertia_ratio.z")
    assert not y.at_bound
    assert not z.at_bound
    assert abs(y.value - 1.0) < 3.0 * y.std
    assert abs(z.value - 1.0 / 1.3) < 3.0 * z.std
    assert not found.problems


@pytest.fixture(scope="module")
def many() -> list[Calibration]:
    """Two hundred made data sets of twenty tosses. Each takes four seconds, and is told when it is there."""
    truth, calibrations = NOISY, []
    for seed in range(200):
        found = calibrate(made_tosses(truth, 20, 1000 + seed), free=SHARP)
        way, other = (found.distance(true_values(truth), by_paths=second) for second in (False, True))
        print(f"set {seed}: {way:.2f} and {other:.2f} of {found.region(0.9):.2f}", flush=True)  # noqa: T201
        calibrations.append(found)
    return calibrations


@pytest.mark.slow
def test_the_90_percent_regions_of_both_ways_hold_the_truth_in_85_to_95_percent(
    many: list[Calibration],
) -> None:
    truth = true_values(NOISY)
    first = np.mean([found.distance(truth) <= found.region(0.9) for found in many])
    second = np.mean([found.distance(truth, by_paths=True) <= found.region(0.9) for found in many])
    assert 0.85 <= first <= 0.95
    assert 0.85 <= second <= 0.95


@pytest.mark.slow
def test_where_the_model_holds_it_is_said_to_fail_in_less_than_a_tenth_of_the_sets(
    many: list[Calibration],
) -> None:
    # two standard deviations for all parameters together are exceeded by chance in 4.6 %; of 200 sets, in
    # more than 10 % once in a thousand times
    said = [any("The two estimates disagree" in text for text in found.warnings) for found in many]
    assert np.mean(said) < 0.1


def test_a_body_that_never_flies_is_refused() -> None:
    motion = made_tosses(TRUTH, 1, 3)[0]
    still = replace(motion, p_WB_W=np.tile(motion.p_WB_W[:1], (len(motion), 1)))
    with pytest.raises(InvalidFieldError, match="without a flight"):
        calibrate([still])


def test_flights_without_a_strike_leave_friction_undetermined_and_say_so() -> None:
    motions = [motion.part(0, 30) for motion in made_tosses(TRUTH, 6, 4)]
    found = calibrate(motions)
    assert any("no impact of a single corner in 6 tosses with 6 flights" in text for text in found.problems)
    assert not found.estimate("friction.floor").determined
    assert found.estimate("friction.floor").value == FLOOR.friction
    assert set(found.undetermined) == {
        "friction.floor +0.5",
        "restitution.floor +0.5",
        "inertia +0.3",
        "rounding +0.018 m",
        "surface_height.floor +0.018 m",
    }
    assert math.isnan(found.estimate("inertia").std)
    assert found.estimate("center_of_mass.x").determined
    assert found.gravity is not None


def test_one_strike_alone_is_called_too_few() -> None:
    found = calibrate(made_tosses(TRUTH, 1, 5), with_paths=False)
    assert any("only one impact of a single corner" in text for text in found.problems)
    assert not found.by_cluster


def test_mislabelled_quaternions_are_recognised() -> None:
    """World into body instead of body into world: flights are smooth, but the corners are elsewhere."""
    motions = [replace(m, q_WB=m.q_WB * [-1.0, -1.0, -1.0, 1.0]) for m in made_tosses(TRUTH, 4, 6)]
    found = calibrate(motions, with_paths=False)
    assert any("published frame, its quaternion's order or the surface" in text for text in found.problems)


def test_gravity_along_another_axis_is_recognised() -> None:
    motions = made_tosses(TRUTH, 3, 7)
    turned_world = replace(motions[0].world, gravity_W=np.array([0.0, -6.0, -8.0]))
    found = calibrate([replace(motion, world=turned_world) for motion in motions], with_paths=False)
    assert any("The world axes are probably mislabelled" in text for text in found.problems)


def test_a_surface_that_is_not_flat_is_recognised() -> None:
    bowed = calibrate(made_tosses(replace(TRUTH, bow=0.25), 18, 8), with_paths=False)
    assert any("Surface 'floor' is not flat: heights deviate by" in text for text in bowed.problems)


def test_a_body_without_corners_is_refused() -> None:
    parts = union([box(0.1, 0.1, 0.1), box(0.1, 0.1, 0.1).moved([0.1, 0.1, 0])])
    for shape, found in ((cylinder(0.05, 0.1), "rims of a round shape"), (parts, "several parts")):
        body = replace(BRICK, shape=shape, vertices_B=np.zeros((0, 3)))
        with pytest.raises(NotSupportedError, match=found):
            Model(body, [FLOOR])


def test_states_of_two_bodies_are_refused() -> None:
    first, second = made_tosses(TRUTH, 2, 9)
    with pytest.raises(InvalidFieldError, match="those of one body"):
        calibrate([first, replace(second, body=replace(BRICK, name="other", vertices_B=BRICK.vertices_B))])


def test_a_long_recording_is_cut_into_its_tosses() -> None:
    """One log with two throws, between which the body was carried back."""
    first, second = made_tosses(TRUTH, 2, 10)
    later = second.times + first.times[-1] + 2.0
    joined = replace(
        first, **{name: np.concatenate([getattr(first, name), getattr(second, name)]) for name in COLUMNS}
    )
    joined = replace(joined, times=np.concatenate([first.times, later]))
    names = [each.name for each in observe("log", joined)]
    assert names == ["log, toss 0", "log, toss 1"]


def test_a_body_that_tips_over_long_after_its_last_flight_is_not_thrown_again() -> None:
    """It falls freely for some frames, as a cube does from an edge, but a corner stays on the floor."""
    motion = made_tosses(TRUTH, 1, 10)[0]
    since = np.arange(20) / RATE
    fall = np.array([0.0, 0.0, 0.05]) - 0.5 * 9.7 * since[:, None] ** 2 * [0.0, 0.0, 1.0]
    joined = replace(
        motion,
        **{name: np.concatenate([getattr(motion, name), getattr(motion, name)[:20]]) for name in COLUMNS},
    )
    joined = replace(
        joined,
        times=np.concatenate([motion.times, motion.times[-1] + 0.6 + since]),
        p_WB_W=np.concatenate([motion.p_WB_W, fall]),
        q_WB=np.concatenate([motion.q_WB, np.tile(motion.q_WB[-1:], (20, 1))]),
    )
    (alone,) = observe("log", joined)
    assert alone.name == "log"
    assert len(alone.flights) == len(observe("log", motion)[0].flights) + 1
