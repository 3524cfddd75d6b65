"""Episodes in several processes: one that dies is replaced, and nothing of its work is lost or done twice."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

import pytest

import irsim
import irsim.benchmarks
from irsim.benchmarks import episode
from irsim.benchmarks.pool import WorkerError

SCENE = """\
world: {width: 8, height: 8}
robot: {number: 4, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, distribution: {name: random},
        behavior: {name: dash}}
"""
FRAGILE = """\
import os, signal, time
from pathlib import Path
from irsim.benchmarks import episode

def fragile(scenario, env, *rest, plain=episode.horizon_of):
    mark = Path({folder!r}, f"{{scenario.objects[0].behavior.name}}-{{env.seed}}")
    if os.getpid() == {mine}:
        time.sleep(1.0)  # leaves the work to the others
    elif env.seed in {seeds} and ({always} or not mark.exists()):
        with mark.open("a") as file:
            file.write("x")
        os.kill(os.getpid(), signal.SIGKILL)
    return plain(scenario, env, *rest)

episode.horizon_of = fragile
"""
pytestmark = [pytest.mark.slow(3), pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs signals")]


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Further processes start at once; the module of a test is forgotten."""
    monkeypatch.setattr("irsim.benchmarks.pool._START_DELAY_S", 0.0)
    monkeypatch.setattr("irsim.benchmarks.episode.horizon_of", episode.horizon_of)
    monkeypatch.delitem(sys.modules, "fragile", raising=False)
    episode.scenario_of.cache_clear()


def fragile(monkeypatch: pytest.MonkeyPatch, folder: Path, seeds: range, *, always: bool) -> None:
    """Write a module with which further processes die in some episodes, always or the first time."""
    code = FRAGILE.format(folder=str(folder), mine=os.getpid(), seeds=seeds, always=always)
    (folder / "fragile.py").write_text(code, encoding="utf-8")
    monkeypatch.syspath_prepend(folder)


def test_a_process_that_is_killed_is_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    undisturbed = irsim.benchmark(SCENE, ["dash", "orca"], 12, workers=1)
    fragile(monkeypatch, tmp_path, range(4, 12, 2), always=False)
    counts: list[tuple[int, int]] = []
    result = irsim.benchmark(
        SCENE, ["dash", "orca"], 12, workers=3, imports=["fragile"], progress=lambda *now: counts.append(now)
    )
    assert result.episodes == undisturbed.episodes
    assert result.rows == undisturbed.rows
    assert len(list(tmp_path.glob("*-*"))) >= 3
    assert counts[-1] == (24, 24)


def test_an_episode_in_which_every_process_dies_is_given_up_and_the_others_are_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fragile(monkeypatch, tmp_path, range(7, 8), always=True)
    with pytest.raises(WorkerError, match=r"3 processes died while they ran \(text\), seed 7, with dash"):
        irsim.benchmark(SCENE, ["dash"], 12, workers=2, imports=["fragile"], log=tmp_path / "log")
    assert (tmp_path / "dash-7").read_text() == "xxx"
    kept = irsim.benchmarks.logged(tmp_path / "log")
    assert {row.seed for row in kept.episodes} >= set(range(7))
    assert 7 not in {row.seed for row in kept.episodes}
