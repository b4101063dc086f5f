# SPDX-License-Identifier: Apache-2.0
"""The benchmarks measure speed and accuracy, and run peers beside us: `python -m benchmarks`."""
