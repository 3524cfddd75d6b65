"""Pictures of what robots do under another policy."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from irsim.diagnostics.errors import PolicyError
from irsim.policies.catalog import UnknownPolicyError

SCENE = """\
world: {width: 8, height: 4, step_time: 0.1}
robot:
  - {name: rover, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [1, 2], goal: [7, 2]}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    return path


def test_a_strip_shows_the_episode_of_the_policy(file: Path, tmp_path: Path) -> None:
    still = irsim.render(file, tmp_path / "still.png", strip=2)
    driven = irsim.render(file, tmp_path / "driven.png", strip=2, policy="orca")
    assert driven.steps < 100 < still.steps  # the first one has no policy, so its robot stands
    assert "--policy orca" in driven.reproduce
    assert "--policy" not in still.reproduce


def test_pictures_and_animations_show_it_too(file: Path, tmp_path: Path) -> None:
    def ahead(seen):
        return [[1.0, 0.0]] * len(seen)

    moved = irsim.render(file, tmp_path / "a.png", steps=20, policy=ahead)
    still = irsim.render(file, tmp_path / "b.png", steps=20)
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "b.png").read_bytes()
    assert moved.steps == still.steps == 20
    shown = irsim.render(file, tmp_path / "c.gif", policy="dash")
    assert 55 < shown.steps < 65
    assert shown.frames > 50


def test_a_policy_that_cannot_drive_them_is_refused_and_nothing_is_written(file: Path, tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match="policy-mismatch"):
        irsim.render(file, tmp_path / "a.png", policy="goal_lidar")
    with pytest.raises(UnknownPolicyError, match="did you mean orca"):
        irsim.render(file, tmp_path / "a.png", policy="orka")
    assert not (tmp_path / "a.png").exists()
