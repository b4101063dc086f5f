"""Logs that answer again: every logged question is asked anew, from the file alone and without ROS.

`verify` has the one call, `verify_log`. `timeline` brings questions and states into the order in which they
came. `again` answers as the server did. `compare` sets two responses side by side. `stand_ins` makes the
classes of messages that ROS would bring. `arguments`, `run` and `report` are the command.
"""
