"""The text that the viewer shows under *Legend*. It says in Markdown how to read the picture."""

from __future__ import annotations

from typing import Final

LEGEND_TEXT: Final = """\
| drawn | means |
| --- | --- |
| blue grey body, trail, curves | measured |
| orange paths, outlines, curves | predicted, in the last 10 s |
| orange ellipsoids | two deviations of the predicted centre of mass; white: not to be relied on |
| orange translucent body | end of the newest prediction |
| red outlines, arrows | bodies at predicted impacts in the last 10 s, impulses on them |
| pale, bright yellow arrow | velocity of the centre of mass before, after the newest of them |
| violet cone | friction cone: the impulses and forces that friction allows |
| green, pink, cyan points and arrows | contacts that stay fixed, slide, separate; their contact forces |
| white outline | the body that the newest answer about contact modes is about |
| thin pink arrow | which way a contact slides |
| orange arrow | acceleration of the centre of mass, or of contacts |

The longest arrow of each kind is drawn as long as suits the body: read its label. Strikes in sequence are
numbered, the largest of them with the body as it is then.

In *impulse space* the tangential impulse goes to the right, the normal impulse up. The red path is
the impulse as it accumulates. On the green line the contact does not slide, on the cyan line it does not
approach.

Several *contact modes* may be consistent: the tab shows all, side by side; the scene shows `mode_1` (switch
on `mode_2` and so on under *contacts* in the blueprint panel). `s` separates, `l` and `r` slide left and
right, `f` stays fixed, `c` slides in space.

The *mode map* shows which applied wrench brings about which mode. Each point of a disc is a direction: its
angle that of the force, its distance from the centre the share of force, the centre a pure torque. White:
several modes are consistent; black: none is. Red: the wrench in question, and its least change into another
mode. Of a moving body, the square shows forces at the applied torque.

*Poinsot*: in the space of angular velocities the inertia ellipsoid turns with the body and rolls on the plane
at right angles to the angular momentum (white). Yellow: the angular velocity, which ends where they touch.
Orange: its way on the ellipsoid, the polhode; green: on the plane, the herpolhode.
"""
