# SPDX-License-Identifier: Apache-2.0
"""Standard numerical methods, without physics."""
