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

from tests.warm import warm

SCRIPT = Path(__file__).with_name("interrupted.py")
SCENARIO = """
      world: {width: 8, height: 8}
      robot:
        - number: 3
          kinematics: {name: diff}
          shape: {name: circle, radius: 0.2}
          distribution: {name: random}
"""
SUITE = f"""
suite: small
version: 1
title: Robots in a square
scenarios:
  - name: robots
    vary: {{"robot[0].number": [3, 6]}}
    scenario: {SCENARIO}
seeds: {{first: 7, count: 10}}
steps: 150
protocols: [freeze, yield]
policies: {{orca: {{name: orca, timeHorizon: 2}}, dash: dash}}
"""
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
def folder(tmp_path: Path, request: pytest.FixtureRequest) -> Folder:
    return Folder(tmp_path, request.param)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, str]]:
    """The files of each suite that was run without a disturbance; made once they are asked for."""

    class Known(dict[str, dict[str, str]]):
        def __missing__(self, text: str) -> dict[str, str]:
            self[text] = Folder(tmp_path_factory.mktemp("undisturbed"), text).finish()
            return self[text]

    return Known()


def assert_refused(done: subprocess.CompletedProcess[str]) -> None:
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    assert re.search(r"error (not-writable|file-access): .*(make room|the space left)", done.stderr), done.stderr


@needs_kill
@pytest.mark.parametrize("folder", [EASY], indirect=True)
def test_a_killed_run_goes_on_as_if_nothing_had_happened(
    folder: Folder, undisturbed: dict[str, dict[str, str]]
) -> None:
    for moment in (("run", 9, "half"), ("run", 10, "before"), ("report", 2, "half")):
        assert folder.run(moment).returncode == -signal.SIGKILL
    assert folder.finish() == undisturbed[EASY]


@pytest.mark.parametrize("folder", [EASY], indirect=True)
def test_a_full_disk_is_an_error_after_which_the_run_goes_on(
    folder: Folder, undisturbed: dict[str, dict[str, str]]
) -> None:
    for moment in (("run", 8, "full"), ("report", 1, "full")):
        assert_refused(folder.run(moment))
    assert folder.finish() == undisturbed[EASY]


@needs_kill
@pytest.mark.slow(60)
@pytest.mark.parametrize("folder", [SUITE], indirect=True)
@pytest.mark.parametrize("draw", range(4))
def test_five_kills_at_random_moments_change_no_file(
    draw: int, folder: Folder, undisturbed: dict[str, dict[str, str]]
) -> None:
    for moment in random_moments(random.Random(draw)):
        if isinstance(moment, float):
            kill_after(moment, folder)
        else:
            assert folder.run(moment, workers=2).returncode == -signal.SIGKILL, moment
        if draw % 2 and (folder.place / "run" / "plan.json").exists():
            folder.arguments = ["benchmark", "-o", "run", "--resume"]
    assert folder.finish(workers=2) == undisturbed[SUITE]


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
@pytest.mark.parametrize("folder", [SUITE], indirect=True)
def test_a_disk_that_is_full_at_any_moment_changes_no_file(
    folder: Folder, undisturbed: dict[str, dict[str, str]]
) -> None:
    for phase, number in (("run", 1), ("run", 3), ("run", 30), ("report", 1), ("report", 7), ("report", 20)):
        assert_refused(folder.run((phase, number, "full"), workers=2))
    assert folder.finish() == undisturbed[SUITE]


@pytest.mark.slow(10)
@pytest.mark.skipif(sys.platform == "win32", reason="needs limits of processes")
@pytest.mark.parametrize("folder", [SUITE], indirect=True)
def test_files_that_may_not_grow_any_more_change_no_file(
    folder: Folder, undisturbed: dict[str, dict[str, str]]
) -> None:
    import resource

    for limit in (10, 3_000, 40_000, 150_000):
        done = subprocess.run(
            [sys.executable, "-m", "irsim", *folder.arguments],
            cwd=folder.place,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
        )
        assert done.returncode == 1, done.stderr
        assert "Traceback" not in done.stderr
        assert "File too large" in done.stderr
    assert folder.finish() == undisturbed[SUITE]
