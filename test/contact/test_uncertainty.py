# SPDX-License-Identifier: Apache-2.0
import math

import pytest

from contact_dynamics.contact import ContactUncertainty
from contact_dynamics.errors import InvalidFieldError


def test_contacts_are_exact_unless_something_is_said() -> None:
    assert ContactUncertainty().is_exact
    for name in ("points", "normals", "frictions"):
        assert not ContactUncertainty(**{name: 1e-300}).is_exact


def test_a_normal_is_known_to_a_right_angle_at_least() -> None:
    assert ContactUncertainty(normals=0.5 * math.pi).normals == 0.5 * math.pi
    with pytest.raises(InvalidFieldError, match="normals"):
        ContactUncertainty(normals=1.6)


def test_each_contact_may_have_a_number_of_its_own() -> None:
    box = ContactUncertainty(points=[1e-3, 2e-3], normals=0.1)
    assert box.of_each(2) == [(1e-3, 0.1, 0.0), (2e-3, 0.1, 0.0)]
    assert not box.is_exact
    assert ContactUncertainty(points=(0.0, 0.0)).is_exact
    with pytest.raises(InvalidFieldError, match=r"uncertainty of points\[1\]"):
        ContactUncertainty(points=[1e-3, -1.0])
    with pytest.raises(InvalidFieldError, match="2 and 3 contacts"):
        ContactUncertainty(points=[1e-3, 1e-3], frictions=[0.1, 0.1, 0.1])
    with pytest.raises(InvalidFieldError, match="each of 3 contacts"):
        box.check_count(3)
