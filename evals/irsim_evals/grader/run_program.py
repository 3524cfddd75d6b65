"""Start one program of an answer in its folder, with what it needs to run scenarios and nothing else.

Run as ``python -I -m irsim_evals.grader.run_program PROGRAM [LOG]``, in the folder. With LOG the program is rehearsed:
it simulates nothing, and the episodes that it starts are written to that file. The rules of
:mod:`irsim_evals.grader.program_rules` have been checked before; the hook here refuses what they cannot see.
"""

from __future__ import annotations

import os
import runpy
import sys
from pathlib import Path
from typing import Any

_REFUSED = ("socket.connect", "socket.bind", "socket.getaddrinfo", "os.system", "os.exec",
            "os.remove", "os.rename", "os.rmdir", "os.symlink", "os.link", "os.chmod", "os.chown", "ctypes.dlopen",
            "shutil.rmtree", "webbrowser.open", "urllib.Request")  # fmt: skip
_WRITE = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


def main() -> None:
    """Run the program that the first argument names."""
    program, *log = sys.argv[1:]
    folder = os.path.realpath(os.getcwd())
    import numpy  # noqa: F401  (libraries load their own parts before the hook watches)

    import irsim
    import irsim.benchmarks
    import irsim.env  # noqa: F401
    from irsim_evals.grader.episode_log import rehearse

    if log:
        rehearse(Path(log[0]).absolute())

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        if event in _REFUSED:
            raise PermissionError(f"a runner may not do this: {event}")
        starts = event in ("subprocess.Popen", "os.posix_spawn") and arguments
        if starts and os.path.realpath(os.fsdecode(arguments[0])) != _PYTHON:
            raise PermissionError("a runner starts no other programs")
        if event == "open" and isinstance(arguments[0], (str, bytes)) and _writes(arguments):
            path = os.path.realpath(os.fsdecode(arguments[0]))
            if not path.startswith((folder + os.sep, "/dev/")):
                raise PermissionError(f"a runner writes only into its folder, not {path}")

    sys.dont_write_bytecode = True
    sys.argv = [program]
    sys.addaudithook(watch)
    runpy.run_path(program, run_name="__main__")


_PYTHON = os.path.realpath(sys.executable)


def _writes(arguments: tuple[Any, ...]) -> bool:
    mode, flags = arguments[1], arguments[2]
    return bool(flags & _WRITE) if mode is None else any(letter in str(mode) for letter in "wax+")


if __name__ == "__main__":
    main()
