"""The dry run: what happens in the first steps, and why nothing happens."""

from __future__ import annotations

import pytest

import irsim

ROBOT = """\
  - name: rover
    kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.3}}
    state: {state}
    goal: {goal}
    vel_max: [1, 1.5]
    vel_min: [-1, -1.5]
    {more}
"""


def tried(
    *,
    state: str = "[1, 4, 0]",
    goal: str = "[9, 4]",
    more: str = "behavior: {name: dash}",
    world: str = "{width: 10, height: 8}",
    obstacle: str = "",
) -> irsim.results.DryRun:
    text = f"world: {world}\nrobot:\n" + ROBOT.format(state=state, goal=goal, more=more)
    if obstacle:
        text += f"obstacle:\n  - {obstacle}\n"
    report = irsim.validate(text=text, simulate=True)
    assert report.dry_run is not None, report.findings
    return report.dry_run


def test_tells_who_arrived() -> None:
    found = tried()
    assert (found.arrived, found.collisions, found.stuck, found.left, found.ended) == (["rover"], [], [], [], "done")
    assert found.sim_time == pytest.approx(8.0, abs=0.3)  # 8 m at 1 m/s
    assert "1 of 1 robots arrived" in found.summary


def test_tells_who_hit_whom_when_and_where() -> None:
    found = tried(obstacle="{name: pillar, shape: {name: circle, radius: 0.5}, state: [5, 4, 0]}")
    hit = found.collisions[0]
    assert {hit.object, hit.partner} == {"rover", "pillar"}
    assert hit.time == pytest.approx(3.2, abs=0.2)  # 4 m less both radii
    assert hit.x == pytest.approx(4.5, abs=0.2)
    assert "pillar" in found.summary


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"more": "color: red"}, "no behavior"),
        (
            {
                "more": "behavior: {name: follow}",
                "obstacle": "{shape: {name: linestring, vertices: [[5, -1], [5, 9]]}, state: [0, 0, 0]}",
            },
            "path",
        ),
    ],
)
def test_tells_why_a_robot_is_stuck(settings: dict[str, str], why: str) -> None:
    found = tried(**settings)
    assert [item.name for item in found.stuck] == ["rover"]
    assert why in found.stuck[0].why
    assert found.stuck[0].since == pytest.approx(0.0, abs=0.5)
    assert (found.stuck[0].x, found.stuck[0].y) == pytest.approx((1, 4), abs=0.2)


def test_tells_who_left_the_world() -> None:
    found = tried(goal="[20, 4]")
    assert [item.name for item in found.left] == ["rover"]
    assert found.left[0].time == pytest.approx(9.0, abs=0.3)


def test_is_the_same_every_time_and_ends_within_its_budget() -> None:
    assert tried() == tried()
    crowd = irsim.validate(
        text="world: {width: 60, height: 60, time_limit: 100000}\n"
        "robot: {number: 300, distribution: {name: random, range_low: [1, 1, -3], range_high: [59, 59, 3]},"
        " kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: orca, wander: true}}\n",
        simulate=True,
    )
    assert crowd.dry_run is not None
    assert crowd.dry_run.ended == "budget"
    assert crowd.dry_run.steps == 1000


def test_a_seed_without_room_is_a_finding() -> None:
    report = irsim.validate(
        text="world: {width: 6, height: 6}\n"
        "robot: {number: 27, distribution: {name: random, range_low: [0, 0, -3], range_high: [6, 6, 3]},"
        " kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, behavior: {name: dash}}\n",
        simulate=True,
    )
    assert report.dry_run is None
    assert not report.valid
    assert report.findings[0].code == "placement-crowded"
