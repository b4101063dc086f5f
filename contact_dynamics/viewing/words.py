"""Words in 2D views, and the room that they need.

The viewer fits a view to what is drawn, but not to words. It allows for more room about points than about
lines, which would make the picture small. So words stand at lines without length, and lines
without length or colour keep the room that they need.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.viewing.strips import strips_2d

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray

_NO_COLOR: Final = (0, 0, 0, 0)


def words_2d(places: FloatArray, texts: Sequence[str], colors: Sequence[palette.Color]) -> rr.LineStrips2D:
    """Return words at places, (n, 2), as rerun's 2D views have them: the second coordinate goes down."""
    return rr.LineStrips2D(
        strips_2d([np.array([place, place]) for place in places]),
        colors=[palette.readable(color) for color in colors],
        radii=0.0,
        labels=list(texts),
        show_labels=True,
    )


def room_2d(corners: FloatArray) -> rr.LineStrips2D:
    """Return what keeps room for a picture that reaches to these points, (n, 2), in the view."""
    return rr.LineStrips2D(
        strips_2d([np.array([corner, corner]) for corner in corners]), colors=_NO_COLOR, radii=0.0
    )
