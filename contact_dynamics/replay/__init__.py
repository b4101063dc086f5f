"""Asks every question of a log again, from the file alone and without ROS.

`verify` has the one call, `verify_log`. `timeline` puts questions and states into the order in which they
came. `again` answers as the server did. `compare` finds the fields in which two responses differ. `stand_ins`
makes the classes of messages where ROS is not installed. `same_definitions`
refuses a log whose services have other fields. `arguments`, `run` and `report` are the command.
"""
