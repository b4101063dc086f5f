"""Writes docs/cases.md from the cases of `contact_dynamics.cases`: `python scripts/cases_page.py`.

The package's numbers come from asking the cases now. MuJoCo's come from benchmarks/measured.json, into which
`python -m benchmarks cases --write` puts them. The code of each case is its own source. A test compares the
page with what this script makes.
"""

from __future__ import annotations

import ast
import math
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))  # the benchmarks are not installed

from benchmarks import _quotes as quotes  # noqa: E402 # after the path
from contact_dynamics.cases import CASES, Case  # noqa: E402
from contact_dynamics.cases.published import PublishedVerdict, published_values  # noqa: E402
from contact_dynamics.cases.report import published_row, shown  # noqa: E402

PAGE = ROOT / "docs" / "cases.md"
HEAD = """\
# Ask before you trust

*Engines answer every question. Which answers are physics, and which are the engine?* Users of the big engines asked the questions on this
page in public, because the answer that they got was an artefact of time steps and softened contacts. Each has an exact answer in closed
form. This command asks all of them here, and of MuJoCo in the same run if it is installed:

```sh
contact-dynamics cases
```

`contact-dynamics cases NAME` asks one case, and `--list` prints the names. `--without-mujoco` leaves out the simulations, which take most of
the time.

**How to read the table.** MuJoCo's numbers are measured in simulations with its default settings and time step, unless the code of the case
says otherwise. They are no verdict on MuJoCo: it computes the motion of whole robots with contacts that are soft on purpose, and smaller
steps and other settings come closer. Where a restitution is asked for, its contact is a spring and damper made for it, resolved by ten
steps. MuJoCo's numbers show how large an artefact can be where nobody looks for it. [When to use what](when-to-use-what.md) says what each is for.

The package answers what its rigid bodies and Coulomb's law imply, to rounding. Whether the world obeys them is another question, and the
coefficients of the real world are yours to know.

"""


def label(case: Case, setting: float) -> str:
    """Return the name of a setting for the tables."""
    return f"{case.setting}: {setting:g}"


def address_text(address: str) -> str:
    """Return what a link to a thread says, such as `mujoco#3328`."""
    parts = address.split("/")
    return f"{parts[4]}#{parts[6]}"


def anchor(title: str) -> str:
    """Return the anchor that MkDocs and GitHub make of a heading."""
    kept = "".join(letter for letter in title.lower() if letter.isalnum() or letter in " -_")
    return kept.replace(" ", "-")


def mujoco(name: str, i: int, measured: dict[str, str]) -> str:
    """Return MuJoCo's number between the marks of a measured number."""
    mark = f"cases.{name}.{i}"
    return f"<!--bench:{mark}-->{measured.get(mark, '?')}<!--/-->"


def table(measured: dict[str, str]) -> Iterator[str]:
    """Yield the lines of the table of all cases."""
    yield "| question | asked | exact | ours | MuJoCo |"
    yield "| --- | --- | --- | --- | --- |"
    for name, case in CASES.items():
        for i, setting in enumerate(case.settings):
            title = f"[{case.title}](#{anchor(case.title)})" if i == 0 else ""
            exact, ours = (shown(of(setting), case.tolerance) for of in (case.exact, case.ours))
            yield f"| {title} | {label(case, setting)} | {exact} | {ours} | {mujoco(name, i, measured)} |"


def source_of(case: Case) -> str:
    """Return the code of `ours` with all that it needs from its file, and lines that print its answers."""
    module = import_module(case.ours.__module__)
    text = Path(str(module.__file__)).read_text(encoding="utf-8")
    nodes = [node for node in ast.parse(text).body if not is_future(node)]
    needed, before = {case.ours.__name__}, set[str]()
    while needed != before:
        before = set(needed)
        for node in nodes:
            if names_of(node) & needed:
                needed |= {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
    parts = [str(ast.get_source_segment(text, node)) for node in nodes if names_of(node) & needed]
    imports = [line for node in nodes for line in import_lines(node, needed)]
    digits = -math.floor(math.log10(case.tolerance))
    prints = "\n".join(
        f"print(round({case.ours.__name__}({setting!r}), {digits}) + 0.0)  #> {round(case.ours(setting), digits) + 0.0!r}"
        for setting in case.settings
    )
    return "\n".join(imports) + "\n\n\n" + "\n\n\n".join(parts) + f"\n\n\n{prints}"


def is_future(node: ast.stmt) -> bool:
    """Tell whether a statement is `from __future__ import ...`."""
    return isinstance(node, ast.ImportFrom) and node.module == "__future__"


def names_of(node: ast.stmt) -> set[str]:
    """Return the names that a statement defines."""
    if isinstance(node, ast.FunctionDef):
        return {node.name}
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return {node.target.id}
    return set()


def import_lines(node: ast.stmt, needed: set[str]) -> list[str]:
    """Return an import with the needed names alone."""
    if not isinstance(node, ast.Import | ast.ImportFrom):
        return []
    kept = [one for one in node.names if (one.asname or one.name) in needed]
    if not kept:
        return []
    of = f"from {node.module} " if isinstance(node, ast.ImportFrom) else ""
    names = ", ".join(f"{one.name} as {one.asname}" if one.asname else one.name for one in kept)
    return [f"{of}import {names}"]


SERVICES = {
    "predict_contact_mode": "PredictContactMode",
    "predict_impact": "PredictImpact",
    "predict_tumbling": "PredictTumbling",
}


def section(name: str, case: Case) -> str:
    """Return the section of one case."""
    threads = ", ".join(f"[{address_text(address)}]({address})" for address in case.threads)
    request = case.request
    exact = shown(request.exact(case.settings[0]), request.tolerance)
    return f"""\
## {case.title}

{case.story} Asked in {threads}.

**Exact:** {case.quantity}: {case.formula}. The package's answer is within {case.tolerance:g} of it ({case.why_tolerance}).
`contact-dynamics cases {name}` asks it.

```python
{source_of(case)}
```

```sh
ros2 service call /contact_dynamics/{request.service} contact_dynamics_interfaces/srv/{SERVICES[request.service]} \\
  "{request.text(case.settings[0])}"
```

In the response, `{request.answer}` is {exact}.
"""


def published() -> str:
    """Return the section on published numbers."""
    compared = [(value, ours := value.ours(), value.verdict(ours)) for value in published_values()]
    counts = {verdict: sum(one[2] is verdict for one in compared) for verdict in PublishedVerdict}
    sources = dict.fromkeys(value.source for value, _, _ in compared)
    listed = "\n".join(
        f"- {source}: {sum(value.source == source for value, _, _ in compared)} numbers" for source in sources
    )
    rows = "\n".join(
        published_row(value, ours, verdict)
        for value, ours, verdict in compared
        if verdict is PublishedVerdict.EXPLAINED
    )
    return f"""\
## Numbers that others published

This command compares the package with printed numbers, and prints for each its source, what was printed, ours, the tolerance and the
verdict:

```sh
contact-dynamics cases --published
```

{listed}

{counts[PublishedVerdict.RIGHT]} are right within half of the last printed digit or, where they were derived, to rounding.
{counts[PublishedVerdict.WRONG]} are wrong. {counts[PublishedVerdict.EXPLAINED]} differ, because the printed number is off. The command says why:

```text
     published           ours  tolerance
{rows}
```

Each number stands in a data file of `contact_dynamics/cases/published_values/` with the place where it was read, or its derivation.
"""


def page() -> str:
    """Return the whole page."""
    measured = quotes.texts(quotes.read())
    lines = [HEAD + "\n".join(table(measured)) + "\n"]
    return "\n".join(lines + [section(name, case) for name, case in CASES.items()] + [published()])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
