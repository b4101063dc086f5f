"""Flights of many samples up to their first contacts: those of `flight`, in arrays.

Arrivals are found nearly, all at once (`arrivals_of_many`). Newton's steps then lead to where the corner is
on the flat, unless it comes down slowly.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.toss.arrivals_of_many import arrivals_of_many

if TYPE_CHECKING:
    from contact_dynamics.toss.flight import AskedFlight

NEWTON: Final = 2
"""Newton's steps towards an arrival. It is found to 1e-7 m before, which is 1e-5 s at most here, so that the
first step leaves 1e-9 m and the second leaves rounding."""


def fly_together(asked: list[AskedFlight]) -> None:
    """Do flights of bodies with as many corners between the same flats."""
    y = np.array([one.y for one in asked])
    found = arrivals_of_many(
        asked[0].solid,
        np.array([one.solid.inertia for one in asked]),
        np.array([one.solid.corners for one in asked]),
        np.array([one.solid.gravity for one in asked]),
        [y[:, :3], y[:, 3:7], y[:, 7:10], y[:, 10:]],
        longest=np.array([one.longest for one in asked]),
        pauses=np.array([one.pause for one in asked]),
        polished=NEWTON,
    )
    after = np.hstack(found.state).tolist()
    for one, seconds, numbers in zip(asked, found.seconds.tolist(), after, strict=True):
        one.seconds, one.after = seconds, numbers
