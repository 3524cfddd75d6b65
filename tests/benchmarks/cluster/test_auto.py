"""``--cluster auto`` on a machine without a cluster; it comes before the tests for which one is started."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.cluster
SCENE = "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, distribution: {name: random}}\n"


def test_a_cluster_is_started_and_says_nothing(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    environment = {name: value for name, value in os.environ.items() if name != "RAY_ADDRESS"}
    outputs = []
    for words in ([], ["--cluster", "auto", "--workers", "2"]):
        done = subprocess.run(
            [sys.executable, "-m", "irsim", "benchmark", "scene.yaml", "--seeds", "3", "--steps", "30", *words],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        said = [line for line in done.stderr.splitlines() if not line.startswith("simulating: ")]  # after some seconds
        outputs.append((done.returncode, done.stdout, said))
    assert outputs[1] == outputs[0]
    assert outputs[0][0] == 0
