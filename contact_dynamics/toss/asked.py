"""What a toss asks for on its way, so that many samples can have it together.

A toss is a generator that yields pieces of work: flights, impacts at one contact, and steps of the
integrator. A single toss does each of them at once. Samples wait for work of the same kind, and have it done
in arrays (`together`).
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Protocol, TypeAlias, TypeVar

Result = TypeVar("Result")

Kind: TypeAlias = tuple[str, int]
"""What work is about, flight, impact or step, with the number of corners, the law, or the contacts."""


class Asked(Protocol):
    """A piece of work, which keeps its result."""

    @property
    def kind(self) -> Kind | None:
        """Work of one kind can be done together. None is done alone."""

    def work(self) -> None:
        """Do this piece alone."""


Asking = Generator[Asked, None, Result]
"""Work that is asked for piece by piece, up to a result. Who asks goes on once the work is done."""
