# SPDX-License-Identifier: Apache-2.0
"""Corners of concave bodies cause a warning, and those of convex ones do not, however a mesh divides them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics import Body, BodyState, Obstacle, free_motion
from contact_dynamics.errors import ConcaveShapeWarning, WrongTypeError
from contact_dynamics.nodes.parameter_reader import ParameterSource
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.inertia import MassDistribution
from contact_dynamics.shapes.convex import box, polyhedron
from contact_dynamics.world import box_vertices
from sweeps import seeds

# Cross sections in the x, y plane, and the boxes that they consist of: sizes and middles.
OUTLINES = {
    "L": [(0, 0), (1, 0), (1, 0.2), (0.2, 0.2), (0.2, 1), (0, 1)],
    "U": [(-1.5, 0), (1.5, 0), (1.5, 2), (0.5, 2), (0.5, 1), (-0.5, 1), (-0.5, 2), (-1.5, 2)],
    "T": [(-1.5, 2), (1.5, 2), (1.5, 3), (-1.5, 3), (-0.5, 2), (0.5, 2), (-0.5, 0), (0.5, 0)],
}
PARTS = {
    "L": [((1, 0.2), (0.5, 0.1)), ((0.2, 0.8), (0.1, 0.6))],
    "U": [((3, 1), (0, 0.5)), ((1, 1), (1, 1.5)), ((1, 1), (-1, 1.5))],
    "T": [((3, 1), (0, 2.5)), ((1, 2), (0, 1))],
}
DEPTH = 0.3


def corners(name: str) -> np.ndarray:
    return np.array([[x, y, z] for z in (0.0, DEPTH) for x, y in OUTLINES[name]])


def mass(name: str) -> MassDistribution:
    return inertia.combined(
        inertia.box(size=(*size, DEPTH), density=1000.0).placed(p_GF_G=(*middle, 0.5 * DEPTH))
        for size, middle in PARTS[name]
    )


@pytest.mark.parametrize("name", OUTLINES)
@pytest.mark.parametrize("is_plate", [False, True])
def test_an_obstacle_with_the_corners_of_a_profile_warns(name: str, *, is_plate: bool) -> None:
    """It has no mass that shows whether they are those of a divided face, as in stairs beside a ramp."""
    given = corners(name)[: len(OUTLINES[name]) if is_plate else None]
    with pytest.warns(ConcaveShapeWarning, match="obstacle 'step': .* corners are in faces of their hull"):
        Obstacle(name="step", vertices_W=given, friction=0.3, restitution=0.0)


@pytest.mark.parametrize("name", OUTLINES)
def test_the_mesh_of_a_profile_warns(name: str) -> None:
    """Its inner corners are in the end faces of its hull, also as float32 and turned, in triangles."""
    with pytest.warns(ConcaveShapeWarning, match=rf"body '{name}': .* corners are in faces of their hull"):
        Body.of(name, mass(name), vertices_F=corners(name))
    turn = Rotation.from_euler("xyz", [0.3, 1.1, -2.0])
    turned = np.repeat(corners(name) @ turn.as_matrix().T, 3, axis=0).astype(np.float32)
    with pytest.warns(ConcaveShapeWarning, match="in faces"):
        Body.of(name, mass(name).placed(q_GF=turn.as_quat()), vertices_F=turned)
    whole = mass(name)
    with pytest.warns(ConcaveShapeWarning, match="in faces"):
        Body(name=name, mass_properties=whole.mass_properties, vertices_B=corners(name) - whole.p_FB_F)


def test_a_corner_inside_the_hull_warns_wherever_corners_are_given() -> None:
    dented = np.vstack([box_vertices((1.0, 1.0, 1.0)), [[0.0, 0.0, 0.3]]])
    even = inertia.box(size=(1.0, 1.0, 1.0), mass=1.0)
    words = r"1 of 9 corners are inside their hull, by up to 0\.2 m"
    with pytest.warns(ConcaveShapeWarning, match=words) as of_mass:
        Body.of("cube", even, vertices_F=dented)
    with pytest.warns(ConcaveShapeWarning, match=words) as of_body:
        Body(name="cube", mass_properties=even.mass_properties, vertices_B=dented)
    with pytest.warns(ConcaveShapeWarning, match=f"obstacle 'step': {words}") as of_obstacle:
        Obstacle(name="step", vertices_W=dented, friction=0.3, restitution=0.0)
    assert [each.filename for each in (*of_mass, *of_body, *of_obstacle)] == [__file__] * 3


@pytest.mark.filterwarnings("error")
@seeds(range(5), slow=range(5, 200))
def test_a_convex_mesh_does_not_warn(seed: int) -> None:
    """A solid of drawn corners, turned, whose faces are divided, as float32."""
    rng = np.random.default_rng(seed)
    from scipy.spatial import ConvexHull

    points = rng.normal(size=(int(rng.integers(6, 30)), 3)) * rng.uniform(0.05, 1.0, 3)
    triangles = points[ConvexHull(points).simplices]
    shares = rng.dirichlet(np.ones(3), size=(len(triangles), 3))
    divided = np.einsum("tpk,tki->tpi", shares, triangles).reshape(-1, 3)
    mesh = np.vstack([triangles.reshape(-1, 3), divided])
    mesh = (mesh @ Rotation.random(random_state=seed).as_matrix() + rng.normal(size=3)).astype(np.float32)
    body = Body.of("solid", inertia.convex_hull(mesh, mass=1.0), vertices_F=mesh)
    assert len(body.vertices_B) > 0
    Obstacle(name="solid", vertices_W=triangles.reshape(-1, 3), friction=0.3, restitution=0.0)


@pytest.mark.filterwarnings("error")
def test_shapes_without_faces_inside_do_not_warn() -> None:
    even = inertia.box(size=(0.1, 0.2, 0.3), mass=1.0)
    Body.of("plate", even, vertices_F=[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    Body.of("rod", even, vertices_F=[[0, 0, 0], [1, 0, 0], [0.5, 0, 0], [0.7, 0, 0]])
    Body.of("point", even, vertices_F=np.zeros((5, 3)))
    Body.of("nothing", even, vertices_F=np.zeros((0, 3)))
    lopsided = inertia.box(size=(0.1, 0.2, 0.3), mass=1.0).placed(p_GF_G=(0.0, 0.0, 0.1))
    bracket = corners("L")
    Body.of("hull on purpose", mass("L"), shape_F=polyhedron([*bracket, [0.1, 0.1, 0.1]]))
    Body.of("box", lopsided, shape_F=box(size=(0.1, 0.2, 0.3)))


def test_a_mass_distribution_is_no_mass_properties() -> None:
    """Its centre of mass would be lost. The error says what takes it."""
    words = (
        r'got a MassDistribution, which Body\.of\("name", it, shape_F=\.\.\.\) takes with its centre of mass'
    )
    with pytest.raises(WrongTypeError, match=f"mass_properties must be a MassProperties, {words}"):
        Body(name="L", mass_properties=mass("L"))  # type: ignore[arg-type]
    state = BodyState(p_WB_W=np.zeros(3), q_WB=[0, 0, 0, 1], w_WB_W=np.ones(3))
    with pytest.raises(WrongTypeError, match=f"body must be a Body or its MassProperties, {words}"):
        free_motion(mass("L"), state)  # type: ignore[arg-type]
    with pytest.raises(WrongTypeError, match=f"name must be a str, {words}"):
        Body.of(mass("L"), shape_F=box(size=(0.1, 0.2, 0.3)))  # type: ignore[call-arg, arg-type]


def test_a_configured_bracket_warns() -> None:
    """With the inertia of its hull too, which its corners in faces contradict."""
    for given in ({"body.bracket.inertia": [0.0]}, {"body.bracket.inertia": [0.1, 0.1, 0.15, 0.0, 0.0, 0.0]}):
        values = {
            "bodies": ["bracket"],
            "body.bracket.mass": 1.0,
            "body.bracket.vertices": corners("L").ravel().tolist(),
            **given,
        }
        source = ParameterSource(values, also_known=(), resolve=lambda _, topic: topic)
        with pytest.warns(
            ConcaveShapeWarning, match=r"body\.bracket\.vertices: 2 of 12 corners are in faces"
        ):
            read_server_parameters(source)
