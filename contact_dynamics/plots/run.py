"""The command `contact-dynamics plot` draws the answers of a log into files."""

from __future__ import annotations

import re
import sys
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.plots.arguments import plot_parser
from contact_dynamics.plots.figures import figures_of
from contact_dynamics.plots.logged_answers import logged_answers
from contact_dynamics.plots.style import save_figure
from contact_dynamics.shapes.convex import NO_SHAPE

if TYPE_CHECKING:
    from contact_dynamics.plots.logged_answers import LoggedAnswer

NOTHING_DRAWN: Final = 1
"""This exit code says that the log has no answer with a diagram."""

NO_LOG: Final = 2
"""This exit code says that the log cannot be read, or a file cannot be written."""

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
        for logged in islice(logged_answers(Path(given.log)), given.max_questions):
            answered += 1
            for path in _write(logged, given.output, given.format):
                drawn += 1
                print(path)
    except (ContactDynamicsError, OSError) as error:
        print(f"contact-dynamics plot: {error}", file=sys.stderr)
        return NO_LOG
    print(f"{drawn} diagrams of {answered} answers", file=sys.stderr)
    return 0 if drawn else NOTHING_DRAWN


def _write(logged: LoggedAnswer, folder: Path, suffix: str) -> list[Path]:
    """Write the diagrams of one answer, and return their files."""
    body = logged.body
    figures = figures_of(
        logged.answer,
        gravity_W=logged.gravity_W,
        body=None if body is None else body.mass_properties,
        other=None if logged.other is None else logged.other.mass_properties,
        shape=NO_SHAPE if body is None else body.shape,
    )
    written = []
    kind = logged.kind.lower().replace(" ", "-")
    for name, figure in figures:
        words = filter(None, (f"{logged.number:03d}", kind, logged.answer.body_name, name))
        path = folder / f"{_UNUSUAL.sub('_', '-'.join(words))}.{suffix}"
        save_figure(figure, path)
        written.append(path)
    return written
