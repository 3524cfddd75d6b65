"""A suite, a marker and fixtures for tests of benchmarks."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from irsim.common.child import ONE_THREAD, Child, python
from tests.warm import warm

SUITE = """
suite: small
version: 1
title: Robots in a square
scenarios:
  - name: robots
    vary: {"robot[0].number": [3, 6]}
    scenario:
      world: {width: 8, height: 8}
      robot:
        - number: 3
          kinematics: {name: diff}
          shape: {name: circle, radius: 0.2}
          distribution: {name: random}
seeds: {first: 7, count: 10}
steps: 150
protocols: [freeze, yield]
policies: {orca: {name: orca, timeHorizon: 2}, dash: dash}
"""
FRAGILE = """\
import os, signal, time
from pathlib import Path
from irsim.benchmarks import episode, together

def fragile(simulation, *rest, plain=episode.horizon_of):
    [seed] = simulation.state.seed.tolist()
    mark = Path({folder!r}, f"{{simulation.scenario.objects[0].behavior.name}}-{{seed}}")
    if os.getpid() == {mine}:
        time.sleep(1.0)  # leaves the work to the others
    elif seed in {seeds} and ({always} or not mark.exists()):
        with mark.open("a") as file:
            file.write("x")
        os.kill(os.getpid(), signal.SIGKILL)
    return plain(simulation, *rest)

if {here} or os.getpid() != {mine}:
    episode.horizon_of = together.horizon_of = fragile
"""


def write_fragile(folder: Path, name: str, seeds: range, *, always: bool, here: bool = True) -> None:
    """Write a module with which other processes die in some episodes, always or the first time.

    With ``here`` this process, which must forget the module afterwards, is slow, so that the others have the work.
    """
    code = FRAGILE.format(folder=str(folder), mine=os.getpid(), seeds=seeds, always=always, here=here)
    (folder / f"{name}.py").write_text(code, encoding="utf-8")


@pytest.fixture(autouse=True)
def warm_helpers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Further processes of a benchmark have loaded already what takes long."""

    def start() -> Child:
        return Child(warm(python("irsim.benchmarks.pool")), start_new_session=False, env=os.environ | ONE_THREAD)

    monkeypatch.setattr("irsim.benchmarks.pool._start", start)


@pytest.fixture
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Further processes start with the benchmark, not some time later."""
    monkeypatch.setattr("irsim.benchmarks.pool._START_DELAY_S", 0.0)
