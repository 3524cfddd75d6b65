"""Episodes in several processes: what they write, when they end, and that no work of one that dies is lost."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import irsim
import irsim.benchmarks
from irsim.benchmarks import episode, together
from irsim.benchmarks.pool import WorkerError
from tests.benchmarks.conftest import write_fragile

SCENE = """\
world: {width: 8, height: 8}
robot: {number: 4, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, distribution: {name: random},
        behavior: {name: dash}}
"""
needs_kill = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs signals")


@pytest.fixture
def forgotten(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, at_once: None, ordinary_processes: None) -> None:
    """The module of a test is found in its folder, and forgotten."""
    monkeypatch.syspath_prepend(tmp_path)
    for module in (episode, together):
        monkeypatch.setattr(module, "horizon_of", episode.horizon_of)
    monkeypatch.delitem(sys.modules, "fragile", raising=False)
    episode.scenario_of.cache_clear()


@needs_kill
@pytest.mark.slow(3)
@pytest.mark.usefixtures("forgotten")
def test_a_process_that_is_killed_is_replaced(tmp_path: Path) -> None:
    undisturbed = irsim.benchmark(SCENE, ["dash", "orca"], 12, workers=1)
    write_fragile(tmp_path, "fragile", range(4, 12, 2), always=False)
    counts: list[tuple[int, int]] = []
    result = irsim.benchmark(
        SCENE, ["dash", "orca"], 12, workers=3, imports=["fragile"], progress=lambda *now: counts.append(now)
    )
    assert result.episodes == undisturbed.episodes
    assert result.rows == undisturbed.rows
    assert len(list(tmp_path.glob("*-*"))) >= 3
    assert counts[-1] == (24, 24)


@needs_kill
@pytest.mark.slow(3)
@pytest.mark.usefixtures("forgotten")
def test_an_episode_in_which_every_process_dies_is_given_up_and_the_others_are_kept(tmp_path: Path) -> None:
    write_fragile(tmp_path, "fragile", range(7, 8), always=True)
    with pytest.raises(WorkerError, match=r"3 processes died while they ran \(text\), seed 7, with dash"):
        irsim.benchmark(SCENE, ["dash"], 12, workers=2, imports=["fragile"], log=tmp_path / "log")
    assert (tmp_path / "dash-7").read_text() == "xxx"
    kept = irsim.benchmarks.logged(tmp_path / "log")
    assert {row.seed for row in kept.episodes} >= set(range(7))
    assert 7 not in {row.seed for row in kept.episodes}


PROGRAM = """
import os, threading
from irsim.benchmarks import episode, together
def run_together(job, seeds):
    for seed in seeds:
        print("from Python")
        os.write(1, b"from a library")
        if seed < 0:
            threading.Event().wait()
        yield seed
together.run_together = run_together
episode.Job.of_data = staticmethod(lambda data: data)
from irsim.benchmarks.pool import main
main()
"""


def test_prints_do_not_mix_with_results_and_the_process_ends_with_its_input_though_an_episode_goes_on() -> None:
    pipe, nowhere = subprocess.PIPE, subprocess.DEVNULL
    with subprocess.Popen([sys.executable, "-c", PROGRAM], stdin=pipe, stdout=pipe, stderr=nowhere) as process:
        process.stdin.write(json.dumps({"job": {}, "seeds": [3, 4, -1]}).encode() + b"\n")
        process.stdin.flush()
        told = [process.stdout.readline() for _ in range(3)]
        assert told == [b"ready\n", b'{"result": 3}\n', b'{"result": 4}\n']
        process.stdin.close()
        try:
            assert process.wait(20) == 0
        finally:
            process.kill()
