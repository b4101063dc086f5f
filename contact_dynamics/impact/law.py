"""This file names the restitution laws and what can happen during an impact (Mason, lecture 27).

Compression collects an amount, and restitution returns a share of it. `RestitutionRule` says for each law
which amount this is and where restitution ends. It serves paths in space, which are not known in advance. In
the plane the path is known, and the three ends are closed forms in the middle of one computation
(`planar.routh`, and `planar.batch` for many). A call there would take a tenth of the time of the computation.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, NoReturn, TypeVar

import numpy as np

from contact_dynamics.records import NamedInt
from contact_dynamics.validation_batches import check_rows
from contact_dynamics.validation_types import Expected, check_type

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.numerics.elementwise import Real
    from contact_dynamics.validation import FloatArray

Series = TypeVar("Series")
"""What is known of a quantity along a path."""


class RestitutionLaw(NamedInt):
    """How the coefficient e decides where restitution ends."""

    POISSON = 0
    """e is the normal impulse of restitution over that of compression (lecture 27, eq. 2; Routh 1860)."""
    NEWTON = 1
    """e is the normal velocity of separation over that of approach (lecture 27, eq. 1). Can create energy
    with friction."""
    ENERGETIC = 2
    """e squared is the work that the normal impulse returns over the work that it took (Stronge 1990)."""


def refuse_unknown(law: NoReturn) -> NoReturn:
    """Raise `NotImplementedError` for a law that a caller has no branch for. Mypy finds such a caller first.

    Where every member of `RestitutionLaw` has its branch, nothing is left for the argument to be.
    """
    message = f"restitution_law: found {law}, which is not written down here"
    raise NotImplementedError(message)


class RestitutionRule:
    """The rule of Poisson's law: it says what compression collects and where restitution ends.

    Numbers are floats, or arrays with one element for each impact. Both give the same bits. ``due`` is what
    restitution still owes, in the unit of the amount. ``final`` is the velocity at which Newton's law ends
    the impact, m/s.
    """

    law = RestitutionLaw.POISSON
    needs_work = False
    """Whether the work of the normal impulse must be known on the way."""

    def share(self, restitution: Real, v_n: Real) -> Real:
        """Return the part of the amount that restitution gives back, for a coefficient e.

        ``v_n``, m/s, is the normal velocity before the impact, on which e may depend.
        """
        del v_n
        return restitution

    def final(self, restitution: Real, v_n: Real) -> Real:
        """Return the velocity at which Newton's law ends an impact that begins with ``v_n``, m/s."""
        return restitution * -v_n

    def amount(self, p: Real, work: Real) -> Real:
        """Return the amount that a normal impulse, N s, collects or gives back while it does some work, J."""
        del work
        return p

    def is_done(self, *, p: Real, v_n: Real, work: Real, due: Real, final: Real) -> Any:
        """Return whether restitution is over once an impulse, with its work, has led to v_n."""
        del v_n, final
        return self.amount(p, work) >= due

    def distance(self, v_n: float, lifting: float, due: float, final: float) -> float:
        """Return the normal impulse, N s, that is left until restitution is over.

        The normal velocity grows by ``lifting`` for each N s.
        """
        del v_n, lifting, final
        return due

    def distances(
        self, v_n: FloatArray, lifting: FloatArray, due: FloatArray, final: FloatArray
    ) -> FloatArray:
        """Return `distance` for many impacts. Where one impact branches, this selects elements instead."""
        del v_n, lifting, final
        return due

    def meter(self, velocity: Series, impulse: Series, work: Series) -> Series:
        """Return which series along a path tells when restitution is over."""
        del velocity, work
        return impulse

    def level(self, first: Real, due: Real, final: Real) -> Real:
        """Return the value that the meter has when restitution is over.

        ``first`` is the value of the meter at the beginning of the stretch.
        """
        del final
        return first + due


class _Newton(RestitutionRule):
    """Newton's law looks at the normal velocity alone."""

    law = RestitutionLaw.NEWTON

    def is_done(self, *, p: Real, v_n: Real, work: Real, due: Real, final: Real) -> Any:
        del p, work, due
        return v_n >= final

    def distance(self, v_n: float, lifting: float, due: float, final: float) -> float:
        del due
        missing = final - v_n
        if missing <= 0.0:
            return 0.0
        return missing / lifting if lifting > 0.0 else math.inf

    def distances(
        self, v_n: FloatArray, lifting: FloatArray, due: FloatArray, final: FloatArray
    ) -> FloatArray:
        del due
        missing = final - v_n
        return np.where(missing <= 0.0, 0.0, np.where(lifting > 0.0, missing / lifting, math.inf))

    def meter(self, velocity: Series, impulse: Series, work: Series) -> Series:
        del impulse, work
        return velocity

    def level(self, first: Real, due: Real, final: Real) -> Real:
        del first, due
        return final


class _Energetic(RestitutionRule):
    """The energetic law collects work, of which e squared is given back."""

    law = RestitutionLaw.ENERGETIC
    needs_work = True

    def share(self, restitution: Real, v_n: Real) -> Real:
        del v_n
        return restitution * restitution

    def amount(self, p: Real, work: Real) -> Real:
        del p
        return work

    def distance(self, v_n: float, lifting: float, due: float, final: float) -> float:
        del final
        if due <= 0.0:
            return 0.0
        square = v_n * v_n + 2.0 * lifting * due
        return 2.0 * due / (v_n + math.sqrt(square)) if square > 0.0 else math.inf

    def distances(
        self, v_n: FloatArray, lifting: FloatArray, due: FloatArray, final: FloatArray
    ) -> FloatArray:
        del final
        square = v_n * v_n + 2.0 * lifting * due
        distance = np.where(square > 0.0, 2.0 * due / (v_n + np.sqrt(square)), math.inf)
        return np.where(due <= 0.0, 0.0, distance)

    def meter(self, velocity: Series, impulse: Series, work: Series) -> Series:
        del velocity, impulse
        return work


RULES: Final = {rule.law: rule for rule in (RestitutionRule(), _Newton(), _Energetic())}
"""The rule of each law."""


class ImpactOutcome(NamedInt):
    """What the contact did while the impulse grew.

    Stopping counts as during compression where it coincides with the end of compression, and as never where
    it coincides with the end of the impact.
    """

    NO_IMPULSE = 0
    """The contact does not approach, and its sliding does not drive it into compression."""
    SLIDES = 1
    """The contact slides until the end and never stops. A contact that is at rest at first slides at once if
    friction cannot hold it."""
    STICKS_IN_COMPRESSION = 2
    """Sliding stops during compression, and friction holds the contact until the end."""
    STICKS_IN_RESTITUTION = 3
    """Sliding stops during restitution, and friction holds the contact until the end."""
    REVERSES_IN_COMPRESSION = 4
    """Sliding stops during compression. Friction cannot hold the contact, so it slides on in another
    direction, which is back in the plane."""
    REVERSES_IN_RESTITUTION = 5
    """Sliding stops during restitution. Friction cannot hold the contact, so it slides on in another
    direction, which is back in the plane."""
    STICKS_THROUGHOUT = 6
    """The contact does not slide at first, and friction holds it until the end."""

    @property
    def sticks(self) -> bool:
        """Return whether the contact ends the impact without sliding."""
        return self in _STICKING


class PathEvent(NamedInt):
    """What a vertex of the impulse path stands for."""

    START = 0
    """The contact begins: the impulse is zero."""
    SLIDING_STOPS = 1
    """The contact stops sliding. It sticks from here on, or slides on in another direction."""
    COMPRESSION_ENDS = 2
    """The contact does not approach any more."""
    RESTITUTION_ENDS = 3
    """The contact separates: the impulse is complete."""
    SAMPLE = 4
    """A point on a curved part of the path, which only paths in space have."""


_STICKING = frozenset(
    {
        ImpactOutcome.STICKS_THROUGHOUT,
        ImpactOutcome.STICKS_IN_COMPRESSION,
        ImpactOutcome.STICKS_IN_RESTITUTION,
    }
)


def check_law_rows(field: str, value: ArrayLike) -> FloatArray:
    """Return values of `RestitutionLaw`, (N,).

    Each may be given as a member or, in an array of numbers, as the member's value.
    """
    if not (isinstance(value, np.ndarray) and value.dtype.kind in "iuf"):
        several = isinstance(value, (list, tuple, np.ndarray)) and np.ndim(value) > 0
        given: Any = value if several else [value]
        for i, law in enumerate(given):
            if type(law) not in {int, float} and not isinstance(law, np.number):
                check_type(f"{field}[{i}]" if several else field, law, Expected((RestitutionLaw,)))
    known = [float(law) for law in RestitutionLaw]
    allowed = " or ".join(f"{law.name} ({law.value})" for law in RestitutionLaw)
    return check_rows(field, value, (), allowed, lambda x: np.isin(x, known))
