"""The command line as a process: pure output, signals, pipes, start-up."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.conftest import ROOM, Spawn

pytestmark = pytest.mark.one_python

LONG = ROOM.replace("dash}", "dash}\n    vel_max: [0, 0]\n    vel_min: [0, 0]")  # never gets there


def test_json_is_all_there_is_on_standard_output(spawn: Spawn, room: Path) -> None:
    room.write_text(ROOM.replace("height: 6", "heigth: 6"), encoding="utf-8")
    done = spawn("run", "room.yaml", "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout)["outcome"] == "success"
    assert "unknown-key" in json.dumps(json.loads(done.stdout)["warnings"])


def test_python_m_irsim_is_called_irsim(spawn: Spawn) -> None:
    done = spawn("--help")
    assert done.returncode == 0
    assert "Usage: irsim " in done.stdout


def test_no_colors_in_a_pipe(spawn: Spawn, room: Path) -> None:
    assert "\x1b" not in spawn("run", "room.yaml").stdout


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_exits_130_without_a_traceback(room: Path, tmp_path: Path) -> None:
    room.write_text(LONG, encoding="utf-8")
    (tmp_path / "says_ready.py").write_text("open('ready', 'w').close()\n", encoding="utf-8")
    command = [sys.executable, "-m", "irsim", "run", "room.yaml", "--steps", "100000000", "--import", "says_ready"]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(600):
        if (tmp_path / "ready").exists() or process.poll() is not None:
            break
        time.sleep(0.1)
    time.sleep(1)
    early = process.poll()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert early is None
    assert process.returncode == 130
    assert "Traceback" not in out + err


@pytest.mark.skipif(sys.platform == "win32", reason="pipes of POSIX")
def test_a_reader_that_leaves_is_no_error(room: Path, tmp_path: Path) -> None:
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "irsim", "describe"]
    done = subprocess.run(command, cwd=tmp_path, stdout=write, stderr=subprocess.PIPE, text=True, check=False)
    os.close(write)
    assert done.stderr == ""
    assert done.returncode == 0


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
@pytest.mark.parametrize("words", [["run", "room.yaml", "--json"], ["run", "nothing.yaml", "--json"], ["--help"]])
def test_a_full_disk_is_told_in_one_line(room: Path, tmp_path: Path, words: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "irsim", *words]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False)
    assert done.returncode in (1, 2)
    assert "Traceback" not in done.stderr
    assert "o space" in done.stderr or "nothing.yaml" in done.stderr


@pytest.mark.skipif(os.name != "posix", reason="limits of the size of files")
def test_a_record_that_cannot_be_written_ends_with_1(room: Path, tmp_path: Path) -> None:
    limited = "ulimit -f 1; trap '' XFSZ; exec \"$@\""
    command = ["bash", "-c", limited, "-", sys.executable, "-m", "irsim", "run", "room.yaml", "--record"]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}  # cut off at that size, others would read it
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("error file-access: ")
    assert {path.name for path in (tmp_path / ".irsim" / "runs").iterdir()} <= {".tidied", ".clock"}


def test_help_starts_quickly(spawn: Spawn) -> None:
    def seconds(code: list[str]) -> float:  # of the processor, which other work on the machine takes no part in
        best = 9.0
        for _ in range(3):
            start = sum(os.times()[2:4])
            subprocess.run([sys.executable, *code], capture_output=True, check=True)
            best = min(best, sum(os.times()[2:4]) - start)
        return best

    assert seconds(["-m", "irsim", "--help"]) < 5 * seconds(["-c", "import numpy"])  # 2.0 on a quiet machine


def test_help_loads_neither_models_nor_pictures() -> None:
    code = (
        "import sys\nsys.argv = ['irsim', '--help']\nfrom irsim.cli import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "heavy = ('numpy', 'matplotlib', 'shapely', 'yaml', 'irsim.api.run_scenario')\n"
        "print('loaded', [m for m in heavy if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "loaded []"


@pytest.mark.skipif(sys.platform == "win32", reason="a shell closes the stream")
@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-"])
def test_a_closed_stream_loses_only_what_is_printed_to_it(tmp_path: Path, room: Path, closed: str) -> None:
    shell = ["bash", "-c", f'"$0" -m irsim run room.yaml --record-to kept {closed}', sys.executable]
    done = subprocess.run(shell, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "kept" / "run.json").is_file()
    assert ("outcome" in done.stdout or "success" in done.stdout) == (closed != ">&-")
