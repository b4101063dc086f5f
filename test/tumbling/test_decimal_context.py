# SPDX-License-Identifier: Apache-2.0
"""The caller's decimal context, or the default one, plays no part in a motion."""

from __future__ import annotations

import decimal
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from contact_dynamics import BodyState, MassProperties, free_motion
from contact_dynamics.rigid_body.inertia.axes_of_inertia import _of_bytes, in_doubles
from contact_dynamics.tumbling.flips import next_flips
from contact_dynamics.tumbling.motion import constants_of
from contact_dynamics.tumbling.poinsot_construction import poinsot, polhode

BODY = MassProperties(mass=1.0, I_B=[[0.1, 0.01, 0.0], [0.01, 0.2, 0.02], [0.0, 0.02, 0.25]])
ALL_SIGNALS = list(decimal.DefaultContext.traps)  # of a context that stays: Python 3.14 forgets them with it


@pytest.fixture(autouse=True)
def _nothing_remembered() -> Iterator[None]:
    """Motions that were computed before, in another context, would hide the fault."""
    yield
    forget()


def forget() -> None:
    for function in (constants_of, _of_bytes, in_doubles):
        function.cache_clear()


def numbers() -> list[float]:
    """Attitudes, flips and curves, to the last bit: about the middle axis and about the first."""
    forget()
    found: list[float] = []
    for rate in ([1.0, 30.0, 0.1], [1e3, 2.0, 3.0]):
        state = BodyState(p_WB_W=np.zeros(3), q_WB=np.full(4, 0.5), w_WB_W=np.array(rate))
        motion = free_motion(BODY, state)
        trajectory = motion.at([0.0, 1e9, 1e12])
        found += [*trajectory.q_WB.ravel(), *trajectory.w_WB_W.ravel(), *polhode(motion, 5).ravel()]
        found += [*next_flips(motion, count=3).seconds, float(motion.regime), poinsot(motion).sensitivity]
    return found


@pytest.mark.parametrize(
    "context",
    [
        decimal.Context(prec=1),
        decimal.Context(prec=5, rounding=decimal.ROUND_UP),
        decimal.Context(Emax=3, Emin=-3, clamp=1),
        decimal.Context(traps=[decimal.Inexact, decimal.Rounded]),
        decimal.Context(traps=[decimal.FloatOperation]),
        decimal.Context(traps=ALL_SIGNALS),
    ],
    ids=str,
)
def test_a_callers_context_changes_nothing(context: decimal.Context) -> None:
    expected = numbers()
    with decimal.localcontext(context):
        assert numbers() == expected


def test_a_changed_default_context_changes_nothing() -> None:
    """Contexts that are made at import take what they do not say from the default one."""
    program = (
        "import decimal\n"
        "default = decimal.DefaultContext\n"
        "default.prec, default.rounding, default.Emax = 4, decimal.ROUND_UP, 5\n"
        "for signal in default.traps: default.traps[signal] = True\n"
        "decimal.setcontext(default)\n"
        "from contact_dynamics.numerics.arithmetic import DECIMALS\n"
        "import numpy as np\n"
        "from contact_dynamics import BodyState, MassProperties, free_motion\n"
        "body = MassProperties(mass=1.0, I_B=np.diag([0.1, 0.2, 0.25]) + 0.01 * np.ones((3, 3)))\n"
        "state = BodyState(p_WB_W=np.zeros(3), q_WB=np.full(4, 0.5), v_WB_W=np.zeros(3),"
        " w_WB_W=np.array([1.0, 30.0, 0.1]))\n"
        "print(free_motion(body, state).state_at(1e9).q_WB.tolist())\n"
    )
    lines = program.splitlines(keepends=True)
    answers = [
        subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True).stdout
        for text in (program, "".join(lines[5:]))
    ]
    assert answers[0] == answers[1] != ""
