from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.diagrams.planar_scene import cone_edges, planar_scene_of
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.viewing.planar_scene import draw_planar_scene

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from viewing.drawn import Drawn

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


def test_letters_forces_and_accelerations_of_a_mode(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    body = PlanarBody(mass=1.0, inertia=0.5)
    wrench = PlanarWrench(f=(8.0, -10.0))  # more than friction holds
    (mode,) = contact_modes(
        PlanarContactProblem(
            body=body, velocity=PlanarVelocity(v=(0.0, 0.0), w=0.0), contacts=BLOCK, wrench=wrench
        )
    ).modes
    draw_planar_scene(recording, OUTLINE, BLOCK, mode=mode)
    drawn = read()
    assert drawn.last("/planar_scene/letters", "LineStrips2D:labels") == [
        f"1 {mode.mode[0]}",
        f"2 {mode.mode[1]}",
    ]
    arrows = drawn.array("/planar_scene/forces", "Arrows2D:vectors")
    pressing = [force for force in mode.contact_forces if force[1] > 0.0]
    assert len(arrows) == len(pressing)
    for arrow, (f_t, f_n) in zip(arrows, pressing, strict=True):  # the second coordinate is downwards
        np.testing.assert_allclose(arrow / -arrow[1], [f_t / f_n, -1.0], atol=1e-6)
    accelerations = drawn.array("/planar_scene/accelerations", "Arrows2D:vectors")
    assert np.all(accelerations[:, 0] > 0.0)


def test_without_a_mode_contacts_are_numbered(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    draw_planar_scene(recording, OUTLINE, BLOCK)
    drawn = read()
    assert drawn.last("/planar_scene/letters", "LineStrips2D:labels") == ["1", "2"]
    assert ("/planar_scene/forces", "Arrows2D:vectors") not in drawn.values


def test_contacts_at_one_place_share_a_label(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    draw_planar_scene(recording, OUTLINE, [*BLOCK, *BLOCK])
    assert read().last("/planar_scene/letters", "LineStrips2D:labels") == ["1, 3", "2, 4"]


def test_the_label_of_a_corner_is_clear_of_both_surfaces() -> None:
    floor, wall = (
        PlanarContact(r=(1.0, -0.5), normal=normal, friction=0.5) for normal in ((0.0, 1.0), (-1.0, 0.0))
    )
    alone, corner = planar_scene_of(OUTLINE, [BLOCK[0], floor, wall]).labels
    assert (alone.contacts, corner.contacts) == ([0], [1, 2])
    distance = BLOCK[0].r[1] - alone.place[1]
    assert distance > 0.0
    right, up = corner.place - np.array(floor.r)
    assert min(right, -up) > distance


def test_the_label_of_a_body_around_a_peg_is_behind_its_first_contact() -> None:
    pair = [PlanarContact(r=(0.0, y), normal=(0.0, 2.0 * y), friction=0.5) for y in (-0.5, 0.5)]
    (label,) = planar_scene_of(OUTLINE, pair, size=10.0).labels
    assert label.place[0] == pytest.approx(0.0)
    assert label.place[1] > pair[0].r[1]
