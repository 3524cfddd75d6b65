"""Start Python programs as processes that have loaded already what takes long: most of a short program is imports.

Tests that are about something else than the start of a process run ``warm(command)`` in place of the command. The
process is a fork of a server that has imported the modules and done nothing else; its files, folder, variables, exit
status and end are as for an ordinary process. Signals do not reach it, it is not a child of the test, and it lives a
moment longer than a command that is killed: tests of those, and of what a start loads or costs, ask for the fixture
``ordinary_processes`` or start processes as usual.
"""

from __future__ import annotations

import atexit
import functools
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

__all__ = ["LIBRARIES", "PACKAGE", "SERVERS", "warm", "warm_mcp"]

HERE = Path(__file__).resolve().parent
LIBRARIES = (
    "numpy",
    "pydantic",
    "jsonschema",
    "yaml",
    "shapely",
    "matplotlib.pyplot",
    "matplotlib.animation",
    "matplotlib.backends.backend_agg",
    "mpl_toolkits.mplot3d",
    "PIL.Image",
)
"""Libraries that irsim builds on."""
PACKAGE = (*LIBRARIES, "irsim.*", "irsim_mcp.*", "tests.warm.schema")
"""irsim and its server, too, and the schema of the language."""
ENABLED = True
"""Whether processes start warm; the fixture ``ordinary_processes`` has them start as users start them."""
SERVERS: list[int] = []
"""Process ids of the servers of this process."""


def warm(command: Sequence[str | Path], modules: tuple[str, ...] = PACKAGE) -> list[str]:
    """The command that runs a program of this Python in a process that has modules loaded.

    Args:
        command: ``sys.executable`` and its arguments: a script, ``-m module`` or ``-c code``, with arguments.
        modules: Modules to load.
    """
    words = [str(word) for word in command]
    assert words[0] == sys.executable
    if not ENABLED or not hasattr(os, "fork"):
        return words
    return [sys.executable, "-IS", str(HERE / "start.py"), _server(modules), *words[1:]]


def warm_mcp(*arguments: str) -> list[str]:
    """The command of an MCP server whose workers start warm, too."""
    prefix = warm([sys.executable])
    if len(prefix) == 1:
        return [*prefix, "-m", "irsim_mcp", *arguments]
    return [*prefix, "-c", _SERVER.format(prefix=prefix), *arguments]


_SERVER = """\
import runpy
from irsim_mcp import worker
command = worker._command
worker._command = lambda: [*{prefix!r}, *command()[1:]]
runpy.run_module("irsim_mcp", run_name="__main__", alter_sys=True)
"""


@functools.cache
def _server(modules: tuple[str, ...]) -> str:
    """The socket of a server that has loaded the modules; it lives as long as this process."""
    folder = tempfile.TemporaryDirectory(prefix="irsim-warm-")  # short: the length of addresses is limited
    address = os.path.join(folder.name, "socket")
    command = [sys.executable, str(HERE / "server.py"), address, *modules]
    server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert server.stdin is not None
    assert server.stdout is not None
    assert server.stdout.readline() == b"ready\n"
    SERVERS.append(server.pid)

    @atexit.register
    def end() -> None:
        assert server.stdin is not None
        server.stdin.close()
        server.wait()
        folder.cleanup()

    return address
