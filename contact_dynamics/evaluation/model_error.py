# SPDX-License-Identifier: Apache-2.0
"""Model errors of predictions, as a calibration measures them in addition to the noise of states.

The model error of the impact law is that of `toss.law_spread`: mostly an impulse through the contact, with
the tails of Student's t for `FREEDOM` degrees of freedom.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.measured.events import EventKind
from contact_dynamics.records import Record
from contact_dynamics.validation import check_array, check_not_negative
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from contact_dynamics.measured.events import FoundEvent
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World

FREEDOM: Final = 3.0
"""Degrees of freedom of Student's t, as in `toss.law_spread`, whose compiled constants cannot be imported."""

_BY_IMPULSE: Final = 0.9
"""Share of the variance that an impulse through the contact causes, from there as well."""

_SAME_MEDIAN: Final = 0.7887
"""Ratio of the medians of the squared distance in three dimensions, chi squared's and by t, as `law_spread`
has it: the model error is stated as that of normal residuals with the same median."""

_SLOWEST: Final = 0.05
"""m/s. Slower approaches of a centre of mass do not make the time of a first contact any more uncertain."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ModelError(Record):
    """Model errors of predictions, in addition to measurement noise, as `calibrate` reports them.

    Raises:
        InvalidFieldError: a number is negative or not finite.
    """

    velocity: float = 0.0  # m/s, >= 0, of each component of the velocity after an impact
    spin: float = 0.0  # rad/s, >= 0, of each component of the angular velocity after an impact
    height: float = 0.0  # m, >= 0, of the height of a corner at a first contact
    # (3, 3), m^2/s^4, covariance of gravity from one recording to another, world axes
    gravity_W: FloatArray = field(default_factory=lambda: np.zeros((3, 3)))
    body_name: str = ""  # of the calibrated body. The errors are applied to all bodies
    problems: tuple[str, ...] = ()  # that the calibration reported

    def __post_init__(self) -> None:
        """Check all fields."""
        for name in ("velocity", "spin", "height"):
            object.__setattr__(self, name, check_not_negative(name, getattr(self, name)))
        object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3, 3)))

    @property
    def freedom(self) -> float:
        """Degrees of freedom of Student's t for impacts; infinite if differences are normal."""
        return FREEDOM if max(self.velocity, self.spin) > 0.0 else math.inf

    def doubts(self, bodies: Iterable[str]) -> Iterator[str]:
        """Yield reasons, in words, for which the errors may be wrong in predictions of bodies."""
        others = sorted({name for name in bodies if self.body_name and name != self.body_name})
        if others:
            yield f"calibration: the model errors of {self.body_name!r} are applied to {', '.join(others)}"
        for problem in self.problems:
            yield f"calibration: {problem}"

    def of_event(self, event: FoundEvent, world: World) -> FoundEvent:
        """Return an event whose time at a first contact includes the error of the height."""
        if event.kind is not EventKind.LANDING or self.height == 0.0:
            return event
        surface = next((each for each in world.surfaces if each.name == event.surface), None)
        if not isinstance(surface, Surface):
            return event
        speed = abs(float(event.state.v_WB_W @ surface.normal_W))
        return replace(event, time_std=math.hypot(event.time_std, self.height / max(speed, _SLOWEST)))

    def of_law(self, body: MassProperties, before: BodyState, p_WC_W: FloatArray) -> FloatArray:
        """Return the covariance of velocities by the error of the law, (6, 6), at one contact, (3,), m."""
        inertia_W = before.R_WB @ body.I_B @ before.R_WB.T
        arm_W = p_WC_W - before.p_WB_W
        turns = body.mass * np.linalg.solve(inertia_W, np.cross(arm_W, np.eye(3)).T)  # by unit velocities
        square = float(np.square(turns).sum()) / 3.0
        velocity, spin = self.velocity**2, self.spin**2
        pushed = _BY_IMPULSE * (min(velocity, spin / square) if square > 0.0 else velocity)
        through = np.vstack([np.eye(3), turns])
        left = np.repeat([velocity - pushed, max(spin - pushed * square, 0.0)], 3)
        covariance: FloatArray = _SAME_MEDIAN * (pushed * through @ through.T + np.diag(left))
        return covariance


def model_error_of(path: Path, name: str = "--calibration") -> ModelError:
    """Return the model errors in a JSON file of `calibrate`.

    Raise `InvalidFieldError`, about ``name``, if it cannot be read, or is no such file.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        spread = content["spread"]
        return ModelError(
            velocity=spread["velocity"],
            spin=spread["spin"],
            height=spread["strike_height"],
            gravity_W=content.get("gravity_covariance_W") or np.zeros((3, 3)),
            body_name=content.get("body", {}).get("name", ""),
            problems=tuple(content.get("problems", ())),
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        expected = "a readable file that calibrate --json has written"
        raise InvalidFieldError(name, str(path), expected) from None
