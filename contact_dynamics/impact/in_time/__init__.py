# SPDX-License-Identifier: Apache-2.0
"""These files follow strikes one after another in time, with free flight between them."""
