"""Spellings of limits and goals that IR-SIM takes: warned about, and meant the same."""

from __future__ import annotations

import pytest

from irsim.scenario.read import read

ROBOT = "robot: {{kinematics: {{name: diff}}, shape: {{name: circle}}, behavior: {{name: dash}}, {keys}}}\n"


@pytest.mark.parametrize("limit", ["0.5", "[0.5]"])
def test_one_number_limits_every_component(limit: str) -> None:
    reading = read(ROBOT.format(keys=f"vel_max: {limit}"), strict=False)
    assert reading.scenario is not None
    assert reading.scenario.objects[0].vel_max == [0.5, 0.5]
    assert [d.path for d in reading.diagnostics if d.severity == "warning"] == [("robot", "vel_max")]
    assert read(ROBOT.format(keys=f"vel_max: {limit}"), strict=True).scenario is None


def test_null_among_goals_is_no_goal() -> None:
    reading = read(ROBOT.format(keys="number: 2, state: [[1, 1], [4, 4]], goal: [null, [1, 2]]"), strict=False)
    assert reading.scenario is not None
    assert [record.goals for record in reading.scenario.objects] == [[], [[1.0, 2.0]]]
    alone = read(ROBOT.format(keys="goal: null"), strict=False)
    assert alone.scenario is not None
    assert alone.scenario.objects[0].goals == [[1.0, 9.0, 0.0]]


def test_limits_of_things_that_never_move_may_have_any_length() -> None:
    text = "obstacle: {shape: {name: circle, radius: 0.3}, state: [2, 2], vel_max: [1, 1]}\n"
    reading = read(text, strict=True)
    assert reading.scenario is not None
    assert reading.scenario.objects[0].vel_max == [1, 1, 1]
