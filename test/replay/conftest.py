# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest

from replay.asked_log import Asked, session


@pytest.fixture(scope="session")
def asked(tmp_path_factory: pytest.TempPathFactory) -> Asked:
    """The log of a session with a real server, and how many questions it was asked."""
    return session(tmp_path_factory.mktemp("asked"))
