# SPDX-License-Identifier: Apache-2.0
"""Messages to domain types and back: the one border between ROS and the physics.

Each module holds explicit, pure functions `x_from_msg` and `x_to_msg`. A message that does not make sense
raises an error of `contact_dynamics.errors` that names the field.
"""
