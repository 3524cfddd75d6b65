"""Run as a program: import modules, then fork for each Python program that is asked for at a socket.

``python server.py SOCKET MODULE…``; it prints a line when it is ready and ends with its standard input.
"""

from __future__ import annotations

import atexit
import gc
import importlib
import marshal
import os
import pkgutil
import runpy
import selectors
import signal
import socket
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import NoReturn, TextIO

from irsim.common.extras import ExtraError

__all__ = ["end", "load", "run", "serve"]

Program = tuple[list[str], str, dict[str, str], list[int]]
"""Arguments after the interpreter, the working directory, environment variables, numbers of files that it inherits."""
_ASIDE = 900
"""Number of the first inherited file until the server's own files are closed."""
_MAX_FILES = 11
"""Number of files that a program gets, with standard input, output and error."""


def load(name: str) -> None:
    """Import a module, or with ``.*`` at the end a package and all that is in it, but for programs and old names."""
    package = importlib.import_module(name.removesuffix(".*"))
    if name.endswith(".*"):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not module.name.endswith(".__main__") and not module.name.startswith("irsim.compat."):
                with suppress(ExtraError, ModuleNotFoundError):  # a module for libraries that are not installed here
                    importlib.import_module(module.name)


def serve(address: str) -> Program | None:
    """Fork for each program; returns it in the process that has to run it, and None at the end of standard input."""
    waiting: dict[int, socket.socket] = {}
    ended, note = os.pipe()
    os.set_blocking(ended, False)
    os.set_blocking(note, False)
    signal.set_wakeup_fd(note)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    selector = selectors.DefaultSelector()
    with socket.socket(socket.AF_UNIX) as door:
        door.bind(address)
        door.listen(64)
        for source in (door, ended, 0):
            selector.register(source, selectors.EVENT_READ)
        print("ready", flush=True)
        while True:
            ready = [key.fileobj for key, _ in selector.select()]
            if ended in ready:
                with suppress(BlockingIOError):
                    os.read(ended, 1024)
            _report(waiting, selector)
            if 0 in ready:
                for pid in waiting:
                    _kill(pid)
                return None
            for connection in ready:
                if connection is door:
                    connection, _ = door.accept()
                    pid, program = _start(connection)
                    if program is not None:
                        for descriptor in (ended, note, *(other.fileno() for other in waiting.values())):
                            os.close(descriptor)
                        selector.close()
                        return program
                    waiting[pid] = connection
                    selector.register(connection, selectors.EVENT_READ, pid)
                elif isinstance(connection, socket.socket) and connection in waiting.values():  # who asked is gone
                    selector.unregister(connection)
                    for pid, other in waiting.items():
                        if other is connection:
                            _kill(pid)


def _report(waiting: dict[int, socket.socket], selector: selectors.BaseSelector) -> None:
    """Pass on how programs have ended."""
    while waiting:
        pid, status = os.waitpid(-1, os.WNOHANG)
        if pid == 0:
            return
        connection = waiting.pop(pid)
        with suppress(KeyError):
            selector.unregister(connection)
        with connection, suppress(OSError):
            connection.sendall(str(os.waitstatus_to_exitcode(status)).encode())


def _kill(pid: int) -> None:
    """End a program and what it has started."""
    with suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)


def _start(connection: socket.socket) -> tuple[int, Program | None]:
    """A process for the program that a connection asks for; in that process also the program."""
    head, files, _, _ = socket.recv_fds(connection, 4, _MAX_FILES)
    with connection.makefile("rb") as stream:
        wanted: Program = marshal.loads(stream.read(int.from_bytes(head, "big")))
    pid = os.fork()
    if pid == 0:
        os.setsid()
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        connection.close()
        for number, file in enumerate(files):
            os.dup2(file, number if number < 3 else _ASIDE + number - 3)
    for file in files:
        os.close(file)
    return pid, wanted if pid == 0 else None


def run(program: Program) -> None:
    """Do in this process what ``python ARGUMENTS…`` does."""
    arguments, folder, variables, files = program
    for place, number in enumerate(files):
        os.dup2(_ASIDE + place, number)
        os.close(_ASIDE + place)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(variables)
    sys.stdin, sys.stdout, sys.stderr = sys.__stdin__, sys.__stdout__, sys.__stderr__ = _streams()  # type: ignore[misc]
    _choose_backend(variables.get("MPLBACKEND"))
    isolated = False
    while arguments and arguments[0] in ("-I", "-X"):
        isolated |= arguments[0] == "-I"
        arguments = arguments[2 if arguments[0] == "-X" else 1 :]
    kind, *rest = arguments
    if not isolated:
        sys.path[:0] = filter(None, variables.get("PYTHONPATH", "").split(os.pathsep))
    if kind == "-m":
        sys.argv = rest
        if not isolated:
            sys.path.insert(0, folder)
        if not hasattr(sys.modules.get(rest[0]), "__path__"):  # of a module that is loaded already, runpy would warn
            sys.modules.pop(rest[0], None)
        runpy.run_module(rest[0], run_name="__main__", alter_sys=True)
    elif kind == "-c":
        sys.argv = ["-c", *rest[1:]]
        if not isolated:
            sys.path.insert(0, "")
        exec(compile(rest[0], "<string>", "exec"), sys.modules["__main__"].__dict__)
    else:
        assert not kind.startswith("-"), f"the server does not know the option {kind}"
        sys.argv = [kind, *rest]
        sys.path.insert(0, os.path.dirname(os.path.abspath(kind)))
        runpy.run_path(kind, run_name="__main__")


def _streams() -> tuple[TextIO, TextIO, TextIO]:
    """Standard input, output and error as the interpreter opens them."""
    out, error = (open(number, "w", encoding="utf-8", closefd=False) for number in (1, 2))  # noqa: SIM115
    out.reconfigure(line_buffering=out.isatty())
    error.reconfigure(errors="backslashreplace", line_buffering=True)
    return open(0, encoding="utf-8", closefd=False), out, error


def _choose_backend(name: str | None) -> None:
    """Have Matplotlib, which has read the variable when it was imported, use a backend."""
    matplotlib = sys.modules.get("matplotlib")
    if name and matplotlib is not None:
        matplotlib.rcParams["backend"] = name


def end(program: Program) -> NoReturn:
    """Run a program and exit as the interpreter does, without tidying up its memory."""
    code: object = 0
    try:
        run(program)
    except SystemExit as stop:
        code = 0 if stop.code is None else stop.code
        if not isinstance(code, int):
            print(code, file=sys.stderr)
            code = 1
    except BaseException:
        sys.excepthook(*sys.exc_info())
        code = 1
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError:
        code = 120
    os._exit(int(code) & 0xFF)  # type: ignore[call-overload]


if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[2])
    for _name in sys.argv[2:]:
        load(_name)
    del sys.path[0]
    if _known := sys.modules.get("tests.warm.schema"):
        _known.json_schema._definitions = _known.definitions
        for _user_code in (True, False):
            _known.definitions(_user_code)
        for _registry in _known.REGISTRIES.values():
            _registry._plugins = None  # what is installed is looked up by each program
    gc.collect()
    gc.freeze()
    _program = serve(sys.argv[1])
    if _program is not None:
        end(_program)
