# SPDX-License-Identifier: Apache-2.0
"""Bodies that are links of a URDF or an SDF file: their parameters become the numbers of the link.

The numbers count as if the configuration contained them: `ros2 param` shows them, they can change while the
server runs, and the log contains them, so it can be replayed without the file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.parameter_reader import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from contact_dynamics.shapes.files import Primitive

URDF: Final = "urdf"
LINK: Final = "link"
PARTS: Final = "parts"


def with_links_read(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of parameters, with the numbers of each link in place of its file.

    A link that cannot be read, or one of whose numbers is given too, raises `ConfigurationError`.
    """
    found = dict(values)
    for name in [each for each in values if each.startswith("body.") and each.endswith(f".{URDF}")]:
        if not values[name]:
            continue
        key = name.removesuffix(f".{URDF}")
        source, link = found.pop(name), found.pop(f"{key}.{LINK}", "")
        numbers = {f"{key}.{leaf}": value for leaf, value in _numbers(name, source, link).items()}
        for twice in numbers:
            if twice in values:
                message = f"{twice} must be left out, since {name} gives it, got {values[twice]!r}"
                raise ConfigurationError(message)
        found |= numbers
    return found


def _numbers(name: str, source: Any, link: Any) -> dict[str, Any]:
    """Return the parameters of a body that are those of a link."""
    from contact_dynamics.shapes.files import read_link  # loads SciPy

    if not isinstance(source, str) or not isinstance(link, str):
        raise ConfigurationError(f"{name} and link must be texts, got {source!r} and {link!r}")
    try:
        found = read_link(source, link or None)
    except ContactDynamicsError as error:
        raise ConfigurationError(f"{name}: {error}") from None
    I_B = found.mass.I_B
    return {
        "mass": float(found.mass.mass),
        "inertia": [float(I_B[i]) for i in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))],
        "center_of_mass": found.mass.p_FB_F.tolist(),
        **_shapes(found.primitives),
    }


def _shapes(primitives: Sequence[Primitive]) -> dict[str, Any]:
    """Return the parameters of collision shapes: a single one is the body's, and several are its parts."""
    if len(primitives) == 1:
        return _shape(primitives[0], "")
    parts = {f"part_{i}": primitive for i, primitive in enumerate(primitives)}
    found: dict[str, Any] = {PARTS: [*parts]} if parts else {}
    for part, primitive in parts.items():
        found |= _shape(primitive, f"{part}.")
    return found


def _shape(primitive: Primitive, before: str) -> dict[str, Any]:
    return {
        f"{before}{primitive.kind}": primitive.numbers.ravel().tolist(),
        f"{before}shape_position": primitive.position.tolist(),
        f"{before}shape_orientation": primitive.orientation.tolist(),
    }
