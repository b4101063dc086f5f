"""What every test runs under."""

import os

# Jazzy's message classes check their fields only where this is set, before the first of them is imported.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
