# SPDX-License-Identifier: Apache-2.0
"""Random values that the answers of every chapter are made of, and whether two are the same."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, TypeVar

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from contact_dynamics import Body, BodyState, ContactSet, MassProperties, World
from contact_dynamics.contact.curvature import alike
from contact_dynamics.plane import PlaneOfMotion
from contact_dynamics.questions import FitQuality
from contact_dynamics.questions.many import ManyStates
from contact_dynamics.tumbling import Trajectory

T = TypeVar("T")
NO_OFFSET = np.zeros(3)
BRICK = Body.box((0.15, 0.09, 0.05), mass=0.4, name="brick")
BAT = Body(name="bat", mass_properties=MassProperties(mass=0.9, I_B=0.01 * np.eye(3)))
WORLD = World(bodies=(BRICK, BAT))
NAMES = ("", "brick")


def same(one: Any, other: Any, *, rounding: float = 0.0) -> bool:
    """Whether two values, domain types or messages, agree in every field; NaN is NaN.

    Numbers may differ by ``rounding``.
    """
    if one is None or other is None:
        return one is other
    if isinstance(one, float) and isinstance(other, float):
        return bool(np.isclose(one, other, rtol=0.0, atol=rounding, equal_nan=True))
    if isinstance(one, np.ndarray):
        return one.shape == other.shape and bool(
            np.isclose(one, other, rtol=0.0, atol=rounding, equal_nan=True).all()
        )
    if hasattr(one, "get_fields_and_field_types"):
        names = list(one.get_fields_and_field_types())
    elif dataclasses.is_dataclass(one):
        names = [field.name for field in dataclasses.fields(one)]
    elif isinstance(one, str | bytes) or not hasattr(one, "__len__"):
        return type(one) is type(other) and bool(one == other)
    else:  # a list, a tuple or an array.array
        return len(one) == len(other) and all(
            same(a, b, rounding=rounding) for a, b in zip(one, other, strict=True)
        )
    return type(one) is type(other) and all(
        same(getattr(one, name), getattr(other, name), rounding=rounding) for name in names
    )


numbers = st.floats(-1e3, 1e3)
odd_numbers = st.one_of(numbers, st.sampled_from([math.nan, math.inf]))
positive = st.floats(1e-3, 1e3)
not_negative = st.one_of(st.just(0.0), positive)
flags = st.booleans()
texts = st.sampled_from(["", "floor", "wall 2", "ü"])
indices = st.integers(0, 9)


def arrays(*shape: int, of: st.SearchStrategy[float] = numbers) -> st.SearchStrategy[np.ndarray]:
    """Arrays of a shape; all but a few numbers of a large one are from a generator."""
    count = math.prod(shape)
    if count > 36:
        return st.integers(0, 2**31).map(lambda seed: np.random.default_rng(seed).normal(size=shape))
    return st.lists(of, min_size=count, max_size=count).map(
        lambda values: np.array(values, dtype=np.float64).reshape(shape)
    )


def tuples_of(values: st.SearchStrategy[T], count: int) -> st.SearchStrategy[tuple[T, ...]]:
    """So many values."""
    return st.lists(values, min_size=count, max_size=count).map(tuple)


def some(values: st.SearchStrategy[T]) -> st.SearchStrategy[T | None]:
    """A value or none."""
    return st.one_of(st.none(), values)


@st.composite
def unit_vectors(draw: st.DrawFn, length: int = 3) -> np.ndarray:
    """Unit vectors that stay as they are when they are scaled to length 1 once more."""
    vector = draw(arrays(length, of=st.floats(-1.0, 1.0)))
    for _ in range(3):
        size = math.sqrt(np.einsum("i,i->", vector, vector))
        assume(size > 0.1)
        vector = vector / size
    again = vector / np.sqrt(np.einsum("ij,ij->i", vector[None], vector[None]))
    assume(np.array_equal(again, vector))
    return vector


states = st.builds(
    BodyState,
    p_WB_W=arrays(3),
    q_WB=unit_vectors(4),
    v_WB_W=arrays(3),
    w_WB_W=arrays(3),
    stamp_ns=st.integers(0, 2**31 * 10**9 - 1),
)


@st.composite
def contact_sets(draw: st.DrawFn, count: int | None = None) -> ContactSet:
    """Up to three contacts, with names and curvatures or without."""
    n = draw(st.integers(0, 3)) if count is None else count
    curved = n > 0 and draw(flags)
    normals = draw(tuples_of(unit_vectors(), n))
    frictions = draw(arrays(n, of=st.floats(0.0, 5.0)))
    return ContactSet(
        p_WC_W=draw(arrays(n, 3)),
        normals_W=np.array(normals).reshape(-1, 3),
        frictions=frictions,
        static_frictions=frictions + draw(st.floats(0.0, 1.0)) if n > 0 and draw(flags) else None,
        restitutions=draw(arrays(n, of=st.floats(0.0, 1.0))),
        surfaces=draw(tuples_of(texts, n)) if draw(flags) else (),
        body_curvatures=alike(n, draw(positive)) if curved else None,
        surface_curvatures=alike(n, draw(positive)) if curved else None,
    )


@st.composite
def trajectories(draw: st.DrawFn, count: int | None = None) -> Trajectory:
    """Up to three samples."""
    n = draw(st.integers(0, 3)) if count is None else count
    return Trajectory(
        seconds=draw(arrays(n)),
        p_WB_W=draw(arrays(n, 3)),
        q_WB=np.array(draw(tuples_of(unit_vectors(4), n))).reshape(-1, 4),
        v_WB_W=draw(arrays(n, 3)),
        w_WB_W=draw(arrays(n, 3)),
    )


fits = st.builds(
    FitQuality, count=st.integers(1, 1000), position_residual=positive, orientation_residual=positive
)
planes = some(st.builds(PlaneOfMotion, normal_W=unit_vectors()))


@st.composite
def many_states(draw: st.DrawFn, count: int) -> ManyStates:
    """So many states."""
    return ManyStates(
        p_WB_W=draw(arrays(count, 3)),
        q_WB=np.array(draw(tuples_of(unit_vectors(4), count))).reshape(-1, 4),
        v_WB_W=draw(arrays(count, 3)),
        w_WB_W=draw(arrays(count, 3)),
    )


warnings = st.lists(st.sampled_from(["contact 0 is outside", "the order decides"]), max_size=2).map(tuple)
