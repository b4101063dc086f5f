# SPDX-License-Identifier: Apache-2.0
"""The demo plays a recorded toss as published states, and compares predictions with measurements."""
