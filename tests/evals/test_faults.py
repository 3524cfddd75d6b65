"""Faults put into the grader by hand: the proof finds each of them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

pytestmark = pytest.mark.slow
FAULTS = yaml.safe_load(Path(__file__).with_name("faults.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault["name"])
def test_the_proof_finds(fault: dict[str, Any]) -> None:
    command = [sys.executable, "-m", "tests.evals.faulty", fault["file"], fault["old"], fault["new"], *fault["cases"]]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(("accepted", "rejected", "disagreed"))
