# SPDX-License-Identifier: Apache-2.0
"""Reads recorded tosses from files, and finds flights, strikes and all other events in measured poses.

`flights` finds flights and the strikes between them from poses alone, and `events` finds landings, impacts,
rests and slides. Evaluation, calibration and the demo use both.
"""
