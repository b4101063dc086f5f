# SPDX-License-Identifier: Apache-2.0
"""Numbers drawn are the numbers of the result, read back from the artists and from SVG."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")

from pathlib import Path

from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes, mode_margins
from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.impulse_space import impulse_space_in_3d
from contact_dynamics.diagrams.many_states import ARROW_SECONDS
from contact_dynamics.impact.law import ImpactOutcome
from contact_dynamics.plane.types import PlanarWrench
from contact_dynamics.plots import draw_impulse_space, draw_many_states, save_figure
from contact_dynamics.rigid_body.body import kinetic_energy, rotational_energy
from plots.drawn_figures import (
    APPLIED,
    BRICK,
    DIRECTIONS,
    GRAVITY_W,
    IN_TRAY,
    KEY,
    ROD,
    SVG_DIGITS,
    TRAY,
    curve,
    drawn,
    impact,
    many_impacts,
    points_in_svg,
    resting,
    tumbling,
)

ROUNDING = 1e-12  # relative; a sum in another order


def test_the_path_in_three_dimensions_is_the_diagrams() -> None:
    marks: dict[str, Any] = {
        mark.name: mark for mark in impulse_space_in_3d(ROD, impact(in_plane=False)).marks
    }
    _, axes = drawn("impulse space in 3D")
    lines = {line.get_gid(): np.column_stack(line.get_data_3d()) for line in axes.lines}
    np.testing.assert_array_equal(lines["path"], marks["path"].strips[0])
    np.testing.assert_array_equal(lines["event_0"], marks["event_0"].places)
    rings = np.array_split(lines["friction_cone"], np.flatnonzero(np.isnan(lines["friction_cone"][:, 0])))
    np.testing.assert_array_equal(rings[0], marks["friction_cone"].strips[0])


def test_a_projection_is_called_one() -> None:
    _, in_plane = drawn("impulse space in the plane")
    _, in_space = drawn("impulse space")
    words = [[text.get_text() for text in axes.get_legend().texts] for axes in (in_plane, in_space)]
    assert not any("projected" in text for text in words[0])
    assert sum("projected" in text for text in words[1]) == 2
    assert sum("cut" in text for text in words[1]) == 1


def test_curves_over_time_are_the_trajectorys() -> None:
    answer = tumbling()
    trajectory = answer.trajectory
    for name, gid, rows in (
        ("position", "position", trajectory.p_WB_W),
        ("attitude", "orientation", trajectory.q_WB),
        ("velocity", "velocity", trajectory.v_WB_W),
        ("angular velocity", "angular_velocity", trajectory.w_WB_W),
        ("momentum", "momentum", BRICK.mass * trajectory.v_WB_W),
    ):
        _, axes = drawn(name)
        for i, component in enumerate("xyzw"[: rows.shape[1]]):
            points = curve(axes, f"{gid}_{component}")
            assert np.array_equal(points, np.column_stack([trajectory.seconds, rows[:, i]])), (
                name,
                component,
            )


def test_energies_and_momenta_are_the_states() -> None:
    answer = tumbling()
    _, axes = drawn("energy")
    energies = {
        name: curve(axes, f"energy_{name}")[:, 1] for name in ("translation", "rotation", "potential", "sum")
    }
    assert energies["rotation"][0] == pytest.approx(rotational_energy(BRICK, answer.state), rel=ROUNDING)
    kinetic = energies["rotation"][0] + energies["translation"][0]
    assert kinetic == pytest.approx(kinetic_energy(BRICK, answer.state), rel=ROUNDING)
    assert energies["potential"][0] == pytest.approx(-BRICK.mass * GRAVITY_W @ answer.state.p_WB_W)
    np.testing.assert_allclose(energies["sum"], energies["sum"][0], rtol=1e-9)  # a free flight keeps it
    _, axes = drawn("angular momentum")
    assert answer.poinsot is not None
    for i, name in enumerate("xyz"):
        momentum = curve(axes, f"angular_momentum_{name}")[:, 1]
        np.testing.assert_allclose(momentum, answer.poinsot.L_W[i], rtol=1e-9, atol=1e-12)


def test_bands_are_two_deviations_wide() -> None:
    answer = tumbling()
    assert answer.covariance is not None
    _, axes = drawn("position")
    bands = [each for each in axes.collections if isinstance(each, PolyCollection)]
    assert len(bands) == 3
    for i, band in enumerate(bands):
        heights = band.get_paths()[0].vertices[:, 1]
        last = answer.trajectory.p_WB_W[-1, i], 2.0 * np.sqrt(answer.covariance.covariances[-1, i, i])
        assert np.min(np.abs(heights - (last[0] + last[1]))) < ROUNDING
        assert np.min(np.abs(heights - (last[0] - last[1]))) < ROUNDING


def test_forces_of_a_planar_scene_stand_in_their_cones_and_in_the_legend() -> None:
    (mode,) = contact_modes(IN_TRAY).modes
    _, axes = drawn("planar scene")
    (arrows,) = (each for each in axes.collections if each.get_gid() == "forces")
    pressing = [i for i, (_, normal) in enumerate(mode.contact_forces) if normal > 0.0]
    vectors = np.column_stack([arrows.U, arrows.V])
    assert len(vectors) == len(pressing) > 0
    words = "\n".join(text.get_text() for text in axes.get_legend().texts)
    for i, vector in zip(pressing, vectors, strict=True):
        contact, (along, up) = TRAY[i], mode.contact_forces[i]
        assert vector @ contact.tangent / (vector @ contact.normal) == pytest.approx(along / up)
        assert abs(vector @ contact.tangent) <= (contact.friction + 1e-9) * (vector @ contact.normal)
        assert f"  {i + 1}: {np.hypot(along, up):.3g} N\n" in words + "\n"


def test_contact_forces_are_the_modes() -> None:
    answer = resting(in_plane=False)
    _, axes = drawn("contact forces")
    for i, force_W in enumerate(answer.modes[0].contact_forces_W):
        ((friction, normal),) = curve(axes, f"contact_{i + 1}")
        assert normal == pytest.approx(force_W[2])
        assert friction == pytest.approx(float(np.hypot(*force_W[:2])))


def test_the_map_has_the_colours_of_the_modes_and_marks_the_wrench() -> None:
    _, axes = drawn("map of modes")
    pixels = axes.images[0].get_array()
    legend = axes.get_legend()
    entries = {
        text.get_text(): tuple(handle.get_facecolor()[:3])
        for text, handle in zip(legend.texts, legend.legend_handles, strict=True)
        if hasattr(handle, "get_facecolor")
    }
    wrenches, shown = DIRECTIONS.wrenches()
    checked = 0
    for row, column in np.random.default_rng(1).permutation(np.argwhere(shown))[:60]:
        f_x, f_y, moment = wrenches[row, column].tolist()
        wrench = PlanarWrench(f=(f_x, f_y), moment=moment)
        modes = contact_modes(PlanarContactProblem(body=KEY, contacts=TRAY, wrench=wrench)).modes
        if len(modes) == 1:
            assert tuple(pixels[row, column]) == entries[modes[0].mode]
            checked += 1
        else:
            assert tuple(pixels[row, column]) == to_rgb(colors.SEVERAL)
    assert checked > 30
    places, _ = DIRECTIONS.place(np.array([[*APPLIED.f, APPLIED.moment]]))
    np.testing.assert_array_equal(curve(axes, "applied"), places)
    (margin,) = mode_margins(IN_TRAY, contact_modes(IN_TRAY))
    change = np.array([*margin.change.f, margin.change.moment])
    end = np.array([*APPLIED.f, APPLIED.moment]) + change
    np.testing.assert_allclose(curve(axes, "applied/way_out")[-1], DIRECTIONS.place(end[None])[0][0])


def test_the_herpolhode_lies_in_the_plane_and_the_polhode_touches_it_at_the_angular_velocity() -> None:
    answer = tumbling()
    assert answer.poinsot is not None
    _, axes = drawn("Poinsot")
    curves = {line.get_gid(): np.array(line.get_data_3d()).T for line in axes.lines if line.get_gid()}
    np.testing.assert_allclose(
        curves["herpolhode"][:, 2], -answer.poinsot.invariable_plane_distance, rtol=1e-9
    )
    (arrow,) = (each for each in axes.collections if each.get_gid() == "angular_velocity")
    ends = np.vstack(arrow._segments3d)
    tip = ends[np.linalg.norm(ends, axis=1).argmax()]
    assert np.linalg.norm(tip) == pytest.approx(np.linalg.norm(answer.state.w_WB_W))
    curves["polhode"] = curves.pop("body/polhode")
    for name in ("polhode", "herpolhode"):  # it ends where both curves touch at this moment
        steps = np.linalg.norm(np.diff(curves[name], axis=0), axis=1)
        assert np.linalg.norm(curves[name] - tip, axis=1).min() <= steps.max(), name


def test_numbers_in_svg_are_those_of_the_result(tmp_path: Path) -> None:
    answer = impact(in_plane=True)
    figure = Figure(figsize=(8.0, 4.6))
    axes = figure.add_subplot()
    draw_impulse_space(axes, ROD, answer)
    save_figure(figure, tmp_path / "impulse.svg")
    again = tmp_path / "again"
    again.mkdir()
    save_figure(figure, again / "impulse.svg")
    assert (tmp_path / "impulse.svg").read_bytes() == (again / "impulse.svg").read_bytes()
    root = ET.parse(tmp_path / "impulse.svg").getroot()
    impulses = points_in_svg(root, "path", axes)
    width = float(np.ptp(axes.get_xlim()))
    tangents = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(impulses, answer.impact.path_W @ tangents.T, atol=SVG_DIGITS * width)
    words = "".join(root.itertext())
    assert "compression ends" in words
    assert f"μ = {0.6:.3g}" in words


def test_states_of_many_stand_where_they_are_and_in_the_group_of_their_outcome() -> None:
    answer = many_impacts()
    axes = Figure().add_subplot()
    draw_many_states(axes, answer)
    groups = {each.get_gid(): np.column_stack(each.get_data()) for each in axes.lines}
    (arrows,) = (each for each in axes.collections if each.get_gid() == "velocities")
    expected = ARROW_SECONDS * answer.states.v_WB_W[:, [0, 2]]
    np.testing.assert_array_equal(np.column_stack([arrows.U, arrows.V]), expected)
    np.testing.assert_array_equal(
        groups["states/separates"], answer.states.p_WB_W[answer.separates][:, [0, 2]]
    )
    slides = (answer.outcomes == ImpactOutcome.SLIDES) & ~answer.separates
    assert slides.any()
    np.testing.assert_array_equal(groups["states/slides"], answer.states.p_WB_W[slides][:, [0, 2]])
