# SPDX-License-Identifier: Apache-2.0
"""Logs that answer again: from the file alone and without ROS, every logged question is asked anew.

There are five modes. `verify` compares the answers with those in the log. `info` lists its contents. `rows`
makes a table, with what was measured after each answer (`then_measured`), and `table_file` writes it. `view`
draws. `publish` plays a log over ROS, in the time that `pacing` keeps.

Tables and pictures are made of `events`. `logged` reads them from a log of the server. `asking` reads the
states of any recording, with a `configuration` beside it, and asks its own questions.

`of_log` makes the server of a log, or rejects one whose services have other fields, and `again` answers as it
did. `timeline` puts questions and states into the order in which they came, and takes both out of events.
`compare` finds the fields in which two responses differ. `stand_ins` makes the classes of messages where ROS
is not installed. `arguments`, `run`, `report` and `progress` are the command.
"""
