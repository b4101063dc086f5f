# SPDX-License-Identifier: Apache-2.0
"""What every test runs under."""

import os
from collections.abc import Generator

# Test processes share the cores already. They import no NumPy before this is set.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
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

BEYOND_ROS = ("mcap", "mcap_ros2", "rosbags")
"""What ROS's build farm lacks, since pip alone has it. A file whose tests need one is skipped there."""


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Skip a file that imports what only pip has, where it is not installed."""
    report = yield
    for module in BEYOND_ROS:
        if report.failed and f"No module named '{module}" in str(report.longrepr):
            reason = (
                f"Skipped: NOT RUN, because {module} is not installed: pip install -r requirements/test.txt"
            )
            report.outcome, report.longrepr = "skipped", (str(collector.path), 0, reason)
    return report
