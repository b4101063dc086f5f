# SPDX-License-Identifier: Apache-2.0
"""Answers to draw, whose numbers a test chooses."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import ModeVerdict, SpatialMode
from contact_dynamics.impact import PathEvent, ResolvedImpact, RestitutionLaw, SeveralContactsLaw
from contact_dynamics.motion.integrated import Method
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import ContactModeAnswer, ImpactAnswer, NamedState, Problem, TumblingAnswer
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tumbling import Trajectory
from contact_dynamics.validation import FloatArray


def tumbling_answer(
    state: BodyState, trajectory: Trajectory, *, body_name: str = "brick", **told: Any
) -> TumblingAnswer:
    """A trajectory, and of the rotation what ``told`` says."""
    nothing: dict[str, Any] = dict.fromkeys(("fit", "covariance", "event", "poinsot", "flips", "curves"))
    return TumblingAnswer(
        body_name=body_name,
        p_FB_F=np.zeros(3),
        state=state,
        trajectory=trajectory,
        method=Method.CLOSED_FORM,
        **{**nothing, **told},
    )


def impact_answer(
    state: BodyState,
    contacts: ContactSet,
    *,
    impulses_W: FloatArray,
    path_W: FloatArray,
    path_events: tuple[PathEvent, ...],
    path_contacts: tuple[int, ...],
    v_after_W: tuple[float, float, float] = (0.0, 0.0, 0.0),
    plane: PlaneOfMotion | None = None,
    body_name: str = "brick",
) -> ImpactAnswer:
    """An impact of one body with the world; where the pictures do not look, there is nothing."""
    none = np.zeros((0, 3))
    impact = ResolvedImpact(
        restitution_law=RestitutionLaw.POISSON,
        several_contacts_law=SeveralContactsLaw.SEQUENTIAL,
        outcome=None,
        jams=False,
        converged=True,
        states=(replace(state, v_WB_W=np.array(v_after_W)),),
        impulses_W=impulses_W,
        compression_impulses_W=none,
        velocities_before_W=none,
        velocities_after_W=none,
        path_W=path_W,
        path_events=path_events,
        path_contacts=path_contacts,
        kinetic_energy_before=1.0,
        kinetic_energy_after=0.5,
        creates_energy=False,
    )
    return ImpactAnswer(
        body_name=body_name,
        p_FB_F=np.zeros(3),
        state=state,
        fit=None,
        other=None,
        seconds_to_contact=0.0,
        contacts=contacts,
        impact=impact,
        problem=Problem.SPATIAL if plane is None else Problem.PLANAR,
        plane=plane,
        out_of_plane=0.0,
        velocity_tolerance=0.0,
        distance_tolerance=0.0,
    )


def of_two(answer: ImpactAnswer, other: NamedState, *, other_after: BodyState) -> ImpactAnswer:
    """The impact as one with a second moving body."""
    return replace(
        answer, other=other, impact=replace(answer.impact, states=(answer.impact.state, other_after))
    )


def contact_mode_answer(
    state: BodyState,
    contacts: ContactSet,
    *modes: SpatialMode,
    plane: PlaneOfMotion | None = None,
    body_name: str = "brick",
) -> ContactModeAnswer:
    """These modes, and nothing else that can be asked for."""
    return ContactModeAnswer(
        body_name=body_name,
        p_FB_F=np.zeros(3),
        state=state,
        contacts=contacts,
        verdict=ModeVerdict.INDETERMINATE if modes else ModeVerdict.INCONSISTENT,
        modes=modes,
        margins=None,
        approaching=(),
        contact_velocities_W=np.zeros((len(contacts), 3)),
        refused=(),
        kinematic_modes=(),
        wrench_sets=None,
        statics=None,
        settled=None,
        problem=Problem.SPATIAL if plane is None else Problem.PLANAR,
        plane=plane,
        out_of_plane=math.nan,
        out_of_plane_reason="",
        velocity_tolerance=0.0,
        acceleration_tolerance=0.0,
        distance_tolerance=0.0,
        friction_facets=0,
        wrench_facets=0,
    )
