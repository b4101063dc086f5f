# SPDX-License-Identifier: Apache-2.0
"""Tosses are read from files, and velocities, flights, strikes and all other events are found in them.

`flights` finds flights and the strikes between them, in poses alone, and `events` whatever else happens:
landings, impacts, rests and slides. Evaluation, calibration and demo use both.
"""
