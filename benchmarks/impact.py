# SPDX-License-Identifier: Apache-2.0
"""The cost of an impact (`_impact_costs`), and how well it predicts measured ones (`_impact_tosses`)."""

from __future__ import annotations

from benchmarks import _impact_costs, _impact_tosses


def run() -> None:
    """Print costs, then errors over measured tosses if the recordings are there."""
    _impact_costs.run()
    print()
    _impact_tosses.run()
