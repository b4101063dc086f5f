# SPDX-License-Identifier: Apache-2.0
"""Seeds of sweeps: a few that run each time, and the many that run with `make test-slow`."""

from __future__ import annotations

import functools
import inspect
import sys
from collections.abc import Callable, Sequence
from typing import Any

import pytest

Test = Callable[..., None]
BLOCK = 100


def seeds(fast: Sequence[int], *, slow: Sequence[int] = ()) -> Callable[[Test], Test]:
    """Return a decorator that runs a test of one ``seed`` with each of these.

    A block of seeds is one test for pytest, which takes 2 ms to collect and set up each. The captured
    output of a failure ends with its seed.
    """
    blocks: list[Any] = [pytest.param(fast, id="fast")] if fast else []
    blocks += [
        pytest.param(slow[i : i + BLOCK], id=f"slow{i // BLOCK}", marks=pytest.mark.slow)
        for i in range(0, len(slow), BLOCK)
    ]

    def of_each(test: Test) -> Test:
        @functools.wraps(test)
        def of_block(*, seed: Sequence[int], **given: Any) -> None:
            for each in seed:
                sys.stdout.write(f"seed = {each}\n")
                test(seed=each, **given)

        # Pytest looks into a wrapped function for the names of what it wants, unless they are given.
        of_block.__signature__ = inspect.signature(test)  # type: ignore[attr-defined]
        decorated: Test = pytest.mark.parametrize("seed", blocks)(of_block)
        return decorated

    return of_each


def sweep(few: int, *, whole: int) -> list[Any]:
    """Return ``whole`` numbers of blocks, from 0 on, of which all but the first ``few`` are slow."""
    return [pytest.param(number, marks=() if number < few else pytest.mark.slow) for number in range(whole)]
