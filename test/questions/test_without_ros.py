# SPDX-License-Identifier: Apache-2.0
"""The questions are asked where there is no ROS at all, and the answers are the same numbers."""

from __future__ import annotations

import json
import os
import subprocess
import sys

from architecture.test_chapters import ROOT
from architecture.test_layers import ROS
from questions.known_world import ask_each


def test_each_question_is_asked_without_ros() -> None:
    blocked = "".join(f"sys.modules[{name!r}] = None\n" for name in sorted(ROS))
    ask = "from questions.known_world import ask_each\nsys.stdout.write(json.dumps(ask_each()))\n"
    code = f"import json, sys\n{blocked}{ask}"
    path = os.pathsep.join([str(ROOT), str(ROOT / "test")])
    result = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout) == json.loads(json.dumps(ask_each()))
