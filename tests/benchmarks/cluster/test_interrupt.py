"""Ctrl-C in a benchmark on a cluster: one line, no traceback of any process, and the command that goes on works."""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = [pytest.mark.cluster, pytest.mark.usefixtures("interruptible")]

SUITE = """\
suite: field
version: 1
title: Two robots in a field
scenarios:
  - name: field
    scenario:
      world: {width: 8, height: 8}
      robot: {number: 2, kinematics: {name: diff}, distribution: {name: random}}
seeds: {count: 400}
steps: 200
policies: {orca: orca}
"""


def kept(folder: Path) -> int:
    """Number of lines of the file of episodes, whose first line is about all of them."""
    file = folder / "full" / "episodes.jsonl"
    return len(file.read_text(encoding="utf-8").splitlines()) if file.exists() else 0


def test_ctrl_c_says_how_it_goes_on_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "field.yaml").write_text(SUITE, encoding="utf-8")
    command = [sys.executable, "-m", "irsim", "benchmark", "field.yaml", "-o", "full", "--cluster", "auto"]
    running = subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    end = time.monotonic() + 120
    while kept(tmp_path) < 5:
        assert running.poll() is None
        assert time.monotonic() < end
        time.sleep(0.05)
    os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to every process of the group
    out, err = running.communicate(timeout=60)
    assert (running.returncode, "Traceback" in out + err) == (130, False), err
    [said] = err.splitlines()
    assert said == "interrupted; finished episodes are kept; go on: irsim benchmark --resume -o full --cluster auto"
    assert 5 <= kept(tmp_path) < 401
    words = shlex.split(re.split(r"go on: ", said)[1])
    done = subprocess.run([sys.executable, "-m", *words], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert kept(tmp_path) == 401
