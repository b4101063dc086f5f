# SPDX-License-Identifier: Apache-2.0
"""The event tree of a toss: what is drawn is what the distribution says, read back from SVG."""

from __future__ import annotations

import dataclasses
import math
from xml.etree import ElementTree as ET

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")

from pathlib import Path

from matplotlib.figure import Figure

from contact_dynamics import BodyState, RestitutionLaw, Surface, World, sampled_toss
from contact_dynamics.diagrams.toss_scene import MAX_FACES, rest_in_words
from contact_dynamics.plots import draw_event_tree, save_figure
from contact_dynamics.toss import TossDistribution
from plots.drawn_figures import CUBE, SVG_DIGITS, points_in_svg


@pytest.fixture(scope="module")
def told() -> TossDistribution:
    """A cube that is let go nearly upright on an edge, so that either of two corners strikes first."""
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5)
    state = BodyState(
        p_WB_W=[0, 0, 0.1],
        q_WB=[math.sin(math.pi / 8.0), 0, 0, math.cos(math.pi / 8.0)],
        v_WB_W=[0.1, 0, 0],
        w_WB_W=[0, 0.2, 0],
    )
    covariance = np.diag([1e-3] * 3 + [0.02] * 3 + [0.02] * 3 + [0.5] * 3) ** 2
    return sampled_toss(
        CUBE,
        state,
        World(bodies=(CUBE,), surfaces=(floor,)),
        covariance=covariance,
        count=200,
        to_rest=True,
        restitution_law=RestitutionLaw.POISSON,
        horizon=3.0,
    )


def test_the_event_tree_in_svg_is_the_distributions(told: TossDistribution, tmp_path: Path) -> None:
    figure = Figure(figsize=(10.0, 6.0))
    axes = figure.add_subplot()
    draw_event_tree(axes, told)
    save_figure(figure, tmp_path / "tree.svg")
    root = ET.parse(tmp_path / "tree.svg").getroot()
    branches = [branch for branch in told.branches if branch.regions is not None]
    assert sum(branch.strike == 1 for branch in branches) >= 2
    assert sum(branch.strike == 2 for branch in branches) >= 1
    off = SVG_DIGITS * float(np.ptp(axes.get_xlim()))
    means: list[float] = []
    rows: list[float] = []
    for k, branch in enumerate(branches):
        regions = branch.regions
        assert regions is not None
        middle, deviation = regions.seconds.mean[0], math.sqrt(regions.seconds.covariance[0, 0])
        means.append(middle)
        for share, radius in zip(("50", "90"), regions.seconds.radii, strict=True):
            ends = points_in_svg(root, f"time_{share}_{k}", axes)
            expected = [middle - radius * deviation, middle + radius * deviation]
            np.testing.assert_allclose(ends[:, 0], expected, atol=off)
            assert ends[0, 1] == pytest.approx(ends[1, 1], abs=1e-3)
            assert ends[0, 1] == pytest.approx(round(ends[0, 1]), abs=1e-3)
        rows.append(round(ends[0, 1]))
        line = points_in_svg(root, f"branch_{k}", axes)
        parent = -1 if branch.parent < 0 else branches.index(told.branches[branch.parent])
        begins = (0.0, 0.0) if parent < 0 else (means[parent], rows[parent])
        np.testing.assert_allclose(line, [begins, (middle, rows[k])], atol=1e-3)
        assert parent < 0 or rows[k] < rows[parent]
    assert sorted(rows) == list(range(1 - len(rows), 1))
    assert told.rest is not None
    low, quarter, _, three, high = told.rest.seconds
    for gid, ends in (("rest_90", [low, high]), ("rest_50", [quarter, three])):
        np.testing.assert_allclose(points_in_svg(root, gid, axes)[:, 0], ends, atol=off)
    words = "".join(root.itertext())
    for branch in branches:
        assert f"{branch.strike}. corner {branch.corner} strikes: {branch.probability:.0%}" in words
    assert f"next events of {told.samples} samples" in words
    assert "rests on face " in words
    for normal, share in list(zip(told.face_normals_B, told.face_probabilities, strict=True))[:MAX_FACES]:
        axis = int(np.abs(normal).argmax())
        face = f"{'-' if normal[axis] > 0.0 else '+'}{'xyz'[axis]}"  # it lies on the face that looks down
        assert f"{face}: {share:.0%}" in words


def test_a_label_names_the_probable_faces_and_sums_up_the_others(told: TossDistribution) -> None:
    normals = np.vstack([np.eye(3), -np.eye(3)])[:5]
    shares = np.array([0.5, 0.25, 0.125, 0.1, 0.025])
    several = dataclasses.replace(told, face_normals_B=normals, face_probabilities=shares)
    likely, *others = rest_in_words(several).splitlines()
    assert likely == "rests on face -x: 50%"
    assert others == ["-y: 25%, -z: 12%, others: 12%"]
    one = dataclasses.replace(told, face_normals_B=normals[:1], face_probabilities=np.ones(1))
    assert rest_in_words(one) == "rests on face -x: 100%"
