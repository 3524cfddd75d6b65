"""Child processes end with their parent, keep to their limits, and say how they have ended."""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from pathlib import Path

import pytest

from irsim.common.child import Child, how_ended, python
from tests.processes import runs, wait_until_gone

POSIX = pytest.mark.skipif(os.name != "posix", reason="the system has no such limits")
ECHO = "import sys\nfor line in sys.stdin.buffer:\n    sys.stdout.buffer.write(line)\n    sys.stdout.flush()"


def child_of(code: str) -> Child:
    return Child([sys.executable, "-c", code])


def test_lines_go_there_and_back() -> None:
    child = child_of(ECHO)
    try:
        assert child.send(b"one")
        assert child.receive(20) == b"one\n"
        long = b"x" * 1_000_000
        assert child.send(long)
        assert child.receive(20) == long + b"\n"
        assert child.receive(0.01) is None
    finally:
        child.end()
    assert child.receive(20) == b""
    assert child.receive(20) == b""
    assert child.send(b"more") is False


def test_what_is_printed_is_no_answer() -> None:
    code = "from irsim.common.child import *\npipe = answers()\nprint('noise')\nwrite_line(pipe, {'a': 1})"
    child = child_of(code)
    try:
        assert json.loads(child.receive(20) or b"") == {"a": 1}
        assert child.receive(20) == b""
    finally:
        child.end()


@pytest.mark.parametrize("watch", ["lines()", "end_with_input()"])
def test_a_child_ends_when_its_input_is_closed(watch: str) -> None:
    child = child_of(f"from irsim.common import child\nchild.{watch}\nprint(flush=True)\nimport time\ntime.sleep(60)")
    assert child.receive(20) == b"\n"
    child.input.close()
    child.process.wait(20)
    child.end()


@POSIX
def test_a_child_ends_with_a_parent_that_is_killed() -> None:
    inner = "import time\nfrom irsim.common.child import *\nend_with_parent()\nprint(flush=True)\ntime.sleep(60)"
    outer = (
        "import os, subprocess, sys, time\n"
        f"child = subprocess.Popen([sys.executable, '-c', {inner!r}], stdout=subprocess.PIPE)\n"
        "child.stdout.readline()\nprint(child.pid, flush=True)\ntime.sleep(60)"
    )
    parent = child_of(outer)
    pid = int(parent.receive(20) or b"0")
    parent.process.kill()
    wait_until_gone([pid])
    parent.end()


@POSIX
def test_what_a_child_has_started_ends_with_it() -> None:
    code = "import subprocess, sys\nprint(subprocess.Popen(['sleep', '60']).pid, flush=True)\nsys.stdin.read()"
    child = child_of(code)
    pid = int(child.receive(20) or b"0")
    assert runs(pid)
    child.end()
    wait_until_gone([pid])


def test_a_child_has_time_to_end_by_itself(tmp_path: Path) -> None:
    done = tmp_path / "done"
    child = child_of(f"import sys, pathlib\nsys.stdin.read()\npathlib.Path({str(done)!r}).touch()")
    child.end(grace=20)
    assert done.exists()
    assert child.process.returncode == 0


def test_a_child_that_does_not_read_is_ended_all_the_same() -> None:
    child = child_of("import time\nprint(flush=True)\ntime.sleep(60)")
    assert child.receive(20) == b"\n"
    begin = time.monotonic()
    child.end(grace=0.2)
    assert time.monotonic() - begin < 20
    assert child.process.returncode is not None


@POSIX
@pytest.mark.parametrize(
    ("limits", "work"),
    [
        ("memory=2**31", "bytearray(2**32)"),
        ("written=1000", "open({file!r}, 'wb').write(bytes(10_000))"),
        ("files=20", "[open({file!r}, 'wb') for _ in range(40)]"),
    ],
)
def test_a_limit_stops_what_exceeds_it(limits: str, work: str, tmp_path: Path) -> None:
    work = work.format(file=str(tmp_path / "file"))
    code = (
        "import signal\nsignal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        f"from irsim.common.child import limit\nlimit({limits})\n"
        f"try:\n    {work}\nexcept (OSError, MemoryError):\n    print('stopped', flush=True)"
    )
    child = child_of(code)
    try:
        assert child.receive(20) == b"stopped\n"
    finally:
        child.end()


@POSIX
def test_processor_time_ends_a_process() -> None:
    child = child_of("from irsim.common.child import limit\nlimit(cpu=1)\nwhile True: pass")
    assert child.receive(30) == b""
    assert child.how_ended() in (f"signal {signal.SIGXCPU.value}", f"signal {signal.SIGKILL.value}")
    child.end()


def test_how_a_process_ended_is_said() -> None:
    assert how_ended(3) == "exit code 3"
    assert how_ended(-9) == "signal 9"
    assert how_ended(None) == "no exit code"
    child = child_of("raise SystemExit(5)")
    assert child.receive(20) == b""
    assert child.how_ended() == "exit code 5"
    child.end()


def test_python_imports_from_the_same_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "own.py").write_text("def main():\n    print('own', flush=True)\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    child = Child(python("own"))
    try:
        assert child.receive(20) == b"own\n"
    finally:
        child.end()
