"""What the answers of each service say in a table.

The records of services name these functions, which yield cells by the names of their columns: once, or once
for each of many states or candidates. `rows` adds what holds for all rows of a question.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.rigid_body.published_frame import origins_of_published_frame

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
    from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer

Cell: TypeAlias = str | int | float | None
Cells: TypeAlias = dict[str, Cell]
Asked: TypeAlias = "Mapping[str, object]"
"""What was asked, by the names of the request's fields, as far as it is not the default."""

STATE: Final = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz")
"""The numbers of a state, as columns name them."""

_OF_A_STATE: Final = {
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

_OF_A_SET: Final = {
    "positions": 3,
    "normals": 3,
    "frictions": 1,
    "restitutions": 1,
    "surface_names": 1,
    "surface_velocities": 3,
    "surface_accelerations": 3,
    "kinds": 1,
    "body_curvatures": 1,
    "surface_curvatures": 1,
    "body_curvature_directions": 3,
    "body_curvatures_across": 1,
    "surface_curvature_directions": 3,
    "surface_curvatures_across": 1,
}
"""How many numbers of a set of contacts belong to one of them, by the name of the field."""


def cells_of_tumbling(answer: TumblingAnswer, asked: Asked) -> Iterator[Cells]:  # noqa: ARG001  as all
    """Yield what ends the flight."""
    event = answer.event
    says, surface = ("flight", "") if event is None else (event.kind.name.lower(), event.surface)
    yield _cells(says, [surface])


def cells_of_impact(answer: ImpactAnswer, asked: Asked) -> Iterator[Cells]:  # noqa: ARG001  as all
    """Yield the outcome of the impact."""
    outcome = answer.impact.outcome
    yield _cells("several at once" if outcome is None else outcome.name.lower(), answer.contacts.surfaces)


def cells_of_toss(answer: TossAnswer, asked: Asked) -> Iterator[Cells]:  # noqa: ARG001  as all
    """Yield the end of the toss, and the corners on which the body rests."""
    corners = " ".join(map(str, answer.toss.resting_corners))
    end = answer.toss.end.name.lower()
    surfaces = [name for event in answer.toss.events[-1:] for name in event.surfaces]
    yield _cells(f"{end} on {corners}" if corners else end, surfaces)


def cells_of_contact_modes(answer: ContactModeAnswer, asked: Asked) -> Iterator[Cells]:  # noqa: ARG001  as all
    """Yield the verdict with its modes."""
    yield _cells(_verdict(answer.verdict, [mode.mode for mode in answer.modes]), answer.contacts.surfaces)


def cells_of_tumblings(answer: ManyTumblingsAnswer, asked: Asked) -> Iterator[Cells]:
    """Yield each state at the end of its flight."""
    return _of_states(answer, asked, lambda _: "flight")


def cells_of_impacts(answer: ManyImpactsAnswer, asked: Asked) -> Iterator[Cells]:
    """Yield the outcome of each impact, and the state after it."""

    def says(i: int) -> str:
        return "separates" if answer.separates[i] else ImpactOutcome(int(answer.outcomes[i])).name.lower()

    return _of_states(answer, asked, says)


def cells_of_many_contact_modes(answer: ManyContactModesAnswer, asked: Asked) -> Iterator[Cells]:
    """Yield the verdict on each candidate with its modes."""
    mode_ends, set_ends = np.cumsum(answer.mode_counts).tolist(), np.cumsum(answer.contact_counts).tolist()
    for i, verdict in enumerate(answer.verdicts.tolist()):
        modes = answer.modes[mode_ends[i] - answer.mode_counts[i] : mode_ends[i]]
        k = i % len(set_ends)
        begin, end = set_ends[k] - answer.contact_counts[k], set_ends[k]
        question = _parts(asked, {"forces": 3, "torques": 3}, i, len(answer))
        contacts = asked.get("contacts")
        if isinstance(contacts, dict) and len(set_ends) > 1:
            question |= {
                "contacts": _contacts(contacts, begin, end),
                "contact_counts": [end - begin],
            }
        yield {
            **_cells(_verdict(ModeVerdict(verdict), modes), answer.contacts.surfaces[begin:end]),
            "state": i,
            "question": json.dumps(question),
        }


def _cells(says: str, surfaces: Iterable[str]) -> Cells:
    return {"says": says, "surface": ", ".join(dict.fromkeys(surfaces))}


def _verdict(verdict: ModeVerdict, modes: Sequence[str]) -> str:
    name = verdict.name.lower()
    return f"{name}: {', '.join(modes)}" if modes else name


def _of_states(
    answer: ManyTumblingsAnswer | ManyImpactsAnswer, asked: Asked, says: Callable[[int], str]
) -> Iterator[Cells]:
    """Yield the cells of each state. Times have none, because such a question names none."""
    states = answer.states
    origins = origins_of_published_frame(states.p_WB_W, states.q_WB, answer.p_FB_F)
    numbers = np.concatenate([origins, states.q_WB, states.v_WB_W, states.w_WB_W], axis=1)
    for i, row in enumerate(numbers.tolist()):
        yield {
            "state": i,
            "question": json.dumps(_parts(asked, _OF_A_STATE, i, len(states))),
            "says": says(i),
            **{f"predicted_{name}": number for name, number in zip(STATE, row, strict=True)},
        }


def _parts(asked: Asked, widths: Mapping[str, int], i: int, count: int) -> dict[str, object]:
    """Return what a request says of one of many: its rows of the lists, and what holds for all."""
    found: dict[str, object] = {}
    for name, value in asked.items():
        width = widths.get(name)
        if width is not None and isinstance(value, list) and len(value) == width * count:
            found[name] = value[width * i : width * (i + 1)] if width > 1 else value[i]
        elif isinstance(value, dict) and name == "states":
            found[name] = _parts(value, widths, i, count)
        else:
            found[name] = value
    return found


def _contacts(contacts: Mapping[str, list[object]], begin: int, end: int) -> dict[str, object]:
    """Return one of many sets of contacts, which stand one after the other."""
    return {name: value[_OF_A_SET[name] * begin : _OF_A_SET[name] * end] for name, value in contacts.items()}
