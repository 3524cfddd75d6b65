"""Keys that several components have: which of them an answer shows first."""

from __future__ import annotations

import pytest

from irsim.lookup import lookup
from irsim.options.registry import REGISTRIES


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("range_max", "robot.sensors.lidar2d.range_max"),
        ("std", "robot.sensors.lidar2d.std"),
        ("mode", "robot.behavior.rvo.mode"),
        ("alpha", "robot.kinematics.diff.alpha"),
        ("path", "world.obstacle_map.image.path"),
    ],
)
def test_the_key_of_the_best_known_component_comes_first(name: str, first: str) -> None:
    assert lookup(name).groups["topics"][0].name == first


def test_the_best_known_components_exist() -> None:
    for registry in REGISTRIES.values():
        assert registry.best_known
        assert set(registry.best_known) <= set(registry.names())
