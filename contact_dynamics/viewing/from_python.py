# SPDX-License-Identifier: Apache-2.0
"""Draws results computed in Python, the bodies' motions and answers, in one call."""

from __future__ import annotations

import warnings
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.contact_modes.result import BodiesModeAnswer
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from contact_dynamics.questions.services import Answer
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.world import World

SURFACE_SIDE: Final = 2.0  # m


def view(
    world: World,
    answers: Sequence[Answer | BodiesModeAnswer] = (),
    *,
    motions: Mapping[str, Sequence[BodyState]] | None = None,
    path: str | Path | None = None,
    surface_side: float = SURFACE_SIDE,
) -> None:
    """Draw motions of bodies and answers in rerun's viewer, or into a file for it.

    Each state and answer appears at its stamp, and an answer of `contact_modes` about several bodies at the
    newest stamp of its states.

    Args:
        world: The bodies, by whose names motions and answers are drawn, and the surfaces.
        answers: Answers of `questions.ask`, or of `contact_modes` about several bodies, in the order of their
            stamps.
        motions: States of each body by its name, in the order of their stamps.
        path: The file to write (.rrd), or None to open the viewer.
        surface_side: m, side of the squares that represent surfaces.

    Raises:
        UnknownBodyError: a motion has a name that is no body's.
        NowhereToDrawError: the viewer cannot be opened.
        OSError: the file cannot be written.
    """
    states = {world.body(name).name: list(motion) for name, motion in (motions or {}).items()}
    sinks = Sinks(viewer=ViewerMode.SPAWN) if path is None else Sinks(rrd_path=str(path))
    recording = OpenRecording(sinks, on_problem=lambda text: warnings.warn(text, stacklevel=4))
    try:
        picture = Picture(recording.stream, world, surface_side=surface_side)
        for answer in answers:
            if isinstance(answer, BodiesModeAnswer):
                problem: Any = answer.problem  # a BodiesContactProblem
                stamp_ns = max((state.stamp_ns for state in problem.states), default=0)
                show = partial(picture.show_bodies, answer, problem.contacts)
            else:
                stamp_ns, show = answer.stamp_ns, partial(picture.show, answer)
            for name, waiting in states.items():
                count = sum(state.stamp_ns <= stamp_ns for state in waiting)
                picture.add_states(name, waiting[:count])
                states[name] = waiting[count:]
            show(now_ns=stamp_ns)
        for name, waiting in states.items():
            picture.add_states(name, waiting)
        if path is not None:
            picture.frame_all()
    finally:
        recording.close()
