"""``irsim.run`` from a text, within limits, and what it says about why a run failed."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from irsim.errors import OverLimitError, ScenarioError
from irsim.scenario.limits import Limits

ROBOT = """\
world: {width: 20, height: 6%s}
robot:
  - {name: rover, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 3], goal: [%g, 3]%s}
"""
DASH = ", behavior: {name: dash}"


def text(goal: float = 4, extra: str = DASH, world: str = "") -> str:
    return ROBOT % (world, goal, extra)


def test_a_text_runs_like_a_file(tmp_path: Path) -> None:
    path = tmp_path / "room.yaml"
    path.write_text(text(), encoding="utf-8")
    from_file, from_text = irsim.run(path, seed=3), irsim.run(text=text(), seed=3)
    assert from_text.outcome == "success"
    assert from_text.robots == from_file.robots
    assert from_text.scenario == "(text)"
    assert from_text.reproduce.endswith("--seed 3  # the text, saved as scenario.yaml")


def test_exactly_one_of_path_and_text() -> None:
    with pytest.raises(ValueError, match="either a path or a text"):
        irsim.run()
    with pytest.raises(ValueError, match="either a path or a text"):
        irsim.run("room.yaml", text=text())


def test_success_needs_no_reason() -> None:
    assert irsim.run(text=text()).reason is None


@pytest.mark.parametrize(
    ("scenario", "reason"),
    [
        (text(extra=""), "'rover' has no behavior, so it stands still 3.00 m from its goal"),
        (text(19, world=", time_limit: 5"), "at 5.0 s (world.time_limit) 'rover' still moved at 1 m/s, 13.00 m from"),
        (text() + "obstacle:\n  - {name: crate, state: [2.5, 3], shape: {name: circle}}\n", "'rover' hit 'crate' at "),
        ("world: {width: 5}\n", "there are no robots"),
    ],
)
def test_failures_say_why(scenario: str, reason: str) -> None:
    found = irsim.run(text=scenario).reason
    assert found is not None
    assert reason in found


def test_a_horizon_beyond_the_limit_is_cut_and_said() -> None:
    result = irsim.run(text=text(19, world=", time_limit: 100"), limits=Limits(steps=20))
    assert (result.steps, result.time_limit_from) == (20, "limits")
    assert "the most steps of one run here" in str(result.reason)
    assert "--steps 20" in result.reproduce


def test_more_steps_than_allowed_are_refused() -> None:
    with pytest.raises(OverLimitError, match=r"over-limit: 21 steps are too many.* ask for at most 20 steps"):
        irsim.run(text=text(), steps=21, limits=Limits(steps=20))
    with pytest.raises(OverLimitError, match="10 steps x objects are run at once, and there are 1 objects"):
        irsim.run(text=text(), steps=11, limits=Limits(work=10))


def test_robots_and_aliases_have_limits_of_their_own() -> None:
    many = "robot:\n  - {number: 11, kinematics: {name: diff}}\nobstacle:\n  - {number: 20, shape: {name: circle}}\n"
    for limits in (Limits(robots=10), Limits(objects=30)):
        with pytest.raises(ScenarioError, match="too-many-objects"):
            irsim.run(text=many, limits=limits)
    aliases = "custom: &a [1]\nrobot:\n  - {tags: *a}\n  - {tags: *a}\n"
    with pytest.raises(ScenarioError, match="more than 1 aliases"):
        irsim.run(text=aliases, limits=Limits(aliases=1))


def test_a_robot_that_left_the_world_is_said_to_be_outside() -> None:
    away = (
        text(4, DASH, ", time_limit: 3").replace("goal: [4, 3]", "goal: [-9, 3]").replace("[1, 3]", "[1, 3, 3.14159]")
    )
    assert "from its goal, outside the world at (-2.00, 3.00)" in str(irsim.run(text=away).reason)
