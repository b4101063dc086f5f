# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.diagrams.marks import Diagram
from contact_dynamics.diagrams.planar_scene import cone_edges, planar_scene_of
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarWrench
from diagrams.marks_of import marks_of

BLOCK = [PlanarContact(r=(x, -0.5), normal=(0.0, 1.0), friction=0.5) for x in (-1.0, 1.0)]
OUTLINE = np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5], [-1.0, -0.5]])


@pytest.mark.parametrize("friction", [0.0, 0.3, 2.0])
def test_a_cone_opens_by_the_friction_angle_about_the_normal(friction: float) -> None:
    contact = PlanarContact(r=(0.2, 0.1), normal=(-0.6, 0.8), friction=friction)
    right, tip, left = cone_edges(contact, length=2.0)
    np.testing.assert_allclose(tip, contact.r)
    for edge, sign in ((right - tip, 1.0), (left - tip, -1.0)):
        assert np.linalg.norm(edge) == pytest.approx(2.0)
        along, across = edge @ np.array(contact.normal), edge @ np.array(contact.tangent)
        assert math.atan2(across, along) == pytest.approx(sign * math.atan(friction))


def labels_of(diagram: Diagram) -> dict[str, np.ndarray]:
    """The labels of contacts with their places."""
    marks = [mark for name, mark in marks_of(diagram).items() if name.startswith("letters/")]
    return {text: place for mark in marks for text, place in zip(mark.texts, mark.places, strict=True)}


def test_letters_forces_and_accelerations_of_a_mode() -> None:
    body = PlanarBody(mass=1.0, inertia=0.5)
    wrench = PlanarWrench(f=(8.0, -10.0))  # more than friction holds
    (mode,) = contact_modes(PlanarContactProblem(body=body, contacts=BLOCK, wrench=wrench)).modes
    scene = planar_scene_of(OUTLINE, BLOCK, mode=mode)
    assert set(labels_of(scene)) == {f"1 {mode.mode[0]}", f"2 {mode.mode[1]}"}
    marks = marks_of(scene)
    pressing = [force for force in mode.contact_forces if force[1] > 0.0]
    assert len(marks["forces"].vectors) == len(pressing)
    for arrow, (f_t, f_n) in zip(marks["forces"].vectors, pressing, strict=True):
        np.testing.assert_allclose(arrow / arrow[1], [f_t / f_n, 1.0], atol=1e-9)
    assert np.all(marks["accelerations"].vectors[:, 0] > 0.0)
    meanings = {mark.legend for name, mark in marks.items() if name.startswith("contacts/")}
    assert meanings == {
        {"l": "contact that slides left (l), right (r)", "r": "contact that slides left (l), right (r)"}.get(
            letter, "contact that separates (s)"
        )
        for letter in mode.mode
    }
    low, high = np.array([(axis.low, axis.high) for axis in scene.axes]).T
    tips = marks["forces"].origins + marks["forces"].vectors
    for place in (*tips, *OUTLINE, *labels_of(scene).values()):
        assert np.all((place > low) & (place < high))


def test_without_a_mode_contacts_are_numbered_and_at_one_place_share_a_label() -> None:
    scene = planar_scene_of(OUTLINE, BLOCK)
    assert set(labels_of(scene)) == {"1", "2"}
    assert "forces" not in marks_of(scene)
    assert set(labels_of(planar_scene_of(OUTLINE, [*BLOCK, *BLOCK]))) == {"1, 3", "2, 4"}


def test_the_label_of_a_corner_is_clear_of_both_surfaces() -> None:
    floor, wall = (
        PlanarContact(r=(1.0, -0.5), normal=normal, friction=0.5) for normal in ((0.0, 1.0), (-1.0, 0.0))
    )
    labels = labels_of(planar_scene_of(OUTLINE, [BLOCK[0], floor, wall]))
    distance = BLOCK[0].r[1] - labels["1"][1]
    assert distance > 0.0
    right, up = labels["2, 3"] - np.array(floor.r)
    assert min(right, -up) > distance


def test_the_label_of_a_body_around_a_peg_is_behind_its_first_contact() -> None:
    pair = [PlanarContact(r=(0.0, y), normal=(0.0, 2.0 * y), friction=0.5) for y in (-0.5, 0.5)]
    (place,) = labels_of(planar_scene_of(OUTLINE, pair, size=10.0)).values()
    assert place[0] == pytest.approx(0.0)
    assert place[1] > pair[0].r[1]
