# SPDX-License-Identifier: Apache-2.0
"""What every test runs under."""

import os

# Test processes share the cores already. They import no NumPy before this is set.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from hypothesis import settings

from contact_dynamics.nodes.own_process import keep_reserved_memory_untouched

# Jazzy's message classes check their fields only where this is set, before the first of them is imported.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"

keep_reserved_memory_untouched()  # a test process joins DDS many times, and would take gigabytes

# The suite draws the same few examples each time, so that a change is what makes it fail.
# HYPOTHESIS_PROFILE=explore draws new ones, and 100. No deadline: a busy machine is not a wrong answer.
settings.register_profile("suite", derandomize=True, deadline=None, max_examples=25)
settings.register_profile("explore", deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "suite"))
