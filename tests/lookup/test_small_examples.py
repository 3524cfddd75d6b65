"""Examples of single keys: every key that draws, senses or is random has one, and each is a valid scenario."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from irsim.lookup import lookup
from irsim.lookup.schema_walk import paths
from irsim.lookup.small_examples import BETTER, example_of, small_example
from irsim.scenario.model.json_schema import json_schema
from irsim.scenario.read import read

ROOT = Path(__file__).parents[2]
SCHEMA = json_schema()
PATHS = [path for path, _ in paths(SCHEMA) if path[0] != "obstacle" and len(path) > 1]
MADE = {
    path: text
    for path in PATHS
    if (path[-1] in BETTER or example_of(path) is None) and (text := small_example(SCHEMA, path)) is not None
}
ROBOT = {
    "kinematics": {"name": "diff"},
    "shape": {"name": "circle", "radius": 0.2},
    "state": [1, 1, 0],
    "goal": [8, 8],
    "behavior": {"name": "dash"},
}
ELSEWHERE = ("map-not-found", "keep-clear", "unknown-object", "unknown-zone")
"""Errors about a file, or another object, that is not part of the example."""
LESS_TELLING = ("name", "type", "_linewidth", "marker_size", "edge_width")


def errors_of(path: tuple[str, ...], text: str) -> list[str]:
    given = yaml.safe_load(f"{{{text}}}")
    data: dict[str, Any] = {"world": {"width": 12, "height": 12}, "robot": [dict(ROBOT)]}
    if path[0] == "bridges":
        data |= given
    elif path[0] == "robot":
        data["robot"][0].update(given)
    else:
        data.setdefault(path[0], {}).update(given)
    diagnostics = read(data, strict=True).diagnostics
    return [item.code for item in diagnostics if item.severity == "error" and item.code not in ELSEWHERE]


def test_every_made_example_is_valid() -> None:
    assert len(MADE) > 300
    assert {".".join(path): codes for path, text in MADE.items() if (codes := errors_of(path, text))} == {}


@pytest.mark.parametrize("place", ["robot.sensors", "robot.distribution", "robot.plot", "world.plot", "world.zones"])
def test_every_key_that_draws_or_senses_has_an_example(place: str) -> None:
    asked = [path for path in PATHS if ".".join(path).startswith(f"{place}.") and not path[-1].endswith(LESS_TELLING)]
    assert asked
    assert [path for path in asked if path not in MADE and example_of(path) is None] in (
        [],
        [("world", "plot", "saved_figure")],
    )


@pytest.mark.parametrize("word", ["random_shape", "wander", "range_low", "noise", "std", "radius_range"])
def test_every_random_key_has_an_example(word: str) -> None:
    asked = [path for path in PATHS if path[-1] == word and path[:2] != ("gui", "mouse")]
    assert asked
    assert [path for path in asked if path not in MADE and example_of(path) is None] == []


def test_the_example_of_a_field_of_view_has_what_it_needs() -> None:
    assert lookup("fov").example == "fov: 1.5708, fov_radius: 4, fov_occlusion: true, plot: {show_fov: true}"


KEYS_OF_OUR_OWN = {
    "robot.start_time": "start_time: 5",
    "robot.appear_time": "appear_time: [",
    "robot.behavior.follow.within": "within: {rectangle:",
    "robot.behavior.follow.avoid": "behavior: {name: follow, avoid: [",
    "robot.distribution.random.keep_clear": "keep_clear: [{",
    "robot.distribution.random.goal_distance": "goal_distance: ",
    "robot.distribution.circle.start_angle": "start_angle: ",
    "robot.sensors.lidar2d.endpoint": "endpoint: false",
}


@pytest.mark.parametrize("topic", KEYS_OF_OUR_OWN)
def test_a_key_of_our_own_has_an_example_and_is_used_in_a_template_or_worked_example(topic: str) -> None:
    assert KEYS_OF_OUR_OWN[topic] in str(lookup(topic).example)
    key = re.compile(rf"\b{topic.rpartition('.')[2]}: ")
    used = [*ROOT.glob("templates/*/scenario.yaml"), *ROOT.glob("skills/*/examples/*/scenario.yaml")]
    assert any(key.search(path.read_text(encoding="utf-8")) for path in used)
