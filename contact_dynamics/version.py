# SPDX-License-Identifier: Apache-2.0
"""The version of this package. Only package.xml has the number.

A source tree has that file beside the package. An installed package has the number in its metadata, which
setup.py takes from the same file.
"""

from __future__ import annotations

import re
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_NAME = "contact_dynamics"


def version_of_this_package() -> str:
    """Return the version, such as "0.1.0". Without a package.xml or metadata, raise `AttributeError`."""
    manifest = Path(__file__).parents[1] / "package.xml"
    if manifest.is_file():
        text = manifest.read_text(encoding="utf-8")
        found = re.search(rf"<name>{_NAME}</name>\s*<version>([^<]+)</version>", text)
        if found:
            return found[1]
    try:
        return version(_NAME)
    except PackageNotFoundError:
        message = f"__version__ requires an installed package, or a package.xml beside {_NAME}"
        raise AttributeError(message) from None
