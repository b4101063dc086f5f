# SPDX-License-Identifier: Apache-2.0
"""What the physics returns is drawn as it is, without a second type."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import contact_dynamics as cd
from contact_dynamics import plots
from contact_dynamics.contact_modes import PlanarModeAnswer, SpatialModeAnswer
from contact_dynamics.toss import Toss

CUBE = cd.Body.box((0.1, 0.1, 0.1), 0.37)
FLOOR = cd.Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.45)
WORLD = cd.World(bodies=(CUBE,), surfaces=(FLOOR,))
RESTING = cd.BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1])
PROBLEM = cd.SpatialContactProblem(
    body=CUBE, state=RESTING, contacts=cd.find_contacts(CUBE, RESTING, WORLD), force_W=[0.5, 0, -3.6]
)
FEET = [cd.PlanarContact(r=(x, -0.1), normal=(0, 1), friction=0.3) for x in (-0.1, 0.1)]
FLAT = cd.PlanarContactProblem(
    body=cd.PlanarBody(mass=1.0, inertia=0.1), contacts=FEET, wrench=cd.PlanarWrench(f=(1.0, -9.8))
)


def tossed(max_alternatives: int) -> Toss:
    state = cd.BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1], v_WB_W=[0.3, 0, 0])
    return cd.toss(CUBE, state, WORLD, max_alternatives=max_alternatives)


def test_a_toss_is_drawn_from_its_first_state_to_rest_and_saved(tmp_path: Path) -> None:
    went = tossed(1)
    figure = plots.toss(went, CUBE)
    side, top = figure.axes
    lines = {line.get_gid(): line for line in side.lines}
    assert {"path", "other_ways"} <= lines.keys()  # the other way that was followed
    ghosts = np.array([each for each in lines["ghosts"].get_xydata() if np.isfinite(each).all()])
    assert [ghosts[:, 0].min(), ghosts[:, 1].max()] == pytest.approx([-0.05, 0.35])  # the cube at first
    figure.draw_without_rendering()
    of_side, of_top = (axes.transData.transform([[0, 0], [1, 1]]) for axes in (side, top))
    assert np.ptp(of_side, axis=0) == pytest.approx(np.ptp(of_top, axis=0))  # one scale in both views
    assert np.ptp(of_side[:, 0]) == pytest.approx(np.ptp(of_side[:, 1]))
    across, up = lines["path"].get_xdata(), lines["path"].get_ydata()
    assert (across[0], up[0]) == pytest.approx((0.0, 0.3))
    assert (across[-1], up[-1]) == pytest.approx(tuple(went.state.p_WB_W[[0, 2]]))
    assert (side.get_ylabel(), top.get_ylabel()) == ("z, m", "y, m")
    assert figure.get_suptitle() == f"Toss: RESTS at {went.seconds:.4g} s"
    assert "at rest" in [text.get_text() for text in side.get_legend().get_texts()]
    samples = cd.sampled_toss(CUBE, went.state_at(0.0), WORLD, count=2, strikes=1)
    drawn = {line.get_gid() for line in plots.toss(went, CUBE, distribution=samples).axes[0].lines}
    assert drawn - lines.keys() == {"samples/ways"}
    plots.save_figure(figure, str(tmp_path / "toss.svg"))
    assert "strikes" in (tmp_path / "toss.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize("problem", [PROBLEM, FLAT])
def test_modes_are_drawn_with_their_words(
    problem: cd.SpatialContactProblem | cd.PlanarContactProblem,
) -> None:
    answer: PlanarModeAnswer | SpatialModeAnswer = cd.contact_modes(problem)
    assert answer.problem is problem
    figure = plots.modes(answer)
    assert [axes.get_title() for axes in figure.axes] == [f"{answer.modes[0].mode}: it stays fixed"]
    assert figure.get_suptitle() == answer.in_short()


def test_an_answer_without_a_mode_is_drawn() -> None:
    falling = cd.PlanarContactProblem(
        body=FLAT.body, velocity=cd.PlanarVelocity(v=(0, -1), w=0), contacts=FEET, wrench=FLAT.wrench
    )
    figure = plots.modes(cd.contact_modes(falling))
    assert [axes.get_title() for axes in figure.axes] == ["IMPACT"]


def test_what_is_no_result_is_refused() -> None:
    with pytest.raises(TypeError, match="answer must be a PlanarModeAnswer or a SpatialModeAnswer"):
        plots.modes(PROBLEM)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="toss must be a Toss"):
        plots.toss(CUBE)  # type: ignore[arg-type]
