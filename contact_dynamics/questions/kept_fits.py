"""The free motions that fit the states of the last few questions, since several are asked about one window.

States do not change, so the fit to the same ones is the same. Where will it land, which impact follows, with
which law: each of these would fit the same window again, which costs more than the rest of its answer.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final

from contact_dynamics.motion.free_fit import FitResult, fit_free_motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

_KEPT: Final = 4


def kept_fit(body: MassProperties, states: Sequence[BodyState], *, gravity_W: FloatArray) -> FitResult:
    """Return the free motion that fits ``states`` best; see `fit_free_motion`, and its errors."""
    return _fit(body, tuple(states), tuple(gravity_W.tolist()))


@lru_cache(maxsize=_KEPT)
def _fit(body: MassProperties, states: tuple[BodyState, ...], gravity_W: tuple[float, ...]) -> FitResult:
    return fit_free_motion(body, states, gravity_W=gravity_W)
