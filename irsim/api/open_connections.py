"""The bridges of a run: whether they may be opened, and what is said when they are connected."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.bridges.base import Bridge, BridgeError
from irsim.bridges.connect import open_bridges
from irsim.bridges.options import check_files
from irsim.common.text import seconds
from irsim.scenario.limits import DEFAULT_LIMITS, Limits

if TYPE_CHECKING:
    from irsim.bridges.connect import Connection

__all__ = ["allowed_bridges", "connected_sentence"]


def allowed_bridges(options: Sequence[Any], limits: Limits | None) -> list[Bridge]:
    """The bridges of some options, not connected yet.

    Raises:
        BridgeError: They may not be opened here.
    """
    if options and not (limits or DEFAULT_LIMITS).bridges:
        what = f"the scenario has bridges ({', '.join(str(one.name) for one in options)}), which are not opened here"
        raise BridgeError(
            "bridges-disabled", what, "leave out the key bridges, or start irsim-mcp with --enable-bridges"
        )
    if limits is not None and limits.root is not None:
        check_files(options, Path(limits.root))
    return open_bridges(options)


def connected_sentence(connection: Connection, bridges: Sequence[Bridge], time_limit: float) -> str:
    """With what a run is connected, and when it ends: at ``time_limit`` [s] at the latest."""
    stops = " and stops the robots" if any(bridge.mode == "real" for bridge in bridges) else ""
    until = f"the run ends when all robots have arrived or stopped, or at {seconds(time_limit)}"
    return f"connected to {connection.peers()}; {until}; Ctrl-C ends it now{stops}"
