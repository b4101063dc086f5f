# SPDX-License-Identifier: Apache-2.0
"""This chapter finds contact modes in the plane."""
