# SPDX-License-Identifier: Apache-2.0
"""Compares a message with words of it."""

import re


def says(message: str, words: str) -> bool:
    """Return whether a message contains words, in which "..." is any text."""
    return re.search(".*".join(map(re.escape, words.split("..."))), message, re.DOTALL) is not None
