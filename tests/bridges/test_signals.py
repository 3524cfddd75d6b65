"""A run with bridges that is ended from outside."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.bridges.peer import Peer

SCENE = """
world: {width: 10, height: 10}
robot: [{kinematics: {name: diff}, state: [1, 5, 0], goal: [1000, 5], vel_max: [0, 0]}]
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_the_other_program_is_told_the_end(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE)
    with Peer(lambda message: None) as peer:
        bridge = f"{{name: json_lines, clock: wall, address: '{peer.address}'}}"
        command = [sys.executable, "-m", "irsim", "run", "scene.yaml", "--steps", "100000", "--bridge", bridge]
        with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
            try:
                until = time.monotonic() + 60
                while len(peer.kinds()) < 5 and time.monotonic() < until:
                    time.sleep(0.05)
                process.send_signal(signal.SIGTERM)
                _, error = process.communicate(timeout=20)
            finally:
                process.kill()
        assert process.returncode == 128 + signal.SIGTERM
        assert "Traceback" not in error
        assert peer.kinds()[-1] == "end"
