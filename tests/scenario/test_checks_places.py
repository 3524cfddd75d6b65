"""Checks of where objects are placed, how they are turned and how large their numbers are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from irsim.scenario.read import read
from tests.scenario.test_checks import DIFF, findings, obstacle, robot

DISCS = {"distribution": {"name": "random"}, "shape": {"name": "circle", "radius": 0.8}}


@pytest.mark.parametrize(
    ("number", "code"), [(5, None), (30, "placement-tight"), (48, "placement-tight"), (60, "placement-impossible")]
)
def test_random_placement_by_arithmetic(number: int, code: str | None) -> None:
    """1.6 m apart in 9 m x 9 m: at most 48 by Groemer's bound; discs dropped at random jam at half the ground."""
    codes = [c for _, c, _ in findings(robot(number=number, **DISCS)) if c.startswith("placement")]
    assert codes == ([code] if code else [])


def test_random_placement_counts_the_minimal_distance() -> None:
    tight = {"name": "random", "min_distance": 3.0}
    assert "placement-impossible" in [c for _, c, _ in findings(robot(number=40, distribution=tight))]
    assert not findings(robot(number=1, distribution={"name": "random", "min_distance": 30.0}))


@pytest.mark.parametrize(
    ("drive", "behavior", "goal", "expected"),
    [
        ("diff", "orca", [9, 9, 1], False),
        ("omni", "orca", [9, 9, 1], True),
        ("omni", "orca", [9, 9, 0], False),
        ("omni", "orca", [9, 9], False),
        ("omni_angular", "orca", [9, 9, 1], False),
        ("acker", "orca", [9, 9, 1], True),
        ("acker", "follow", [9, 9, 1], False),
    ],
)
def test_goal_headings_that_no_behavior_steers_for(
    drive: str, behavior: str, goal: list[float], expected: bool
) -> None:
    kinematics = {"name": drive, **({"wheelbase": 0.3} if drive == "acker" else {})}
    data = robot(kinematics=kinematics, goal=goal, arrive_mode="state", behavior={"name": behavior}, state=[1, 1, 0])
    assert ("heading-not-reached" in [c for _, c, _ in findings(data)]) == expected


def test_steering_angles_in_degrees() -> None:
    car = {"kinematics": {"name": "acker", "wheelbase": 1}, "vel_min": [-1, -0.5]}
    assert "steering-limit" in [c for _, c, _ in findings(robot(**car, vel_max=[1, 30]))]
    assert "steering-limit" not in [c for _, c, _ in findings(robot(**car, vel_max=[1, 0.5]))]


@pytest.mark.parametrize(
    ("data", "key"),
    [
        ({"world": {"dt": 0.1}}, "step_time"),
        (robot(sensors=[{"range": 5}]), "range_max"),
        (robot(sensors=[{"name": "fmcw_lidar2d", "beams": 5}]), "number"),
        (robot(max_speed=[1, 1]), "vel_max"),
    ],
)
def test_words_that_people_write_for_keys(data: Any, key: str) -> None:
    diagnostic = next(d for d in read(data, strict=True).diagnostics if d.code == "unknown-key")
    assert diagnostic.fix == f"rename it to '{key}'"


def test_parked_robots_that_overlap() -> None:
    parked = {"shape": {"name": "circle", "radius": 0.5}, "number": 3, "state": [[2, 2, 0], [2.5, 2, 0], [3.2, 2, 0]]}
    overlaps = [d for d in read({"robot": [parked]}).diagnostics if d.code == "initial-overlap"]
    assert len(overlaps) == 1
    assert "1 more such pairs" in overlaps[0].message
    assert not findings({"obstacle": [parked]})


@pytest.mark.parametrize(
    "data", [{"world": {"width": 1e308}}, robot(shape={"name": "circle", "radius": 1e200}), robot(state=[1e9, 2, 0])]
)
def test_absurd_magnitudes(data: Any) -> None:
    assert "too-large" in [c for _, c, _ in findings(data)]


def test_missing_images(tmp_path: Path) -> None:
    assert ("warning", "image-not-found", ("robot", 0, "description")) in findings(robot(description="file:///x.png"))
    assert findings(robot(description="car_red.png")) == []
    near = next(d for d in read(robot(description="car_rde.png")).diagnostics if d.code == "image-not-found")
    assert near.fix == "description: car_red.png"


def test_a_state_left_out_is_told_as_a_hint() -> None:
    (item,) = read(robot(), strict=True).diagnostics
    assert (item.severity, item.code, item.path) == ("hint", "default-state", ("robot", 0))
    assert "[1, 1, 0]" in item.message


def test_in_unobstructed_mode_sharing_a_place_is_a_hint() -> None:
    data = {"robot": [{**DIFF, "state": [1, 1]}, {**DIFF, "state": [1.1, 1], "goal": [9, 5]}]}
    for mode, severity in (("stop", "warning"), ("unobstructed", "hint")):
        (item,) = read({"world": {"collision_mode": mode}, **data}, strict=True).diagnostics
        assert (item.code, item.severity) == ("initial-overlap", severity)


def test_touching_is_not_measured() -> None:
    """Rounding may leave a sliver of an overlap, of which no depth is worth telling."""
    post = {"shape": {"name": "rectangle", "length": 0.2, "width": 0.2}, "state": [1.3, 1, 0]}
    diagnostics = read({"robot": [{**DIFF, "state": [1, 1, 0]}], "obstacle": [post]}, strict=True).diagnostics
    assert all("e-" not in item.message for item in diagnostics)


def test_a_very_long_body_in_a_large_world_is_a_hint_and_in_a_small_one_a_warning() -> None:
    ship = {"name": "rectangle", "length": 220, "width": 30}
    for size, severity in ((2000, "hint"), (300, "warning")):
        data = {"world": {"width": 2000, "height": size}, **robot(shape=ship, state=[200, 150], goal=[900, 150])}
        (item,) = [d for d in read(data, strict=True).diagnostics if d.code == "looks-like-centimetres"]
        assert item.severity == severity


def test_fixes_name_numbers() -> None:
    def fix(data: dict[str, Any]) -> str | None:
        return next(d.fix for d in read(data, strict=True).diagnostics if d.code != "default-state")

    assert fix(robot(number=6, distribution={"name": "circle", "radius": 8})) == "radius: 5 or less"
    assert fix(robot(state=[[1, 1], [3, 3]], goal=[[9, 1], [9, 3]])) == "number: 2"
    shape = {"name": "circle", "random_shape": True, "radius_range": [1, 0.2]}
    assert fix(obstacle(shape=shape, state=[5, 5])) == "radius_range: [0.2, 1]"
    thinned = {"obstacle_map": "cave.png", "mdownsample": 500}
    assert "mdownsample" in str(fix({"world": thinned}))
    follows = read(robot(behavior={"name": "follow", "local": "follow"}), strict=True).errors[0]
    assert follows.message == "'follow' is a behavior, but it cannot be used here"


def test_a_goal_at_which_the_body_reaches_over_the_edge() -> None:
    wide = {"shape": {"name": "circle", "radius": 0.3}}
    over = ("hint", "outside-world", ("robot", 0, "goal"))
    assert over in findings(robot(goal=[9.9, 4], **wide))
    assert over not in findings(robot(goal=[9.7, 4], **wide))
    walls = {**robot(goal=[9.9, 4], **wide), "world": {"width": 10, "height": 10, "boundary": "walls"}}
    assert over not in findings(walls), "another finding says that it does not fit"
    [told] = [d for d in read(robot(goal=[9.9, 4], **wide)).diagnostics if d.code == "outside-world"]
    assert "reaches 0.2 m over the edge of the world" in told.message
    assert "x from 0.3 to 9.7" in str(told.fix)
