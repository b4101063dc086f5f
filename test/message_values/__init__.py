# SPDX-License-Identifier: Apache-2.0
"""Random values of all that travels in messages, by chapter."""
