# SPDX-License-Identifier: Apache-2.0
"""Answers and colours in words: the list of all answers, the newest of each kind, and the legend."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import rerun as rr

from contact_dynamics.viewing.entities import ANSWER_LOG, NEWEST_ANSWERS, SUMMARY

if TYPE_CHECKING:
    from collections.abc import Sequence


class AnswersInWords:
    """The reported answers, in the order of their arrival."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._newest: dict[str, str] = {}  # by kind

    def tell(self, kind: str, text: str, *, is_error: bool = False) -> None:
        """Write an answer into both lists, and its first words into the summary, at the time that is set."""
        level = rr.TextLogLevel.WARN if is_error else rr.TextLogLevel.INFO
        self._recording.log(ANSWER_LOG, rr.TextLog(f"{kind}: {text}", level=level))
        self._newest[kind] = text
        document = "\n\n".join(f"**{kind}**: {newest}" for kind, newest in self._newest.items())
        self._recording.log(NEWEST_ANSWERS, rr.TextDocument(document, media_type=rr.MediaType.MARKDOWN))
        summary = f"**{kind}**: {text.partition(';')[0]}"
        self._recording.log(SUMMARY, rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN))


def sentence(
    body_name: str, words: Sequence[str], *, remark: str = "", computation_time: float | None = None
) -> str:
    """Return an answer about a body in words, with a remark, and its computation time, s, if known."""
    said = [*words, remark] if remark else words
    took = "" if computation_time is None else f" ({_in_ms(computation_time)})"
    return f"{body_name or 'a body'} {'; '.join(said)}{took}"


def _in_ms(seconds: float) -> str:
    """Return a time in ms with at least two digits, without an exponent."""
    ms = seconds * 1e3
    return f"{ms:.0f} ms" if ms >= 10.0 else f"{ms:.2g} ms"


LEGEND_TEXT: Final = """\
| drawn | means |
| --- | --- |
| body, trail and thick curves in the body's colour | measured; a single body is blue grey |
| orange path, outlines, thin curves | the newest prediction; faint: the three paths before it |
| curve *error of the predicted position* | distance of the measured from the predicted centre of mass |
| orange ellipsoids | two deviations of the predicted centre of mass; white: not to be relied on |
| orange translucent body | end of the newest prediction |
| red outlines, arrows | each body at its newest predicted impact, impulses on it |
| pale, bright yellow arrow | velocity of the centre of mass before, after it as predicted |
| arrow in the body's colour | its velocity after the impact as measured, from the poses of the next 50 ms |
| red, pale curve of the speed | after an impact, as predicted and as measured from the poses |
| points with arrows, of many | where many states are then, their velocities; red: their impulses |
| red points, faint red outlines | strikes of a whole toss, and of its samples; white: other ways |
| yellow lines, points, ellipsoids | the tree of the next strikes, and where nine tenths of the samples are |
| violet cone | friction cone: the impulses and forces that friction allows |
| green, pink, cyan points and arrows | contacts that stay fixed, slide, separate; their contact forces |
| white outline | the body that the newest answer about contact modes is about |
| thin pink arrow | which way a contact slides |
| white arrow | gravity and applied load together, at the centre of mass |
| orange arrow | acceleration of the centre of mass, or of contacts |

The longest arrow of each kind is drawn as long as suits the body: read its label. Strikes in sequence are
numbered, the largest of them with the body as it is then. The newest impact has labels, until 0.5 s after it;
older ones of other bodies go then.

In *impulse space* the tangential impulse goes to the right, the normal impulse up. The red path is
the impulse as it accumulates. On the green line the contact does not slide, on the cyan line it does not
approach.

*Impulse space in 3-D*, of impacts in space, has the round friction cone (violet), the line on which the
contact does not slide (green), and the plane on which it does not approach (cyan).

Several *contact modes* may be consistent: the tab shows all, side by side; the scene shows `mode_1` (switch
on `mode_2` and so on under *contacts* in the blueprint panel). `s` separates, `l` and `r` slide left and
right, `f` stays fixed, `c` slides in space.

The *mode map* shows the contact modes by applied wrench. Each point of a disc is a direction: its angle is
that of the force, its distance from the centre is the share of force, and the centre is a pure torque. White:
several modes are consistent; black: none is. Red: the applied wrench, and its smallest change to another
mode. Of a moving body, the square shows forces at the applied torque.

The *force dual* shows the first mode in the plane of the body at rest, twice: wrenches that turn it
anticlockwise on the left, clockwise on the right. Each is a point: the centre about which it would turn the
free body. Violet `-c`: edges of friction cones, negated; orange `a`: centres of accelerations that the mode
allows. What they span can bring the mode about. Red: the wrench in question; the larger orange point: the
centre of the acceleration.

*Energy and momentum* are those of the body that was asked about, until its prediction is over. The energy
includes the potential energy. The angular momentum is about the centre of mass. In free flight it stays, and
the angular velocity changes. A velocity that was estimated over a window of time is wrong after a strike,
until the window has passed.

*Poinsot*: in the space of angular velocities the inertia ellipsoid turns with the body and rolls on the plane
at right angles to the angular momentum (white). Yellow: the angular velocity, which ends where they touch.
Orange: its way on the ellipsoid, the polhode; green: on the plane, the herpolhode.
"""
