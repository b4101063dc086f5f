"""Predictions beside what came: events are found in recordings, asked about beforehand, and compared.

`recording` has the one call, `evaluate_recording`. A recording is read from a log (`log_states`) or a toss by
`sources`; `motion` has its measured states. `events` finds what happened in them: `flight_events` and
`mode_events`, with `touching`, as `found_event` describes. `asking` asks, as `settings` say, and makes a
`comparison` of each answer by `differences`.

At size, `job` is one recording's work, `workers` share it, `results_folder` keeps what is done, and `result`
is the whole. `summary` and `significance` put it together. `report`, `tables`, `plots` and `picture` show it.
`arguments` and `run` are the command.
"""
