# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 nodes, which take parameters and messages, ask the library once, and send messages."""
