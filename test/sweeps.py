# SPDX-License-Identifier: Apache-2.0
"""Sweeps that are one test: over seeds, of which many run with `make test-slow` only, and over any items."""

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


def each(argument: str, items: Sequence[Any]) -> Callable[[Test], Test]:
    """Return a decorator that calls a test with each item, and names the items for which it fails.

    All of them are one test for pytest, as with `seeds`.
    """

    def of_each(test: Test) -> Test:
        @functools.wraps(test)
        def of_all(**given: Any) -> None:
            failures = []
            for item in items:
                try:
                    test(**{argument: item}, **given)
                except AssertionError as error:  # noqa: PERF203  each failure is told
                    failures.append(f"{item}: {error}")
            assert items
            assert not failures, "\n".join(failures)

        signature = inspect.signature(test)
        fixtures = [one for name, one in signature.parameters.items() if name != argument]
        of_all.__signature__ = signature.replace(parameters=fixtures)  # type: ignore[attr-defined]
        return of_all

    return of_each
