# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from rerun.chunk import RrdReader

from contact_dynamics.viewing.blueprint import (
    COLORS_IN_WORDS,
    DIAGRAMS,
    LOWEST_DISTANCE,
    Eye,
    eye_on,
    make_blueprint,
)
from contact_dynamics.viewing.entities import (
    ANSWERS,
    CONTACTS,
    ENERGY,
    ERROR,
    FORCE_DUAL,
    IMPACTS,
    IMPULSE_SPACE,
    IMPULSE_SPACE_IN_3D,
    MANY,
    MODE_MAP,
    PLANAR_MODES,
    POINSOT,
    PREDICTED,
    TOSSES,
    contacts_entity,
    entity,
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
    eye = eye_on(points, about_W=points, up_W=UP, margin=0.2)
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
        eye = eye_on(points, about_W=points, up_W=UP, margin=0.2)
        nearest = np.linalg.norm(points - eye.position_W, axis=1).argmin()
        assert nearest == 1


HEIGHT = "Height, m (thin: predicted)"
SPEED = "Speed, m/s (thin: predicted)"
APART = "Error of the predicted position, m"
OF_ONE_BODY = [
    "Whose curves",
    "Energy, J (thin: predicted)",
    "Momentum, kg m/s (thin: predicted)",
    "Angular momentum, kg m²/s (thin: predicted)",
    "Angular velocity, rad/s (thin: predicted)",
]
OVERVIEW = ["Scene", HEIGHT, "Legend"]
COMPARED = ["Scene", APART, "Legend"]
TOLD = ["Newest answer", "Newest answers", "All answers"]
PAGES = {
    "nothing yet": ([], OVERVIEW, []),
    "a refusal": ([ANSWERS], [*OVERVIEW, *TOLD], []),
    "a flight": (
        [ANSWERS, PREDICTED, POINSOT, ERROR],
        [*COMPARED, *TOLD, "Poinsot", "Flight", "Poinsot", HEIGHT, SPEED, APART],
        ["Flight"],
    ),
    "an impact": (
        [ANSWERS, IMPACTS, IMPULSE_SPACE],
        [*OVERVIEW, *TOLD, "Impulse space", "Impact", "Impulse space", SPEED, "Newest answers"],
        ["Impact"],
    ),
    "an impact in space": (
        [ANSWERS, IMPACTS, IMPULSE_SPACE, IMPULSE_SPACE_IN_3D],
        [
            *OVERVIEW,
            *TOLD,
            "Impact",
            SPEED,
            "Newest answers",
            *2 * ["Impulse space", "Impulse space in 3-D"],
        ],
        ["Impact"],
    ),
    "energy": ([ENERGY], [*OVERVIEW, "Motion", *OF_ONE_BODY], ["Energy and momentum"]),
    "contact modes in space": (
        [ANSWERS, CONTACTS],
        [*OVERVIEW, *TOLD, "Contacts", "Newest answers"],
        ["Contact modes"],
    ),
    "contact modes in the plane": (
        [ANSWERS, CONTACTS, PLANAR_MODES, MODE_MAP, FORCE_DUAL],
        [*OVERVIEW, *TOLD, "Contacts", "Newest answers", *2 * ["Contact modes", "Mode map", "Force dual"]],
        ["Contact modes"],
    ),
    "a toss": ([ANSWERS, TOSSES], [*OVERVIEW, *TOLD, "Toss", HEIGHT, SPEED, "Newest answers"], ["Toss"]),
    "many states": ([ANSWERS, MANY], [*OVERVIEW, *TOLD, "Many states", "Newest answers"], ["Many states"]),
    "everything": (
        [ANSWERS, PREDICTED, IMPACTS, CONTACTS, TOSSES, MANY, ERROR, ENERGY, *DIAGRAMS],
        [
            *COMPARED,
            *TOLD,
            *DIAGRAMS.values(),
            "Flight",
            "Poinsot",
            HEIGHT,
            SPEED,
            APART,
            "Impact",
            "Impulse space",
            "Impulse space in 3-D",
            SPEED,
            "Newest answers",
            "Contacts",
            "Contact modes",
            "Mode map",
            "Force dual",
            "Newest answers",
            "Toss",
            HEIGHT,
            SPEED,
            "Newest answers",
            "Many states",
            "Newest answers",
            "Motion",
            *OF_ONE_BODY,
        ],
        ["Flight", "Impact", "Contact modes", "Toss", "Many states", "Energy and momentum"],
    ),
}  # what there is to see, the views, the pages beside the overview


@pytest.mark.parametrize("case", PAGES)
def test_each_question_has_a_page_and_what_is_not_there_has_no_panel(tmp_path: Path, case: str) -> None:
    shown, views, pages = PAGES[case]
    names, _ = names_and_paths(tmp_path, eye=None, shown=shown)
    found = [name.removesuffix(f" ({COLORS_IN_WORDS})") for name in names["ViewBlueprint"]]
    assert sorted(found) == sorted(views)
    assert sorted(names["ContainerBlueprint"]) == sorted(["Overview", *pages, "Answers and legend"])


@pytest.mark.parametrize(
    "eye", [None, Eye(position_W=np.array([1.0, 2.0, 3.0]), target_W=np.zeros(3), up_W=UP)]
)
def test_every_scene_has_the_eye_and_keeps_the_trails(tmp_path: Path, eye: Eye | None) -> None:
    shown = [ANSWERS, PREDICTED, IMPACTS, CONTACTS, POINSOT]
    _, paths = names_and_paths(tmp_path, eye=eye, shown=shown)
    scenes = 4  # of the overview and of three pages
    poinsots = 2  # of the overview and of the flight
    assert sum("EyeControls3D" in path for path in paths) == (scenes if eye else 0) + poinsots
    for name in ("brick", "arm/tool 1"):
        assert sum(f"overrides/{trail_entity(name)}/" in path for path in paths) == scenes
        hidden = {
            path for path in paths if "overrides/" in path and f"{contacts_entity(name)}/mode_2" in path
        }
        assert len(hidden) == 2  # in the overview and among the contact modes; other scenes have no contacts


def names_and_paths(
    folder: Path, *, eye: Eye | None, shown: list[str]
) -> tuple[dict[str, list[str]], list[str]]:
    """The names of views and containers in an arrangement's file, and the paths of all that is in it."""
    path = folder / "views.rbl"
    make_blueprint(["brick", "arm/tool 1"], eye=eye, shown=shown).save("test", path)
    (entry,) = RrdReader(path).blueprints()
    names: dict[str, list[str]] = {"ViewBlueprint": [], "ContainerBlueprint": []}
    paths: list[str] = []
    for chunk in RrdReader(path).stream(store=entry):
        batch = chunk.to_record_batch()
        paths.append(str(chunk.entity_path))
        for kind, found in names.items():
            if f"{kind}:display_name" in batch.schema.names:
                rows = batch.column(f"{kind}:display_name").to_pylist()
                found += [name for row in rows if row for name in row]
    return names, paths


def test_names_may_hold_any_characters() -> None:
    assert entity("world/bodies", "arm/tool 1") == r"world/bodies/arm\/tool\ 1"
