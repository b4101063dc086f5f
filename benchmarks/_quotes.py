# SPDX-License-Identifier: Apache-2.0
"""The numbers that documents quote: `measured.json` has them, and documents have them between two marks.

A benchmark offers its numbers (`quote`), rounded to a few digits. `python -m benchmarks --write` puts them
into the file, with the command, the day, the machine and the versions, and from there into the documents:
    takes <!--bench:impact.space-->0.13 ms<!--/-->, of which ...

A browser does not show the marks. A test checks that documents and file agree.
"""

from __future__ import annotations

import datetime as dt
import json
import os
import platform
import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).parents[1]
FILE: Final = Path(__file__).parent / "measured.json"
DOCUMENTS: Final = ("README.md", "docs/*.md", "contact_dynamics_interfaces/README.md")
MARKED: Final = re.compile(r"<!--bench:([^>]*?)-->(.*?)<!--/-->")
VERSIONS: Final = ("numpy", "scipy", "mcap", "mujoco", "drake")
MACHINE: Final = "machine"
"""The mark of the machine, or of the machines, that all numbers of the file were measured on."""

_offered: dict[str, dict[str, Any]] = {}


def quote(name: str, value: float | Sequence[float], unit: str = "", *, digits: int = 2) -> None:
    """Offer a number to the documents. Its name begins with that of the benchmark.

    Args:
        name: The name in a document's mark, such as `impact.space`.
        value: The number, or several, of which documents have the least and the largest.
        unit: The unit as it is written after the number.
        digits: The number of digits to write.
    """
    several = list(value) if isinstance(value, Sequence) else [value]
    rounded = [float(f"{x:.{digits - 1}e}") for x in (min(several), max(several))]
    _offered[name] = {"value": rounded[0] if rounded[0] == rounded[1] else rounded, "unit": unit}


def offered(benchmark: str) -> dict[str, dict[str, Any]]:
    """Return what a benchmark has offered so far, by name."""
    return {name: number for name, number in _offered.items() if name.split(".")[0] == benchmark}


def text_of(number: Mapping[str, Any]) -> str:
    """Return a number as documents write it: `0.13 ms`, `2 to 15 ms`, `0.2°`, `5e-17 rad`."""
    value, unit = number["value"], number["unit"]
    written = " to ".join(f"{x:g}" for x in (value if isinstance(value, list) else [value]))
    return f"{written}{'' if unit in {'', '°'} else ' '}{unit}"


def read() -> dict[str, Any]:
    """Return the file's content, by benchmark."""
    content: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8")) if FILE.is_file() else {}
    return content


def texts(measured: Mapping[str, Any]) -> dict[str, str]:
    """Return what documents write, by name."""
    found = {name: text_of(number) for one in measured.values() for name, number in one["numbers"].items()}
    machines = sorted({str(one["machine"]) for one in measured.values()})
    return {**found, MACHINE: " and ".join(machines)}


def documents() -> list[Path]:
    """Return the documents that may quote numbers."""
    return [path for pattern in DOCUMENTS for path in sorted(ROOT.glob(pattern))]


def quoted(benchmark: str) -> set[str]:
    """Return the names of a benchmark's numbers that documents quote."""
    names = {match[1] for path in documents() for match in MARKED.finditer(path.read_text(encoding="utf-8"))}
    return {name for name in names if name.split(".")[0] == benchmark}


def rewritten(document: str, written: Mapping[str, str]) -> str:
    """Return a document with the ``written`` numbers between its marks. Unknown names stay as they are."""
    return MARKED.sub(
        lambda match: f"<!--bench:{match[1]}-->{written.get(match[1], match[2])}<!--/-->", document
    )


def write_documents() -> None:
    """Write the file's numbers into the documents."""
    written = texts(read())
    for path in documents():
        before = path.read_text(encoding="utf-8")
        after = rewritten(before, written)
        if after != before:
            path.write_text(after, encoding="utf-8")
            print(f"wrote {path.relative_to(ROOT)}")


def write(benchmark: str) -> set[str]:
    """Write what a benchmark has offered into the file. Return the names that documents quote and it lacks.

    If any is lacking, nothing is written. A peer may not be installed, or recordings may be missing.
    """
    numbers = offered(benchmark)
    lacking = quoted(benchmark) - set(numbers)
    if lacking or not numbers:
        return lacking
    measured = read()
    measured[benchmark] = {
        "command": f"python -m benchmarks {benchmark}",
        "date": dt.datetime.now(tz=dt.timezone.utc).date().isoformat(),
        "machine": _machine(),
        "versions": {"python": platform.python_version(), **_versions()},
        "numbers": dict(sorted(numbers.items())),
    }
    text = json.dumps(dict(sorted(measured.items())), indent=2, ensure_ascii=False)
    # A number a line, so that a change of it is one.
    lines = re.sub(r'\{\s+"value": (.*?),\s+"unit": (".*?")\s+\}', _on_one_line, text, flags=re.DOTALL)
    FILE.write_text(lines + "\n", encoding="utf-8")
    return set()


def _on_one_line(match: re.Match[str]) -> str:
    return f'{{"value": {" ".join(match[1].split())}, "unit": {match[2]}}}'


def print_beside(benchmark: str) -> None:
    """Print what documents quote of a benchmark, and what it has just found."""
    written, now = texts(read()), offered(benchmark)
    names = sorted(quoted(benchmark))
    if names:
        print(f"\n{'quoted in the documents':48} {'there':>20} {'now':>20}")
    for name in names:
        found = text_of(now[name]) if name in now else "not measured"
        print(f"{name:48} {written.get(name, 'not known'):>20} {found:>20}")


def _versions() -> dict[str, str]:
    """Return the versions of those packages in `VERSIONS` that are installed."""
    installed = {(one.metadata["Name"] or "").lower(): one.version for one in metadata.distributions()}
    return {name: installed[name] for name in VERSIONS if name in installed}


@cache  # the clock is not told the same each time
def _machine() -> str:
    """Return the class of the machine: architecture, cores, clock as far as the kernel tells it."""
    try:
        cpus = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        cpus = ""
    speeds = re.findall(r"^cpu MHz\s*: ([\d.]+)", cpus, re.MULTILINE)
    clock = f" at {max(map(float, speeds)) / 1000:.1f} GHz" if speeds else ""
    return f"{os.cpu_count()} cores{clock} ({platform.machine()})"
