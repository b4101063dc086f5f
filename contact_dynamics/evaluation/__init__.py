# SPDX-License-Identifier: Apache-2.0
"""Predictions beside what came: events are found in recordings, asked about beforehand, and compared.

`recording` has the one call, `evaluate_recording`. A recording is read from a log (`log_states`) or a toss by
`sources`. `measured.events` finds what happened in it. `asking` asks, as `settings` say, and makes a
`comparison` of each answer.

At size, `jobs` are each recording's work, whose results are kept and which processes share, and `result` is
the whole. `summary` and `significance` put it together. `report`, `plots` and `picture` show it. `arguments`
and `run` are the command.
"""
