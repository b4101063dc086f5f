# SPDX-License-Identifier: Apache-2.0
"""This chapter resolves impacts in space. Its `path` and `response` are parts of the compiled core."""

from contact_dynamics.numerics.compiled import import_core

import_core("contact_dynamics.impact.spatial.path", "contact_dynamics.impact.spatial.response")
