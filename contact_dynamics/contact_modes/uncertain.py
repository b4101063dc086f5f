# SPDX-License-Identifier: Apache-2.0
"""Boxes of contact sets are searched for other answers, in the plane and in space.

One question is which verdicts occur in the box of a problem's uncertainty. If there is no proof, contact sets
in the box are sampled, and whether more verdicts occur than they have is not known. Another is how far
contacts would have to move, turn or change friction for another answer. For this, boxes of growing size are
searched for the largest one in which the answer is proven, and above it for the smallest one in which a
sample has another answer. The true margin lies between the two sizes.
"""

from __future__ import annotations

import math
from itertools import islice
from typing import TYPE_CHECKING, Final, Generic, TypeVar

from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact_modes.result import AnyModeAnswer, GeometryMargin, ModeVerdict, VerdictsWithin

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


_FAILED: Final = 4
"""After this many failed proofs the smallest box is tried. If its proof fails, all others would fail too."""


_TRIED_FIRST: Final = 6
"""Proofs that are tried from the largest box on, before samples. Feet on a floor need no more."""


AnyAnswer = TypeVar("AnyAnswer", bound=AnyModeAnswer)


class Boxes(Generic[AnyAnswer]):
    """Boxes of contact sets around those of a question, and what is known of the answers in them."""

    __slots__ = ("_answer", "_is_certain", "_largest", "_sampled", "_samples", "_step", "_steps")

    def __init__(
        self,
        answer: AnyAnswer,
        *,
        is_certain: Callable[[ContactUncertainty], bool],
        sampled: Callable[[ContactUncertainty], Iterable[AnyAnswer]],
        radius_of_gyration: float,
        frictions: Iterable[float],
        step: float,
        steps: int,
        samples: int | None = None,
    ) -> None:
        """Take what is known.

        Args:
            answer: The answer to the question itself.
            is_certain: Whether it is proven that the verdict of this answer holds everywhere in a box.
            sampled: The answers at some contact sets in a box.
            radius_of_gyration: m, of the body. Points are tried so far off at most for margins.
            frictions: Those of the contacts. The largest, or 1, is the most that frictions are tried off.
            step: Each size that is tried is this factor from the next.
            steps: How many sizes below the largest are tried.
            samples: How many contact sets are tried for each size, or None for all that are ``sampled``.
        """
        self._answer, self._is_certain, self._sampled = answer, is_certain, sampled
        self._largest = {
            "points": radius_of_gyration,
            "normals": 0.5 * math.pi,
            "frictions": max([1.0, *frictions]),
        }
        self._step, self._steps, self._samples = step, steps, samples

    def verdicts_within(self, box: ContactUncertainty) -> VerdictsWithin:
        """Return the verdicts that occur in a box.

        It is sampled if there is no proof that there is only one.
        """
        certain = box.is_exact or self._is_certain(box)
        samples = [] if certain else list(self._sampled(box))
        verdicts = dict.fromkeys(one.verdict for one in (self._answer, *samples))
        modes = dict.fromkeys(mode.mode for one in (self._answer, *samples) for mode in one.modes)
        return VerdictsWithin(
            uncertainty=box,
            verdicts=tuple(verdicts),
            modes=tuple(modes),
            certain=certain,
            samples=len(samples),
        )

    def margins(self) -> tuple[GeometryMargin, ...]:
        """Return the margins of the answer in points, normals and frictions, in this order.

        In each of them only that one is off, for all contacts at once and for each in its own way. There are
        no margins if a contact approaches.
        """
        kinds = () if self._answer.verdict == ModeVerdict.IMPACT else self._largest.items()
        return tuple(
            self._margin(kind, [size / self._step**k for k in range(self._steps, -1, -1)])
            for kind, size in kinds
        )

    def _margin(self, kind: str, sizes: Sequence[float]) -> GeometryMargin:
        """Return the margin of an answer in one kind of error, of which sizes are tried in growing order."""
        found: dict[int, AnyAnswer] = {}

        def box(k: int) -> ContactUncertainty:
            return ContactUncertainty(**{kind: sizes[k]})

        def changes(k: int) -> bool:
            beyond = next(
                (
                    one
                    for one in islice(self._sampled(box(k)), self._samples)
                    if _says_otherwise(one, self._answer)
                ),
                None,
            )
            if beyond is not None:
                found[k] = beyond
            return beyond is not None

        # A proof that fails mostly does so early, and takes a hundredth of one that succeeds. So the first
        # that succeeds on the way down is the last. Boxes with a proof need no samples.
        tried = max(0, len(sizes) - _TRIED_FIRST)
        proven = next((k for k in range(len(sizes), tried, -1) if self._is_certain(box(k - 1))), 0)
        changed = _first(proven, len(sizes), changes)
        if proven == 0:
            proven = first = min(changed, tried)
            while proven > 0 and not self._is_certain(box(proven - 1)):
                proven -= 1
                if first - proven == _FAILED and proven > 0 and not self._is_certain(box(0)):
                    proven = 0
        beyond = found.get(changed, self._answer)
        return GeometryMargin(
            kind=kind,
            holds_within=sizes[proven - 1] if proven > 0 else 0.0,
            changes_at=sizes[changed] if found else math.inf,
            verdict_beyond=beyond.verdict,
            modes_beyond=tuple(mode.mode for mode in beyond.modes) if found else (),
        )


def _says_otherwise(one: AnyModeAnswer, other: AnyModeAnswer) -> bool:
    """Return whether answers have different verdicts, or different modes that are UNIQUE.

    An answer that could not be decided says nothing else.
    """
    if one.verdict != other.verdict:
        return one.verdict != ModeVerdict.UNDECIDED
    return one.verdict == ModeVerdict.UNIQUE and one.modes[0].mode != other.modes[0].mode


def _first(low: int, high: int, happens: Callable[[int], bool]) -> int:
    """Return the first step from ``low`` on at which a condition holds that then keeps holding, by bisection.

    It is ``high`` if the condition does not hold before.
    """
    while low < high:
        middle = (low + high) // 2
        if happens(middle):
            high = middle
        else:
            low = middle + 1
    return low
