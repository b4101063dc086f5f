# SPDX-License-Identifier: Apache-2.0
"""The monitor: predicts each event of a body before it happens, compares, and detects changed parameters.

`monitor` takes states one by one, live or from a log, and returns a record for each event that has ended.
`evidence` compares an impact at a single contact with predictions for other restitutions and frictions, and
`changes` collects this per surface: a sequential test and an estimate. `report` describes both in words.
`arguments` and `run` are the command for recordings, and `live` is the node.
"""
