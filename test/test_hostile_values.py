"""Every public constructor and function of the physics meets hostile values: it answers, or refuses by name.

Each argument in turn becomes a value that is not allowed, or one at the ends of what doubles hold. Then there
is an answer whose numbers are finite, or a `ContactDynamicsError` that names the argument. There is no other
exception, no warning (pytest makes errors of them) and no hang.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import signal
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

import numpy as np
import pytest

from contact_dynamics import (
    BodyState,
    Contact,
    ContactSet,
    MassProperties,
    PlanarBody,
    PlanarContact,
    PlanarVelocity,
)
from contact_dynamics.errors import ContactDynamicsError
from hostile_values import CALLS
from hostile_values.shared import (
    CORNERS,
    FALLING,
    LEAN,
    TIP,
    TOUCH,
)

SECONDS = 20
"""A call may take no longer, even on a loaded machine. The slowest takes less than one."""

HOSTILE = [
    math.nan,
    math.inf,
    -math.inf,
    -1.0,
    0.0,
    8.5,
    1e300,
    1e160,
    1e61,
    1e-300,
    1.0 + 2.0j,
    "text",
    None,
    True,
    [],
    [[1.0]],
    [1.0, 2.0],
    {"a": 1.0},
]


ALIASES = {
    "p_FV_F": ("triangles",),
    "frictions": ("p_WC_W",),
    "masses": ("p_FP_F",),
}
"""Arguments that an error may name instead of the hostile one.

A flat mesh is one of its triangles as much as of its vertices. Lists of unequal lengths are told of either.
"""

NEVER = {"contact_path", "body_curvature", "surface_curvature", "semi_axes"}
"""Fields that may be infinite: a stop that never comes, a corner's curvature, an axis without inertia."""


def hostile_cases() -> Iterator[tuple[str, str, object]]:
    for name, (_, arguments, chosen) in CALLS.items():
        for argument in arguments:
            if not chosen or argument in chosen:
                for value in HOSTILE:
                    yield name, argument, value
                    good = arguments[argument]
                    if isinstance(value, float) and isinstance(good, (list, tuple, np.ndarray)):
                        worse = np.array(good, dtype=np.float64)
                        worse.ravel()[0] = value
                        yield name, argument, worse
                        yield name, argument, np.full(np.shape(good), value)


def numbers(value: object) -> Iterator[float]:
    """All numbers in a result."""
    if isinstance(value, (float, int, np.number)):
        yield float(value)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "fiu":
        yield from value.ravel().tolist()
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        for entry in dataclasses.fields(value):
            if entry.name in NEVER:
                continue
            yield from numbers(getattr(value, entry.name))
    elif isinstance(value, (list, tuple)):
        for one in value:
            yield from numbers(one)


def too_long(_number: int, _frame: FrameType | None) -> None:
    raise TimeoutError


def accepted(kind: Callable[..., object], fields: dict[str, Any], *changes: dict[str, Any]) -> list[object]:
    """Return the values that a constructor makes of fields with changes, without those that it refuses."""
    made = []
    for change in changes:
        with contextlib.suppress(ContactDynamicsError):
            made.append(kind(**{**fields, **change}))
    return made


def extreme_objects() -> dict[str, list[object]]:
    """Values that constructors accept, with a number at an end of what doubles hold, by argument."""
    sizes = (1e-300, 1e-160, 1e-60, 1e60, 1e61, 1e160, 1e300)
    moments = np.diag([0.1, 0.2, 0.25])
    mass, flat = {"mass": 1.0, "I_B": moments}, {"mass": 1.0, "inertia": 0.5}
    return {
        "body": [
            *accepted(MassProperties, mass, *({"mass": x} for x in sizes)),
            *accepted(MassProperties, mass, *({"I_B": x * moments} for x in sizes)),
            *accepted(PlanarBody, flat, *({"mass": x} for x in sizes)),
            *accepted(PlanarBody, flat, *({"inertia": x} for x in sizes)),
        ],
        "state": [
            state
            for field in ("p_WB_W", "v_WB_W", "w_WB_W")
            for state in accepted(BodyState, FALLING, *({field: [x, -x, -x]} for x in sizes))
        ],
        "contact": [
            *accepted(Contact, TOUCH, *({"friction": x} for x in sizes)),
            *accepted(Contact, TOUCH, *({"p_WC_W": [x, 0.0, 0.0]} for x in sizes)),
            *accepted(PlanarContact, TIP, *({"friction": x} for x in sizes)),
            *accepted(PlanarContact, TIP, *({"r": (x, -x)} for x in sizes)),
        ],
        "contacts": [
            *accepted(ContactSet, CORNERS, *({"frictions": [x, 0.1]} for x in sizes)),
            *accepted(ContactSet, CORNERS, *({"p_WC_W": [[x, 0, 0], [0.1, 0, 0]]} for x in sizes)),
        ],
        "velocity": accepted(PlanarVelocity, LEAN, *({"v": (x, -x)} for x in sizes)),
    }


def answered_or_refused(call: Callable[[], object]) -> str:
    """Return what is wrong with the answer, the text of a refusal after a colon, or nothing."""
    signal.signal(signal.SIGALRM, too_long)
    signal.alarm(SECONDS)
    try:
        return "" if all(map(math.isfinite, numbers(call()))) else "not finite"
    except ContactDynamicsError as error:
        return f":{error}"
    except Exception as error:  # noqa: BLE001  this is what is looked for
        return f"{type(error).__name__}: {error}"
    finally:
        signal.alarm(0)


@pytest.mark.parametrize("name", CALLS)
def test_hostile_values_are_answered_or_refused_by_name(name: str) -> None:
    call, arguments, _ = CALLS[name]
    call(**arguments)
    wrong = []
    for which, argument, value in hostile_cases():
        if which == name:
            found = answered_or_refused(lambda a=argument, v=value: call(**{**arguments, a: v}))
            named = any(one in found for one in (argument, *ALIASES.get(argument, ())))
            if found and not (found.startswith(":") and named):
                wrong.append((argument, value, found))
    assert wrong == []


@pytest.mark.parametrize(
    "name",
    # Interleavings take half a second for each of some fifty values.
    [pytest.param(one, marks=pytest.mark.slow if "interleavings" in one else ()) for one in CALLS],
)
def test_extreme_objects_are_answered_or_refused(name: str) -> None:
    call, arguments, _ = CALLS[name]
    wrong = []
    for argument, values in extreme_objects().items():
        for value in values:
            if isinstance(value, type(arguments.get(argument))):
                found = answered_or_refused(lambda a=argument, v=value: call(**{**arguments, a: v}))
                if found and not found.startswith(":"):
                    wrong.append((argument, value, found))
    assert wrong == []
