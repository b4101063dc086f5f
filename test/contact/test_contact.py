# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics.contact import Contact, ContactSet, ContactUncertainty, Curvatures
from contact_dynamics.contact.curvature import alike
from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarWrench
from contact_dynamics.plane.types import OrientedPoint, Turn, acceleration_centre, force_dual, friction_cone

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


# Smaller forces have a force dual at a distance that no double holds.
numbers = st.floats(-10.0, 10.0).filter(lambda x: x == 0.0 or abs(x) > 1e-100)


def test_the_edges_push_right_and_left() -> None:
    right, left = friction_cone(PlanarContact(r=(2.0, -1.0), normal=(0.0, 1.0), friction=0.5))
    assert right == PlanarWrench(f=(0.5, 1.0), moment=2.5)
    assert left == PlanarWrench(f=(-0.5, 1.0), moment=1.5)


@given(numbers, numbers, st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.sampled_from([-1.0, 1.0]))
def test_a_wrench_accelerates_the_body_about_its_force_dual(
    f_x: float, f_y: float, mass: float, rho: float, moment: float
) -> None:
    body = PlanarBody(mass=mass, inertia=mass * rho * rho)
    dual = force_dual(body, PlanarWrench(f=(f_x, f_y), moment=moment))
    assert dual is not None
    assert dual.turn == moment
    x, y = dual.point
    alpha = moment / body.inertia
    scale = 1e-12 * (abs(f_x) + abs(f_y) + 1.0) / mass
    assert abs(f_x / mass - alpha * y) <= scale
    assert abs(f_y / mass + alpha * x) <= scale
    # Mason 5.8: the dual lies across the centre from the line of force, at rho^2 over its distance.
    distance = abs(moment) / math.hypot(f_x, f_y) if f_x or f_y else math.inf
    assert math.hypot(x, y) * distance == pytest.approx(rho * rho) or (f_x, f_y) == (0.0, 0.0)


def test_pure_forces_and_translations_have_their_point_at_infinity() -> None:
    body = PlanarBody(mass=1.0, inertia=1.0)
    assert force_dual(body, PlanarWrench(f=(0.0, -2.0))) == OrientedPoint((1.0, 0.0), Turn.NEITHER)
    assert acceleration_centre((0.0, 0.0), 0.0) is None
    assert acceleration_centre((0.0, 0.0), -3.0) == OrientedPoint((0.0, 0.0), Turn.CLOCKWISE)


@given(st.tuples(numbers, numbers, numbers), st.floats(0.0, 3.0), st.integers(3, 16))
def test_the_pyramid_is_inside_the_round_cone(
    direction: tuple[float, float, float], friction: float, facets: int
) -> None:
    length = math.hypot(*direction)
    if length < 1e-3:
        return
    normal = np.array(direction) / length
    one, two = tangents_towards(normal)
    np.testing.assert_allclose(np.cross(one, two), normal, atol=1e-12)
    edges = linearised_cone(normal, friction, facets)
    assert edges.shape == (facets, 3)
    np.testing.assert_allclose(edges @ normal, 1.0, atol=1e-12)
    across = edges - normal
    np.testing.assert_allclose(np.linalg.norm(across, axis=1), friction, atol=1e-12)
    # Evenly spread: neighbours are all the same angle apart, and the first differs from the last.
    turns = np.sum(across * np.roll(across, 1, axis=0), axis=1)
    np.testing.assert_allclose(turns, friction**2 * math.cos(2.0 * math.pi / facets), atol=1e-12)
