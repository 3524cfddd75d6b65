"""Compiler launcher: what has been compiled before, wherever its files lay, is copied instead of compiled again.

pip builds in folders with random names, which defeats ccache and sccache. Here the key of an object is the preprocessed
source without line markers, the compiler, and the options that are not paths. Objects with source positions (debug
information, sanitizers) are always compiled.

Usage: ``compile_once.py OBJECTS COMPILER ARGUMENT…``, with the folder the objects are kept in.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

PATHS = {"-o", "-I", "-isystem", "-MF", "-MT", "-MQ"}
"""Options followed by a path, or beginning with it, that has no influence on the object."""


def split(arguments: list[str]) -> tuple[list[str], dict[str, str]]:
    """The arguments that are not paths, and the paths (``-c``: the source)."""
    kept, paths = [], {}
    rest = iter(arguments)
    for argument in rest:
        if argument in PATHS or argument == "-c":
            paths[argument] = next(rest, "")
        elif not argument.startswith("-I"):
            kept.append(argument)
    return kept, paths


def preprocessed(command: list[str]) -> bytes:
    """The source as the compiler proper sees it. Writes the file of dependencies, too, if the command asks for one."""
    at = command.index("-o")
    shorter = [part for part in (*command[:at], *command[at + 2 :]) if part != "-c"]
    return subprocess.run([*shorter, "-E", "-P"], stdout=subprocess.PIPE, check=True).stdout


def main(folder: Path, command: list[str]) -> int:
    """Make the object; returns the exit status of the compiler."""
    kept, paths = split(command[1:])
    located = any(option.startswith(("-g", "-fsanitize", "--coverage")) for option in kept)
    if located or not {"-c", "-o"} <= paths.keys():
        return subprocess.run(command, check=False).returncode
    compiler = shutil.which(command[0]) or command[0]
    version = os.stat(compiler)
    kept.sort(key=lambda option: not option.startswith("-std="))  # it is first or last, depending on CMake's version
    key = hashlib.sha256(repr((os.path.realpath(compiler), version.st_size, version.st_mtime_ns, kept)).encode())
    try:
        key.update(preprocessed(command))
    except subprocess.CalledProcessError as error:
        return error.returncode
    known = folder / key.hexdigest()
    if not known.exists():
        status = subprocess.run(command, check=False).returncode
        if status:
            return status
        fresh = known.with_suffix(f".{os.getpid()}")
        shutil.copyfile(paths["-o"], fresh)
        fresh.replace(known)
        return 0
    shutil.copyfile(known, paths["-o"])
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
