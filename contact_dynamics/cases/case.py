# SPDX-License-Identifier: Apache-2.0
"""A question whose exact answer is known, in Python and as a request of a service."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

from contact_dynamics.records import Record

OfSetting: TypeAlias = Callable[[float], float]
"""A number that follows from the setting of a case, in the units that the case states."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Case(Record):
    """One question with its exact answer. The engines (`engine.py`) answer it by its name in `CASES`.

    Attributes:
        title: The question in a few words.
        story: What users saw, and what is right. One or two sentences.
        discussed: Public threads in which it was asked, as ``owner/repository/issues/1``, space-separated.
        setting: The name of the number that is varied.
        settings: Its values.
        quantity: What the answer is, with its unit.
        formula: The closed form, in words and symbols.
        exact: The closed form as a function of the setting.
        tolerance: Largest difference of this package's answer from it, in the unit of the quantity.
        why_tolerance: The reason for that size.
        answer: Service, and path of the number in its response: ``predict_tumbling.poinsot.polhode_period``.
        request: The request in YAML, as `ros2 service call` takes it. ``%(x)s`` stands for the setting.
        values: Other values in the request, by name, that follow from the setting.
        answer_exact: The number in the response, if it is not ``exact``, as a velocity is not a ratio.
        answer_tolerance: Largest difference from it, if it is not ``tolerance``.
    """

    title: str
    story: str
    discussed: str
    setting: str
    settings: tuple[float, ...]
    quantity: str
    formula: str
    exact: OfSetting = field(repr=False)
    tolerance: float
    why_tolerance: str
    answer: str
    request: str
    values: Callable[[float], dict[str, float]] | None = field(default=None, repr=False)
    answer_exact: OfSetting | None = field(default=None, repr=False)
    answer_tolerance: float | None = None

    @property
    def threads(self) -> tuple[str, ...]:
        """The addresses of the threads."""
        return tuple(f"https://github.com/{thread}" for thread in self.discussed.split())

    def request_text(self, setting: float) -> str:
        """Return the request for a setting."""
        return self.request % {"x": setting, **(self.values(setting) if self.values else {})}

    def answer_of(self, setting: float) -> tuple[float, float]:
        """Return the exact number in the response to that request, and its tolerance."""
        exact = (self.answer_exact or self.exact)(setting)
        return exact, self.tolerance if self.answer_tolerance is None else self.answer_tolerance
