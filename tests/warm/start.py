"""Run as a program: have the server at a socket run a Python program with this process's files, folder and variables.

This process ends as the program does, by exit status or signal; the program ends with this process. It needs no more
than the standard library, so it is there at once: ``python -IS start.py SOCKET -m irsim run room.yaml``.
"""

from __future__ import annotations

import contextlib
import marshal
import os
import signal
import socket
import sys


def main(address: str, arguments: list[str]) -> None:
    """Ask for the program and wait for its end."""
    files = inherited()
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(address)
        wanted = marshal.dumps((arguments, os.getcwd(), dict(os.environ), files))
        socket.send_fds(connection, [len(wanted).to_bytes(4, "big")], [0, 1, 2, *files])
        connection.sendall(wanted)
        code = int(connection.recv(16) or b"70")  # the server is gone
    if code < 0:
        with contextlib.suppress(OSError):  # it has no handler that could be changed
            signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    os._exit(code)


def inherited() -> list[int]:
    """The open files besides standard input, output and error that the caller has passed on."""
    files = []
    for name in os.listdir("/dev/fd"):
        with contextlib.suppress(OSError):  # the list itself is closed by now
            if int(name) > 2 and os.get_inheritable(int(name)):
                files.append(int(name))
    return files


main(sys.argv[1], sys.argv[2:])
