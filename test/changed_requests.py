# SPDX-License-Identifier: Apache-2.0
"""Changes of one field of a request, for tests that put a wrong value into each."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def put(path: str, value: Any) -> Callable[[Any], None]:
    """Return a function that sets a field of a request. The field is given as a dotted path."""

    def change(request: Any) -> None:
        *parents, name = path.split(".")
        for parent in parents:
            request = getattr(request, parent)
        setattr(request, name, value)

    return change
