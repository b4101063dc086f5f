# SPDX-License-Identifier: Apache-2.0
"""This file makes `python -m contact_dynamics <verb>` do the same as `contact-dynamics <verb>`."""

import sys

from contact_dynamics.command_line import main

if __name__ == "__main__":  # a worker imports this file, too
    sys.exit(main())
