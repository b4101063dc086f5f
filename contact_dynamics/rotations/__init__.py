# SPDX-License-Identifier: Apache-2.0
"""This chapter calculates with unit quaternions and rotation matrices, one at a time and many."""
