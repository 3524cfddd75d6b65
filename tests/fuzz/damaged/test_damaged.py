"""Each kind of file, damaged in many ways: it is read, or it is an error with a code, soon and within little memory.

The quick tests try 20 ways each, the gate 500 and ``nox -s nightly`` 10,000. A way is a number, so that a failure names
it: ``python -m pytest tests/fuzz/damaged -k KIND`` tries it again.
"""

from __future__ import annotations

import os
import random
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim.diagnostics.errors import CodedError, ScenarioError, ScenarioNotFoundError
from tests.fuzz.damaged.kind import Kind
from tests.fuzz.damaged.kinds import KINDS
from tests.fuzz.damaged.ways import damaged

pytestmark = pytest.mark.one_python
GATE, NIGHT = 500, 10_000
QUICK = 20
_CODES = {*CODES, *TOOL_CODES} - {"internal-error"}
_SECONDS = 10
"""Time for one reading, on a busy machine."""
_MOST_MEMORY = 1 << 30
"""Growth of the process in one test [bytes]."""


@pytest.mark.parametrize("name", KINDS)
def test_some_damages(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    try_ways(name, KINDS[name], tmp_path, range(max(1, QUICK // KINDS[name].share)))


@pytest.mark.nightly
@pytest.mark.slow(30)
@pytest.mark.parametrize("name", KINDS)
def test_many_damages(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ways = NIGHT if os.environ.get("IRSIM_NIGHTLY") else GATE
    try_ways(name, KINDS[name], tmp_path, range(0, ways, KINDS[name].share))


def try_ways(name: str, kind: Kind, folder: Path, numbers: range) -> None:
    """Read an example in each of some ways of being damaged, a missing file and a folder."""
    file = kind.make(folder)
    content, before = file.read_bytes(), memory()
    kind.read(file, random.Random(0))  # it is sound
    for number in numbers:
        draw = random.Random(f"{name} {number}")
        file.write_bytes(damaged(content, draw))
        read(kind.read, file, draw, f"{name}, way {number}")
    file.unlink()
    read(kind.read, file, random.Random(0), f"{name}, missing")
    file.mkdir()
    read(kind.read, file, random.Random(0), f"{name}, a folder")
    assert memory() - before < _MOST_MEMORY, f"reading damaged files of {name} takes too much memory"


def read(reader: Any, file: Path, draw: random.Random, way: str) -> None:
    """Read a file, and accept errors with codes of the list only."""
    codes: list[str] = []
    try:
        with within(_SECONDS):
            reader(file, draw)
    except ScenarioError as error:
        codes = [item.code for item in error.diagnostics]
    except ScenarioNotFoundError:
        codes = ["file-not-found"]
    except CodedError as error:
        codes = [error.code]
    except BaseException as error:
        raise AssertionError(f"{way}: {type(error).__name__}: {error}") from error
    unknown = [code for code in codes if code not in _CODES]
    assert not unknown, f"{way}: {unknown}"


class Frozen(BaseException):
    """Reading takes too long."""


@contextmanager
def within(seconds: int) -> Iterator[None]:
    """Raise :class:`Frozen` after some time, where signals can do that."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def frozen(*_: object) -> None:
        raise Frozen(f"it takes more than {seconds} s")

    before = signal.signal(signal.SIGALRM, frozen)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def memory() -> int:
    """The most memory that the process has had [bytes]; 0 where that is not known."""
    if sys.platform == "win32":
        return 0
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
