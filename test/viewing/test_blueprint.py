# SPDX-License-Identifier: Apache-2.0
"""Arrangements of views, where they look, what they cost when many are sent, and colours."""

from __future__ import annotations

from itertools import combinations, permutations
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.palette import LEAST_DIFFERENCE, Color
from contact_dynamics.viewing.blueprint import (
    COLORS_IN_WORDS,
    DIAGRAMS,
    FAR,
    LOWEST_DISTANCE,
    Eye,
    Framing,
    eye_on,
    make_blueprint,
    near_most,
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
    TRAILS,
    entity,
)
from contact_dynamics.viewing.kept_recording import KeptRecording
from plots.test_every_diagram import difference

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
        [*OVERVIEW, *TOLD, "Impact", SPEED, "Newest answers", *2 * ["Impulse space", "Impulse space in 3-D"]],
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
        assert sum(f"overrides/{entity(TRAILS, name)}/" in path for path in paths) == scenes
        hidden = {
            path for path in paths if "overrides/" in path and f"{entity(CONTACTS, name)}/mode_2" in path
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


COUNT = 20


def threads() -> int:
    """How many threads this process has."""
    return len(list(Path("/proc/self/task").iterdir()))


def test_further_arrangements_cost_no_threads(tmp_path: Path) -> None:
    """With `rr.send_blueprint` there were two more after each."""
    recording = KeptRecording()
    recording.open(rr.FileSink(tmp_path / "picture.rrd", write_footer=False))
    recording.send_blueprint(make_blueprint(["brick"], eye=None, shown=set()))
    before = threads()
    for number in range(COUNT):
        recording.send_blueprint(make_blueprint([f"brick_{number}"], eye=None, shown=set()))
    assert threads() < before + COUNT // 2
    recording.disconnect()


def test_each_place_gets_the_newest_arrangement(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    """All are one blueprint of rerun's, so that a viewer shows the newest and keeps no others beside it."""
    paths = [tmp_path / "early.rrd", tmp_path / "late.rrd"]
    recording = KeptRecording()
    recording.open(rr.FileSink(paths[0], write_footer=False))
    for number in range(3):
        recording.send_blueprint(make_blueprint([f"brick_{number}"], eye=None, shown=set()))
    recording.open(rr.FileSink(paths[1], write_footer=False))
    recording.disconnect()
    early, late = (RrdReader(path).blueprints() for path in paths)
    assert len(early) == len(late) == 1
    assert early[0].recording_id == late[0].recording_id
    recwarn.clear()  # files without an index are read whole


PATH = np.column_stack([np.linspace(0.0, 0.3, 20), np.zeros(20), np.linspace(1.0, 0.0, 20) ** 2])
MARGIN = 0.2
EXTENT = float(np.linalg.norm(np.ptp(PATH, axis=0) + MARGIN))
HALF_VIEW = np.radians(55.0 / 2)  # the viewer's field of view is 55 degrees or wider


def is_seen(eye: Eye, p_W: np.ndarray) -> bool:
    ahead, to = eye.target_W - eye.position_W, p_W - eye.position_W
    return bool(ahead @ to > np.cos(HALF_VIEW) * np.linalg.norm(ahead) * np.linalg.norm(to))


@pytest.mark.parametrize("distance", np.geomspace(1e-6, 1e4, 41))
@pytest.mark.parametrize("direction", [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.64, 0.48]])
def test_a_body_near_the_path_is_seen_whether_it_comes_before_or_after_the_prediction(
    distance: float, direction: list[float]
) -> None:
    place = 0.5 * (PATH[0] + PATH[-1]) + distance * np.array(direction)
    known = Framing(UP)
    assert known.add_body("other", place) is None  # there is nothing to look at yet
    eye = known.turn_to(PATH, margin=MARGIN)
    alone = Framing(UP)
    first = alone.turn_to(PATH, margin=MARGIN)
    later = alone.add_body("other", place)
    if distance < 0.99 * FAR * EXTENT:
        assert is_seen(eye, place)
        assert is_seen(first if later is None else later, place)
    elif distance > 1.01 * FAR * EXTENT:
        assert later is None  # the path could not be made out
        np.testing.assert_array_equal(eye.position_W, first.position_W)
    assert all(is_seen(eye, p_W) for p_W in PATH)


def test_the_order_in_which_bodies_come_does_not_matter() -> None:
    places = {"a": [0.5, 0.0, 0.3], "b": [0.0, 1.0, 0.3], "c": [2.0, 1.5, 0.3], "path": None}
    centers = []
    for names in permutations(places):
        framing = Framing(UP)
        for name in names:
            place = places[name]
            if place is None:
                framing.turn_to(PATH, margin=MARGIN)
            else:
                framing.add_body(name, np.array(place))
        centers.append(framing.center_W)
    np.testing.assert_allclose(centers, np.tile(centers[0], (len(centers), 1)))


def test_the_view_stays_when_a_body_comes_that_is_in_sight() -> None:
    framing = Framing(UP)
    framing.turn_to(PATH, margin=MARGIN)
    assert framing.add_body("other", PATH[7] + 0.5 * MARGIN) is None


@pytest.mark.parametrize("far", [1e3, 1e15, 1e160, 1e300])
def test_one_body_far_away_does_not_take_the_view_from_all_others(far: float) -> None:
    bodies = np.vstack(
        [PATH + np.array(aside) for aside in ([0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 2.0, 0.0])]
    )
    lost = np.full((10, 3), far)
    np.testing.assert_array_equal(near_most(np.vstack([bodies, lost])), bodies)
    np.testing.assert_array_equal(near_most(bodies), bodies)
    np.testing.assert_array_equal(near_most(lost), lost)


def test_a_single_point_without_size_is_looked_at_with_its_neighbours() -> None:
    framing = Framing(UP)
    framing.turn_to(PATH[:1], margin=0.0)
    eye = framing.add_body("other", PATH[0] + [LOWEST_DISTANCE, 0.0, 0.0])
    assert eye is not None
    assert is_seen(eye, PATH[0])


pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")


MEANINGS = {
    "measured": palette.MEASURED,
    "predicted": palette.PREDICTED,
    "impact": palette.IMPACT,
    "before the impact": palette.BEFORE_IMPACT,
    "after the impact": palette.AFTER_IMPACT,
    "friction cone": palette.FRICTION_CONE,
    "separates": palette.SEPARATE,
    "slides": palette.SLIDE,
    "stays fixed": palette.FIXED,
    "normal, undecided": palette.NORMAL,
    "background": palette.BACKGROUND,
}


def apart(one: Color, other: Color) -> float:
    """How much two colours differ, the smaller of what usual eyes and deuteranopes see."""
    return difference(*(tuple(part / 255.0 for part in color[:3]) for color in (one, other)))


@pytest.mark.parametrize(("one", "other"), list(combinations(MEANINGS, 2)))
def test_deuteranopes_tell_apart_what_means_different_things(one: str, other: str) -> None:
    assert apart(MEANINGS[one], MEANINGS[other]) >= LEAST_DIFFERENCE


def test_twenty_bodies_are_told_apart_and_from_what_is_predicted_of_them() -> None:
    assert len(palette.BODIES) == 20
    for one, other in combinations([*palette.BODIES, palette.PREDICTED, palette.IMPACT], 2):
        assert apart(one, other) >= LEAST_DIFFERENCE, (one, other)


@pytest.mark.parametrize("color", [*MEANINGS.values(), *palette.BODIES])
def test_words_can_be_read_on_the_background_and_are_otherwise_left_as_they_are(color: Color) -> None:
    word = palette.readable(color)
    assert palette.contrast(word, palette.BACKGROUND) >= palette.WORD_CONTRAST
    if palette.contrast(color, palette.BACKGROUND) >= palette.WORD_CONTRAST:
        assert word[:3] == color[:3]


def test_contrast_is_that_of_wcag() -> None:
    assert palette.contrast((255, 255, 255, 255), (0, 0, 0, 255)) == pytest.approx(21.0)
    grey = palette.contrast(
        (255, 255, 255, 255), (118, 118, 118, 255)
    )  # the darkest grey of level AA on white
    assert grey == pytest.approx(4.54, abs=0.005)
