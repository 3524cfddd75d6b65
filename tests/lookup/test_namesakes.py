"""Keys that several components have: which of them an answer shows first."""

from __future__ import annotations

import pytest

from irsim.lookup import lookup
from irsim.lookup.language import language_schema
from irsim.lookup.schema_walk import components, key, step
from irsim.options.registry import REGISTRIES


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("range_max", "robot.sensors.lidar2d.range_max"),
        ("std", "robot.sensors.lidar2d.std"),
        ("mode", "robot.behavior.rvo.mode"),
        ("alpha", "robot.kinematics.diff.alpha"),
        ("wheelbase", "robot.shape.rectangle.wheelbase"),
        ("path", "world.obstacle_map.image.path"),
    ],
)
def test_the_key_of_the_best_known_component_comes_first(name: str, first: str) -> None:
    assert lookup(name).groups["topics"][0].name == first


def test_the_best_known_components_exist() -> None:
    for registry in REGISTRIES.values():
        assert registry.best_known
        assert set(registry.best_known) <= set(registry.names())


@pytest.mark.parametrize(
    ("place", "kind"),
    [
        ("robot.kinematics", "kinematics"),
        ("robot.behavior", "behavior"),
        ("robot.sensors", "sensor"),
        ("robot.shape", "shape"),
        ("robot.distribution", "distribution"),
        ("world.obstacle_map", "map"),
        ("robot.behavior.follow.planner", "planner"),
        ("bridges", "bridge"),
    ],
)
def test_a_name_is_one_of_all_components_and_has_no_default(place: str, kind: str) -> None:
    about = lookup(f"{place}.name").about
    assert about is not None
    assert about.default is None
    assert about.allowed == ", ".join(REGISTRIES[kind].names())


def test_a_key_asked_for_without_its_component_has_what_it_is_in_each() -> None:
    schema = language_schema()
    asked = 0
    for place in ("robot.kinematics", "robot.behavior", "robot.sensors", "robot.shape", "robot.distribution"):
        named = components(schema, step(schema, step(schema, [schema], place.split(".")[0]), place.split(".")[1])[0])
        for word in sorted({word for option in named.values() for word in option["properties"]} - {"name"}):
            answer = lookup(f"{place}.{word}")
            own = {
                name: key(schema, word, one["properties"][word])
                for name, one in named.items()
                if word in one["properties"]
            }
            facts = {(one.type, one.unit, one.default, one.allowed) for one in own.values()}
            shown = answer.groups.get("meanings", [answer.about])
            assert {(one.type, one.unit, one.default, one.allowed) for one in shown if one is not None} == facts
            asked += len(facts) > 1
    assert asked > 10
