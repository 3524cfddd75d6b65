"""Each number of each schema has a least and a largest value, and what no engine survives is refused by name."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.episodes.episode import horizon_of
from irsim.scenario.limits import DEFAULT_LIMITS, MAX_STEPS

ROOT = Path(__file__).resolve().parents[2]
SCHEMAS = sorted((ROOT / "schema").glob("*.schema.json"))
UNLIMITED = ("acce", "mass", "inertia")
"""Keys for which infinity has a meaning."""
WORLD = """\
world: {{width: 10, height: 10, {world}}}
robot: {{kinematics: {{name: diff}}, behavior: {{name: dash}}, {robot}}}
"""


def numbers(part: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], dict[str, Any]]]:
    """Path and schema of each number in a schema."""
    if isinstance(part, dict):
        if {"number", "integer"} & set(_kinds(part)) and not {"const", "enum"} & set(part):
            yield path, part
        for key, value in part.items():
            if key not in ("examples", "default", "enum", "const"):
                yield from numbers(value, (*path, key))
    elif isinstance(part, list):
        for index, value in enumerate(part):
            yield from numbers(value, (*path, str(index)))


def _kinds(part: dict[str, Any]) -> list[str]:
    kind = part.get("type", [])
    return [kind] if isinstance(kind, str) else list(kind) if isinstance(kind, list) else []


@pytest.mark.parametrize("file", SCHEMAS, ids=lambda file: file.name)
def test_each_number_of_a_schema_has_a_least_and_a_largest_value(file: Path) -> None:
    matches = list(numbers(json.loads(file.read_text(encoding="utf-8"))))
    open_ended = [
        "/".join(path)
        for path, part in matches
        if not (
            ("minimum" in part or "exclusiveMinimum" in part)
            and ("maximum" in part or "exclusiveMaximum" in part or set(path) & set(UNLIMITED))
        )
    ]
    assert open_ended == []


@pytest.mark.parametrize(
    ("world", "robot", "where"),
    [
        ("time_limit: 1.0e+308", "", "world.time_limit"),
        ("step_time: 1.0e-308", "", "world.step_time"),
        ("sample_time: 1.0e-308", "", "world.sample_time"),
        ("", "appear_time: 1.0e+308", "robot.appear_time"),
        ("", "start_time: [1.0e+308]", "robot.start_time[0]"),
        ("", "state: [1, -1.0e+308, 0]", "robot.state[1]"),
        ("", "group: 2147483647", "robot.group"),
        ("", "goal: [[1, 2], [3, 1.0e+308]]", "robot.goal[1][1]"),
        ("", "waypoints: [[1, 2], [3, 1.0e+308]]", "robot.waypoints[1][1]"),
        ("", "shape: {name: polygon, vertices: [[0, 0], [1, 0], [0, -1.0e+300]]}", "robot.shape.vertices[2][1]"),
        (
            "",
            "shape: {name: polygon, random_shape: true, num_vertices_range: [1000000, 2000000]}",
            "robot.shape.num_vertices_range[0]",
        ),
    ],
)
def test_a_number_that_no_engine_survives_is_refused_where_it_stands(world: str, robot: str, where: str) -> None:
    report = irsim.validate(text=WORLD.format(world=world, robot=robot))
    assert [finding.code for finding in report.findings if finding.path == where] == ["out-of-range"], report


def test_a_bound_far_away_is_named_only_when_a_value_is_beyond_it() -> None:
    texts = [WORLD.format(world="", robot=f"shape: {{name: circle, radius: {r}}}") for r in ("-1", "2.0e+9")]
    low, high = (irsim.validate(text=text).findings[0] for text in texts)
    assert low.allowed == "> 0 [m]"
    assert high.allowed == "> 0 and ≤ 1000000000 [m]"


def test_worlds_as_large_as_the_earth_and_slow_clocks_are_allowed() -> None:
    large = "offset: [691000.5, 5334000.25], time_limit: 1.0e+9, step_time: 1.0e-6"
    report = irsim.validate(
        text=WORLD.format(world=large, robot="state: [691003, 5334003, 0], goal: [691008, 5334008]")
    )
    assert report.errors == 0, report


def test_a_speed_near_zero_gives_a_long_but_finite_horizon(tmp_path: Path) -> None:
    text = WORLD.format(world="step_time: 1.0e-6", robot="vel_max: [5.0e-324, 1], state: [1, 1, 0], goal: [8, 8]")
    (tmp_path / "slow.yaml").write_text(text)
    env = irsim.make(tmp_path / "slow.yaml", headless=True)
    assert horizon_of(env.simulation, None, DEFAULT_LIMITS) == (MAX_STEPS, "limits")
    env.end()


def test_poses_of_a_replay_are_apart_in_time() -> None:
    walk = "{{name: replay, times: [0.0, {}], poses: [[1, 1, 0], [2, 1, 0]]}}"
    text = "world: {{}}\nobstacle: {{kinematics: {{name: omni_angular}}, behavior: {}}}\n"
    for second, code in (("5.0e-324", "invalid-value"), ("0.001", None)):
        report = irsim.validate(text=text.format(walk.format(second)))
        assert [one.code for one in report.findings if one.severity == "error"] == ([code] if code else []), report


def test_random_outlines_of_many_objects_have_a_limit_together() -> None:
    shape = "{name: polygon, random_shape: true, num_vertices_range: [999, 1000]}"
    crowd = "world: {{width: 500, height: 500}}\nobstacle: {{number: {}, distribution: {{name: random}}, shape: {}}}\n"
    for number, code in ((10_000, "too-many-objects"), (10, None)):
        report = irsim.validate(text=crowd.format(number, shape))
        assert [one.code for one in report.findings if one.severity == "error"] == ([code] if code else []), report
