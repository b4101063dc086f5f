# SPDX-License-Identifier: Apache-2.0
"""What was measured at the time that an answer is about.

A flight is measured by the last state that was published before that time. It is carried on to that time as
a free flight, over a few ms where states come often. An impact is measured by the free flight that fits the
poses of the 50 ms after it best, carried back to it. So what a tracker makes of velocities across an impact
plays no part. Where the body does not fly then, or strikes again, what is measured is no answer to what was
asked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import ns_after, seconds_between
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.tumbling.motion import free_motion

if TYPE_CHECKING:
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body

WITHIN: Final = 0.1
"""s. A state that is older than this when an answer's time comes says nothing of it any more."""

AFTER_IMPACT: Final = 0.05
"""s. The flight after an impact is fitted to the states of this time."""

_AT_IMPACT: Final = 1
"""States after an impact that do not count, since the impact can come a little later than predicted."""


class Measuring:
    """Watches the states of a body until what an answer predicts has been measured."""

    def __init__(
        self,
        *,
        body: Body,
        predicted: BodyState,
        newest: BodyState,
        gravity_W: FloatArray,
        is_impact: bool,
    ) -> None:
        """Begin to watch.

        Args:
            body: the body.
            predicted: what the answer predicts, with its stamp.
            newest: the newest state of the body by now.
            gravity_W: (3,), m/s^2, world axes.
            is_impact: whether the answer predicts what follows an impact, or what a flight comes to.
        """
        self.body_name = body.name
        self.predicted = predicted
        self.is_complete = False
        self._body = body.mass_properties
        self._gravity_W = gravity_W
        self._is_impact = is_impact
        self._before = newest
        self._after: list[BodyState] = []

    def see(self, body_name: str, state: BodyState) -> None:
        """Take a state that was published, of whatever body."""
        if body_name != self.body_name or self.is_complete:
            return
        if state.stamp_ns <= self.predicted.stamp_ns:
            self._before = state
            return
        until_ns = ns_after(self.predicted.stamp_ns, AFTER_IMPACT)
        if self._is_impact and state.stamp_ns <= until_ns:
            self._after.append(state)
        else:
            self.is_complete = True

    def result(self) -> BodyState | None:
        """Return what was measured, stamped with the predicted time, or None if too little was."""
        if not self.is_complete:
            return None
        try:
            state = self._before
            if self._is_impact:
                fitted = fit_free_motion(self._body, self._after[_AT_IMPACT:], gravity_W=self._gravity_W)
                if not (fitted.converged and fitted.turns_known):
                    return None
                state = fitted.state
            seconds = seconds_between(state.stamp_ns, self.predicted.stamp_ns)
            if abs(seconds) > WITHIN:
                return None
            return free_motion(self._body, state, gravity_W=self._gravity_W).state_at(seconds)
        except ContactDynamicsError:  # too few states, or they are of no flight
            return None
