"""`python -m contact_dynamics <verb>`."""

import sys

from contact_dynamics.command_line import main

sys.exit(main())
