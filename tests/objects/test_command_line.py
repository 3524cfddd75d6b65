"""Code of users on the command line: --import registers it before the scenario is read."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from irsim.scenario.open import import_modules
from tests.warm import warm

MODULE = '''
from irsim.lib import KinematicsHandler, register_behavior_class, register_kinematics


@register_kinematics("hover")
class Hover(KinematicsHandler):
    """Glides."""

    def step(self, state, velocity, step_time):
        moved = state.copy()
        moved[:2] += velocity * step_time
        return moved

    def velocity_from_xy(self, state, velocity_xy):
        return velocity_xy


@register_behavior_class("hover", "drift")
class Drift:
    def __init__(self, object_info, **keys):
        self.pace = keys["pace"]

    def __call__(self, ego_object, external_objects, **keys):
        return [self.pace, 0.0]
'''
SCENARIO = """
world: {time_limit: 4}
robot:
  - {kinematics: {name: hover}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [2, 1],
     behavior: {name: drift, pace: 0.5}}
  - {kinematics: {name: hover}, shape: {name: circle, radius: 0.2}, state: [1, 3, 0], goal: [2, 4],
     behavior: {name: dash}}
"""


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "irsim", *arguments]
    return subprocess.run(warm(command), cwd=folder, capture_output=True, text=True, check=False)


def test_drives_and_behaviors_of_an_imported_module(tmp_path: Path) -> None:
    (tmp_path / "own_code.py").write_text(MODULE)
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    unknown = run(tmp_path, "validate", "scenario.yaml")
    assert unknown.returncode == 2
    assert "unknown-kinematics" in unknown.stdout
    assert run(tmp_path, "validate", "scenario.yaml", "--import", "own_code").returncode == 0
    done = run(tmp_path, "run", "scenario.yaml", "--strict", "--import", "own_code", "--require-success", "--json")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", ["modules_beside/own_place.py", "modules_beside.own_place"])
def test_modules_below_the_current_folder_are_found_by_any_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    (tmp_path / "modules_beside").mkdir()
    (tmp_path / "modules_beside" / "own_place.py").write_text("SEEN = True\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [path for path in sys.path if path])  # as the installed command starts
    try:
        import_modules([name])
        assert sys.modules["modules_beside.own_place"].SEEN
    finally:
        for module in ("modules_beside.own_place", "modules_beside"):
            sys.modules.pop(module, None)
