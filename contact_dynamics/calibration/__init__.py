# SPDX-License-Identifier: Apache-2.0
"""Estimates the parameters of a body and its surfaces, with their uncertainty, from recorded states."""

from contact_dynamics.calibration.calibrate import calibrate, calibrate_observed
from contact_dynamics.calibration.free import Free
from contact_dynamics.calibration.result import Calibration, Estimate
from contact_dynamics.validation_types import check_types_of

__all__ = ["Calibration", "Estimate", "Free", "calibrate", "calibrate_observed"]

check_types_of(globals())
