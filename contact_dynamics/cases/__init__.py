"""Questions whose exact answers are known, because simulators got them wrong or because somebody published them.

`contact-dynamics cases` asks all of them and prints the exact answer, the package's own and MuJoCo's. Each
case is a file that is small enough to read: `creeping_capsule`, `tipping_cube` and so on. `case` says what a
case consists of, `peer` runs MuJoCo, `every_case` lists all, and `report` makes the table.
"""

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.every_case import CASES

__all__ = ["CASES", "Case", "Request"]


def __dir__() -> list[str]:
    return __all__
