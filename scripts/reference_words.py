# SPDX-License-Identifier: Apache-2.0
"""An extension of griffe, which reads the docstrings for the site: chapters are described by their purpose.

The first paragraph of a chapter says what it is for. The others say what is in which of its files, which
concerns those who change them.
"""

from typing import Any

from griffe import Extension, Module


class PurposeAlone(Extension):
    """Keeps the first paragraph of the docstring of each module."""

    def on_module(self, *, mod: Module, **_: Any) -> None:
        """Shorten a module's docstring."""
        if mod.docstring is not None:
            mod.docstring.value = mod.docstring.value.partition("\n\n")[0]
