# SPDX-License-Identifier: Apache-2.0
"""Every public constructor, function and method of the physics meets hostile values.

Each argument in turn becomes a value that is not allowed, one of another type, or a number at the ends of
what doubles hold. Then there is an answer whose numbers are finite, or a `ContactDynamicsError` that names
the argument. There is no other exception, no warning (pytest makes errors of them) and no hang.
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import inspect
import itertools
import math
import signal
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

import numpy as np
import pytest

from architecture.test_doors import CHAPTERS
from contact_dynamics import (
    Body,
    BodyState,
    Contact,
    ContactSet,
    MassProperties,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarVelocity,
    PlanarWrench,
    SpatialContactProblem,
    contact_modes,
)
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.motion import ConstantWrench, Drag
from contact_dynamics.records import Record
from hostile_values import CALLS, UNCHECKED
from hostile_values.shared import (
    BALL,
    BOX,
    CONTACT,
    CONTACTS,
    CORNERS,
    DEEP,
    FALLING,
    FLAT,
    LEAN,
    RESTING,
    ROD,
    STATE,
    TIP,
    TOUCH,
    WORLD,
)

SECONDS = 10
"""Of the processor's time: a call may take no longer. The slowest takes less than one."""

# A hostile state is far from the contact that it is given with.
pytestmark = pytest.mark.filterwarnings("ignore::contact_dynamics.errors.FarContactWarning")

HOSTILE = [
    *(math.nan, math.inf, -1.0, 0.0, 1e308, 1e160, 10**400, 1.0 + 2.0j, "text", None, True, [], [[1.0]]),
    *(object(), BALL, BOX, STATE, CONTACTS),
]
MORE = [
    *(-math.inf, 8.5, 1e300, 1e61, 1e-300, 10**7, [1.0, 2.0], {"a": 1.0}, b"bytes", Body, ROD, CONTACT),
    WORLD,
]
"""Values much like the others."""


ALIASES = {
    "p_FV_F": ("triangles",),
    "frictions": ("p_WC_W",),
    "masses": ("p_FP_F",),
    "bodies": ("states",),
    "lasting_factors": ("lasting_factor_stds",),
    "directions_W": ("along",),
    "count": ("samples",),
    "force_W": ("applied force",),
    "torque_W": ("applied torque",),
    "w": ("contact normal velocity",),
    "r": ("contact normal velocity",),
    "velocity_W": ("contact normal velocity",),
    "velocities_W": ("contact normal velocity",),
}
"""Arguments that an error may name instead of the hostile one.

A flat mesh is one of its triangles as much as of its vertices. Lists of unequal lengths are told of either.
The count of a `TossSampling` has the name of its request's field. A contact of a large spin or arm
separates, and so does one of a large velocity.
"""

FUNCTIONS = {"wrench_of", "is_settled", "now_ns"}
"""Arguments that are functions of the user's."""

NEVER = {
    "contact_path",
    "body_curvature",
    "surface_curvature",
    "along",
    "across",
    "semi_axes",
    "stable_disturbance",
    "factor",
    "only_rest",
    "frictions",
    "miss_probability",
}
"""Fields that may be infinite: a stop that never comes, a corner's curvature, an axis without inertia, a load
that no friction yields to, and friction that is never enough. And one that is NaN unless it is asked for."""

NAN_ALLOWED = {"flips_of_many", "next_flips of a body that flips"}
"""Calls that answer NaN for the time of a flip that never comes, or for a deviation without a covariance."""


def parameters(call: Callable[..., Any], arguments: dict[str, Any]) -> dict[str, Any]:
    """Return the arguments of a call with those of its own that have a default."""
    own = inspect.signature(call).parameters.values()
    return {one.name: one.default for one in own if one.kind != one.VAR_KEYWORD} | arguments


def hostile_cases(name: str, values: list[object]) -> Iterator[tuple[str, object]]:
    """All arguments of a call, each with all values that it gets. Functions of users may do anything."""
    for argument, good in parameters(*CALLS[name]).items():
        for value in [*values, [good]]:
            if not (argument in FUNCTIONS and callable(value)):
                yield argument, value
            if isinstance(value, float) and numeric(good):
                worse = np.array(good, dtype=np.float64)
                worse.ravel()[:1] = value
                yield argument, worse
                yield argument, np.full(np.shape(good), value)


def numeric(good: object) -> bool:
    if not isinstance(good, (list, tuple, np.ndarray)):
        return False
    return all(isinstance(one, (int, float)) for one in np.asarray(good, dtype=object).ravel())


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


def planar_problem(**wrench: Any) -> PlanarContactProblem:
    return dataclasses.replace(FLAT, wrench=PlanarWrench(**{"f": (0.0, -1.0), **wrench}))


def spatial_problem(**load: Any) -> SpatialContactProblem:
    return dataclasses.replace(DEEP, **load)


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
        "problem": [
            *accepted(planar_problem, {}, *({"moment": x} for x in sizes), *({"f": (x, -x)} for x in sizes)),
            *accepted(spatial_problem, {}, *({"torque_W": [x, -x, x]} for x in sizes)),
            *accepted(spatial_problem, {}, *({"force_W": [x, -x, x]} for x in sizes)),
        ],
        "wrench": [
            *accepted(PlanarWrench, {"f": (0.0, -1.0)}, *({"moment": x} for x in sizes)),
            *accepted(ConstantWrench, {}, *({"torque": [x, -x, x]} for x in sizes)),
            *accepted(ConstantWrench, {}, *({"force": [x, -x, x]} for x in sizes)),
        ],
        "drag": accepted(Drag, {}, *({name: x} for name in ("linear", "quadratic_angular") for x in sizes)),
        "velocity": accepted(PlanarVelocity, LEAN, *({"v": (x, -x)} for x in sizes)),
    }


def answered_or_refused(call: Callable[[], object]) -> str:
    """Return what is wrong with the answer, the text of a refusal after a colon, or nothing."""
    signal.signal(signal.SIGVTALRM, too_long)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    try:
        return "" if all(map(math.isfinite, numbers(call()))) else "not finite"
    except ContactDynamicsError as error:
        return f":{error}"
    except Exception as error:  # noqa: BLE001  this is what is looked for
        return f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)


def public() -> dict[str, Callable[..., object]]:
    """Return what users call on the chapters' pages: functions, checked records, and records' methods."""
    found: dict[str, Callable[..., object]] = {}
    for chapter in CHAPTERS:
        page = importlib.import_module(f"contact_dynamics.{chapter}")
        for name in page.__all__:
            thing = getattr(page, name)
            if inspect.isfunction(thing):
                found[f"{chapter}.{name}"] = thing
            elif inspect.isclass(thing) and issubclass(thing, Record):
                if hasattr(thing, "__post_init__"):
                    found[name] = thing
                for method, one in inspect.getmembers(thing, inspect.isroutine):
                    inner = getattr(one, "__func__", one)
                    if not method.startswith("_") and inner.__module__ == thing.__module__:
                        found[f"{name}.{method}"] = inner
    return {
        name: call for name, call in found.items() if {*inspect.signature(call).parameters} - {"self", "cls"}
    }


def test_every_call_of_the_pages_meets_them() -> None:
    called = {getattr(call, "__func__", call) for call, _ in CALLS.values()}
    missed = {name for name, call in public().items() if call not in called}
    assert missed == UNCHECKED


@pytest.mark.parametrize("values", [HOSTILE, pytest.param(MORE, marks=pytest.mark.slow)], ids=["", "more"])
def test_hostile_values_are_answered_or_refused_by_name(values: list[object]) -> None:
    wrong = []
    for name, (call, arguments) in CALLS.items():
        call(**arguments)
        for argument, value in hostile_cases(name, values):
            found = answered_or_refused(lambda c=call, a=arguments, n=argument, v=value: c(**{**a, n: v}))
            if name in NAN_ALLOWED and found == "not finite":
                continue
            named = any(one in found for one in (argument, *ALIASES.get(argument, ())))
            if found and not (found.startswith(":") and named):
                wrong.append((name, argument, value, found))
    assert wrong == []


SLOW = [name for name in CALLS if "interleavings" in name]
"""They take half a second for each of some fifty values."""


@pytest.mark.parametrize(
    "names", [[*CALLS.keys() - SLOW], pytest.param(SLOW, marks=pytest.mark.slow)], ids=["", "slow"]
)
def test_extreme_objects_are_answered_or_refused(names: list[str]) -> None:
    wrong = []
    for name, (argument, values) in itertools.product(names, extreme_objects().items()):
        call, arguments = CALLS[name]
        for value in values:
            if isinstance(value, type(arguments.get(argument))):
                found = answered_or_refused(lambda c=call, a=arguments, n=argument, v=value: c(**{**a, n: v}))
                if found and not found.startswith(":"):
                    wrong.append((name, argument, value, found))
    assert wrong == []


EXTREMES = [
    *(("body", {"mass": x}) for x in (1e-300, 1e-60, 1e60, 1e300)),
    *(("body", {"I_B": x * BALL.I_B}) for x in (1e-300, 1e-59, 1e20, 1e59, 1e300)),
    *(
        ("state", {field: [x, -x, x]})
        for field in ("p_WB_W", "v_WB_W", "w_WB_W")
        for x in (1e-300, -1e15, 1e60, 1e100, 1e160, 1e300)
    ),
    *(("contacts", {"frictions": [x, 0.1]}) for x in (1e-300, 1e12, 1e60, 1e160, 1e300)),
    *(
        ("contacts", {field: [[x, -x, x], [0.0, 0.0, 0.0]]})
        for field in ContactSet.SURFACE_MOTION
        for x in (1e-300, 1e30, 1e60)
    ),
]


@pytest.mark.parametrize("argument", ["body", "state", "contacts"])
def test_contact_modes_of_extreme_problems_are_found_or_refused(argument: str) -> None:
    """Of one body, of two, of which it is the upper one, and of a mechanism."""
    wrong = []
    good = {"body": BALL, "state": RESTING, "contacts": CONTACTS}
    for change in (each for name, each in EXTREMES if name == argument):
        for kind in ("one", "two", "mechanism"):

            def found(change: dict[str, Any] = change, kind: str = kind) -> object:
                given: dict[str, Any] = {**good, argument: dataclasses.replace(good[argument], **change)}
                return contact_modes.contact_modes(extreme_problem(kind, **given))

            text = answered_or_refused(found)
            if text and not text.startswith(":"):
                wrong.append((kind, change, text))
    assert wrong == []


def extreme_problem(
    kind: str, body: MassProperties, state: BodyState, contacts: ContactSet
) -> SpatialContactProblem | contact_modes.BodiesContactProblem | contact_modes.ResponseContactProblem:
    if kind == "one":
        return dataclasses.replace(DEEP, body=body, state=state, contacts=contacts)
    if kind == "two":
        return contact_modes.BodiesContactProblem(
            bodies=[BALL, body],
            states=[RESTING, state],
            contacts=contacts,
            pairs=[(0, None if contacts.surfaces_move else 1), (1, None)],
            forces_W=[0.0, 0.0, -9.8],
        )
    return contact_modes.ResponseContactProblem(
        inverse_inertia_W=np.eye(6) / body.mass,
        accelerations_W=[[0.0, 1.0, -9.8], state.v_WB_W],
        contacts=contacts,
        velocities_W=state.v_WB_W,
    )
