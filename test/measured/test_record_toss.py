# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import importlib.util
import platform
from pathlib import Path
from types import ModuleType

import pytest

from contact_dynamics.measured.read_toss import DEFAULT_RECORDING, read_toss
from measured.brick_truth import PATH as TRUTH_PATH

ROOT = Path(__file__).parents[2]

mujoco = pytest.importorskip(
    "mujoco", reason="MuJoCo, which makes the recording, is not installed: `pip install mujoco`"
)


def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("record_toss", ROOT / "scripts" / "record_toss.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_writing_what_was_read_gives_the_same_numbers(tmp_path: Path) -> None:
    script().write_toss_csv(tmp_path / "again.csv", read_toss())
    original = DEFAULT_RECORDING.read_text(encoding="utf-8").splitlines()
    again = (tmp_path / "again.csv").read_text(encoding="utf-8").splitlines()
    header = original.index(again[0])
    assert again == original[header:]


def test_the_script_makes_the_committed_recording_bit_for_bit(tmp_path: Path) -> None:
    recorded_by = f'"MuJoCo {mujoco.__version__} '
    if recorded_by not in DEFAULT_RECORDING.read_text(encoding="utf-8"):
        pytest.skip(f"the recording was made by another MuJoCo than the installed {mujoco.__version__}")
    if platform.machine() != "x86_64":
        pytest.skip(f"the recording was made on x86_64; the last bits may differ on {platform.machine()}")
    assert (
        script().main(["--output", str(tmp_path / "brick.csv"), "--truth", str(tmp_path / "truth.csv")]) == 0
    )
    assert (tmp_path / "brick.csv").read_bytes() == DEFAULT_RECORDING.read_bytes()
    assert (tmp_path / "truth.csv").read_bytes() == TRUTH_PATH.read_bytes()
