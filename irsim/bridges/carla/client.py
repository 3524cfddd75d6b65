"""Connecting to a server of CARLA, and what its errors mean."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.carla.probe import server_version
from irsim.common.extras import ExtraError, require
from irsim.common.text import clean
from irsim.components.bridges.carla import Carla

__all__ = ["NEWEST_PYTHON", "connect", "import_client", "server_errors"]

NEWEST_PYTHON = (3, 12)
"""The newest Python that the client is made for."""
_LONGEST = 300
_LOST = ("time-out", "timeout", "rpc::", "connection", "broken pipe")
"""Words of errors of a server that is gone."""


def import_client() -> Any:
    """The module ``carla``.

    Raises:
        ExtraError: It is not installed, or there is none for this Python.
    """
    try:
        require("carla", "carla")
    except ExtraError:
        if sys.version_info[:2] <= NEWEST_PYTHON:
            raise
        what = f"the client of CARLA is made for Python up to {NEWEST_PYTHON[0]}.{NEWEST_PYTHON[1]}"
        fix = "use another Python: uv venv --python 3.12, then pip install 'irsim-mcp[carla]'"
        raise ExtraError(
            "missing-extra", f"{what}, and this is {sys.version_info[0]}.{sys.version_info[1]}", fix
        ) from None
    import carla

    return carla


@contextmanager
def server_errors(what: str, address: str, lose: Callable[[], None] | None = None) -> Iterator[None]:
    """Turn errors of the client, which all are a ``RuntimeError``, into one that says what failed.

    Args:
        what: What is done.
        address: Where the server is.
        lose: Called if the server does not answer.
    """
    try:
        yield
    except BridgeLostError:
        if lose is not None:
            lose()
        raise
    except RuntimeError as error:
        text = clean(str(error), _LONGEST)
        if any(word in text.lower() for word in _LOST):
            if lose is not None:
                lose()
            raise BridgeLostError(f"the CARLA server at {address} did not answer ({what}): {text}") from None
        raise BridgeError("bridge-failed", f"CARLA refused {what}: {text}", "look at the log of the server") from None


def connect(options: Carla) -> tuple[Any, Any, Any]:
    """The module ``carla``, a client of the server, and its world.

    Raises:
        ExtraError: The client library is missing.
        BridgeLostError: No server answers within the timeout.
        BridgeError: What answers is not CARLA, or has another version or another town.
    """
    carla = import_client()
    address = f"{options.host}:{options.port}"
    theirs = server_version(options.host, options.port, options.timeout)
    with server_errors("connecting", address):
        client = carla.Client(options.host, options.port)
        client.set_timeout(options.timeout)
        ours = client.get_client_version()
    if theirs != ours and not options.any_version:
        what = f"the CARLA server at {address} has version {clean(theirs, 40)}, and the client of this Python {ours}"
        fix = f"install the client of the server: pip install carla=={clean(theirs, 40)}; or try any_version: true"
        raise BridgeError("bridge-mismatch", what, fix)
    with server_errors("getting the world", address):
        world = client.get_world()
    if options.town is not None:
        with server_errors("getting the map", address):
            name = str(world.get_map().name)
        if name.rsplit("/", 1)[-1] != options.town.rsplit("/", 1)[-1]:
            what = f"the CARLA server at {address} has loaded {clean(name)}, not {clean(options.town)}"
            fix = f"load it: python PythonAPI/util/config.py --map {clean(options.town)}; or write town: {clean(name)}"
            raise BridgeError("bridge-mismatch", what, fix)
    return carla, client, world
