"""Contact modes (Mason, lecture 26): does the body, at each contact, separate, slide or stay fixed?

In reading order: verdicts and evidence (`result`), one contact in closed form (`single`), any planar set
(`planar`).
"""

from contact_dynamics.contact_modes.planar import planar_contact_modes
from contact_dynamics.contact_modes.result import (
    ConsistentMode,
    ContactModeAnswer,
    ModeVerdict,
    Refusal,
    RefusedMode,
)

__all__ = [
    "ConsistentMode",
    "ContactModeAnswer",
    "ModeVerdict",
    "Refusal",
    "RefusedMode",
    "planar_contact_modes",
]
