# SPDX-License-Identifier: Apache-2.0
"""One body or several strike at several contacts at once."""
