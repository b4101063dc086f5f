# SPDX-License-Identifier: Apache-2.0
"""Each restitution law has its rule for paths in space."""

from __future__ import annotations

from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.spatial.path import RULES


def test_every_law_has_its_rule_and_only_the_energetic_one_asks_for_work() -> None:
    assert set(RULES) == set(RestitutionLaw)
    assert [law for law, rule in RULES.items() if rule.needs_work] == [RestitutionLaw.ENERGETIC]
