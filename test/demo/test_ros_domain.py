# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
import socket
import subprocess
import sys
import time

import pytest

from contact_dynamics.demo import processes as ros_domain
from contact_dynamics.demo.patience import MAX_OF_A_LOOK_S, Patience
from contact_dynamics.demo.processes import claim_domain


@pytest.fixture
def nobody_listens(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ros_domain, "_domains_in_use", set)


@pytest.mark.usefixtures("nobody_listens")
def test_claims_differ_within_a_process_and_between_processes() -> None:
    mine = [claim_domain(), claim_domain()]
    # another process, which tries the same ones first
    code = f"import os; os.getpid = lambda: {os.getpid()}\n"
    code += "from contact_dynamics.demo.processes import claim_domain; print(claim_domain())"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=True
    )
    assert len({*mine, int(done.stdout)}) == 3
    assert all(1 <= domain <= 100 for domain in mine)


def test_a_domain_in_which_somebody_listens_is_left_out() -> None:
    """Whoever that is: another ROS on this machine claims nothing."""
    domain = claim_domain()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 7400 + 250 * domain + 10))  # unicast discovery of its first participant
        assert domain in ros_domain._domains_in_use()
    assert domain not in ros_domain._domains_in_use()


def test_it_says_when_none_is_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ros_domain, "_domains_in_use", lambda: set(range(1, 101)))
    with pytest.raises(RuntimeError, match="got all in use"):
        claim_domain()


def test_a_stall_counts_as_one_look() -> None:
    patience = Patience(2.0 * MAX_OF_A_LOOK_S)
    time.sleep(5.0 * MAX_OF_A_LOOK_S)
    patience.look()
    assert not patience.is_over


def test_looks_that_find_nothing_end_it_in_its_time() -> None:
    seconds = 2.0 * MAX_OF_A_LOOK_S
    patience, begun = Patience(seconds), time.monotonic()
    while not patience.is_over:
        time.sleep(0.1 * MAX_OF_A_LOOK_S)
        patience.look()
    assert time.monotonic() - begun >= seconds
