"""A quiet connection to a Ray cluster, within a bounded time."""

from __future__ import annotations

import logging
import os
import socket
import subprocess
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import Any
from urllib.parse import urlsplit

from irsim.common.extras import require
from irsim.common.text import clean
from irsim.diagnostics.errors import ArgumentError, CodedError

__all__ = ["ClusterError", "connected"]

AUTO = "auto"
"""Address of the cluster that RAY_ADDRESS names, else of the one on this machine, which is started if missing."""
_CLIENT = "ray://"
_CONNECT_S = 10.0
"""Time within which the port of a cluster must answer [s]."""
_JOIN_S = 40.0
"""Time within which a process must have joined the cluster [s]."""
_CLIENT_ATTEMPTS = 2
"""Attempts to connect from outside; Ray gives up each after 30 s, which a busy cluster may need to start a process."""
_NO_CLUSTER = 3
"""Exit status of the probe where Ray knows of no cluster."""
_PROBE = f"""
import logging, sys
logging.getLogger("ray").setLevel("CRITICAL")
import ray
try:
    ray.init(address=sys.argv[1], log_to_driver=False, configure_logging=False)
except ConnectionError as error:
    print(error)
    sys.exit({_NO_CLUSTER})
except Exception as error:
    print(error)
    sys.exit(1)
"""
_QUIET = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0"}
"""Environment in which Ray sends no statistics and does not warn of coming changes."""
_STORE_BYTES = 100 * 1024**2
"""Memory for shared objects of a cluster that is started here: results are small."""


class ClusterError(CodedError, RuntimeError):
    """A cluster does not answer, or cannot run what this process can."""


@contextmanager
def connected(address: str, cpus: int) -> Iterator[Any]:
    """Connect to a cluster, and yield the module ``ray``; a connection that the program has already is used and kept.

    Args:
        address: ``auto``, ``ray://host:port`` from anywhere, or ``host:port`` from a machine of the cluster.
        cpus: Number of cores of a cluster that is started here.

    Raises:
        ExtraError: Ray is not installed.
        ArgumentError: The address is not valid.
        ClusterError: No cluster answers.
    """
    require("cluster", "ray")
    if address == AUTO:
        address = os.environ.get("RAY_ADDRESS", AUTO)
    if address != AUTO:
        _check_port(address)
    import ray  # sets the level of its log

    if ray.is_initialized():
        yield ray
        return
    with _quiet():
        _join(ray, address, cpus)
        try:
            yield ray
        finally:
            ray.shutdown()


def _join(ray: Any, address: str, cpus: int) -> None:
    """Join a cluster, or start one."""
    options: dict[str, Any] = {"address": address}
    if not address.startswith(_CLIENT):  # Ray's own attempts last for minutes
        if address == AUTO and _probe(address) == _NO_CLUSTER:
            options = {
                "address": "local", "num_cpus": cpus, "include_dashboard": False, "object_store_memory": _STORE_BYTES,
            }  # fmt: skip
        elif address != AUTO:
            _probe(address)
    attempts = _CLIENT_ATTEMPTS if address.startswith(_CLIENT) else 1
    for left in reversed(range(attempts)):
        try:
            ray.init(**options, log_to_driver=False, configure_logging=False, logging_level=logging.CRITICAL)
            return
        except Exception as error:  # Ray has no common class for these
            with suppress(Exception):
                ray.shutdown()  # of a connection that is half made
            if not left:
                raise _refused(address, str(error) or type(error).__name__) from None


def _probe(address: str) -> int:
    """Have another process join, and return its exit status: 0, or that no cluster is known on this machine.

    Raises:
        ClusterError: It cannot join.
    """
    try:
        done = subprocess.run(
            [sys.executable, "-c", _PROBE, address],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False,
            timeout=_JOIN_S,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        if address == AUTO:  # Ray remembers a cluster that is gone
            return _NO_CLUSTER
        raise _refused(address, f"it did not answer within {_JOIN_S:g} s") from None
    if done.returncode == 0 or (done.returncode == _NO_CLUSTER and address == AUTO):
        return done.returncode
    raise _refused(address, done.stdout)


def _check_port(address: str) -> None:
    """Check that something listens at the address."""
    try:
        parts = urlsplit(address if address.startswith(_CLIENT) else f"//{address}")
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if not host or not port:
        fix = "give auto, ray://host:port (10001 by default), or host:port (6379) on a machine of the cluster"
        raise ArgumentError(f"{clean(address)!r} is not the address of a cluster", fix)
    try:
        socket.create_connection((host, port), timeout=_CONNECT_S).close()
    except OSError as error:
        raise _refused(address, error.strerror or str(error)) from None


def _refused(address: str, why: str) -> ClusterError:
    first = next((line.strip() for line in why.splitlines() if line.strip()), "no reason given")
    return ClusterError(
        "no-cluster",
        f"no Ray cluster can be used at {clean(address, 200)}: {clean(first, 300)}",
        "check with `ray status` there, that the port is open, and that Python and Ray have the same versions here and "
        "there; without --cluster the benchmark runs on this machine",
    )


@contextmanager
def _quiet() -> Iterator[None]:
    """Context in which Ray prints nothing and sends no statistics."""
    kept: Mapping[str, str | None] = {name: os.environ.get(name) for name in _QUIET}
    os.environ.update(_QUIET)
    logger = logging.getLogger("ray")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    printers = [(owner, name, getattr(owner, name)) for owner, name in _printers()]
    try:
        for owner, name, _ in printers:
            setattr(owner, name, lambda *words, **options: None)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        for owner, name, plain in printers:
            setattr(owner, name, plain)
        logger.setLevel(level)
        for name, value in kept.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _printers() -> Iterator[tuple[Any, str]]:
    """Owner and name of the functions with which Ray reports deaths of processes on standard output, come what may."""
    for module, path, name in (
        ("ray._private.worker", "", "print_to_stdstream"),
        ("ray.util.client.logsclient", "LogstreamClient", "stdstream"),
    ):
        with suppress(ImportError, AttributeError):  # of another version, or installed without its client
            owner: Any = import_module(module)
            owner = getattr(owner, path) if path else owner
            getattr(owner, name)
            yield owner, name
