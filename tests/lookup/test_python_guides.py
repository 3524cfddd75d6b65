"""Topics for those who write programs: they are found by the names of Python, and their examples run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.env import Env
from irsim.lookup.python_guides import PYTHON
from irsim.lookup.topics import lookup

SCENE = """
world: {width: 10, height: 10, step_time: 0.1, time_limit: 2}
robot: {state: [1, 5, 0], goal: [9, 5], kinematics: {name: diff}, behavior: {name: dash}, sensors: [{name: lidar2d}]}
"""


@pytest.mark.parametrize(
    ("asked", "topic"),
    [
        ("save_ani", "animations"),
        ("end", "animations"),
        ("env.end", "animations"),
        ("ani_kwargs", "animations"),
        ("IrsimError", "exceptions"),
        ("ScenarioError", "exceptions"),
        ("diagnostics", "exceptions"),
        ("done", "done"),
        ("get_lidar_scan", "scan keys"),
        ("keys of a scan", "scan keys"),
        ("episodes", "episodes"),
        ("seeds for parallel work", "episodes"),
        ("to_pandas", "notebooks"),
        ("jupyter", "notebooks"),
    ],
)
def test_names_of_python_lead_to_their_text(asked: str, topic: str) -> None:
    assert lookup(asked).title == f"{topic}: {PYTHON[topic].title}"


@pytest.mark.parametrize("topic", [name for name in PYTHON if name not in ("scan keys", "episodes")])
def test_its_example_runs(topic: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scenario.yaml").write_text(SCENE, encoding="utf-8")
    if topic == "notebooks":
        monkeypatch.setenv("MPLBACKEND", "agg")
    exec(compile(PYTHON[topic].example or "", topic, "exec"), {})
    assert Path("run.gif").exists() == (topic == "animations")


def test_the_keys_of_a_scan_are_those_that_it_says(tmp_path: Path) -> None:
    (tmp_path / "scenario.yaml").write_text(SCENE, encoding="utf-8")
    env = irsim.make(tmp_path / "scenario.yaml", headless=True, log_level="ERROR")
    assert [key for key in env.get_lidar_scan() if key not in PYTHON["scan keys"].text] == []
    names: dict[str, Any] = {"env": env}
    exec(PYTHON["scan keys"].example or "", names)
    assert np.isfinite(names["nearest"])


def test_what_it_says_of_done_is_so_and_stands_in_its_docstring(tmp_path: Path) -> None:
    (tmp_path / "scenario.yaml").write_text(SCENE, encoding="utf-8")
    env = irsim.make(tmp_path / "scenario.yaml", headless=True, log_level="ERROR")
    for _ in range(30):
        env.step([0.0, 0.0])
    assert env.time > 2.5
    assert not env.done()  # the limit is 2 s
    for text in (Env.done.__doc__, PYTHON["done"].text):
        assert "world.time_limit" in str(text)
