# SPDX-License-Identifier: Apache-2.0
"""What MuJoCo answers where the exact answer is known: the numbers of docs/cases.md."""

from __future__ import annotations

from benchmarks._quotes import quote
from contact_dynamics.cases import CASES
from contact_dynamics.cases.engine import MUJOCO
from contact_dynamics.cases.run import main

DIGITS = 3


def run() -> None:
    """Print the table of `contact-dynamics cases`, and offer MuJoCo's numbers."""
    main([])
    if not MUJOCO.version:
        return
    for name, case in CASES.items():
        for i, setting in enumerate(case.settings):
            answer = MUJOCO.answer(name, setting)
            # What is below a billionth is the rounding of zero.
            quote(f"cases.{name}.{i}", answer if abs(answer) > 1e-9 else 0.0, digits=DIGITS)
