"""The identity of the engine: the same for the same sources, another one after a change of any that decides numbers."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import irsim._core as core
from irsim.simulation import engine as module
from irsim.simulation.engine import ENGINE_PARTS, engine

ROOT = Path(module.__file__).parents[1]


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """A copy of the sources that count."""
    for part in ENGINE_PARTS:
        (tmp_path / part).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, tmp_path / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / part, tmp_path / part)
    return tmp_path


def identity_of(folder: Path, monkeypatch: pytest.MonkeyPatch, sources: str = core.sources) -> str:
    """The identity of an installation in another folder."""
    changed: Any = SimpleNamespace(sources=sources)
    monkeypatch.setattr(module, "__file__", str(folder / "simulation" / "engine.py"))
    monkeypatch.setattr(module, "core", changed)
    return engine.__wrapped__()


def test_the_identity_follows_from_the_sources_alone(copied: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = engine()
    assert len(known) == 12
    assert identity_of(copied, monkeypatch) == known
    law = copied / "simulation" / "simulation.py"
    text = law.read_bytes()
    law.write_bytes(text.replace(b"\n", b"\r\n"))
    assert identity_of(copied, monkeypatch) == known
    law.write_bytes(text + b"# another law\n")
    assert identity_of(copied, monkeypatch) != known
    law.write_bytes(text)
    assert identity_of(copied, monkeypatch, sources="0" * 64) != known


def test_all_rooms_that_an_episode_loads_count() -> None:
    script = "import irsim.benchmarks.together, sys; print(*(n for n in sys.modules if n.startswith('irsim.')))"
    names = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    rooms = {name.split(".")[1] for name in names} - {"_core", "benchmarks"}
    without_numbers = {"diagnostics", "graphics", "results", "runs"}
    assert rooms - without_numbers == {part for part in ENGINE_PARTS if "/" not in part}
