# SPDX-License-Identifier: Apache-2.0
"""An extension of griffe, which reads the docstrings for the site: chapters are described by their purpose.

The first paragraph of a chapter says what it is for. Some chapters then list their functions by purpose, up
to the paragraph about internal modules. That paragraph, and all others, concern those who change the files.
"""

from typing import Any, Final

from griffe import Extension, Module

INTERNAL: Final = "\n\nThe modules of this package are internal."


class PurposeAlone(Extension):
    """Keeps the part of the docstring of each module that concerns users."""

    def on_module(self, *, mod: Module, **_: Any) -> None:
        """Shorten a module's docstring."""
        if mod.docstring is not None:
            text = mod.docstring.value
            mod.docstring.value = text.partition(INTERNAL if INTERNAL in text else "\n\n")[0]
