# SPDX-License-Identifier: Apache-2.0
"""Questions with known exact answers, which simulators got wrong or which somebody published.

`contact-dynamics cases` solves all of them and prints the exact answer, the package's own and MuJoCo's.
`catalog` has the cases as data, `ours` and `mujoco` the answers of each engine, `run` prints the table, and
`published` compares with numbers that others published.
"""

from contact_dynamics.cases.catalog import CASES, Case

__all__ = ["CASES", "Case"]


def __dir__() -> list[str]:
    return __all__
