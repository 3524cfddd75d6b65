"""``irsim studio`` as a command: its address, its folder, and how it ends."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.cli.studio import _place
from tests.cli.conftest import CRASH

pytestmark = [pytest.mark.one_python, pytest.mark.skipif(sys.platform != "linux", reason="processes are in /proc")]


@pytest.fixture
def command(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    (tmp_path / "crash.yaml").write_text(CRASH, encoding="utf-8")
    words = [sys.executable, "-m", "irsim", "studio", "crash.yaml", "--no-browser"]
    process = subprocess.Popen(
        words,
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"COLUMNS": "200"},
    )
    yield process
    process.kill()
    process.communicate()


def address_of(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    matched = re.match(r"studio: (http://127\.0\.0\.1:\d+/)#[\w-]{43}$", process.stdout.readline().strip())
    assert matched is not None
    return matched[1]


def children(pid: int) -> set[int]:
    return {int(one) for one in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()}


def alive(pids: set[int]) -> set[int]:
    return {
        pid
        for pid in pids
        if Path(f"/proc/{pid}").exists() and "Z" not in Path(f"/proc/{pid}/stat").read_text().split()[2]
    }


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_it_serves_until_it_is_ended_and_leaves_no_process(command: subprocess.Popen[str], how: signal.Signals) -> None:
    with urllib.request.urlopen(address_of(command), timeout=10) as answer:
        assert b"irsim studio" in answer.read()
    workers = children(command.pid)
    assert len(workers) == 2
    command.send_signal(how)
    assert command.wait(10) in (0, -how)
    end = time.monotonic() + 10
    while alive(workers):
        assert time.monotonic() < end
        time.sleep(0.05)
    assert command.stderr is not None
    assert command.stderr.read() == ""


def test_the_folder_is_the_current_one_or_that_of_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "in.yaml").touch()
    (tmp_path / "out.yaml").touch()
    monkeypatch.chdir(tmp_path / "here")
    assert _place(None) == (tmp_path / "here", None)
    assert _place("in.yaml") == (tmp_path / "here", {"name": "in.yaml"})
    assert _place("../out.yaml") == (tmp_path, {"name": "out.yaml"})
    assert _place("crossing") == (tmp_path / "here", {"template": "crossing"})
    run = irsim.run(text=CRASH, seed=3, record=True)
    assert _place("last") == (tmp_path / "here", {"run": run.run_id})
    assert _place(str(run.run_id)) == (tmp_path / "here", {"run": run.run_id})


def test_what_is_neither_a_file_nor_a_template_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["studio", "crosing"])
    assert done.exit_code == 2
    assert "irsim studio crossing" in done.output
