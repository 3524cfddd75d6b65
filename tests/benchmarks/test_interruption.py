"""A benchmark that is killed, or finds the disk full, at any moment goes on to the files of an undisturbed run.

Moments are counted in writes, see ``interrupted.py``, and in seconds.
"""

from __future__ import annotations

import hashlib
import os
import random
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests.benchmarks.conftest import SUITE
from tests.warm import warm

SCRIPT = Path(__file__).with_name("interrupted.py")
EASY = """
suite: easy
version: 1
title: One robot
scenarios:
  - name: robot
    scenario: {robot: {kinematics: {name: diff}, state: [1, 1], goal: [2, 1], distribution: {name: random}}}
seeds: {count: 12}
steps: 300
policies: {dash: dash}
"""
"""Little work, for the quick tests."""
REPORT_WRITES = 30
"""Number of writes that there are at least from the result of SUITE to the end."""
Moment = tuple[str, int, str]
"""Phase, number of the write, and what happens there: the arguments of ``interrupted.py``."""
needs_kill = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs signals")


class Folder:
    """A folder in which a suite is run."""

    def __init__(self, place: Path, text: str) -> None:
        self.place = place
        (place / "suite.yaml").write_text(text, encoding="utf-8")
        self.arguments = ["benchmark", "suite.yaml", "-o", "run", "--resume"]

    def run(self, moment: Moment = ("run", 0, "not"), workers: int = 1) -> subprocess.CompletedProcess[str]:
        """Run the suite, or go on with it, until a moment."""
        words = [sys.executable, str(SCRIPT), *map(str, moment), *self.arguments, "--workers", str(workers)]
        return subprocess.run(warm(words), cwd=self.place, capture_output=True, text=True, check=False)

    def finish(self, workers: int = 1) -> dict[str, str]:
        """Run the suite to its end, and return the hash of every file but the one with wall-clock times."""
        done = self.run(workers=workers)
        assert done.returncode == 0, done.stderr
        run = self.place / "run"
        assert (run / "timing.json").is_file()
        files = [path for path in sorted(run.rglob("*")) if path.is_file() and path.name != "timing.json"]
        return {str(path.relative_to(run)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture
def easy(tmp_path: Path) -> Folder:
    return Folder(tmp_path, EASY)


@pytest.fixture
def small(tmp_path: Path) -> Folder:
    return Folder(tmp_path, SUITE)


Hashes = dict[str, str]
"""File of a run -> its hash."""


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Hashes]:
    """The files of each suite that was run without a disturbance; made once they are asked for."""

    class Known(dict[str, Hashes]):
        def __missing__(self, text: str) -> Hashes:
            self[text] = Folder(tmp_path_factory.mktemp("undisturbed"), text).finish()
            return self[text]

    return Known()


def assert_refused(done: subprocess.CompletedProcess[str]) -> None:
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    assert re.search(r"error (disk-full|not-writable|file-access): .*(make room|the space left)", done.stderr), (
        done.stderr
    )


@needs_kill
def test_a_killed_run_goes_on_as_if_nothing_had_happened(easy: Folder, undisturbed: dict[str, Hashes]) -> None:
    for moment in (("run", 9, "half"), ("run", 10, "before"), ("report", 2, "half")):
        assert easy.run(moment).returncode == -signal.SIGKILL
    assert easy.finish() == undisturbed[EASY]


def test_a_full_disk_is_an_error_after_which_the_run_goes_on(easy: Folder, undisturbed: dict[str, Hashes]) -> None:
    for moment in (("run", 8, "full"), ("report", 1, "full")):
        assert_refused(easy.run(moment))
    assert easy.finish() == undisturbed[EASY]


@needs_kill
@pytest.mark.slow(60)
@pytest.mark.parametrize("draw", range(4))
def test_five_kills_at_random_moments_change_no_file(draw: int, small: Folder, undisturbed: dict[str, Hashes]) -> None:
    for moment in random_moments(random.Random(draw)):
        if isinstance(moment, float):
            kill_after(moment, small)
        else:
            assert small.run(moment, workers=2).returncode == -signal.SIGKILL, moment
        if draw % 2 and (small.place / "run" / "plan.json").exists():
            small.arguments = ["benchmark", "-o", "run", "--resume"]
    assert small.finish(workers=2) == undisturbed[SUITE]


def random_moments(rng: random.Random) -> Iterable[Moment | float]:
    """Moments in an order in which a run that goes on can reach them; two of five are in the writing of the report."""
    hows = ("before", "half", "after")
    yield ("run", rng.randrange(1, 8), rng.choice(hows))
    yield ("run", rng.randrange(8, 60), rng.choice(hows))
    yield rng.uniform(0.3, 1.5)
    yield ("report", rng.randrange(1, REPORT_WRITES), rng.choice(hows))
    yield ("report", rng.randrange(1, REPORT_WRITES), rng.choice(hows))


def kill_after(seconds: float, folder: Folder) -> None:
    """Kill a run with all of its processes after a time, wherever it is."""
    command = [sys.executable, "-m", "irsim", *folder.arguments, "--workers", "2"]
    process = subprocess.Popen(
        command, cwd=folder.place, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    time.sleep(seconds)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@pytest.mark.slow(20)
def test_a_disk_that_is_full_at_any_moment_changes_no_file(small: Folder, undisturbed: dict[str, Hashes]) -> None:
    for phase, number in (("run", 1), ("run", 3), ("run", 30), ("report", 1), ("report", 7), ("report", 20)):
        assert_refused(small.run((phase, number, "full"), workers=2))
    assert small.finish() == undisturbed[SUITE]


@pytest.mark.slow(10)
def test_files_that_may_not_grow_any_more_change_no_file(small: Folder, undisturbed: dict[str, Hashes]) -> None:
    resource = pytest.importorskip("resource")
    for limit in (10, 3_000, 40_000, 150_000):
        done = subprocess.run(
            [sys.executable, "-m", "irsim", *small.arguments],
            cwd=small.place,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
        )
        assert done.returncode == 1, done.stderr
        assert "Traceback" not in done.stderr
        assert "File too large" in done.stderr
    assert small.finish() == undisturbed[SUITE]
