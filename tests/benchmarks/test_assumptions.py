"""A page of numbers says what it takes for granted of the robots' drives."""

from __future__ import annotations

from typing import Any

import pytest

from irsim.benchmarks.assumptions import assumptions_of
from irsim.scenario.read import or_raise, read

EXACT = "robots change their speed at once (no acce)"


@pytest.mark.parametrize(
    ("robots", "told"),
    [
        ([{}], EXACT),
        ([{"acce": [1, 4]}], "accelerations are limited"),
        ([{"acce": [1, 4]}, {}], "accelerations of some robots are limited"),
        ([{"actuation": {}}], EXACT),
        (
            [{"actuation": {"lag": 0.2, "delay": 0.1}}],
            "accelerations are not limited (no acce), and commands pass actuators (delay, lag)",
        ),
        (
            [{"acce": [1, 4], "actuation": {"noise": 0.1}}, {"acce": [1, 4]}],
            "accelerations are limited, and commands of some robots pass actuators (noise)",
        ),
    ],
)
def test_the_drives_of_robots_are_told(robots: list[dict[str, Any]], told: str) -> None:
    made = [
        {"kinematics": {"name": "diff"}, "state": [1, 1 + 3 * k, 0], "goal": [9, 1 + 3 * k], **keys}
        for k, keys in enumerate(robots)
    ]
    scenario, _ = or_raise(read({"robot": made}, strict=True))
    assert assumptions_of({"one": scenario})[1] == told


@pytest.mark.parametrize(
    ("ways", "told"),
    [
        (["truth", "truth"], "what policies know, they know exactly and at once"),
        (["both", "both"], "robots know where they are from an estimate and others from tracks of a detector"),
        (["estimate", "truth"], "some robots know where they are from an estimate"),
        (["tracks", "tracks"], "robots know others from tracks of a detector"),
    ],
)
def test_what_robots_go_by_is_told(ways: list[str], told: str) -> None:
    sensors = [{"name": "localization"}, {"name": "detector"}]
    made = [
        {"kinematics": {"name": "diff"}, "state": [1, 1 + 3 * k, 0], "goal": [9, 1 + 3 * k], "sensors": sensors}
        | {"perceives": way}
        for k, way in enumerate(ways)
    ]
    scenario, _ = or_raise(read({"robot": made}, strict=True))
    assert assumptions_of({"one": scenario})[2] == told
