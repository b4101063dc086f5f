"""The whole picture of a world and of what is asked about it, drawn into one recording as it happens."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from contact_dynamics.constants import ns_after, to_ns
from contact_dynamics.diagrams.planar_scene import silhouette
from contact_dynamics.diagrams.shape import Shape, drawn_shape
from contact_dynamics.diagrams.words import (
    CONTACT_MODE,
    IMPACT,
    TUMBLING,
    contact_modes_in_words,
    impact_in_words,
    tumbling_in_words,
)
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.tumbling.regime import Regime
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
from contact_dynamics.viewing.planar_modes import draw_planar_map, draw_planar_modes
from contact_dynamics.viewing.poinsot import (
    clear_poinsot,
    count_of_flight,
    draw_poinsot,
    draw_rolling,
)
from contact_dynamics.viewing.scene import draw_axes, draw_body, draw_obstacle, draw_surface
from contact_dynamics.viewing.trajectory import draw_trajectory
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.planar_modes import AnswersMap
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact import ImpactAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.tumbling.poinsot_construction import Poinsot
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Prediction:
    begin_ns: int
    trajectory: Trajectory


class Picture:
    """Draws states and answers into a recording. An unknown body is drawn without shape.

    Answers may come from a live server, from its log, or from a question asked in Python.
    """

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
        self._map: AnswersMap | None = None
        self._rolling: dict[str, Poinsot] = {}  # bodies whose predicted flight still goes on
        self._framed = False
        self._eye: Eye | None = None
        self._diagrams: set[str] = set()  # the diagrams that have been drawn
        self._recent: deque[tuple[int, FloatArray]] = (
            deque()
        )  # stamp, ns, position, m, of the last `WINDOW_S`
        gravity = float(np.linalg.norm(world.gravity_W))
        self._up_W = -world.gravity_W / gravity if gravity > 0.0 else np.array([0.0, 0.0, 1.0])
        self._draw_scene()

    def add_states(self, body_name: str, states: Sequence[BodyState]) -> None:
        """Draw measured states, in the order of their stamps."""
        if not states:
            return
        before = self._newest.get(body_name)
        if before is None:  # it was not in the picture before
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

    def show_tumbling(
        self,
        answer: TumblingAnswer,
        *,
        now_ns: int = 0,
        remark: str = "",
        computation_time: float | None = None,
    ) -> None:
        """Draw where a body was predicted to be, with what certainty, and Poinsot's picture if it has curves.

        Args:
            answer: The answer.
            now_ns: ns, the time of the picture if the answer's state has no stamp.
            remark: A remark that is added to the answer's words.
            computation_time: s, how long the answer took, or None if that is not known.
        """
        stamp_ns = answer.state.stamp_ns or now_ns
        name, trajectory, rotation = answer.body_name, answer.trajectory, answer.poinsot
        set_time(self._recording, stamp_ns)
        draw_trajectory(self._recording, name, self._shape(name), trajectory, covariance=answer.covariance)
        self._predictions[name] = _Prediction(begin_ns=stamp_ns, trajectory=trajectory)
        if len(trajectory) > 0 and not self._framed:
            self._framed = True
            self._look_at(trajectory.p_WB_W)  # after that the view belongs to the user
        if rotation is not None and answer.curves is not None and rotation.regime is not Regime.AT_REST:
            draw_poinsot(self._recording, name, rotation, answer.curves)
            draw_rolling(self._recording, name, [replace(answer.state, stamp_ns=stamp_ns)])
            self._rolling[name] = rotation
            self._bring_up(POINSOT)
        words = tumbling_in_words(answer)
        self._tell_answer(TUMBLING, name, words, remark, computation_time, stamp_ns=stamp_ns)

    def show_impact(
        self,
        answer: ImpactAnswer,
        *,
        now_ns: int = 0,
        remark: str = "",
        computation_time: float | None = None,
    ) -> None:
        """Draw an impact in the scene and in impulse space, at the time of the state it was predicted from.

        Arguments are those of `show_tumbling`.
        """
        stamp_ns, name, other = answer.state.stamp_ns, answer.body_name, answer.other
        stamp_ns = ns_after(stamp_ns, -answer.seconds_to_contact) if stamp_ns else now_ns
        set_time(self._recording, stamp_ns)
        other_shape = self._shape(other.name) if other is not None and other.name else None
        draw_impact(self._recording, self._shape(name), answer, other_shape=other_shape)
        if len(answer.impact.path_W) > 0:
            draw_impulse_space(
                self._recording,
                self._mass_properties(name),
                answer,
                other=self._mass_properties(other.name) if other is not None else None,
            )
            self._bring_up(IMPULSE_SPACE)
        words = impact_in_words(answer)
        self._tell_answer(IMPACT, name, words, remark, computation_time, stamp_ns=stamp_ns)

    def show_contact_modes(
        self,
        answer: ContactModeAnswer,
        *,
        now_ns: int = 0,
        remark: str = "",
        computation_time: float | None = None,
    ) -> None:
        """Draw an answer about contact modes in the scene, and in 2D if it has a plane of motion.

        Arguments are those of `show_tumbling`.
        """
        stamp_ns, name, plane = answer.state.stamp_ns or now_ns, answer.body_name, answer.plane
        set_time(self._recording, stamp_ns)
        shape = self._shape(name)
        draw_contact_modes(self._recording, shape, answer)
        if plane is not None:
            outline = silhouette(shape, plane.axes_W @ answer.state.R_WB)
            draw_planar_modes(self._recording, answer, plane, outline=outline)
            body = self._mass_properties(name)
            self._map = draw_planar_map(self._recording, answer, plane, self._map, body=body)
            self._bring_up(PLANAR_MODES, *([MODE_MAP] if answer.wrench_sets else []))
        words = contact_modes_in_words(answer)
        self._tell_answer(CONTACT_MODE, name, words, remark, computation_time, stamp_ns=stamp_ns)

    def tell(self, kind: str, text: str, *, stamp_ns: int, is_error: bool = False) -> None:
        """Write an answer in words, both into the list of all answers and as the newest of its kind."""
        set_time(self._recording, stamp_ns)
        self._told_ns = stamp_ns
        level = rr.TextLogLevel.WARN if is_error else rr.TextLogLevel.INFO
        self._recording.log(ANSWER_LOG, rr.TextLog(f"{kind}: {text}", level=level))
        self._answers[kind] = text
        document = "\n\n".join(f"**{kind}**: {newest}" for kind, newest in self._answers.items())
        self._recording.log(NEWEST_ANSWERS, rr.TextDocument(document, media_type=rr.MediaType.MARKDOWN))

    def frame_all(self) -> None:
        """Make the view show all that is there at the end, for the user who opens the file."""
        if self._recent:
            self._look_at(np.array([p_WB_W for _, p_WB_W in self._recent]))

    def newest_stamp_ns(self) -> int | None:
        """Return the stamp of the newest measured state, or else of the last answer, if there is either."""
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

    def _tell_answer(
        self,
        kind: str,
        body_name: str,
        words: list[str],
        remark: str,
        computation_time: float | None,
        *,
        stamp_ns: int,
    ) -> None:
        said = [*words, remark] if remark else words
        took = "" if computation_time is None else f" ({computation_time * 1e3:.2g} ms)"
        self.tell(kind, f"{body_name or 'a body'} {'; '.join(said)}{took}", stamp_ns=stamp_ns)

    def _mass_properties(self, body_name: str) -> MassProperties | None:
        """Return the mass properties of a body of the world, or None if the body is not known."""
        known = (body.mass_properties for body in self._world.bodies if body.name == body_name)
        return next(known, None)

    def _shape(self, body_name: str) -> Shape:
        if body_name not in self._shapes:
            self._shapes[body_name] = drawn_shape(NO_SHAPE)
        return self._shapes[body_name]

    def _look_at(self, points_W: FloatArray) -> None:
        """Turn the view towards a path, and put the ground below it."""
        center = 0.5 * (points_W.min(axis=0) + points_W.max(axis=0))
        for surface in self._world.surfaces:
            if isinstance(surface, Surface):
                draw_surface(self._recording, surface, center_W=center, side=self._surface_side)
        margin = max((shape.size for shape in self._shapes.values()), default=0.0)
        self._eye = eye_on(points_W, up_W=self._up_W, margin=margin)
        self._arrange()

    def _bring_up(self, *diagrams: str) -> None:
        """Add a tab for each diagram that is drawn for the first time."""
        if not self._diagrams.issuperset(diagrams):
            self._diagrams.update(diagrams)
            self._arrange()

    def _arrange(self) -> None:
        blueprint = make_blueprint(list(self._shapes), eye=self._eye, diagrams=sorted(self._diagrams))
        self._recording.send_blueprint(blueprint)
