# SPDX-License-Identifier: Apache-2.0
"""Every argument that is one of an enumeration refuses what is not, by its own name."""

from __future__ import annotations

import inspect
from enum import Enum
from typing import Any

import numpy as np
import pytest

from contact_dynamics import impact
from contact_dynamics.errors import InvalidFieldError, WrongTypeError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from hostile_values import CALLS

IMPACTS = CALLS["spatial_impacts"][1]


def choices() -> list[tuple[str, str, type[Enum]]]:
    """Return the public calls with their arguments that are of an enumeration, or of rows of one."""
    found: list[tuple[str, str, type[Enum]]] = []
    for name, (call, _) in CALLS.items():
        inner = inspect.unwrap(getattr(call, "__func__", call))
        for argument, text in inspect.get_annotations(inner).items():
            kind = vars(inspect.getmodule(inner)).get(text)
            if argument == "restitution_laws" and name.endswith("_impacts"):
                kind = RestitutionLaw
            if argument != "return" and inspect.isclass(kind) and issubclass(kind, Enum):
                found.append((name, argument, kind))
    return found


@pytest.mark.parametrize(("name", "argument", "kind"), choices())
def test_members_are_taken_and_all_else_is_refused_by_name(
    name: str, argument: str, kind: type[Enum]
) -> None:
    call, arguments = CALLS[name]
    for member in kind:
        call(**{**arguments, argument: member})
    other = SeveralContactsLaw.SIMULTANEOUS if kind is RestitutionLaw else RestitutionLaw.NEWTON
    for wrong, shown in (
        ("newton", "'newton'"),
        (None, "None"),
        (True, "True"),
        (other, f"{type(other).__name__}.{other.name}"),
    ):
        with pytest.raises(WrongTypeError) as raised:
            call(**{**arguments, argument: wrong})
        text = str(raised.value)
        assert text.startswith(f"{argument} must be ")
        assert f", got {shown}" in text
        assert all(member.name in text for member in kind)
    with pytest.raises(InvalidFieldError, match=rf"^{argument}(\[0\])? must be .* got 7"):
        call(**{**arguments, argument: 7})


def test_choices_are_found_in_every_chapter() -> None:
    kinds = {kind.__name__ for _, _, kind in choices()}
    assert {"Precision", "WrenchAxes", "PropagationMethod", "SeveralContactsLaw", "Problem"} < kinds
    assert len(choices()) > 25


@pytest.mark.parametrize(
    ("laws", "row"),
    [
        ([RestitutionLaw.NEWTON, "newton"], 1),
        ([RestitutionLaw.NEWTON, SeveralContactsLaw.SIMULTANEOUS], 1),
        (np.array(["poisson"]), 0),
        (np.array([0.0, 1.0, float(len(RestitutionLaw))]), 2),
        ([None], 0),
    ],
)
def test_a_list_of_laws_names_the_row(laws: Any, row: int) -> None:
    with pytest.raises(InvalidFieldError, match=rf"^restitution_laws\[{row}\](:| must be).*NEWTON"):
        impact.spatial_impacts(**IMPACTS, restitution_laws=laws)


def test_a_list_of_laws_may_hold_members_or_values() -> None:
    by_member = impact.spatial_impacts(
        **IMPACTS, restitution_laws=[RestitutionLaw.NEWTON, RestitutionLaw.POISSON]
    )
    by_value = impact.spatial_impacts(**IMPACTS, restitution_laws=np.array([1, 0]))
    assert by_member.restitution_laws.tolist() == by_value.restitution_laws.tolist() == [1, 0]
    assert np.array_equal(by_member.impulses_W, by_value.impulses_W)
