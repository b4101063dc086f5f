# SPDX-License-Identifier: Apache-2.0
"""This chapter finds contact modes in space. Its `simplex_steps` is a part of the compiled core."""

from contact_dynamics.numerics.compiled import import_core

import_core("contact_dynamics.contact_modes.spatial.simplex_steps")
