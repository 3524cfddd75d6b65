"""Looks at a scene beside its run work with robots that decide from what they believe."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import irsim

TRAP = """\
world: {width: 12, height: 10, time_limit: 60}
robot:
  name: scout
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 5, 0]
  goal: [11, 5]
  perceives: both
  behavior: {name: orca}
  sensors: [{name: lidar2d}, {name: localization}, {name: detector}]
obstacle:
  - {shape: {name: linestring, vertices: [[4, 9], [6, 9], [6, 1], [4, 1]]}, state: [0, 0, 0]}
  - name: cart
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [8, 8, 0]
    goal: [8, 2]
    behavior: {name: dash}
"""


def test_a_believer_in_a_dead_end_is_told_to_plan() -> None:
    assert "needs-planning" in [finding.code for finding in irsim.validate(text=TRAP).findings]


def test_a_believer_on_a_route_is_told_of_a_narrow_door() -> None:
    wall = "{{shape: {{name: linestring, vertices: [[5, {}], [5, {}]]}}, state: [0, 0, 0]}}"
    walls = f"{wall.format(0, 4.77)}\n  - {wall.format(5.23, 10)}"
    door = re.sub(r"\{shape: \{name: linestring.*", walls, TRAP).replace("{name: orca}", "{name: follow, local: orca}")
    assert "narrow-passage" in [finding.code for finding in irsim.validate(text=door).findings]


@pytest.mark.parametrize("overlays", [None, ["plan"]])
def test_the_table_of_a_picture_has_the_plan_of_a_believer(tmp_path: Path, overlays: list[str] | None) -> None:
    path = tmp_path / "trap.yaml"
    path.write_text(TRAP.replace("{name: orca}", "{name: follow, local: {name: orca}}"), encoding="utf-8")
    result = irsim.render(path, tmp_path / "a.png", seed=0, overlays=overlays)
    assert result.table is not None
    assert ["scout"] in [row.names for row in result.table.rows]
