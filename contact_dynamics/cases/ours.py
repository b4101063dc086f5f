# SPDX-License-Identifier: Apache-2.0
"""This package's answers to the cases. `docs/cases.md` shows each function with the imports that it needs."""

from __future__ import annotations

import math

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact import Contact, ContactSet
from contact_dynamics.contact_modes import PlanarContactProblem, SpatialContactProblem, contact_modes
from contact_dynamics.impact import (
    RestitutionLaw,
    SeveralContactsLaw,
    bodies_impact,
    planar_impact,
    spatial_impact,
    spatial_pair_impact,
)
from contact_dynamics.landing import next_landing
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.rigid_body import BodyState, MassProperties, inertia, kinetic_energy
from contact_dynamics.shapes import sphere
from contact_dynamics.tumbling import free_motion, poinsot
from contact_dynamics.world import Body, Surface, World


def creeping_capsule(margin: float) -> float:
    """Return how far the capsule is after 10 s, m."""
    slope, g = math.atan(0.7 / margin), -STANDARD_GRAVITY_W[2]
    capsule = PlanarBody(mass=0.045, inertia=6e-6)
    ends = [PlanarContact(r=(x, -0.004), normal=(0.0, 1.0), friction=0.7) for x in (-0.02, 0.02)]
    weight = PlanarWrench(f=(0.045 * g * math.sin(slope), -0.045 * g * math.cos(slope)))
    (mode,) = contact_modes(PlanarContactProblem(body=capsule, contacts=ends, wrench=weight)).modes
    return 0.5 * mode.acceleration[0] * 10.0**2


def friction_angle(beyond: float) -> float:
    """Return the acceleration down the slope, m/s^2."""
    slope, g = math.atan(0.5) + beyond, -STANDARD_GRAVITY_W[2]
    block = PlanarBody(mass=1.0, inertia=1.0 / 600.0)
    feet = [PlanarContact(r=(x, -0.02), normal=(0.0, 1.0), friction=0.5) for x in (-0.05, 0.05)]
    weight = PlanarWrench(f=(g * math.sin(slope), -g * math.cos(slope)))
    problem = PlanarContactProblem(body=block, contacts=feet, wrench=weight, acceleration_tolerance=1e-12)
    (mode,) = contact_modes(problem).modes
    return mode.acceleration[0]


def pressed_book(friction: float) -> float:
    """Return the downward acceleration of a book of 1 kg that 20 N press against the wall, m/s^2."""
    book = PlanarBody(mass=1.0, inertia=0.01)
    corners = [PlanarContact(r=(-0.01, y), normal=(1.0, 0.0), friction=friction) for y in (-0.1, 0.1)]
    # The hand is smooth and presses where the book would not turn.
    press = PlanarWrench(f=(-20.0, STANDARD_GRAVITY_W[2]))
    (mode,) = contact_modes(PlanarContactProblem(body=book, contacts=corners, wrench=press)).modes
    return -mode.acceleration[1]


def turning_bar(arm: float) -> float:
    """Return the angular acceleration of a bar of 1 kg, rad/s^2, whose middle is beside the fingertip."""
    bar = MassProperties(mass=1.0, I_B=0.01 * np.eye(3))
    state = BodyState(p_WB_W=[arm, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    wall = ContactSet(p_WC_W=[[0, 0, 0]], normals_W=[0, 1, 0], frictions=1.0)
    # The fingertip presses with 50 N, opposite the contact.
    force, torque = [0.0, -50.0, STANDARD_GRAVITY_W[2]], [0.0, 0.0, 50.0 * arm]
    problem = SpatialContactProblem(body=bar, state=state, contacts=wall, force_W=force, torque_W=torque)
    (mode,) = contact_modes(problem).modes
    return float(mode.angular_acceleration_W[1])


def ladder(beyond: float) -> float:
    """Return the angular acceleration of a ladder of 2 m, rad/s^2."""
    friction = 0.5
    angle = math.atan(0.5 / friction) - beyond
    x, y = math.cos(angle), math.sin(angle)
    foot = PlanarContact(r=(x, -y), normal=(0.0, 1.0), friction=friction)
    top = PlanarContact(r=(-x, y), normal=(1.0, 0.0), friction=0.0)
    body, weight = PlanarBody(mass=1.0, inertia=1.0 / 3.0), PlanarWrench(f=(0.0, STANDARD_GRAVITY_W[2]))
    (mode,) = contact_modes(PlanarContactProblem(body=body, contacts=[foot, top], wrench=weight)).modes
    return mode.angular_acceleration


def jamming_drawer(friction: float) -> float:
    """Return the acceleration, m/s^2, of a 1 kg drawer of 0.2 m under a push of 10 N, 0.1 m off-centre."""
    drawer = PlanarBody(mass=1.0, inertia=0.01)
    left = PlanarContact(r=(-0.05, 0.1), normal=(1.0, 0.0), friction=friction)
    right = PlanarContact(r=(0.05, -0.1), normal=(-1.0, 0.0), friction=friction)
    push = PlanarWrench(f=(0.0, 10.0), moment=10.0 * 0.1)
    answer = contact_modes(PlanarContactProblem(body=drawer, contacts=[left, right], wrench=push))
    return min(mode.acceleration[1] for mode in answer.modes)


def four_feet(mass: float) -> float:
    """Return the width of the range of one foot's load, N: its load on it and its opposite foot alone."""
    table = inertia.box(size=(1.0, 1.0, 0.5), mass=mass).mass_properties
    state = BodyState(p_WB_W=[0, 0, 0.25], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    corners = [[0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [-0.5, 0.5, 0.0]]
    weight = [0.0, 0.0, mass * STANDARD_GRAVITY_W[2]]
    sets = [ContactSet(p_WC_W=feet, normals_W=[0, 0, 1], frictions=0.5) for feet in (corners, corners[:2])]
    four, two = (
        contact_modes(SpatialContactProblem(body=table, state=state, contacts=feet, force_W=weight)).modes
        for feet in sets
    )
    rest = next(mode for mode in two if mode.mode == "ff")
    return 0.0 if four[0].forces_unique else float(rest.contact_forces_W[0, 2])


def tipping_cube(friction: float) -> float:
    """Return the angular acceleration of a cube of 0.1 m that slides to the right, rad/s^2."""
    cube = PlanarBody(mass=1.0, inertia=0.1**2 / 6.0)
    feet = [PlanarContact(r=(x, -0.05), normal=(0.0, 1.0), friction=friction) for x in (-0.05, 0.05)]
    sliding, weight = PlanarVelocity(v=(6.0, 0.0), w=0.0), PlanarWrench(f=(0.0, STANDARD_GRAVITY_W[2]))
    problem = PlanarContactProblem(body=cube, velocity=sliding, contacts=feet, wrench=weight)
    (mode,) = contact_modes(problem).modes
    return mode.angular_acceleration


def oblique_sliding(degrees: float) -> float:
    """Return the acceleration across the x axis of a box that slides at 2 m/s in this direction, m/s^2."""
    box = inertia.box(size=(0.2, 0.2, 0.02), mass=1.0).mass_properties
    v = [2.0 * math.cos(math.radians(degrees)), 2.0 * math.sin(math.radians(degrees)), 0.0]
    sliding = BodyState(p_WB_W=[0, 0, 0.01], q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=[0, 0, 0])
    corners = [[0.1, 0.1, 0.0], [0.1, -0.1, 0.0], [-0.1, 0.1, 0.0], [-0.1, -0.1, 0.0]]
    feet = ContactSet(p_WC_W=corners, normals_W=[0, 0, 1], frictions=0.5)
    weight = [0.0, 0.0, STANDARD_GRAVITY_W[2]]
    problem = SpatialContactProblem(body=box, state=sliding, contacts=feet, force_W=weight)
    (mode,) = contact_modes(problem).modes
    return float(mode.acceleration_W[1])


def bowling_ball(speed: float) -> float:
    """Return the speed at which a ball of radius 0.1 m rolls that started sliding, m/s."""
    ball, radius = PlanarBody(mass=7.0, inertia=0.4 * 7.0 * 0.1**2), 0.1
    floor = PlanarContact(r=(0.0, -radius), normal=(0.0, 1.0), friction=0.2)
    weight = PlanarWrench(f=(0.0, 7.0 * STANDARD_GRAVITY_W[2]))
    sliding = PlanarVelocity(v=(speed, 0.0), w=0.0)
    problem = PlanarContactProblem(body=ball, velocity=sliding, contacts=[floor], wrench=weight)
    (mode,) = contact_modes(problem).modes
    # Both accelerations are constant until the point below the ball has stopped sliding.
    rolls_after = speed / -(mode.acceleration[0] + radius * mode.angular_acceleration)
    return speed + rolls_after * mode.acceleration[0]


def rolling_down(degrees: float) -> float:
    """Return the acceleration of a ball on the slope, m/s^2."""
    slope, g = math.radians(degrees), -STANDARD_GRAVITY_W[2]
    ball = PlanarBody(mass=1.0, inertia=0.4 * 0.1**2)
    ground = PlanarContact(r=(0.0, -0.1), normal=(0.0, 1.0), friction=0.2)
    weight = PlanarWrench(f=(g * math.sin(slope), -g * math.cos(slope)))
    (mode,) = contact_modes(PlanarContactProblem(body=ball, contacts=[ground], wrench=weight)).modes
    return mode.acceleration[0]


def bounce(restitution: float) -> float:
    """Return the speed after the impact over that before."""
    ball = inertia.sphere(radius=0.1, mass=1.0).mass_properties
    falling = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -3.0], w_WB_W=[0, 0, 0])
    floor = Contact(p_WC_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=restitution)
    return float(spatial_impact(ball, falling, floor).state.v_WB_W[2]) / 3.0


def hundred_bounces(bounces: float) -> float:
    """Return the height, m, to which a ball dropped from 1 m rises after a number of bounces."""
    mass = inertia.sphere(radius=0.1, mass=1.0).mass_properties
    ball = Body(name="ball", mass_properties=mass, shape=sphere(radius=0.1))
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=1.0)
    world = World(bodies=(ball,), surfaces=(floor,))
    state = BodyState(p_WB_W=[0, 0, 1.1], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    for _ in range(int(bounces)):
        landing = next_landing(ball, state, world, horizon=2.0)
        if landing is None:
            break
        state = spatial_impact(ball, landing.state, landing.contacts[0]).state
    return float(state.v_WB_W[2]) ** 2 / (-2.0 * STANDARD_GRAVITY_W[2])


def spinning_bounce(spin: float) -> float:
    """Return the forward velocity after the bounce, m/s."""
    ball = inertia.sphere(radius=0.1, mass=1.0).mass_properties
    thrown = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[2, 0, -4], w_WB_W=[0, spin, 0])
    floor = Contact(p_WC_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.8, restitution=0.8)
    return float(spatial_impact(ball, thrown, floor).state.v_WB_W[0])


def two_balls(mass: float) -> float:
    """Return the speed of the ball that was struck, m/s."""
    first, second = (inertia.sphere(radius=0.5, mass=m).mass_properties for m in (mass, 10.0))
    first_state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[1, 0, 0], w_WB_W=[0, 0, 0])
    second_state = BodyState(p_WB_W=[1, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    contact = Contact(p_WC_W=[0.5, 0, 0], normal_W=[-1, 0, 0], friction=0.0, restitution=1.0)
    other = spatial_pair_impact(first, first_state, second, second_state, contact).other_state
    return 0.0 if other is None else float(other.v_WB_W[0])


def cradle_in_turn(restitution: float) -> float:
    """Return the speed of the last ball, m/s, where the pairs collide one after the other."""
    return last_ball(restitution, SeveralContactsLaw.SEQUENTIAL)


def cradle_at_once(restitution: float) -> float:
    """Return the speed of the last ball, m/s, where all contacts collide together under Newton's law."""
    return last_ball(restitution, SeveralContactsLaw.SIMULTANEOUS)


def last_ball(restitution: float, law: SeveralContactsLaw) -> float:
    """Return the speed of the last of three equal balls after the first has struck at 1 m/s, m/s."""
    ball = MassProperties(mass=1.0, I_B=4e-4 * np.eye(3))
    row = [
        BodyState(p_WB_W=[x, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[v, 0, 0], w_WB_W=[0, 0, 0])
        for x, v in ((0.0, 1.0), (0.1, 0.0), (0.2, 0.0))
    ]
    touching = ContactSet(
        p_WC_W=[[0.05, 0, 0], [0.15, 0, 0]], normals_W=[-1, 0, 0], frictions=0.0, restitutions=restitution
    )
    pairs, newton = [(0, 1), (1, 2)], RestitutionLaw.NEWTON
    answer = bodies_impact([ball] * 3, row, touching, pairs, several_contacts_law=law, restitution_law=newton)
    return float(answer.states[-1].v_WB_W[0])


def painleve_rod(friction: float) -> float:
    """Return the upward velocity of the centre of mass after the impact, m/s."""
    lean = math.radians(75.0)
    rod, sliding = PlanarBody(mass=1.0, inertia=1.0), PlanarVelocity(v=(-1.0, 0.0), w=0.0)
    reach = (-4.0 * math.cos(lean), -4.0 * math.sin(lean))  # from the centre of mass to the tip, m
    tip = PlanarContact(r=reach, normal=(0.0, 1.0), friction=friction, restitution=0.5)
    return planar_impact(rod, sliding, tip).velocity.v[1]


def free_fall(seconds: float) -> float:
    """Return the height after falling from rest at 0, m."""
    ball = inertia.sphere(radius=0.1, mass=1.0).mass_properties
    at_rest = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    return float(free_motion(ball, at_rest).state_at(seconds).p_WB_W[2])


def flip_period(wobble: float) -> float:
    """Return the period of the angular velocity in the body, s."""
    body = MassProperties(mass=1.0, I_B=np.diag([1.0e-3, 2.0e-3, 2.8e-3]))
    spin = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[wobble, 10.0, 0.0])
    return poinsot(free_motion(body, spin)).polhode_period


def hour_of_spin(seconds: float) -> float:
    """Return the relative change of the kinetic energy."""
    body = MassProperties(mass=1.0, I_B=np.diag([1.0e-3, 2.0e-3, 2.8e-3]))
    spin = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0.1, 10.0, 0.0])
    later = free_motion(body, spin, gravity_W=[0, 0, 0]).state_at(seconds)
    return kinetic_energy(body, later) / kinetic_energy(body, spin) - 1.0
