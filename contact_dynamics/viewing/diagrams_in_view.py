"""Draws the diagrams of answers beside the scene, and remembers which of them are in view."""

from __future__ import annotations

from typing import TYPE_CHECKING

import rerun as rr

from contact_dynamics.diagrams.impulse_space import impulse_space, impulse_space_in_3d
from contact_dynamics.diagrams.planar_modes import applied_of
from contact_dynamics.viewing.drawing import draw_diagram
from contact_dynamics.viewing.entities import (
    FORCE_DUAL,
    IMPULSE_SPACE,
    IMPULSE_SPACE_IN_3D,
    MODE_MAP,
    PLANAR_MODES,
)
from contact_dynamics.viewing.planar_dual import draw_planar_dual
from contact_dynamics.viewing.planar_modes import draw_planar_map, draw_planar_modes

if TYPE_CHECKING:
    from contact_dynamics.diagrams.planar_modes import AnswersMap
    from contact_dynamics.plane.projection import PlaneOfMotion
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.planar_dual import DualInView


class DiagramsInView:
    """The diagrams of the newest answers. Each method draws at the recording's current time."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._map: AnswersMap | None = None
        self._dual: DualInView | None = None
        self._in_3d = False

    def draw_impact(
        self, answer: ImpactAnswer, *, body: MassProperties | None, other: MassProperties | None
    ) -> list[str]:
        """Draw an impact in impulse space, in 3-D too if it is not planar, and return what there is to see.

        Args:
            answer: The impact.
            body: Mass properties of the body, or None if they are not known.
            other: Those of the body that is struck, or None.
        """
        if len(answer.impact.path_W) == 0:
            return []
        draw_diagram(self._recording, impulse_space(body, answer, other=other), IMPULSE_SPACE)
        if answer.plane is None:
            self._in_3d = True
            in_3d = impulse_space_in_3d(body, answer, other=other)
            draw_diagram(self._recording, in_3d, IMPULSE_SPACE_IN_3D)
            return [IMPULSE_SPACE, IMPULSE_SPACE_IN_3D]
        if self._in_3d:  # that of an impact before
            self._in_3d = False
            self._recording.log(IMPULSE_SPACE_IN_3D, rr.Clear(recursive=True))
        return [IMPULSE_SPACE]

    def draw_planar_modes(
        self,
        answer: ContactModeAnswer,
        plane: PlaneOfMotion,
        *,
        outline: FloatArray,
        body: MassProperties | None,
    ) -> list[str]:
        """Draw the modes of a planar answer, their map and the force dual, and return what there is to see.

        Args:
            answer: The answer, in world axes.
            plane: The plane of motion.
            outline: Outline of the body, a closed strip, (k, 2), m from the centre of mass. It may be empty.
            body: Mass properties of the body, or None if they are not known.
        """
        draw_planar_modes(self._recording, answer, plane, outline=outline)
        self._map = draw_planar_map(self._recording, answer, plane, self._map, body=body)
        self._dual = draw_planar_dual(
            self._recording,
            answer,
            plane,
            self._dual,
            shown=self._map,
            applied=applied_of(answer, plane, body),
            outline=outline,
        )
        maps = [MODE_MAP] if answer.wrench_sets else []
        duals = [] if self._dual is None else [FORCE_DUAL]
        return [PLANAR_MODES, *maps, *duals]
