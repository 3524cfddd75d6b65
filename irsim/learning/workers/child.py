"""A worker process makes its worlds, and carries out commands until its standard input is closed."""

from __future__ import annotations

import os
import signal
import sys
import threading
from typing import Any

from irsim.common.child import answers, end_with_parent
from irsim.learning.workers.process import DONE, packed_error, read_message, write_message

__all__ = ["main"]

_GRACE_S = 1.0
"""Time for the interpreter to end by itself [s]."""


def main() -> None:
    """Carry out commands."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is a matter of the parent
    pipe = answers()
    end_with_parent()
    try:
        _serve(pipe.fileno())
    except (EOFError, OSError):  # the parent has closed the pipes, or does not live any more
        end = threading.Timer(_GRACE_S, os._exit, (0,))
        end.daemon = True
        end.start()


def _serve(pipe: int) -> None:
    from irsim.learning.workers.memory import SharedMemory  # while the parent makes its own worlds
    from irsim.learning.workers.part import Part, python_parts
    from irsim.learning.worlds import Worlds

    setup: dict[str, Any] = read_message(0)
    try:
        sys.argv = setup["argv"]  # files of scenarios are looked for beside the script, too
        worlds = Worlds(setup["task"], setup["n"], seed=setup["seed"], threads=setup["threads"], level=setup["level"])
        if python_parts(worlds) != setup["python"]:
            raise RuntimeError("the program that made the environment has registered behaviors, sensors or drives")
    except BaseException as error:
        read_message(0)
        write_message(pipe, packed_error(error), b"\1")
        return
    layout = read_message(0)
    memory = SharedMemory(setup["memory"])
    part = Part(worlds, setup["number"], setup["first"], layout, memory.arrays(layout))
    memory.close()
    os.write(pipe, DONE)
    while True:
        command = read_message(0)
        try:
            part.do(command)
        except BaseException as error:  # of a function of the user, SystemExit too: it is raised in the parent
            write_message(pipe, packed_error(error), b"\1")
        else:
            os.write(pipe, DONE)
