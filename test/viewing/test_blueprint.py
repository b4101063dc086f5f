from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from rerun.chunk import RrdReader

from contact_dynamics.viewing.blueprint import DIAGRAMS, LOWEST_DISTANCE, Eye, eye_on, make_blueprint
from contact_dynamics.viewing.entities import (
    MODE_MAP,
    POINSOT,
    entity,
    impact_entity,
    predicted_entity,
    trail_entity,
)

if TYPE_CHECKING:
    from pathlib import Path

UP = np.array([0.0, 0.0, 1.0])
FALL = np.column_stack([np.linspace(3.0, 3.5, 20), np.full(20, 4.0), np.linspace(1.0, 0.0, 20) ** 2])


@pytest.mark.parametrize(
    "points",
    [FALL, FALL * 100.0, np.repeat(FALL[:1], 3, axis=0), FALL[::-1], np.outer(np.linspace(0, 1, 5), UP)],
    ids=["fall", "far fall", "one place", "rise", "straight up"],
)
def test_the_eye_sees_all_from_above_and_from_the_side(points: np.ndarray) -> None:
    eye = eye_on(points, up_W=UP, margin=0.2)
    line_of_sight = eye.target_W - eye.position_W
    distance = np.linalg.norm(line_of_sight)
    assert distance >= LOWEST_DISTANCE
    assert 0.0 < -line_of_sight @ UP < 0.5 * distance
    directions = points - eye.position_W
    cosines = directions @ line_of_sight / distance / np.linalg.norm(directions, axis=1)
    assert (
        np.degrees(np.arccos(np.minimum(cosines, 1.0))).max() < 30.0
    )  # the viewer's field of view is 55 degrees or wider
    level = (points[-1] - points[0]) * (1.0 - UP)
    assert abs(line_of_sight @ level) <= 1e-9 * distance * np.linalg.norm(level)


def test_the_eye_is_where_the_path_bulges_to() -> None:
    corner = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]])
    for points in (corner, corner[::-1]):
        eye = eye_on(points, up_W=UP, margin=0.2)
        nearest = np.linalg.norm(points - eye.position_W, axis=1).argmin()
        assert nearest == 1


@pytest.mark.parametrize(
    "eye", [None, Eye(position_W=np.array([1.0, 2.0, 3.0]), target_W=np.zeros(3), up_W=UP)]
)
@pytest.mark.parametrize("diagrams", [[], [MODE_MAP], list(DIAGRAMS)])
def test_the_arrangement_holds_every_view(tmp_path: Path, eye: Eye | None, diagrams: list[str]) -> None:
    path = tmp_path / "views.rbl"
    make_blueprint(["brick", "arm/tool 1"], eye=eye, diagrams=diagrams).save("test", path)
    (entry,) = RrdReader(path).blueprints()
    names: list[str] = []
    paths: list[str] = []
    for chunk in RrdReader(path).stream(store=entry):
        batch = chunk.to_record_batch()
        paths.append(str(chunk.entity_path))
        if "ViewBlueprint:display_name" in batch.schema.names:
            names += [name for row in batch.column("ViewBlueprint:display_name").to_pylist() for name in row]
    assert len(names) == 6 + len(diagrams)
    eyes = (eye is not None) + (POINSOT in diagrams)
    assert sum("EyeControls3D" in path for path in paths) == eyes
    for name in ("brick", "arm/tool 1"):
        recent = [trail_entity(name), f"{predicted_entity(name)}/path", f"{impact_entity(name)}/impulse"]
        for kept in recent:
            assert sum(f"overrides/{kept}/" in path for path in paths) == 1


def test_names_may_hold_any_characters() -> None:
    assert entity("world/bodies", "arm/tool 1") == r"world/bodies/arm\/tool\ 1"
