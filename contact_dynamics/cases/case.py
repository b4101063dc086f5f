"""A question whose exact answer is known, and how to ask it here, over ROS 2, and of a simulator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

from contact_dynamics.records import Record

OfSetting: TypeAlias = Callable[[float], float]
"""A number that follows from the setting of a case, in the units that the case states."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Request(Record):
    """The same question as a request of a service.

    Attributes:
        service: The service's name without the node's, such as ``predict_impact``.
        text: The request in YAML for a setting of the case, as `ros2 service call` takes it.
        answer: Where the number stands in the response, such as ``modes[0].linear_acceleration[0]``.
        exact: That number in closed form. It may differ from the case's own, as a velocity does from a ratio.
        tolerance: Largest difference from it, in its unit.
    """

    service: str
    text: Callable[[float], str]
    answer: str
    exact: OfSetting
    tolerance: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Case(Record):
    """One question with its exact answer.

    Attributes:
        title: The question in a few words.
        story: What users saw, and what is right. One or two sentences.
        threads: Addresses of public threads in which it was asked.
        setting: The name of the number that is varied.
        settings: Its values. All of them are asked.
        quantity: What the answer is, with its unit.
        formula: The closed form, in words and signs.
        exact: The closed form as a function of the setting.
        ours: The package's answer. The page shows its source.
        mujoco: What MuJoCo gives, measured in a simulation.
        tolerance: Largest difference between ours and the exact answer, in the unit of the quantity.
        why_tolerance: The reason of that size.
        request: The same question for `ros2 service call`.
    """

    title: str
    story: str
    threads: tuple[str, ...]
    setting: str
    settings: tuple[float, ...]
    quantity: str
    formula: str
    exact: OfSetting = field(repr=False)
    ours: OfSetting = field(repr=False)
    mujoco: OfSetting = field(repr=False)
    tolerance: float
    why_tolerance: str
    request: Request
