# SPDX-License-Identifier: Apache-2.0
"""The documents' code passes mypy as a user's own would; a complaint names the document and the line."""

from __future__ import annotations

import ast
import importlib
import re
from dataclasses import MISSING, fields
from pathlib import Path

import numpy as np
import pytest
from mypy import api

from hostile_values import CALLS
from running_server import ROOT

PAGES = ("README.md", "docs/*.md", "docs/tutorials/*.md", "contact_dynamics_interfaces/README.md")
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)


def blocks() -> dict[str, str]:
    """Each block below as many empty lines as stand before it, by the document and that number."""
    found = {}
    for page in (page for pattern in PAGES for page in sorted(ROOT.glob(pattern))):
        text = page.read_text(encoding="utf-8")
        for block in BLOCK.finditer(text):
            before = text.count("\n", 0, block.start(1))
            found[f"{page.relative_to(ROOT)}:{before}"] = "\n" * before + block.group(1)
    return found


def complaints(sources: dict[str, str], folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """What mypy says of sources by document, with no settings but its own and the package's types."""
    for i, source in enumerate(sources.values()):
        (folder / f"block_{i}.py").write_text(source, encoding="utf-8")
    monkeypatch.chdir(folder)
    monkeypatch.setenv("MYPYPATH", str(ROOT))
    # What mypy thinks of installed packages is not the user's concern; from MYPYPATH it would say it.
    files = [f"block_{i}.py" for i in range(len(sources))]
    report, trouble, _ = api.run(["--config-file=", "--strict", "--follow-imports=silent", *files])
    assert not trouble
    pages = [name.split(":")[0] for name in sources]
    return re.sub(r"block_(\d+)\.py", lambda match: pages[int(match.group(1))], report)


def test_the_code_in_the_documents_has_no_type_errors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """But for that of a document which is made here, whose complaint names it and the line."""
    found = blocks()
    assert {name.split(":")[0] for name in found} >= {"README.md", "docs/tumbling.md", "docs/impact.md"}
    wrong = '\n\nfrom contact_dynamics import MassProperties\nMassProperties(mass="1", I_B=[[1]])\n'
    first, *others = complaints({**found, "docs/made.md:2": wrong}, tmp_path, monkeypatch).splitlines()
    assert first.startswith(
        'docs/made.md:4: error: Argument "mass" to "MassProperties" has incompatible type'
    )
    assert not [line for line in others if "error: " in line]


def typed_constructors() -> list[tuple[str, str, list[str]]]:
    """Constructors that are written for type checkers: module, class, arguments, with `?` for a default."""
    found = []
    for path in sorted((ROOT / "contact_dynamics").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for owner in (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)):
            for block in (node for node in owner.body if isinstance(node, ast.If)):
                (init,) = (node for node in block.body if isinstance(node, ast.FunctionDef))
                if init.name != "__init__":
                    continue
                pairs = zip(init.args.kwonlyargs, init.args.kw_defaults, strict=True)
                arguments = [f"{one.arg}{'' if default is None else '?'}" for one, default in pairs]
                module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
                found.append((module, owner.name, arguments))
    return found


def test_what_type_checkers_see_of_a_constructor_is_what_it_takes() -> None:
    for module, name, arguments in typed_constructors():
        taken = []
        for one in fields(getattr(importlib.import_module(module), name)):
            if one.init:
                optional = one.default is not MISSING or one.default_factory is not MISSING
                taken.append(f"{one.name}{'?' if optional else ''}")
        assert sorted(arguments) == sorted(taken), name


def test_what_is_typed_as_array_like_may_be_a_list() -> None:
    for module, name, arguments in typed_constructors():
        given = {
            field: value.tolist() if isinstance(value, np.ndarray) else value
            for field, value in CALLS[name][1].items()
        }
        assert set(given) <= {argument.removesuffix("?") for argument in arguments}, name
        made = getattr(importlib.import_module(module), name)(**given)
        for field, value in given.items():
            array = getattr(made, field)
            if isinstance(value, list) and isinstance(array, np.ndarray):
                assert array.dtype == np.float64, (name, field)
                assert not array.flags.writeable, (name, field)
                np.testing.assert_array_equal(array, np.broadcast_to(value, array.shape))
