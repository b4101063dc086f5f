# SPDX-License-Identifier: Apache-2.0
"""docs/limits.md and the constants of the code agree, and each row of docs/certainty.md has its test."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROW = re.compile(r"^\| [^|]+ \| ([^|]+) \| `([\w.]+)\.([A-Z_]+)` \| [^|]+ \|$", re.MULTILINE)
ROWS = ROW.findall((ROOT / "docs" / "limits.md").read_text(encoding="utf-8"))
DECLARED = re.compile(r"^((?:MAX|LARGEST)_[A-Z_]+): Final = ", re.MULTILINE)
CHAPTERS = (
    "contact",
    "contact_modes",
    "impact",
    "landing",
    "motion",
    "questions",
    "shapes",
    "toss",
    "tumbling",
)

NOT_REFUSED = {
    # They bound work after which a result says that it is not complete or not converged, or choose a way.
    "contact_modes.planar.uncertain.MAX_PROGRAMS",
    "contact_modes.spatial.completeness.MAX_PROGRAMS",
    "contact_modes.spatial.uncertain.MAX_PROGRAMS",
    "contact_modes.spatial.margins.MAX_CORNERS",
    "impact.in_time.sequence.MAX_STRIKES",
    "impact.in_time.sequence.MAX_HELD",
    "impact.several.interleavings.MAX_INCREMENTS",
    "impact.several.orders.MAX_ORDERS",
    "impact.several.sequential.MAX_STRIKES",
    "impact.several.jamming.MAX_JAMS",
    "impact.several.simultaneous.MAX_SWEEPS",
    "impact.spatial.path.MAX_STRETCHES",
    "impact.spatial.path.MAX_ITERATIONS",
    "motion.whole_turns.MAX_NOISE_RATIO",
    "motion.whole_turns.MAX_ORIENTATION_RESIDUAL",
    "questions.effort.MAX_QUICK_CANDIDATES",
    "questions.effort.MAX_QUICK_CONTACTS",
    "questions.effort.MAX_QUICK_CORNERS",
    "questions.effort.MAX_QUICK_FITTED",
    "questions.effort.MAX_QUICK_IMPACTS",
    "questions.effort.MAX_QUICK_TURNS",
    "questions.settled_impact.MAX_CONTACTS_IN_ORDERS",
    "questions.state_store.MAX_STATES",
    "toss.cone_forces.MAX_SWEEPS",
    "toss.laid_flat.MAX_CORNERS",
    "toss.law_spread.MAX_TURNED_BACK",
    "toss.phase.LARGEST_STEP",
    "toss.phase.MAX_PHASE_STEPS",
    "toss.sampled.MAX_GHOSTS",
    "toss.strike.MAX_STRIKES_AT_ONCE",
    "toss.next_strikes.MAX_FURTHER",
    "tumbling.attitude_form.MAX_TERMS",
}


def test_the_table_has_the_numbers_of_the_code() -> None:
    stated = {f"{module}.{name}": float(limit.split(maxsplit=1)[0]) for limit, module, name in ROWS}
    modules = {module: importlib.import_module(f"contact_dynamics.{module}") for _, module, _ in ROWS}
    assert stated == {f"{module}.{name}": getattr(modules[module], name) for _, module, name in ROWS}


def test_every_limit_of_the_code_is_in_the_table() -> None:
    listed = {f"{module}.{name}" for _, module, name in ROWS}
    assert len(listed) == len(ROWS) > 30
    package = ROOT / "contact_dynamics"
    files = [package / "tolerances.py", *(file for one in CHAPTERS for file in (package / one).rglob("*.py"))]
    declared = {
        f"{'.'.join(path.relative_to(package).with_suffix('').parts)}.{name}"
        for path in files
        for name in DECLARED.findall(path.read_text(encoding="utf-8"))
    }
    assert declared - listed - NOT_REFUSED == set()
    assert listed - declared == set()
    assert NOT_REFUSED - declared == set()


CERTAIN = re.compile(r"^\| .+ \| .+ \| `([\w/]+\.py)::(\w+)` \|$", re.MULTILINE)


def test_each_statement_of_the_page_on_certainty_has_its_test() -> None:
    page = (ROOT / "docs" / "certainty.md").read_text(encoding="utf-8")
    rows = CERTAIN.findall(page)
    stated = re.findall(r"^\| (?!statement|---)", page, re.MULTILINE)
    assert len(rows) == len(stated) > 20
    for path, name in rows:
        assert f"def {name}(" in (ROOT / "test" / path).read_text(encoding="utf-8"), f"{path}::{name}"
