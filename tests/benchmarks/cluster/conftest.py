"""Ray clusters of several nodes, each with processes of its own, on this machine."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest


@dataclass
class LocalCluster:
    """A cluster with a head of one core and a node of two.

    Attributes:
        address: ``host:port`` of its head.
        client: ``ray://host:port``.
        nodes: Those besides the head.
        cluster: Where nodes can be added and removed.
    """

    address: str
    client: str
    nodes: list[Any]
    cluster: Any


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@pytest.fixture(scope="session")
def cluster() -> Iterator[LocalCluster]:
    made = start()
    yield made
    made.cluster.shutdown()


def start() -> LocalCluster:
    """Start a cluster; on a busy machine the second attempt is in time for what Ray allows."""
    from ray.cluster_utils import Cluster

    for left in (1, 0):
        port, made = free_port(), Cluster()
        try:
            made.add_node(num_cpus=1, ray_client_server_port=port, include_dashboard=False)
            node = made.add_node(num_cpus=2)
            made.wait_for_nodes()
            return LocalCluster(made.address, f"ray://127.0.0.1:{port}", [node], made)
        except Exception:
            made.shutdown()
            if not left:
                raise
    raise AssertionError
