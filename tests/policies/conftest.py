"""A fixture for tests of policies."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from irsim.policies.networks import Network, NetworkPolicy, open_network, save_network


@pytest.fixture
def opened(tmp_path: Path) -> Callable[[Network], NetworkPolicy]:
    """``opened(network)``: the policy of a network that was written to a file."""

    def make(network: Network) -> NetworkPolicy:
        save_network(tmp_path / "net.npz", network)
        return open_network(tmp_path / "net.npz")

    return make
