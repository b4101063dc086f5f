# SPDX-License-Identifier: Apache-2.0
"""The command `contact-dynamics plot` draws the answers of a log into files."""

from __future__ import annotations

import re
import sys
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.plots.arguments import plot_parser
from contact_dynamics.plots.drawing import save_figure
from contact_dynamics.plots.figures import figures_of
from contact_dynamics.replay.events import OK, UNREADABLE, Answered, LoggedEvents, WorldChanged
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.replay.events import Answered
    from contact_dynamics.world import World

NOTHING_DRAWN: Final = 1  # exit code if the log has no answer with a diagram
NO_LOG: Final = 2  # exit code if the log cannot be read, or a file cannot be written
_UNUSUAL: Final = re.compile(r"[^A-Za-z0-9._-]+")


def main(arguments: list[str]) -> int:
    """Draw the answers of a log and return the exit code."""
    parser = plot_parser()
    given = parser.parse_args(arguments)
    if given.log is None or given.output is None:  # argparse would complain of this before a mistyped option
        parser.error(f"{'LOG' if given.log is None else '--output DIR'} is required")
    answered = drawn = 0
    try:
        given.output.mkdir(parents=True, exist_ok=True)
        for number, logged, world in islice(_answers(Path(given.log)), given.max_responses):
            answered += 1
            for path in _write(number, logged, world, given.output, given.format):
                drawn += 1
                print(path)
    except (ContactDynamicsError, OSError) as error:
        print(f"contact-dynamics plot: {error}", file=sys.stderr)
        return NO_LOG
    print(f"{drawn} diagrams of {answered} responses", file=sys.stderr)
    return 0 if drawn else NOTHING_DRAWN


def _answers(path: Path) -> Iterator[tuple[int, Answered, World]]:
    """Yield the answers of a log, each with the number of its question and the world at that time."""
    events = LoggedEvents(path, states=False)
    world, number = events.world, 0
    for event in events:
        if isinstance(event, WorldChanged):
            world = event.world
        elif isinstance(event, Answered):
            number += 1
            if event.status == OK:
                yield number, event, world
            elif event.status == UNREADABLE:
                print(f"contact-dynamics plot: request {number}: {event.message}", file=sys.stderr)


def _write(number: int, logged: Answered, world: World, folder: Path, suffix: str) -> list[Path]:
    """Write the diagrams of one answer, and return their files."""
    if logged.asked is None or logged.answer is None:
        return []
    about = logged.asked.about
    body, other = (_body(getattr(about, role, None), world) for role in ("body", "other"))
    gravity_W = getattr(about, "gravity_W", None)  # an impact needs none
    figures = figures_of(
        logged.answer,
        gravity_W=world.gravity_W if gravity_W is None else gravity_W,
        body=None if body is None else body.mass_properties,
        other=None if other is None else other.mass_properties,
        shape=NO_SHAPE if body is None else body.shape,
    )
    written = []
    kind = logged.service.kind.lower().replace(" ", "-")
    for name, figure in figures:
        words = filter(None, (f"{number:03d}", kind, logged.answer.body_name, name))
        path = folder / f"{_UNUSUAL.sub('_', '-'.join(words))}.{suffix}"
        save_figure(figure, path)
        written.append(path)
    return written


def _body(body: Body | str | None, world: World) -> Body | None:
    """Return a body that a question describes or names, or None if the world does not have it."""
    if body is None or isinstance(body, Body):
        return body
    return next((each for each in world.bodies if each.name == body), None)
