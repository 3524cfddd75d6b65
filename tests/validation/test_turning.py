"""Cars without reverse whose goals lie inside their turning circle: a finding before the run, a reason after it."""

from __future__ import annotations

import pytest

import irsim
from tests.scenario.test_checks_single import named

CAR = """
world: {width: 60, height: 60, time_limit: 60}
robot:
  - name: car
    kinematics: {name: acker}
    shape: {name: rectangle, length: 4.6, width: 1.6, wheelbase: 3}
    state: [30, 20, 0]
    goal: GOAL
    vel_max: [2, 0.5]
    vel_min: [BACK, -0.5]
    behavior: {name: follow, local: LOCAL}
"""


def text(goal: str, back: float = 0, local: str = "dash") -> str:
    return CAR.replace("GOAL", goal).replace("BACK", str(back)).replace("LOCAL", local)


def messages(scenario: str) -> list[str]:
    return [finding.message for finding in named("turning-circle", scenario)]


@pytest.mark.parametrize("goal", ["[30, 30]", "[30, 27]", "[26, 22]"])
@pytest.mark.parametrize("local", ["dash", "orca"])
def test_a_goal_inside_the_turning_circle_needs_reverse(goal: str, local: str) -> None:
    [message] = messages(text(goal, local=local))
    assert "needs reverse" in message
    assert "inside its turning circle of radius 5.49 m, so it stands still" in message
    assert named("turning-circle", text(goal))[0].fix.startswith("vel_min: [-2, -0.5] lets it back up")
    result = irsim.run(text=text(goal, local=local))
    assert result.outcome == "timeout"
    assert "it needs reverse" in (result.reason or "")


@pytest.mark.parametrize(("goal", "within"), [("[20, 20, 0]", "0.52"), ("[30, 33]", "1.9"), ("[36, 33]", "1.14")])
def test_a_goal_that_the_car_misses_needs_reverse(goal: str, within: str) -> None:
    [message] = messages(text(goal))
    assert f"it gets within {within} m of" in message
    result = irsim.run(text=text(goal))
    assert f"{float(within):.2f} m from its goal: it needs reverse" in (result.reason or "")


@pytest.mark.parametrize(
    ("goal", "back", "local"),
    [("[30, 30]", -2, "dash"), ("[20, 20, 0]", -2, "dash"), ("[45, 25]", 0, "dash"), ("[20, 20, 0]", 0, "orca")],
)
def test_cars_that_arrive_are_not_reported(goal: str, back: float, local: str) -> None:
    assert messages(text(goal, back, local)) == []
    assert irsim.run(text=text(goal, back, local)).outcome == "success"


def test_later_waypoints_count() -> None:
    assert messages(text("[45, 20]")) == []
    [message] = messages(text("[45, 20]").replace("goal: [45, 20]", "waypoints: [[45, 20], [45, 26]]"))
    assert "(45, 26)" in message


def test_behind_an_obstacle_nothing_is_known() -> None:
    wall = "obstacle:\n  - {shape: {name: rectangle, length: 10, width: 1}, state: [30, 25, 0]}\n"
    assert messages(text("[30, 30]") + wall) == []
