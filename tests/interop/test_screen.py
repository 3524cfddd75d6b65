"""The first program of the README opens a real window, on a virtual screen, and each of its steps is seen there."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.test_pages import BLOCKS

pytestmark = pytest.mark.interop
PROGRAM = next(content for _, _, language, content in BLOCKS if language == "python")
WATCH = """
import atexit
from irsim.graphics.figure import window
frames, refresh = [], window.Window.refresh
def counted(self, seconds):
    refresh(self, seconds)
    canvas = self.figure.canvas
    frames.append((bool(canvas.get_tk_widget().winfo_viewable()), bytes(canvas.buffer_rgba())))
window.Window.refresh = counted
atexit.register(lambda: print("frames", len(frames), len(dict.fromkeys(frames)), sum(seen for seen, _ in frames)))
"""
"""Counts the frames that a window shows, and how many of them differ."""


@pytest.fixture(scope="module")
def screen() -> Iterator[str]:
    """A virtual screen; its name."""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24"], pass_fds=[write])
    os.close(write)
    with os.fdopen(read) as numbers:
        number = numbers.readline().strip()
    yield f":{number}"
    server.terminate()
    server.wait()


def test_the_first_program_of_the_readme_is_seen(screen: str, tmp_path: Path) -> None:
    for kind, name, _, content in BLOCKS:
        if kind == "file":
            (tmp_path / str(name)).write_text(content, encoding="utf-8")
    variables = {key: value for key, value in os.environ.items() if key != "WAYLAND_DISPLAY"}
    done = subprocess.run(
        [sys.executable, "-c", WATCH + PROGRAM.replace("env.end()", "env.end(0)")], cwd=tmp_path,
        env={**variables, "DISPLAY": screen, "MPLBACKEND": "TkAgg"},
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    shown, different, viewable = map(int, re.findall(r"frames (\d+) (\d+) (\d+)", done.stdout)[0])
    assert min(different, viewable) > shown - 5 > 50
    assert done.stderr == ""
