"""What sets the restitution laws apart: one impact and many have the same ends, to the last bit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics.impact.law import RULES, RestitutionLaw

COUNT = 300


@pytest.mark.parametrize("law", RestitutionLaw)
def test_many_end_where_each_does(law: RestitutionLaw) -> None:
    rng = np.random.default_rng(7)
    v_n, lifting, due = rng.normal(size=(3, COUNT))
    v_n, final = abs(v_n), abs(rng.normal(size=COUNT))
    with np.errstate(all="ignore"):
        many = RULES[law].distances(v_n, lifting, due, final)
    each = [
        RULES[law].distance(*numbers) for numbers in np.stack([v_n, lifting, due, final], axis=1).tolist()
    ]
    assert many.tolist() == each


@pytest.mark.parametrize("law", RestitutionLaw)
def test_restitution_is_done_after_the_distance_to_its_end(law: RestitutionLaw) -> None:
    rule, v_n, lifting, due, final = RULES[law], 0.3, 0.7, 0.4, 0.9
    p = rule.distance(v_n, lifting, due, final)
    assert 0.0 < p < math.inf
    for part, over in ((0.99, False), (1.01, True)):
        gone = part * p
        work = gone * (v_n + 0.5 * lifting * gone)
        assert rule.is_done(p=gone, v_n=v_n + lifting * gone, work=work, due=due, final=final) is over


def test_every_law_has_its_rule_and_only_the_energetic_one_asks_for_work() -> None:
    assert {law: rule.law for law, rule in RULES.items()} == {law: law for law in RestitutionLaw}
    assert [law for law, rule in RULES.items() if rule.needs_work] == [RestitutionLaw.ENERGETIC]
    assert {law: rule.share(0.5, -2.0) for law, rule in RULES.items()} == {
        RestitutionLaw.POISSON: 0.5,
        RestitutionLaw.NEWTON: 0.5,
        RestitutionLaw.ENERGETIC: 0.25,
    }
