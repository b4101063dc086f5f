"""Makes the rows of an answer about many states, one for each."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
from contact_dynamics.rigid_body.published_frame import origins_of_published_frame

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from contact_dynamics.replay.events import Answered

Cell: TypeAlias = str | int | float | None

STATE: Final = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz")
"""The numbers of a state, as columns name them."""

_WIDTHS: Final = {
    "positions": 3,
    "orientations": 4,
    "linear_velocities": 3,
    "angular_velocities": 3,
    "contact_positions": 3,
    "contact_normals": 3,
    "frictions": 1,
    "restitutions": 1,
    "times": 1,
}
"""How many numbers of a request belong to a state, by the name of the field."""


def rows_of_batch(answered: Answered) -> Iterator[dict[str, Cell]]:
    """Yield the cells of each state: its place, what was asked, what the answer says, and the state then.

    Times have no cells, because such a question names none. Nothing of it is measured either.
    """
    answer = answered.answer
    if not isinstance(answer, (ManyTumblingsAnswer, ManyImpactsAnswer)):
        return
    states = answer.states
    origins = origins_of_published_frame(states.p_WB_W, states.q_WB, answer.p_FB_F)
    numbers = np.concatenate([origins, states.q_WB, states.v_WB_W, states.w_WB_W], axis=1)
    for i, row in enumerate(numbers.tolist()):
        yield {
            "state": i,
            "question": json.dumps(_of_state(answered.question, i, len(states))),
            "says": _says(answer, i),
            **{f"predicted_{name}": number for name, number in zip(STATE, row, strict=True)},
        }


def _of_state(question: Mapping[str, object], i: int, count: int) -> dict[str, object]:
    """Return what a request says of one state: its rows of the lists, and what holds for all."""
    return {name: _part(name, value, i, count) for name, value in question.items()}


def _part(name: str, value: object, i: int, count: int) -> object:
    if isinstance(value, dict):
        return _of_state(value, i, count)
    width = _WIDTHS.get(name)
    if width is None or not isinstance(value, list) or len(value) != width * count:
        return value
    return value[width * i : width * (i + 1)] if width > 1 else value[i]


def _says(answer: ManyTumblingsAnswer | ManyImpactsAnswer, i: int) -> str:
    if isinstance(answer, ManyTumblingsAnswer):
        return "flight"
    return "separates" if answer.separates[i] else ImpactOutcome(int(answer.outcomes[i])).name.lower()
