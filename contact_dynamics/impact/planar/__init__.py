# SPDX-License-Identifier: Apache-2.0
"""This chapter resolves impacts in the plane. Its `routh` is part of the compiled core."""

from contact_dynamics.numerics.compiled import import_core

import_core("contact_dynamics.impact.planar.routh")
