"""The whole picture of a world and of what is asked about it, drawn into one recording as it happens."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from contact_dynamics.constants import to_ns
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.viewing.blueprint import WINDOW_S, Eye, eye_on, make_blueprint
from contact_dynamics.viewing.contact_modes import draw_contact_modes
from contact_dynamics.viewing.entities import (
    ANSWER_LOG,
    IMPULSE_SPACE,
    LEGEND,
    MODE_MAP,
    NEWEST_ANSWERS,
    PLANAR_MODES,
    POINSOT,
)
from contact_dynamics.viewing.impact import draw_impact
from contact_dynamics.viewing.impulse_space import draw_impulse_space
from contact_dynamics.viewing.legend import LEGEND_TEXT
from contact_dynamics.viewing.measured import draw_prediction_at, draw_states, set_time, style_series
from contact_dynamics.viewing.planar_modes import DrawnMap, draw_planar_map, draw_planar_modes, silhouette
from contact_dynamics.viewing.poinsot import (
    clear_poinsot,
    count_of_flight,
    draw_poinsot,
    draw_rolling,
)
from contact_dynamics.viewing.scene import draw_axes, draw_body, draw_obstacle, draw_surface
from contact_dynamics.viewing.shape import Shape, drawn_shape
from contact_dynamics.viewing.trajectory import draw_trajectory
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.contact_modes import ContactModesPicture
    from contact_dynamics.viewing.impact import ImpactPicture
    from contact_dynamics.viewing.planar_modes import PlanarModesPicture
    from contact_dynamics.viewing.poinsot import PoinsotPicture
    from contact_dynamics.viewing.trajectory import PositionUncertainty
    from contact_dynamics.world import Body, World


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Prediction:
    begin_ns: int
    trajectory: Trajectory


class Picture:
    """Draws into a recording. Times are stamps in ns; an unknown body is drawn without shape."""

    def __init__(self, recording: rr.RecordingStream, world: World, *, surface_side: float) -> None:
        """Draw the surfaces, as squares of ``surface_side``, m, and the bodies."""
        self._recording = recording
        self._world = world
        self._surface_side = surface_side
        self._shapes: dict[str, Shape] = {body.name: drawn_shape(body.shape) for body in world.bodies}
        self._newest: dict[str, BodyState] = {}
        self._predictions: dict[str, _Prediction] = {}
        self._answers: dict[str, str] = {}
        self._told_ns: int | None = None  # stamp of the last answer
        self._map: DrawnMap | None = None
        self._rolling: dict[str, PoinsotPicture] = {}  # of the bodies whose flight still goes on
        self._framed = False
        self._eye: Eye | None = None
        self._diagrams: set[str] = set()  # those that have been drawn
        self._recent: deque[tuple[int, FloatArray]] = deque()  # stamps and positions of the last `WINDOW_S`
        gravity = float(np.linalg.norm(world.gravity_W))
        self._up_W = -world.gravity_W / gravity if gravity > 0.0 else np.array([0.0, 0.0, 1.0])
        self._draw_scene()

    def add_states(self, body_name: str, states: Sequence[BodyState]) -> None:
        """Draw measured states, in the order of their stamps."""
        if not states:
            return
        before = self._newest.get(body_name)
        if before is None:  # until now it was nowhere
            draw_body(self._recording, body_name, self._shape(body_name))
        draw_states(self._recording, body_name, states, before=before, up_W=self._up_W)
        prediction = self._predictions.get(body_name)
        if prediction is not None:
            draw_prediction_at(
                self._recording,
                body_name,
                [state.stamp_ns for state in states],
                trajectory=prediction.trajectory,
                begin_ns=prediction.begin_ns,
                up_W=self._up_W,
            )
        if body_name in self._rolling:
            self._roll(body_name, states)
        self._newest[body_name] = states[-1]
        self._recent.extend((state.stamp_ns, state.p_WB_W) for state in states)
        while self._recent[-1][0] - self._recent[0][0] > to_ns(WINDOW_S):
            self._recent.popleft()

    def show_trajectory(
        self,
        body_name: str,
        trajectory: Trajectory,
        *,
        stamp_ns: int,
        uncertainty: PositionUncertainty | None = None,
    ) -> None:
        """Draw where the body was predicted to be from a stamp on, and how surely."""
        set_time(self._recording, stamp_ns)
        shape = self._shape(body_name)
        draw_trajectory(self._recording, body_name, shape, trajectory, uncertainty=uncertainty)
        self._predictions[body_name] = _Prediction(begin_ns=stamp_ns, trajectory=trajectory)
        if len(trajectory) > 0 and not self._framed:
            self._framed = True
            self._look_at(trajectory.p_WB_W)  # later ones leave the view to whoever looks

    def show_poinsot(self, picture: PoinsotPicture, *, state: BodyState, body_name: str) -> None:
        """Draw Poinsot's picture of the rotation that a state began; later ones of the flight roll it on."""
        set_time(self._recording, state.stamp_ns)
        draw_poinsot(self._recording, body_name, picture)
        draw_rolling(self._recording, body_name, [state])
        self._rolling[body_name] = picture
        self._bring_up(POINSOT)

    def show_impact(self, body_name: str, impact: ImpactPicture, *, stamp_ns: int) -> None:
        """Draw a predicted impact in the scene and in impulse space."""
        set_time(self._recording, stamp_ns)
        other = self._shape(impact.other.name) if impact.other is not None and impact.other.name else None
        draw_impact(self._recording, body_name, self._shape(body_name), impact, other_shape=other)
        if len(impact.path_W) > 0:
            draw_impulse_space(
                self._recording,
                self._mass_properties(body_name),
                impact,
                other=self._mass_properties(impact.other.name) if impact.other else None,
            )
            self._bring_up(IMPULSE_SPACE)

    def show_contact_modes(self, body_name: str, modes: ContactModesPicture, *, stamp_ns: int) -> None:
        """Draw an answer about contact modes."""
        set_time(self._recording, stamp_ns)
        draw_contact_modes(self._recording, body_name, self._shape(body_name), modes)

    def show_planar_modes(
        self, body_name: str, modes: PlanarModesPicture, *, axes_B: FloatArray, stamp_ns: int
    ) -> None:
        """Draw a planar answer about contact modes in 2D, seen along two axes, (2, 3), unit, body axes."""
        set_time(self._recording, stamp_ns)
        draw_planar_modes(self._recording, modes, outline=silhouette(self._shape(body_name), axes_B))
        self._map = draw_planar_map(self._recording, modes, self._map)
        self._bring_up(PLANAR_MODES, *([MODE_MAP] if modes.sets else []))

    def body(self, body_name: str) -> Body | None:
        """Return a body of the world; None: it is not known."""
        return next((body for body in self._world.bodies if body.name == body_name), None)

    def tell(self, kind: str, text: str, *, stamp_ns: int, is_error: bool = False) -> None:
        """Write an answer in words: to the log of all, and as the newest one of its kind."""
        set_time(self._recording, stamp_ns)
        self._told_ns = stamp_ns
        level = rr.TextLogLevel.WARN if is_error else rr.TextLogLevel.INFO
        self._recording.log(ANSWER_LOG, rr.TextLog(f"{kind}: {text}", level=level))
        self._answers[kind] = text
        document = "\n\n".join(f"**{kind}**: {newest}" for kind, newest in self._answers.items())
        self._recording.log(NEWEST_ANSWERS, rr.TextDocument(document, media_type=rr.MediaType.MARKDOWN))

    def frame_all(self) -> None:
        """Look at all that is in view at the end, for whoever opens the file."""
        if self._recent:
            self._look_at(np.array([p_WB_W for _, p_WB_W in self._recent]))

    def newest_stamp_ns(self) -> int | None:
        """Return the stamp of the newest measured state; without one that of the last answer, if any."""
        return max((state.stamp_ns for state in self._newest.values()), default=self._told_ns)

    def _draw_scene(self) -> None:
        draw_axes(self._recording, self._up_W)
        for surface in self._world.surfaces:
            if isinstance(surface, Surface):
                draw_surface(self._recording, surface, center_W=surface.p_WS_W, side=self._surface_side)
            else:
                draw_obstacle(self._recording, surface)
        for name in self._shapes:
            style_series(self._recording, name)
        legend = rr.TextDocument(LEGEND_TEXT, media_type=rr.MediaType.MARKDOWN)
        self._recording.log(LEGEND, legend, static=True)
        self._arrange()

    def _roll(self, body_name: str, states: Sequence[BodyState]) -> None:
        count = count_of_flight(self._rolling[body_name], states)
        draw_rolling(self._recording, body_name, states[:count])
        if count < len(states):
            set_time(self._recording, states[count].stamp_ns)
            clear_poinsot(self._recording, body_name)
            del self._rolling[body_name]

    def _mass_properties(self, body_name: str) -> MassProperties | None:
        body = self.body(body_name)
        return None if body is None else body.mass_properties

    def _shape(self, body_name: str) -> Shape:
        if body_name not in self._shapes:
            self._shapes[body_name] = drawn_shape(NO_SHAPE)
        return self._shapes[body_name]

    def _look_at(self, points_W: FloatArray) -> None:
        """Look at a path, and put the ground below it."""
        center = 0.5 * (points_W.min(axis=0) + points_W.max(axis=0))
        for surface in self._world.surfaces:
            if isinstance(surface, Surface):
                draw_surface(self._recording, surface, center_W=center, side=self._surface_side)
        margin = max((shape.size for shape in self._shapes.values()), default=0.0)
        self._eye = eye_on(points_W, up_W=self._up_W, margin=margin)
        self._arrange()

    def _bring_up(self, *diagrams: str) -> None:
        """Give diagrams that are drawn for the first time a tab."""
        if not self._diagrams.issuperset(diagrams):
            self._diagrams.update(diagrams)
            self._arrange()

    def _arrange(self) -> None:
        blueprint = make_blueprint(list(self._shapes), eye=self._eye, diagrams=sorted(self._diagrams))
        self._recording.send_blueprint(blueprint)
