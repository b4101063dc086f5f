# SPDX-License-Identifier: Apache-2.0
"""The sentences about answers."""

from __future__ import annotations

import pytest

from contact_dynamics.viewing.words import sentence


@pytest.mark.parametrize(
    ("seconds", "told"), [(1.234e-4, "0.12 ms"), (0.00563, "5.6 ms"), (0.0921, "92 ms"), (0.1114, "111 ms")]
)
def test_the_time_of_an_answer_has_no_power_of_ten(seconds: float, told: str) -> None:
    assert sentence("brick", ["slides"], computation_time=seconds) == f"brick slides ({told})"
