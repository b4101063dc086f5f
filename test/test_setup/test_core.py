# SPDX-License-Identifier: Apache-2.0
"""The compiled core gives the same bits as the Python that it comes from, and an outdated one is not used.

Numbers are compared as they are, since both round each operation alike. So fused multiply-adds, which round
once where Python rounds twice, must stay off even where the compiler is told to use the processor's own.
"""

from __future__ import annotations

import ast
import importlib
import os
import re
import shutil
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.planar import routh
from contact_dynamics.impact.spatial import path, response
from contact_dynamics.numerics.compiled import import_core
from impact.spatial.test_to_rounding import SLENDER, beside_an_invariant_direction, drawn

ROOT = Path(__file__).parents[2]
NAME = "contact_dynamics"
IMPACT = ROOT / NAME / "impact"
SOURCE = IMPACT / "spatial" / "path.py"
COUNT = 300
SOURCES = sorted(types.with_suffix(".py") for types in (ROOT / NAME).rglob("*.pxd"))
SUFFIX = EXTENSION_SUFFIXES[0]


def loaded(file: Path) -> ModuleType:
    """Return the module of a file, beside the one that is imported."""
    spec = spec_from_file_location(file.name.partition(".")[0], file)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def bits(module: ModuleType) -> list[object]:
    """Return what a module finds on drawn paths."""
    rng = np.random.default_rng(3)
    found: list[object] = []
    for law in RestitutionLaw:
        for i in range(COUNT):
            sliding, u, v_n, e = drawn(rng, list(SLENDER.values())[i % 3])
            if i % 5 == 0:
                u = beside_an_invariant_direction(rng, sliding, float(np.hypot(*u)))
            elif i % 5 == 1:
                v_n = 0.0
            elif i % 5 == 2 and i % 2:
                u = (0.0, 0.0)
            numbers = [getattr(sliding, name) for name in ("l1", "l2", "k1", "k2", "kn", "mu")]
            found.append(module.trace(module.SlidingLaw(*numbers), u, v_n, restitution=e, law=law))
    return found


def test_the_suite_runs_with_the_compiled_core() -> None:
    assert all((module.__file__ or "").endswith(SUFFIX) for module in (path, response, routh))


def test_compiled_and_plain_give_the_same_bits() -> None:
    """Of all kinds of paths. Whole impacts and tosses are in test_compiled_core."""
    plain = loaded(SOURCE)
    assert (plain.__file__ or "").endswith(".py")
    assert bits(plain) == bits(path)


@pytest.mark.slow  # half a minute of compilation
@pytest.mark.skipif(
    " fma " not in Path("/proc/cpuinfo").read_text(encoding="utf-8"), reason="the processor fuses nothing"
)
def test_a_build_for_a_processor_that_fuses_gives_the_same_bits(tmp_path: Path) -> None:
    sources = tmp_path / "sources"  # of impacts, since all modules have the same flags
    shutil.copytree(IMPACT, sources / IMPACT.relative_to(ROOT), ignore=shutil.ignore_patterns(f"*{SUFFIX}"))
    for name in ("contact_dynamics/numerics", "requirements"):
        shutil.copytree(ROOT / name, sources / name)
    for name in ("README.md", "package.xml", "setup.py", f"{NAME}/__init__.py"):
        shutil.copy(ROOT / name, sources / name)
    command = [sys.executable, "setup.py", "-q", "build_ext", "-b", tmp_path / "lib", "-t", tmp_path / "temp"]
    subprocess.run(
        command, cwd=sources, env={**os.environ, "CFLAGS": "-O3 -mfma"}, capture_output=True, check=True
    )
    (built,) = (tmp_path / "lib").rglob(f"path{SUFFIX}")
    assert bits(loaded(built)) == bits(path)
    fused = tmp_path / "fused"
    shutil.copytree(ROOT / NAME, fused / NAME, copy_function=os.symlink)
    for each in (tmp_path / "lib").rglob(f"*{SUFFIX}"):
        (fused / each.relative_to(tmp_path / "lib")).unlink()
        shutil.copy(each, fused / each.relative_to(tmp_path / "lib"))
    script = ROOT / "test" / "test_compiled_core.py"
    whole = [sys.executable, "-W", "error::RuntimeWarning", script]  # of a core that is not used
    ours, theirs = (
        subprocess.run(whole, env={**os.environ, "PYTHONPATH": str(folder)}, capture_output=True, check=True)
        for folder in (ROOT, fused)
    )
    assert ours.stdout == theirs.stdout


def test_lists_in_python_are_as_long_as_arrays_in_c() -> None:
    types = SOURCE.with_suffix(".pxd").read_text(encoding="utf-8")
    lengths = {int(length) for length in re.findall(r"double\[(\d+)\]", types)}
    assert lengths == {int(length) for length in re.findall(r"\[0\.0\] \* (\d+)", SOURCE.read_text("utf-8"))}
    plain = loaded(SOURCE)
    assert lengths == {plain.ORDER + 1, plain.ORDER + 2, plain.TERMS + 1, plain.SLOW_TERMS + 1}


@pytest.mark.parametrize("source", SOURCES, ids=lambda each: each.stem)
def test_no_index_is_counted_from_the_end(source: Path) -> None:
    """In compiled code such an index reads what is before the first element, or fails, as Pythons differ."""
    tree = ast.parse(source.read_text(encoding="utf-8"))
    indices = [each for each in ast.walk(tree) if isinstance(each, ast.Subscript)]
    signs = [sign for each in indices for sign in ast.walk(each.slice) if isinstance(sign, ast.UnaryOp)]
    assert [ast.unparse(sign) for sign in signs if isinstance(sign.op, ast.USub)] == []


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of its own with a copy of the core's sources, `copied_core.path`."""
    folder = tmp_path / "copied_core"
    folder.mkdir()
    (folder / "__init__.py").touch()
    for suffix in (".py", ".pxd"):
        shutil.copy(SOURCE.with_suffix(suffix), folder)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delenv("CONTACT_DYNAMICS_PLAIN", raising=False)
    for name in ("copied_core", "copied_core.path"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    importlib.import_module("copied_core")
    return folder


def imported() -> str:
    """Import the copy, and return its file's name."""
    import_core("copied_core.path")
    module = importlib.import_module("copied_core.path")
    assert sys.modules["copied_core"].path is module  # type: ignore[attr-defined]
    return Path(module.__file__ or "").name


def test_a_core_of_these_sources_is_used(package: Path) -> None:
    shutil.copy(path.__file__ or "", package)
    assert imported() == f"path{SUFFIX}"


def test_a_core_of_other_sources_is_not_used(package: Path) -> None:
    shutil.copy(path.__file__ or "", package)
    with (package / "path.py").open("a", encoding="utf-8") as source:
        source.write("# edited\n")
    with pytest.warns(RuntimeWarning, match="was built from other sources; copied_core.path runs as plain"):
        assert imported() == "path.py"


def test_a_core_that_cannot_be_imported_is_not_used(package: Path) -> None:
    (package / f"path{SUFFIX}").write_bytes(b"no library")
    with pytest.warns(RuntimeWarning, match="cannot be imported"):
        assert imported() == "path.py"


@pytest.mark.usefixtures("package")
def test_without_a_core_a_warning_says_how_much_slower_it_is() -> None:
    with pytest.warns(RuntimeWarning, match="is missing; .* 5 to 20 times as long, .* 20 to 60 times"):
        assert imported() == "path.py"


def test_plain_python_can_be_chosen(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copy(path.__file__ or "", package)
    monkeypatch.setenv("CONTACT_DYNAMICS_PLAIN", "1")
    assert imported() == "path.py"


TOSS = """
import contact_dynamics as cd
from contact_dynamics.toss import toss

side = dict(p_WS_W=[0, 0, 0], friction=0.5, restitution=0.3)
sides = [cd.Surface(name=str(x), normal_W=[x, 0, 0.8], **side) for x in (-0.6, 0.6)]
state = cd.BodyState(p_WB_W=[0, 0, 0.6], q_WB=[0.36, 0.48, 0, 0.8], w_WB_W=[1, 2, 3])
went = toss(cd.Body.box((0.2, 0.2, 0.1), 1.0), state, cd.World(surfaces=sides))
print(went.end.name, went.seconds.hex(), went.at([0.5 * went.seconds]).p_WB_W.tolist())
"""


@pytest.mark.parametrize("edited", ["toss/phase.py", "impact/spatial/path.py"])
def test_a_core_of_which_one_module_is_outdated_gives_the_same_tosses_and_warns_once(
    tmp_path: Path, edited: str
) -> None:
    """Plain modules kept the compiled ones that they had imported, and tosses ended in TypeError."""
    shutil.copytree(ROOT / NAME, tmp_path / NAME, copy_function=os.symlink)
    source = tmp_path / NAME / edited
    text = source.read_text(encoding="utf-8")
    source.unlink()
    source.write_text(f"{text}# edited\n", encoding="utf-8")
    environment = {key: value for key, value in os.environ.items() if key != "CONTACT_DYNAMICS_PLAIN"}
    whole, partly = (
        subprocess.run(
            [sys.executable, "-W", "always", "-c", TOSS],
            env={**environment, "PYTHONPATH": str(folder)},
            cwd=folder,
            capture_output=True,
            text=True,
            check=True,
        )
        for folder in (ROOT, tmp_path)
    )
    assert whole.stdout == partly.stdout != ""
    assert (whole.stderr.count("RuntimeWarning"), partly.stderr.count("RuntimeWarning")) == (0, 1)
    assert "was built from other sources" in partly.stderr
