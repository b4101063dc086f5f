# SPDX-License-Identifier: Apache-2.0
"""Logs that answer again: from the file alone and without ROS, every logged question is asked anew.

There are five modes. `verify` compares the answers with those in the log, and reports it. `rows` makes a
table, with what was measured after each answer, and `table_file` writes it. `view` draws. `publish` plays a
log over ROS. The fifth lists its contents (`run`).

Tables and pictures are made of `events`, which are read from a log of the server, or of any recording, with a
configuration beside it and questions that are asked now.

`of_log` makes the server of a log, or rejects one whose services have other fields, and `again` answers as it
did. `timeline` puts questions and states into the order in which they came, and takes both out of events.
`arguments`, `run` and `progress` are the command.
"""
