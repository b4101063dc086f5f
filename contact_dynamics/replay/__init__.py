# SPDX-License-Identifier: Apache-2.0
"""Replays logs: recomputes the response to every logged request from the file alone, without ROS.

There are five modes. `verify` compares the recomputed responses with the logged ones and reports the result.
`rows` makes a table that includes the measurements after each response, and `table_file` writes it. `view`
draws a log. `publish` plays it over ROS. The fifth mode lists its contents (`run`).

Tables and pictures are made of `events`, which come from a log of the server, or from any recording with a
separate configuration and requests that are made on replay.

`of_log` configures the server of a log, or rejects a log whose services have different fields, and `again`
recomputes that server's responses. `timeline` orders requests and states by their arrival and extracts both
from service events. `arguments`, `run` and `progress` are the command. `recover` is the command that repairs
logs.
"""
