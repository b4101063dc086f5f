# SPDX-License-Identifier: Apache-2.0
"""Count the product's lines by room: all, those of code, and statements.

Lines of code are those left without docstrings, blank lines, comments and imports. A room is a folder of the
package, or a single file; ``.pxd`` files count too. Run it as ``python -m benchmarks.lines``.
"""

from __future__ import annotations

import argparse
import ast
import io
import tokenize
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LAYOUT = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}


def counted(path: Path) -> tuple[int, int, int]:
    """Return how many lines, lines of code and statements a file has."""
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    if path.suffix == ".pxd":
        code = [
            line for line in lines if line.strip() and not line.lstrip().startswith(("#", "cimport", "from "))
        ]
        return len(lines), len(code), len(code)
    tree = ast.parse(text)
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    outside: set[int] = set()
    statements = 0
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            outside.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        elif (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            # Docstrings, also those that stand below a name.
            outside.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        elif isinstance(node, ast.stmt) and not isinstance(node, documented):
            statements += 1
    used: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in LAYOUT:
            used.update(range(token.start[0], token.end[0] + 1))
    return len(lines), len(used - outside), statements


def rooms() -> dict[str, list[Path]]:
    """Return the files of each room."""
    found: dict[str, list[Path]] = defaultdict(list)
    for package in ("contact_dynamics", "msg_adapters"):
        for path in sorted((ROOT / package).rglob("*.p*")):
            if path.suffix in {".py", ".pxd"}:
                inside = path.relative_to(ROOT).parts
                found["/".join(inside[:2]) if package == "contact_dynamics" else package].append(path)
    return found


def main() -> None:
    """Print a row for each room, the largest first."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.parse_args()
    rows = []
    for name, paths in rooms().items():
        counts = [counted(path) for path in paths]
        rows.append((name, len(paths), *(sum(column) for column in zip(*counts, strict=True))))
    rows.sort(key=lambda row: -row[2])
    rows.append(("together", *(sum(row[k] for row in rows) for k in range(1, 5))))
    print(f"{'room':40} {'files':>6} {'lines':>7} {'code':>7} {'statements':>10}")
    for name, files, lines, code, statements in rows:
        print(f"{name:40} {files:6} {lines:7} {code:7} {statements:10}")


if __name__ == "__main__":
    main()
