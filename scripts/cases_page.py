# SPDX-License-Identifier: Apache-2.0
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
from contact_dynamics.cases.engine import OURS  # noqa: E402
from contact_dynamics.cases.published import PublishedVerdict, published_values  # noqa: E402
from contact_dynamics.cases.run import published_row, shown  # noqa: E402
from contact_dynamics.questions.services import SERVICES  # noqa: E402

PAGE = ROOT / "docs" / "cases.md"
HEAD = """\
# Cases with exact answers, compared with MuJoCo

Each case on this page is a problem with an exact solution in closed form, which users of physics engines have reported because an engine
returned another result. This command solves all of them with this package and, if it is installed, with MuJoCo:

```sh
contact-dynamics cases
```

`contact-dynamics cases NAME` solves one case, and `--list` prints the names.

Each row of the table is a case with one value of its parameter. The last three columns contain the value of the *quantity*: the exact
solution, and the results of this package and of MuJoCo. An empty cell has the content of the cell above it. μ is the friction coefficient, e the coefficient of restitution, and g the
acceleration of gravity.

{TABLE}
MuJoCo uses its default settings and time step, unless the code of the case sets others. In cases with a restitution, its contact is a spring
and damper designed for this restitution, with ten time steps in the impact. With smaller time steps and other settings, MuJoCo is more
accurate. [When to use a simulator](when-to-use-what.md) compares the two approaches.

The solutions are exact for rigid bodies with Coulomb friction. Check separately whether your system agrees with this model.
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
    yield "| case | parameter | quantity | exact | this package | MuJoCo |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for name, case in CASES.items():
        for i, setting in enumerate(case.settings):
            title, quantity = (
                (f"[{case.title}](#{anchor(case.title)})", case.quantity) if i == 0 else ("", "")
            )
            exact, ours = (
                shown(value, case.tolerance) for value in (case.exact(setting), OURS.answer(name, setting))
            )
            yield f"| {title} | {label(case, setting)} | {quantity} | {exact} | {ours} | {mujoco(name, i, measured)} |"


def source_of(name: str, case: Case) -> str:
    """Return the package's solution with all that it needs from its file, and lines that print its answers."""
    text = Path(str(import_module(OURS.module).__file__)).read_text(encoding="utf-8")
    nodes = ast.parse(text).body
    functions = {node.name: node for node in nodes if isinstance(node, ast.FunctionDef)}
    needed, before = {name}, set[str]()
    while needed != before:
        before = set(needed)
        for function in before & functions.keys():
            needed |= {one.id for one in ast.walk(functions[function]) if isinstance(one, ast.Name)}
    parts = [str(ast.get_source_segment(text, node)) for key, node in functions.items() if key in needed]
    imports = [line for node in nodes for line in import_lines(node, needed)]
    digits = -math.floor(math.log10(case.tolerance))
    prints = "\n".join(
        f"print(round({name}({setting!r}), {digits}) + 0.0)  #> {round(OURS.answer(name, setting), digits) + 0.0!r}"
        for setting in case.settings
    )
    return "\n".join(imports) + "\n\n\n" + "\n\n\n".join(parts) + f"\n\n\n{prints}"


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


TYPES = {each.name: each.type_name for each in SERVICES}


def section(name: str, case: Case) -> str:
    """Return the section of one case."""
    threads = ", ".join(f"[{address_text(address)}]({address})" for address in case.threads)
    service, path = case.answer.split(".", maxsplit=1)
    exact = shown(*case.answer_of(case.settings[0]))
    return f"""\
## {case.title}

{case.story} Discussed in {threads}.

**Exact solution** ({case.quantity}): {case.formula}. The package agrees within {case.tolerance:g}, in the same unit.
`contact-dynamics cases {name}` solves this case.

```python
{source_of(name, case)}
```

```sh
ros2 service call /contact_dynamics/{service} contact_dynamics_interfaces/srv/{TYPES[service]} \\
  "{case.request_text(case.settings[0])}"
```

In the response, `{path}` is {exact}, in SI units.
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
## Published numbers

This command compares the package with results in textbooks:

```sh
contact-dynamics cases --published
```

{listed}

{counts[PublishedVerdict.RIGHT]} agree: within half of the last digit of a published number, or within rounding error of a derived one. {counts[PublishedVerdict.WRONG]} disagree without an explanation. {counts[PublishedVerdict.EXPLAINED]} disagree because
the published number is inaccurate; the reason is printed below each:

```text
     published           ours  tolerance
{rows}
```

The files in `contact_dynamics/cases/published_values/` contain all numbers with their sources.
"""


def page() -> str:
    """Return the whole page."""
    measured = quotes.texts(quotes.read())
    lines = [HEAD.replace("{TABLE}", "\n".join(table(measured)) + "\n")]
    return "\n".join(lines + [section(name, case) for name, case in CASES.items()] + [published()])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
