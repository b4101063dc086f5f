import math

import pytest

from contact_dynamics.contact import ContactUncertainty
from contact_dynamics.errors import InvalidFieldError


def test_contacts_are_exact_unless_something_is_said() -> None:
    assert ContactUncertainty().is_exact
    for name in ("points", "normals", "frictions"):
        assert not ContactUncertainty(**{name: 1e-300}).is_exact


@pytest.mark.parametrize("value", [-1e-300, math.nan, math.inf, "wide", 1j])
@pytest.mark.parametrize("name", ["points", "normals", "frictions"])
def test_what_is_no_distance_is_refused_by_its_name(name: str, value: object) -> None:
    with pytest.raises(InvalidFieldError, match=f"uncertainty of {name}"):
        ContactUncertainty(**{name: value})  # type: ignore[arg-type]


def test_a_normal_is_known_to_a_right_angle_at_least() -> None:
    assert ContactUncertainty(normals=0.5 * math.pi).normals == 0.5 * math.pi
    with pytest.raises(InvalidFieldError, match="normals"):
        ContactUncertainty(normals=1.6)
