# SPDX-License-Identifier: Apache-2.0
"""Diagrams are drawn in rerun with their numbers, and with words that do not cover each other."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, ContactSet, MassProperties, PlanarWrench, World
from contact_dynamics.contact_modes import contact_modes, wrench_sets
from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.diagrams.impulse_space import impulse_space, impulse_space_in_3d
from contact_dynamics.diagrams.mode_map import mode_map
from contact_dynamics.diagrams.planar_scene import ModesSideBySide
from contact_dynamics.plane import PlaneOfMotion
from contact_dynamics.questions import ImpactAnswer, ImpactQuestion, Problem, ask
from contact_dynamics.viewing.drawing import EYE, TARGET, draw_diagram, draw_side_by_side
from contact_dynamics.viewing.picture import Picture
from plots.drawn_figures import APPLIED, DIRECTIONS, IN_TRAY, OUTLINE, TRAY
from viewing.drawn import STAMP_NS, Canvas, Drawn

ROD = Body(name="rod", mass_properties=MassProperties(mass=1.0, I_B=np.diag([0.2, 0.5, 0.6])))
ORIGIN = "/impulse_space_in_3d"
LETTER, LINE = 6.2, 18.0  # points of the screen, measured in pictures of the viewer
FIELD_OF_VIEW = np.radians(55.0)


def an_impact(speed: float = -1.0, friction: float = 0.6) -> ImpactAnswer:
    falling = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[speed, 0.4, -1])
    ground = ContactSet(p_WC_W=[[0.3, 0.2, -0.9]], normals_W=[0, 0, 1], frictions=friction, restitutions=0.5)
    return ask(ImpactQuestion(body=ROD, state=falling, contacts=ground))


def words_on_screen(drawn: Drawn, *, in_space: bool, height: float) -> list[tuple[str, np.ndarray]]:
    """Each word and its box (left, top, right, bottom), in points of the screen of a panel of that height."""
    component, place_of = ("Points3D", "positions") if in_space else ("LineStrips2D", "strips")
    found: list[tuple[str, np.ndarray]] = []
    for entity, name in drawn.values:
        if name == f"{component}:labels":
            places = [
                np.ravel(each)[: 3 if in_space else 2]
                for each in drawn.last(entity, f"{component}:{place_of}")
            ]
            found += zip(drawn.last(entity, name), places, strict=True)
    if in_space:
        ahead = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
        right = np.cross(ahead, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        screen = 0.5 * height / np.tan(0.5 * FIELD_OF_VIEW) * np.array([right, np.cross(ahead, right)])
        seen = [place - EYE for _, place in found]
        seen = [screen @ place / (place @ ahead) for place in seen]
    else:
        strips = [drawn.last(*key) for key in drawn.values if key[1] == "LineStrips2D:strips"]
        everything = np.vstack([strip for several in strips for strip in several])
        seen = [place * (height / np.ptp(everything[:, 1])) for _, place in found]
    boxes = []
    for (text, _), (x, y) in zip(found, seen, strict=True):
        lines = text.splitlines()
        half = 0.5 * LETTER * max(map(len, lines))
        boxes.append((text, np.array([x - half, y, x + half, y + LINE * len(lines)])))
    return boxes


@pytest.mark.parametrize("in_space", [False, True])
@pytest.mark.parametrize(("speed", "friction"), [(-1.0, 0.6), (-0.2, 0.05), (0.0, 0.3), (0.7, 1.5)])
def test_words_of_impulse_space_do_not_cover_each_other(
    canvas: Canvas, *, in_space: bool, speed: float, friction: float
) -> None:
    answer = an_impact(speed, friction)
    diagram = (impulse_space_in_3d if in_space else impulse_space)(ROD, answer)
    draw_diagram(canvas.stream, diagram, ORIGIN)
    words = words_on_screen(canvas.read(), in_space=in_space, height=240.0)
    assert {text for text, _ in words} >= {axis.name for axis in diagram.axes}
    assert {mark.legend for mark in diagram.marks if mark.legend} <= {text for text, _ in words}
    cover_no_other(words)


@pytest.mark.parametrize("name", ["modes", "map"])
def test_words_of_contact_modes_do_not_cover_each_other(canvas: Canvas, name: str) -> None:
    """On the page of contact modes, where the map has names for regions and points for the small ones."""
    leans = replace(IN_TRAY, wrench=PlanarWrench(f=(4.0, -9.0)))
    (mode,) = contact_modes(leans).modes
    if name == "modes":
        titles = [f"{mode.mode}: {mode_in_words(mode.mode)}\n(margin 6.53 N to llss)"]
        view = ModesSideBySide(contacts=tuple(TRAY), modes=(mode,), titles=titles, outline=OUTLINE)
        draw_side_by_side(canvas.stream, view.scenes, "shown", name="mode")
    else:
        draw_diagram(canvas.stream, mode_map(wrench_sets(IN_TRAY), DIRECTIONS, applied=APPLIED), "shown")
    drawn = canvas.read()
    words = words_on_screen(drawn, in_space=False, height=235.0)
    if name == "map":
        assert len(drawn.last("/shown/small_regions", "Points2D:labels")) > 0
    assert len(words) > 12
    cover_no_other(words)


def cover_no_other(words: list[tuple[str, np.ndarray]]) -> None:
    for (one, a), (other, b) in combinations(words, 2):
        wide, high = np.minimum(a[2:], b[2:]) - np.maximum(a[:2], b[:2])
        assert wide <= 1.0 or high <= 1.0, f"{one!r} covers {other!r}"


def test_every_diagram_in_space_is_equally_high(canvas: Canvas) -> None:
    heights = []
    for name, speed in (("slow", -0.1), ("fast", -30.0)):
        diagram = impulse_space_in_3d(ROD, an_impact(speed))
        draw_diagram(canvas.stream, diagram, name)
        heights.append(diagram.axes[2].high)
    assert heights[1] != pytest.approx(heights[0], rel=0.3)
    drawn = canvas.read()
    for name in ("slow", "fast"):
        axes = drawn.last(f"/{name}/frame/axes", "LineStrips3D:strips")
        assert max(np.ptp(np.array(axis)[:, 2]) for axis in axes) == pytest.approx(1.0)


def test_a_diagram_is_drawn_with_its_numbers_in_place_of_the_one_before(canvas: Canvas) -> None:
    draw_diagram(canvas.stream, impulse_space(ROD, an_impact()), "impulse_space")
    diagram = impulse_space(None, an_impact())
    draw_diagram(canvas.stream, diagram, "impulse_space")
    drawn = canvas.read()
    marks: dict[str, Any] = {mark.name: mark for mark in diagram.marks}
    path = drawn.array("/impulse_space/path", "LineStrips2D:strips")[0]
    np.testing.assert_allclose(path, marks["path"].strips[0] * (1.0, -1.0), atol=1e-6)  # down on the screen
    dot = drawn.array("/impulse_space/event_0", "Points2D:positions")
    np.testing.assert_allclose(dot, marks["event_0"].places * (1.0, -1.0), atol=1e-6)
    assert len(drawn.values["/impulse_space/sticking_line", "LineStrips2D:strips"]) == 1
    assert drawn.values["/impulse_space", "Clear:is_recursive"] == [(STAMP_NS, [True])] * 2
    numbers = drawn.last("/impulse_space/frame/numbers", "LineStrips2D:labels")
    assert "tangential impulse, N s" in numbers
    assert "0" in numbers


@pytest.mark.parametrize("first_in_space", [True, False])
def test_a_planar_impact_takes_away_the_picture_in_3d(canvas: Canvas, *, first_in_space: bool) -> None:
    picture = Picture(canvas.stream, World(bodies=(ROD,), surfaces=()), surface_side=1.0)
    side = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])
    flat = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[-1, 0, -1])
    ground = ContactSet(p_WC_W=[[0.3, 0, -0.9]], normals_W=[0, 0, 1], frictions=0.6, restitutions=0.5)
    planar = ImpactQuestion(body=ROD, state=flat, contacts=ground, problem=Problem.PLANAR, plane=side)
    if first_in_space:
        picture.show(an_impact(), now_ns=1)
    picture.show(ask(planar), now_ns=2)
    drawn = canvas.read()
    if first_in_space:
        assert drawn.values[ORIGIN, "Clear:is_recursive"][-1] == (2, [True])
    else:
        assert not any(entity.startswith(ORIGIN) for entity in drawn.entities)
