# SPDX-License-Identifier: Apache-2.0
"""Plots a calibration: residuals against noise, and configured values against estimates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import NotSupportedError

if TYPE_CHECKING:
    from pathlib import Path

    from contact_dynamics.calibration.result import Calibration


def write_plots(folder: Path, found: Calibration) -> list[Path]:
    """Draw a calibration into PNG files of a folder, which is made if it is missing.

    Raises:
        NotSupportedError: Matplotlib is not installed.
        OSError: a file cannot be written.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise NotSupportedError("--plots needs matplotlib: pip install '.[plot]'") from None
    folder.mkdir(parents=True, exist_ok=True)
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    parts = ((slice(0, 3), "velocity after an impact, m/s"), (slice(3, 6), "spin after an impact, rad/s"))
    for column, (part, label) in enumerate(parts):
        axes = figure.add_subplot(1, 2, column + 1)
        left = np.sort(np.linalg.norm(found.residuals[:, part], axis=1))
        noise = np.sort(np.linalg.norm(found.residual_stds[:, part], axis=1))
        share = np.linspace(0.0, 1.0, len(left))
        axes.plot(left, share, color="#3f7fb5", label="predicted less measured")
        axes.plot(noise, share, color="#8a8a8a", label="noise of measurement")
        axes.set(xlabel=label, ylabel="share of impacts below", xscale="log")
        axes.legend()
    path = folder / "residuals.png"
    figure.savefig(path, dpi=130)
    return [path, _estimates(folder / "estimates.png", Figure, found)]


def _estimates(path: Path, figure_type: type, found: Calibration) -> Path:
    """Draw the deviations of configured values and of the second way, in standard deviations."""
    known = [each for each in found.estimates if each.determined and each.std > 0.0]
    figure = figure_type(figsize=(7.5, 0.4 * len(known) + 1.6), layout="constrained")
    axes = figure.add_subplot()
    rows = np.arange(len(known))
    axes.axvspan(-1.0, 1.0, color="#d8e4ee", label="estimate, one standard deviation")
    axes.plot(
        [(e.configured - e.value) / e.std for e in known], rows, "o", color="#e08a1e", label="configured"
    )
    axes.plot(
        [(e.by_paths - e.value) / e.std for e in known], rows, "x", color="#3f9b52", label="by trajectories"
    )
    axes.set_yticks(rows, [each.name for each in known])
    axes.set(xlabel="standard deviations from the estimate", xscale="symlog")
    axes.legend(fontsize="small")
    figure.savefig(path, dpi=130)
    return path
