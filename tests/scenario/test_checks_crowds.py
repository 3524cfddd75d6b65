"""People who stop for good when they touch: hint `crowd-stops`, and what happens with and without its fix."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim

CROWD = """
world: {{width: 10, height: 10, time_limit: 40{mode}}}
{role}:
  - number: {number}
    kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.25}}
    distribution: {{name: random}}
    behavior: {behavior}
"""
WANDER = "{name: sfm, wander: true}"


def crowd(number: int = 12, behavior: str = WANDER, role: str = "obstacle", mode: str | None = None) -> str:
    written = "" if mode is None else f", collision_mode: {mode}"
    return CROWD.format(number=number, behavior=behavior, role=role, mode=written)


def stopped(tmp_path: Path, text: str) -> int:
    """Objects that stand for good after 40 s."""
    path = tmp_path / "crowd.yaml"
    path.write_text(text, encoding="utf-8")
    env = irsim.make(path, seed=1, headless=True, log_level="ERROR")
    env.rollout(400, until_done=False)
    count = sum(bool(view.stop_flag) for view in env.objects)
    env.end()
    return count


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        (crowd(), "unobstructed_obstacles"),
        (crowd(mode="stop"), "unobstructed_obstacles"),
        (crowd(2), "unobstructed_obstacles"),
        (crowd(role="robot"), "unobstructed"),
        (crowd(behavior="{name: follow, local: sfm, wander: true}"), "unobstructed_obstacles"),
        (crowd(behavior="{name: sfm}"), "unobstructed_obstacles"),
    ],
)
def test_a_crowd_that_freezes_is_told_of_with_the_mode_that_lets_it_go_on(text: str, fix: str) -> None:
    (hint,) = [finding for finding in irsim.validate(text=text).findings if finding.code == "crowd-stops"]
    assert hint.severity == "hint"
    assert f"collision_mode: {fix}" in (hint.fix or "")


@pytest.mark.parametrize(
    "text",
    [
        crowd(mode="unobstructed_obstacles"),
        crowd(mode="unobstructed"),
        crowd(mode="contact"),
        crowd(behavior="{name: orca, wander: true}"),
        crowd(1),
        crowd(3, behavior="{name: sfm}"),
        crowd(role="robot", behavior="{name: sfm}"),
    ],
)
def test_others_are_not(text: str) -> None:
    assert "crowd-stops" not in [finding.code for finding in irsim.validate(text=text).findings]


def test_with_the_fix_no_object_freezes(tmp_path: Path) -> None:
    assert stopped(tmp_path, crowd()) > 6
    assert stopped(tmp_path, crowd(mode="unobstructed_obstacles")) == 0
