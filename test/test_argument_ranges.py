# SPDX-License-Identifier: Apache-2.0
"""Numbers that would be answered by chance are errors of their argument, and every covariance is one."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from contact_dynamics import impact
from contact_dynamics.contact import linearised_cone
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.questions import UncertainState
from contact_dynamics.tumbling import rolling_curves
from contact_dynamics.validation_types import _meaning
from hostile_values import CALLS
from hostile_values.motions import FREE
from hostile_values.shared import STATE
from test_hostile_values import numeric

NAN = math.nan


def call(name: str, **changes: Any) -> object:
    function, arguments = CALLS[name]
    return function(**{**arguments, **changes})


RANGES: list[tuple[str, str, Any]] = [
    *[("sampled_toss", "horizon", value) for value in (NAN, -1.0, 0.0, math.inf, "1")],
    *[("sampled_toss", "covariance", value) for value in (np.full((12, 12), NAN), np.eye(3), 1.0)],
    *[("sampled_toss", "count", value) for value in (0, -1, 2.5, True, NAN)],
    *[("sampled_toss", "strikes", value) for value in (0, 11, 1.5)],
    *[("sampled_toss", "seed", value) for value in (-1, 0.5)],
    *[("sampled_toss", "by_gravity", value) for value in ((NAN, 0.0), (0.0,), 1.0)],
    *[("toss", "error", value) for value in (1e-200, 0.0, -1.0, NAN)],
    *[("toss", "lasting_factors", value) for value in ([1e300], [-1.0], [NAN])],
    *[("linearised_cone", "normal", value) for value in ([0, 0, 0], [0, 0, 2], [NAN, 0, 1])],
    *[("linearised_cone", "friction", value) for value in (-1.0, NAN, math.inf)],
    ("linearised_cone", "towards", [NAN, 0.0, 0.0]),
    *[("SpatialContactProblem", name, [1e308, 0, 0]) for name in ("force_W", "torque_W")],
    *[("rolling_curves", "count", value) for value in (0, -3, 2.5, NAN)],
    *[("MassProperties.radius_of_gyration", "axis_B", value) for value in ([0, 0, 2], [0, 0, 0])],
    *[("planar_in_space", "axes_W", value) for value in ([[1, 0, 0], [1, 0, 0]], [[2, 0, 0], [0, 1, 0]])],
    *[("BodyState", "stamp_ns", value) for value in (NAN, 0.5, "now", 10**400)],
    ("forced_motion", "max_steps", 0.5),
    *[("spatial_sliding_modes", "planes", value) for value in (2.5, 1)],
    *[("spatial_impact_distribution", "samples", value) for value in (101, 0)],
    ("linearised_cone", "facets", 2),
    *[("mode_margins in the plane", "margin_length", value) for value in (1e61, 1e-61, 1e300)],
    *[("statics in the plane", "margin_length", value) for value in (0.0, -1.0, 1e61, 1e-61, NAN)],
    *[("statics", "margin_length", value) for value in (0.0, -1.0, NAN)],
    *[("SpatialContactProblem", "friction_facets", value) for value in (2, 8.5, 1_000_000)],
]


@pytest.mark.parametrize(("name", "argument", "value"), RANGES)
def test_a_number_out_of_its_range_is_named(name: str, argument: str, value: Any) -> None:
    with pytest.raises(InvalidFieldError) as raised:
        call(name, **{argument: value})
    assert str(raised.value).startswith(argument)


OUTSIDE = {">= 0": (-1.0,), "> 0": (0.0, -1.0), "in [0, 1]": (-0.5, 1.5), ">= 1": (0.0,), "> 2": (2.0,)}
"""Values outside of each range that the descriptions of arguments state."""

IGNORED = {("covariance_along", "samples"), ("covariance_along", "seed")}
"""Arguments that the call in `CALLS` does not use."""

MAY_BE_INFINITE = {"body_curvature", "surface_curvature", "along", "across", "max_normal_forces"}


def wrong_values(call: Callable[..., Any], arguments: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Each numeric argument: not finite, outside of the range in its description, or of another shape."""
    for argument, parameter in inspect.signature(call).parameters.items():
        stated = _meaning(call, argument)
        good = arguments.get(argument, parameter.default)
        numbers = [NAN] if argument in MAY_BE_INFINITE else [NAN, math.inf]
        for words, outside in OUTSIDE.items():
            if re.search(rf"{re.escape(words)}(?!\.?\d)", stated):
                numbers += outside
                good = 1.0 if good is None else good
        if isinstance(good, bool) or not (isinstance(good, (int, float)) or numeric(good)):
            continue
        right = np.array(good, dtype=np.float64)
        yield argument, "text"
        for number in numbers if right.size else ():
            wrong = right.copy()
            wrong.ravel()[-1:] = number
            yield argument, wrong if right.ndim else number
        if re.search(r"\bunit\b(?! tangents)", stated):
            yield argument, 2.0 * right
            yield argument, 0.0 * right
        if right.ndim and re.match(r" \(\(.*?[34],?\)", stated):
            yield argument, np.concatenate([right, right[..., -1:]], axis=-1)


@pytest.mark.filterwarnings("ignore::contact_dynamics.errors.FarContactWarning")
def test_a_number_outside_of_the_stated_range_is_an_error_that_names_its_argument() -> None:
    """For every public call. Numbers that are not finite and arrays of another shape are errors too."""
    tried, wrong = 0, []
    for name, (function, arguments) in CALLS.items():
        for argument, value in wrong_values(function, arguments):
            tried += 1
            named = "samples" if (name, argument) == ("TossSampling", "count") else argument
            try:
                function(**{**arguments, argument: value})
            except InvalidFieldError as error:
                if not (named in str(error).partition(" must")[0] and ", got " in str(error)):
                    wrong.append((name, argument, value, str(error)))
            else:
                if (name, argument) not in IGNORED:
                    wrong.append((name, argument, value, "no error"))
    assert wrong == []
    assert tried > 1000


BATCH = {
    "masses": np.ones(4),
    "inertias": np.ones(4),
    "v": np.tile([0.3, -1.0], (4, 1)),
    "w": np.zeros(4),
    "r": np.tile([0.1, -0.5], (4, 1)),
    "normals": np.tile([0.0, 1.0], (4, 1)),
    "frictions": np.full(4, 0.3),
    "restitutions": np.full(4, 0.5),
}


@pytest.mark.parametrize("field", BATCH)
@pytest.mark.parametrize("value", [NAN, math.inf])
def test_what_is_not_finite_in_a_batch_is_named_with_its_row(field: str, value: float) -> None:
    rows = BATCH[field].copy()
    rows[2] = value
    with pytest.raises(InvalidFieldError, match=rf"^{field}\[2\] must be finite.*, got .*(nan|inf).*"):
        impact.planar_impacts(**{**BATCH, field: rows})


def test_a_curve_of_ten_million_points_is_too_large() -> None:
    with pytest.raises(TooLargeError, match=r"^count must be at most 1000000.*, got 10000000$"):
        rolling_curves(FREE, 10_000_000)


def test_a_cone_takes_lists_and_leans_towards_any_vector() -> None:
    near = linearised_cone([0, 0, 1], 0.5, 8, towards=[1.0, 2.0, 0.0])
    far = linearised_cone(np.array([0.0, 0.0, 1.0]), 0.5, 8, towards=[1e300, 2e300, 0.0])
    assert near == pytest.approx(far, abs=1e-15)


def uncertain_state(covariance: Any) -> object:
    return UncertainState(state=STATE, covariance=covariance)


WITH_COVARIANCE: dict[str, Callable[..., object]] = {
    **{
        name: lambda covariance, name=name: call(name, covariance=covariance)
        for name, (_, arguments) in CALLS.items()
        if "covariance" in arguments and name != "UncertainState"
    },
    "UncertainState": uncertain_state,
}


def indefinite(size: int) -> np.ndarray:
    """A symmetric matrix with variances > 0 and correlations that no variables have."""
    matrix = np.eye(size)
    matrix[:3, :3] = np.array([[1.0, -0.9, -0.9], [-0.9, 1.0, -0.9], [-0.9, -0.9, 1.0]])
    return 1e-6 * matrix


@pytest.mark.parametrize("name", WITH_COVARIANCE)
def test_what_is_no_covariance_is_refused_everywhere(name: str) -> None:
    size = len(CALLS[name][1]["covariance"])
    skew = 1e-6 * np.eye(size)
    skew[0, 1] = 5e-7
    for wrong in (-np.eye(size), indefinite(size), skew, np.full((size, size), NAN)):
        with pytest.raises(InvalidFieldError, match=r"covariance(\[0\])? must be"):
            WITH_COVARIANCE[name](wrong)
    WITH_COVARIANCE[name](np.zeros((size, size)))


def test_covariances_are_found_in_several_chapters() -> None:
    assert len(WITH_COVARIANCE) > 6
