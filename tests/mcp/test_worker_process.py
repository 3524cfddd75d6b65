"""One worker by itself: what it writes, and when it ends."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ENDLESS = "threading.Event().wait()"
NOISY = "print('from Python') or os.write(1, b'from a library') and '[1]'"


def start(folder: Path, work: str) -> subprocess.Popen[bytes]:
    """A worker whose task evaluates an expression."""
    code = (
        f"import os, threading\nfrom irsim_mcp import job\njob._TASKS['x'] = lambda job, progress: {work}\njob.main()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    resources = {"memory": 10**10, "cpu": 60, "written": 10**6}
    line = json.dumps({"task": "x", "workspace": str(folder), "resources": resources, "limits": {}})
    assert process.stdin is not None
    process.stdin.write(line.encode() + b"\n")
    process.stdin.flush()
    return process


def test_what_libraries_print_does_not_mix_with_the_answer(tmp_path: Path) -> None:
    with start(tmp_path, NOISY) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.read() == b'{"result": [1]}\n'
        assert b"from a library" in process.stderr.read()


@pytest.mark.parametrize("work", [ENDLESS, "exec('while True: pass')"])
def test_it_ends_when_its_input_is_closed(tmp_path: Path, work: str) -> None:
    with start(tmp_path, work) as process:
        assert process.stdin is not None
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.5)
        process.stdin.close()
        try:
            assert process.wait(20) == 1
        finally:
            process.kill()
