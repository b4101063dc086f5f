# SPDX-License-Identifier: Apache-2.0
"""Compares predictions with measured events: flights, landings, impacts, rests and slides of recordings.

The entry point is `evaluate_recording` in `recording`. `sources` finds recordings and reads them from a log
(`log_states`) or a toss, and `measured.events` finds their events. `asking` predicts each event with the
horizons, laws and fit window of `settings`, and returns one `comparison` for each prediction. `model_error`
reads the model errors that a calibration has measured, with which regions are as wide as errors are.

`jobs` distributes many recordings over processes and stores their results. `result` contains the records of
an evaluation and their file formats. `summary` groups the comparisons, and `significance` tests the
difference of two evaluations. `report`, `plots` and `picture` display them. `arguments` and `run` implement
the command line.
"""
