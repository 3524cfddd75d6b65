"""The identity of the engine: a hash of the sources that decide the numbers of an episode.

The version stays the same between two releases, and hashes of plans say what was run, not by what. The identity is the
same on all systems: it covers sources, not compiled files, and neither NumPy nor the files of policies, whose hashes
stand beside it in results.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import irsim._core as core
from irsim.common.hashing import digest
from irsim.common.installed import version

__all__ = ["ENGINE_PARTS", "engine", "program"]

ENGINE_PARTS = (
    *("common", "options", "components", "scenario", "simulation", "objects", "navigation", "policies", "compat"),
    *("env", "metrics", "episodes", "benchmarks/episode.py", "benchmarks/roles.py", "benchmarks/together.py"),
)
"""Folders and files of the package whose Python takes part in an episode or measures it."""
_LENGTH = 12


@cache
def engine() -> str:
    """The identity: the first 12 digits of a SHA-256, of the core's sources and of ``ENGINE_PARTS``, as installed."""
    root = Path(__file__).parents[1]
    files = [file for part in ENGINE_PARTS for file in _sources(root / part)]
    texts = (f"{file.relative_to(root).as_posix()} {digest(_text(file))}\n" for file in sorted(files))
    return digest(core.sources, "\n", *texts)[:_LENGTH]


def program() -> str:
    """Version and engine, as two machines must have them in common to share a benchmark."""
    return f"{version()}, engine {engine()}"


def _sources(part: Path) -> list[Path]:
    return [part] if part.is_file() else list(part.rglob("*.py"))


def _text(file: Path) -> bytes:
    """The content of a file; line ends do not count."""
    return file.read_bytes().replace(b"\r\n", b"\n")
