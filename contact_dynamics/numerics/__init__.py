# SPDX-License-Identifier: Apache-2.0
"""Known numerical methods that the physics uses. They contain no physics."""
