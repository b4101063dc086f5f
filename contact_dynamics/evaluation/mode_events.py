"""When a measured body rests or slides: windows of poses in which its contacts stay what they are.

In each window (`MODE_SPAN`) outside of flights the poses, as position and rotation vector, are fitted by a
quadratic function of time, because friction slows a slide evenly. If the poses keep to it as noise allows,
its slopes in the middle of the window are the velocities there. A contact point that is slower than
`MODE_SPEED`, plus the slopes' noise, is fixed (`f`) or slides (`c`), as its velocity along the surface says;
one that is faster across the surface separates or approaches, and then the window holds neither rest nor
sliding. Neighbouring windows of one kind make one event.

Not covered: rolling, tipping and spinning on a point, which are neither; slides shorter than a window.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.evaluation.found_event import EventKind, FoundEvent
from contact_dynamics.evaluation.touching import touch_of
from contact_dynamics.measured.flights import DEVIATIONS, ORIENTATION_SLACK, POSITION_SLACK
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import rotation_vectors, turned
from contact_dynamics.tolerances import MODE_SPAN, MODE_SPEED, TOUCHING_GAP

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.evaluation.motion import MeasuredMotion
    from contact_dynamics.evaluation.touching import Touch


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class _Window(Record):
    """What the contacts do in one window of samples."""

    first: int
    stop: int
    kind: EventKind
    mode: str
    touch: Touch
    middle: BodyState
    velocity_std: float
    angular_velocity_std: float


def mode_events(motion: MeasuredMotion, flights: Sequence[slice]) -> list[FoundEvent]:
    """Return the rests and slides of a body, between its flights."""
    count = max(5, round(MODE_SPAN * motion.rate))
    begins = [0, *(flight.stop for flight in flights)]
    ends = [*(flight.start for flight in flights), len(motion)]
    events = []
    for begin, end in zip(begins, ends, strict=True):
        stretch: list[_Window] = []
        for first in range(begin, end - count + 1, max(1, count // 4)):
            window = _window(motion, first, first + count)
            if stretch and (window is None or window.kind is not stretch[-1].kind):
                events.append(_event(motion, stretch))
                stretch = []
            if window is not None:
                stretch.append(window)
        if stretch:
            events.append(_event(motion, stretch))
    return events


def _window(motion: MeasuredMotion, first: int, stop: int) -> _Window | None:
    middle = (first + stop) // 2
    times = motion.times[first:stop] - motion.times[middle]
    poses = np.hstack(
        [
            motion.p_WB_W[first:stop] - motion.p_WB_W[middle],
            rotation_vectors(motion.q_WB[first:stop], motion.q_WB[middle]),
        ]
    )
    powers = np.column_stack([np.ones_like(times), times, times * times])
    fitted = np.linalg.lstsq(powers, poses, rcond=None)[0]
    at_middle, slopes = fitted[0], fitted[1]
    noise = np.repeat([motion.position_noise, motion.orientation_noise], 3)
    allowed = DEVIATIONS * noise + np.repeat([POSITION_SLACK, ORIENTATION_SLACK], 3)
    if (np.abs(poses - powers @ fitted) > allowed).any():
        return None
    state = BodyState(
        p_WB_W=motion.p_WB_W[middle] + at_middle[:3],
        q_WB=turned(motion.q_WB[middle], at_middle[None, 3:])[0],
        v_WB_W=slopes[:3],
        w_WB_W=slopes[3:],
        stamp_ns=motion.stamp_ns(middle),
    )
    touch = touch_of(motion.body, state, motion.world, within=TOUCHING_GAP)
    if touch is None:
        return None
    spread = float(np.sqrt(np.square(times - times.mean()).sum()))
    velocity_std, angular_velocity_std = noise[0] / spread, noise[3] / spread
    mode = _mode(state, touch, velocity_std, angular_velocity_std)
    if not mode:
        return None
    reach = float(np.linalg.norm(motion.body.shape.vertices, axis=1).max()) + motion.body.shape.rounding
    is_slow = max(
        np.linalg.norm(state.v_WB_W), reach * np.linalg.norm(state.w_WB_W)
    ) <= MODE_SPEED + DEVIATIONS * (velocity_std + reach * angular_velocity_std)
    if "c" not in mode and not is_slow:  # it rolls, or spins on a point
        return None
    return _Window(
        first=first,
        stop=stop,
        kind=EventKind.SLIDING if "c" in mode else EventKind.REST,
        mode=mode,
        touch=touch,
        middle=state,
        velocity_std=velocity_std,
        angular_velocity_std=angular_velocity_std,
    )


def _mode(state: BodyState, touch: Touch, velocity_std: float, angular_velocity_std: float) -> str:
    """Return a letter for each contact, f or c; empty if a contact separates or approaches."""
    letters = []
    for point, normal in zip(touch.contacts.p_WC_W, touch.contacts.normals_W, strict=True):
        velocity = state.velocity_of_point(point)
        arm = float(np.linalg.norm(point - state.p_WB_W))
        allowed = MODE_SPEED + DEVIATIONS * float(np.hypot(velocity_std, arm * angular_velocity_std))
        across = float(velocity @ normal)
        if abs(across) > allowed:
            return ""
        letters.append("c" if float(np.linalg.norm(velocity - across * normal)) > allowed else "f")
    return "".join(letters)


def _event(motion: MeasuredMotion, stretch: Sequence[_Window]) -> FoundEvent:
    last = stretch[-1]
    sample = (last.first + last.stop) // 2
    return FoundEvent(
        kind=last.kind,
        body=motion.body.name,
        surface=last.touch.surface,
        since=float(motion.times[stretch[0].first]),
        first_sample=stretch[0].first,
        time=float(motion.times[sample]),
        time_ns=motion.stamp_ns(sample),
        time_std=0.0,
        state=last.middle,
        position_std=motion.position_noise,
        orientation_std=np.full(3, motion.orientation_noise),
        velocity_std=last.velocity_std,
        angular_velocity_std=np.full(3, last.angular_velocity_std),
        gap=last.touch.gap,
        mode=last.mode,
    )
