# SPDX-License-Identifier: Apache-2.0
"""What is cleared from the scene, and when."""

from __future__ import annotations

from contact_dynamics.constants import to_ns
from contact_dynamics.viewing.in_view import LABELS_S, ConservedInView, ImpactsInView
from viewing.drawn import STAMP_NS, Canvas, Drawn

AFTER_NS = STAMP_NS + to_ns(LABELS_S) + 1


def cleared(drawn: Drawn, entity: str) -> list[int]:
    """The stamps at which something was cleared."""
    return [stamp for stamp, _ in drawn.values.get((entity, "Clear:is_recursive"), [])]


def test_an_older_impact_goes_when_it_is_over_and_the_newest_keeps_its_arrows(canvas: Canvas) -> None:
    impacts = ImpactsInView(canvas.stream)
    impacts.come("a", stamp_ns=STAMP_NS, strike_ns=STAMP_NS)
    impacts.come("b", stamp_ns=STAMP_NS + 5, strike_ns=STAMP_NS)
    for name in ("a", "b", "c"):
        impacts.pass_by(name, AFTER_NS - 1)  # not yet over
        impacts.pass_by(name, AFTER_NS)
        impacts.pass_by(name, AFTER_NS + 1)  # no second time
    drawn = canvas.read()
    assert cleared(drawn, "/world/impact/a") == [AFTER_NS]
    assert cleared(drawn, "/world/impact/a/velocity_label") == [STAMP_NS + 5]
    assert cleared(drawn, "/world/impact/b") == []
    assert cleared(drawn, "/world/impact/b/velocity_label") == [AFTER_NS]


def test_an_impact_that_is_over_goes_when_that_of_another_body_comes(canvas: Canvas) -> None:
    impacts = ImpactsInView(canvas.stream)
    impacts.come("a", stamp_ns=STAMP_NS, strike_ns=STAMP_NS)
    impacts.pass_by("a", AFTER_NS)
    impacts.come("b", stamp_ns=AFTER_NS + 7, strike_ns=AFTER_NS + 7)
    assert cleared(canvas.read(), "/world/impact/a") == [AFTER_NS + 7]


def test_the_curves_stay_with_a_body_until_its_prediction_is_over(canvas: Canvas) -> None:
    curves, end_ns = ConservedInView(canvas.stream), STAMP_NS + 100
    assert curves.body_name is None
    assert curves.come("a", stamp_ns=STAMP_NS, end_ns=end_ns)
    assert not curves.come("b", stamp_ns=end_ns - 1, end_ns=end_ns + 50)
    assert curves.body_name == "a"
    assert curves.come("b", stamp_ns=end_ns, end_ns=end_ns + 50)
    assert not curves.come("b", stamp_ns=end_ns + 1, end_ns=end_ns + 50)
    assert curves.body_name == "b"
    drawn = canvas.read()
    words = drawn.values["/whose_energy", "TextDocument:text"]
    assert [stamp for stamp, _ in words] == [STAMP_NS, end_ns]
    assert [name for name, (_, text) in zip("ab", words, strict=True) if f"**{name}**" in text[0]] == [
        "a",
        "b",
    ]
    for quantity in ("energy", "momentum", "angular_momentum", "angular_velocity"):
        for kind in ("measured", "predicted"):
            assert cleared(drawn, f"/{quantity}/a/{kind}") == [end_ns]
            assert cleared(drawn, f"/{quantity}/b/{kind}") == []
