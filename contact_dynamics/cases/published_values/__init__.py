# SPDX-License-Identifier: Apache-2.0
"""Numbers that others published, as data: one file for each source, which says where each number was read."""
