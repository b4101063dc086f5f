# SPDX-License-Identifier: Apache-2.0
"""This file searches boxes of contact sets for other answers, in the plane and in space.

One question is which verdicts occur in the box of a problem's uncertainty. Another is how far contacts would
have to move, turn or change friction for another answer. For this, boxes of growing size are searched for the
largest one in which the answer is proven, and above it for the smallest one in which a sample has another
answer. The true margin lies between the two sizes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, Protocol, TypeVar

from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact_modes.result import GeometryMargin, ModeVerdict, VerdictsWithin

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


_FAILED: Final = 4
"""After so many proofs that failed the smallest box is tried. If its proof fails too, all others would."""


_TRIED_FIRST: Final = 6
"""Proofs that are tried from the largest box on, before samples. Feet on a floor need no more."""


class _Mode(Protocol):
    @property
    def mode(self) -> str: ...


class _Answer(Protocol):
    @property
    def verdict(self) -> ModeVerdict: ...

    @property
    def modes(self) -> Sequence[_Mode]: ...


AnyAnswer = TypeVar("AnyAnswer", bound=_Answer)


def verdicts_within(
    answer: AnyAnswer,
    box: ContactUncertainty,
    *,
    is_certain: Callable[[ContactUncertainty], bool],
    sampled: Callable[[ContactUncertainty], Iterable[AnyAnswer]],
) -> VerdictsWithin:
    """Return the verdicts that occur in a box. It is sampled if there is no proof that there is only one.

    Args:
        answer: The answer to the question itself.
        box: The uncertainty of its contacts.
        is_certain: Whether it is proven that the verdict of this answer holds everywhere in a box.
        sampled: The answers at some contact sets in a box.
    """
    certain = box.is_exact or is_certain(box)
    samples = [] if certain else list(sampled(box))
    verdicts = dict.fromkeys(one.verdict for one in (answer, *samples))
    modes = dict.fromkeys(mode.mode for one in (answer, *samples) for mode in one.modes)
    return VerdictsWithin(
        uncertainty=box,
        verdicts=tuple(verdicts),
        modes=tuple(modes),
        certain=certain,
        samples=len(samples),
    )


def geometry_margins_within(
    answer: AnyAnswer,
    *,
    radius_of_gyration: float,
    frictions: Iterable[float],
    step: float,
    steps: int,
    is_certain: Callable[[ContactUncertainty], bool],
    sampled: Callable[[ContactUncertainty], Iterable[AnyAnswer]],
) -> tuple[GeometryMargin, ...]:
    """Return the margins of an answer in each kind of error.

    In each of them only that one is off, for all contacts at once and for each in its own way. There are no
    margins if a contact approaches.

    Args:
        answer: The answer to the question itself.
        radius_of_gyration: m, of the body. Points are tried so far off at most.
        frictions: Those of the contacts. The largest, or 1, is the most that frictions are tried off.
        step: Each size is this factor from the next.
        steps: How many sizes below the largest are tried.
        is_certain: Whether it is proven that the verdict of this answer holds everywhere in a box.
        sampled: The answers at some contact sets in a box.
    """
    if answer.verdict == ModeVerdict.IMPACT:
        return ()
    largest = {
        "points": radius_of_gyration,
        "normals": 0.5 * math.pi,
        "frictions": max([1.0, *frictions]),
    }
    return tuple(
        _margin(
            kind,
            [size / step**k for k in range(steps, -1, -1)],
            answer,
            is_certain=is_certain,
            sampled=sampled,
        )
        for kind, size in largest.items()
    )


def _margin(
    kind: str,
    sizes: Sequence[float],
    answer: AnyAnswer,
    *,
    is_certain: Callable[[ContactUncertainty], bool],
    sampled: Callable[[ContactUncertainty], Iterable[AnyAnswer]],
) -> GeometryMargin:
    """Return the margin of an answer in one kind of error, of which sizes are tried in growing order."""
    found: dict[int, AnyAnswer] = {}

    def box(k: int) -> ContactUncertainty:
        return ContactUncertainty(**{kind: sizes[k]})

    def changes(k: int) -> bool:
        beyond = next((one for one in sampled(box(k)) if _says_otherwise(one, answer)), None)
        if beyond is not None:
            found[k] = beyond
        return beyond is not None

    # A proof that fails mostly does so early, and takes a hundredth of one that succeeds. So the first that
    # succeeds on the way down is the last. Boxes with a proof need no samples.
    tried = max(0, len(sizes) - _TRIED_FIRST)
    proven = next((k for k in range(len(sizes), tried, -1) if is_certain(box(k - 1))), 0)
    changed = _first(proven, len(sizes), changes)
    if proven == 0:
        proven = first = min(changed, tried)
        while proven > 0 and not is_certain(box(proven - 1)):
            proven -= 1
            if first - proven == _FAILED and proven > 0 and not is_certain(box(0)):
                proven = 0
    beyond = found.get(changed, answer)
    return GeometryMargin(
        kind=kind,
        holds_within=sizes[proven - 1] if proven > 0 else 0.0,
        changes_at=sizes[changed] if found else math.inf,
        verdict_beyond=beyond.verdict,
        modes_beyond=tuple(mode.mode for mode in beyond.modes) if found else (),
    )


def _says_otherwise(one: _Answer, other: _Answer) -> bool:
    """Return whether answers have different verdicts, or different modes that are UNIQUE.

    An answer that could not be decided says nothing else.
    """
    if one.verdict != other.verdict:
        return one.verdict != ModeVerdict.UNDECIDED
    return one.verdict == ModeVerdict.UNIQUE and one.modes[0].mode != other.modes[0].mode


def _first(low: int, high: int, happens: Callable[[int], bool]) -> int:
    """Return the first step from ``low`` on at which something happens that goes on to happen, by bisection.

    Returns ``high`` if it does not happen before.
    """
    while low < high:
        middle = (low + high) // 2
        if happens(middle):
            high = middle
        else:
            low = middle + 1
    return low
