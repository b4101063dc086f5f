"""What the viewer shows under *Legend*: how to read the picture, in Markdown."""

from __future__ import annotations

from typing import Final

LEGEND_TEXT: Final = """\
| drawn | means |
| --- | --- |
| blue grey body, trail, curves | measured |
| orange path, outlines, curves | predicted, from the newest answer |
| orange translucent body | end of that prediction |
| red outline, arrow at the contact | body at the predicted impact, impulse on it |
| pale, bright yellow arrow at its centre | velocity of the centre of mass before, after |
| violet cone | friction cone: the impulses and forces that friction allows |
| green, pink, cyan points and arrows | contacts that stay fixed, slide, separate; their contact forces |

The longest arrow of each kind is drawn as long as suits the body: read its label.

In *impulse space* the tangential impulse goes to the right, the normal impulse up. The red path is
the impulse as it accumulates. On the green line the contact does not slide, on the cyan line it does not
approach.
"""
