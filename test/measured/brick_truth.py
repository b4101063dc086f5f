# SPDX-License-Identifier: Apache-2.0
"""What the engine computed for the recorded toss, without noise, as `record_toss.py --truth` wrote it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

PATH = Path(__file__).parent / "reference" / "brick_truth.csv"


class Strike(NamedTuple):
    begin: float  # s
    end: float  # s
    most_contacts: int


class Truth(NamedTuple):
    table: np.ndarray
    strikes: list[Strike]

    @property
    def times(self) -> np.ndarray:
        return self.table[:, 0]

    @property
    def p_WB_W(self) -> np.ndarray:
        return self.table[:, 1:4]

    @property
    def q_WB(self) -> np.ndarray:
        return self.table[:, 4:8]

    @property
    def v_WB_W(self) -> np.ndarray:
        return self.table[:, 8:11]

    @property
    def w_WB_W(self) -> np.ndarray:
        return self.table[:, 11:14]


def read_truth() -> Truth:
    lines = PATH.read_text(encoding="utf-8").splitlines()
    words = [line.split()[2:] for line in lines if line.startswith("# strike:")]
    strikes = [Strike(float(begin), float(end), int(most)) for begin, end, most in words]
    rows = [line for line in lines if not line.startswith("#")][1:]
    return Truth(np.array([[float(x) for x in row.split(",")] for row in rows]), strikes)


TRUTH = read_truth()
