# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest

from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.contact.curvature import Curvatures, alike
from contact_dynamics.errors import InvalidFieldError

UP = [0.0, 0.0, 1.0]
WALL = Contact(
    p_WC_W=[1.0, 0.0, 0.5], normal_W=[-1.0, 0.0, 0.0], friction=0.2, restitution=0.7, surface="wall"
)
ROLLING = Contact(
    p_WC_W=[0.0, 0.0, 0.0],
    normal_W=UP,
    friction=0.3,
    restitution=0.0,
    body_curvatures=Curvatures(along=[10.0], across=[5.0], directions_W=[[1.0, 0.0, 0.0]]),
)


def same(one: Contact, other: Contact) -> bool:
    """Whether two contacts are alike, but for curvatures."""
    return (
        one.p_WC_W.tolist() == other.p_WC_W.tolist()
        and one.normal_W.tolist() == other.normal_W.tolist()
        and (one.friction, one.restitution, one.surface) == (other.friction, other.restitution, other.surface)
    )


def test_a_set_holds_its_contacts() -> None:
    contacts = ContactSet.of([WALL, ROLLING])
    assert len(contacts) == 2
    assert all(same(*pair) for pair in zip(contacts, [WALL, ROLLING], strict=True))
    assert same(contacts[-1], ROLLING)
    with pytest.raises(IndexError):
        contacts[2]
    assert len(ContactSet.of([])) == 0
    assert list(ContactSet.of([])) == []


def test_curvatures_go_with_their_contact() -> None:
    """The other contact of the set is a point, as it was alone."""
    wall, rolling = ContactSet.of([WALL, ROLLING])
    assert wall.body_curvatures is not None
    assert math.isinf(wall.body_curvatures.along[0])
    assert rolling.body_curvatures is not None
    assert (rolling.body_curvatures.along[0], rolling.body_curvatures.across[0]) == (10.0, 5.0)
    assert ContactSet.of([WALL]).body_curvatures is None


def test_one_number_stands_for_all_and_lists_are_arrays() -> None:
    feet = ContactSet(p_WC_W=[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], normals_W=UP, frictions=0.3)
    assert feet.normals_W.tolist() == [UP, UP]
    assert feet.frictions.tolist() == [0.3, 0.3]
    assert feet.restitutions is None
    assert (
        ContactSet(p_WC_W=feet.p_WC_W, normals_W=UP, frictions=[0.1, 0.2], restitutions=1).frictions[1] == 0.2
    )
    assert len(ContactSet(p_WC_W=np.zeros((0, 3)), normals_W=UP, frictions=0.3)) == 0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"body_curvatures": alike(2, 1.0)}, "body_curvatures must be .*, got 2 contacts"),
        ({"body_curvatures": alike(1, -1.0)}, "curvatures"),
    ],
)
def test_a_contact_that_makes_no_sense_is_refused(changes: dict[str, object], words: str) -> None:
    good: dict[str, object] = {"p_WC_W": [0.0, 0.0, 0.0], "normal_W": UP, "friction": 0.5}
    with pytest.raises(InvalidFieldError, match=words):
        Contact(**{**good, **changes})  # type: ignore[arg-type]
