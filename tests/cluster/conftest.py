"""Ray clusters of several nodes, each with processes of its own, on this machine."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest


@dataclass
class LocalCluster:
    """A cluster with three nodes of one core each.

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
    from ray.cluster_utils import Cluster

    port = free_port()
    made = Cluster(
        initialize_head=True,
        head_node_args={"num_cpus": 1, "ray_client_server_port": port, "include_dashboard": False},
    )
    nodes = [made.add_node(num_cpus=1) for _ in range(2)]
    made.wait_for_nodes()
    yield LocalCluster(made.address, f"ray://127.0.0.1:{port}", nodes, made)
    made.shutdown()
