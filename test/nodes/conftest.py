# SPDX-License-Identifier: Apache-2.0
"""One server for the tests that only ask it, since each start of a server takes seconds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from contact_dynamics.demo.processes import claim_domain
from running_server import Client, server_and_client

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture(scope="session")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A client of a server with the commented configuration, to which nobody publishes states.

    It is in a domain of its own, beside the servers that other tests start. Tests that publish or change
    parameters have a server of their own.
    """
    folder = tmp_path_factory.mktemp("log")
    with server_and_client(folder, domain_id=claim_domain(), parameters=["workers:=2"]) as client:
        yield client
