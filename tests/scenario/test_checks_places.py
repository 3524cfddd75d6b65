"""Checks of where objects are placed and how large their numbers are; distributions that cross."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import irsim
from irsim.common.text import metres
from irsim.diagnostics.errors import PlacementError
from irsim.env import Env
from irsim.scenario.open import read_scenario
from irsim.scenario.read import read
from irsim.validation.validate import validate
from tests.scenario.test_checks import DIFF, PARKED, SMALL, findings, obstacle, robot


def test_parked_robots_that_overlap() -> None:
    (overlap,) = [d for d in read({"robot": [PARKED]}).diagnostics if d.code == "initial-overlap"]
    assert "1 more such pairs" in overlap.message


def test_absurd_magnitudes() -> None:
    assert "error too-large robot[0].shape" in findings(robot(shape={"name": "circle", "radius": 1e8}))
    assert "error too-large robot[0].state" in findings(robot(state=[1e9, 2, 0]))


def test_a_state_left_out_is_told_as_a_hint() -> None:
    (item,) = read(robot(), strict=True).diagnostics
    assert (item.severity, item.code, item.path) == ("hint", "default-state", ("robot", 0))
    assert "[1, 1, 0]" in item.message


def test_touching_is_not_measured() -> None:
    """Rounding may leave a sliver of an overlap, of which no depth is worth telling."""
    post = {"shape": {"name": "rectangle", "length": 0.2, "width": 0.2}, "state": [1.3, 1, 0]}
    diagnostics = read({"robot": [{**DIFF, "state": [1, 1, 0]}], "obstacle": [post]}, strict=True).diagnostics
    assert all("e-" not in item.message for item in diagnostics)


def test_fixes_name_numbers() -> None:
    def fix(data: dict[str, Any]) -> str | None:
        return next(d.fix for d in read(data, strict=True).diagnostics if d.code != "default-state")

    assert fix(robot(number=6, distribution={"name": "circle", "radius": 8})) == "radius: 5 or less"
    assert fix(robot(state=[[1, 1], [3, 3]], goal=[[9, 1], [9, 3]])) == "number: 2"
    shape = {"name": "circle", "random_shape": True, "radius_range": [1, 0.2]}
    assert fix(obstacle(shape=shape, state=[5, 5])) == "radius_range: [0.2, 1]"
    assert fix(robot(description="car_rde.png")) == "description: car_red.png"
    thinned = {"obstacle_map": "cave.png", "mdownsample": 500}
    assert "mdownsample" in str(fix({"world": thinned}))
    follows = read(robot(behavior={"name": "follow", "local": "follow"}), strict=True).errors[0]
    assert follows.message == "'follow' is a behavior, but it cannot be used here"


WORLD = "world: {width: 12, height: 12, offset: [-6, -6], step_time: 0.25}\n"
PERSON = "kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, behavior: {name: dash}"


def scene_of(text: str, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    objects = Env(read_scenario(text=text, strict=True)[0], seed=seed, display=False, log_level="ERROR").objects
    return np.array([one.state[:2, 0] for one in objects]), np.array([one.goal[:2, 0] for one in objects])


def test_a_scene_of_crowdnav() -> None:
    text = WORLD + (
        f"robot: {{{PERSON}, state: [0, -4, 1.57], goal: [0, 4]}}\n"
        "obstacle:\n"
        f"  - {{{PERSON}, number: 5, distribution: {{name: circle_crossing, center: [0, 0], radius: 4}}}}\n"
        f"  - {{{PERSON}, number: 5, distribution: {{name: square_crossing, center: [0, 0], width: 10}}}}\n"
    )
    for seed in range(3):
        starts, goals = scene_of(text, seed)
        np.testing.assert_allclose(goals[1:6], -starts[1:6], atol=1e-12)
        assert (abs(np.linalg.norm(starts[1:6], axis=1) - 4) < 0.75).all()
        assert (starts[6:, 0] * goals[6:, 0] < 0).all()
        pairs = np.triu_indices(11, 1)
        for points in (starts, goals):
            assert np.linalg.norm(points[:, None] - points, axis=2)[pairs].min() >= 0.8
    assert not np.array_equal(scene_of(text, 3)[0], starts)


@pytest.mark.parametrize("shape", ["{name: circle, radius: 0.3}", "{name: polygon, random_shape: true}"])
@pytest.mark.parametrize("name", ["circle_crossing", "square_crossing"])
def test_robots_cross_inside_the_world_by_default(name: str, shape: str) -> None:
    text = WORLD + f"robot: {{kinematics: {{name: diff}}, number: 4, shape: {shape}, distribution: {{name: {name}}}}}\n"
    starts, goals = scene_of(text)
    assert abs(starts).max() <= 5.5
    assert abs(goals).max() <= 5.5
    assert validate(text=text).valid


@pytest.mark.parametrize(
    ("number", "distribution", "said"),
    [
        (28, "{name: circle_crossing, radius: 4}", "the circle of radius 4 m with its noise of 0.5 m"),
        (35, "{name: square_crossing, width: 4}", "the halves of a square of 4 m"),
    ],
)
def test_a_seed_without_room_says_what_to_change(number: int, distribution: str, said: str) -> None:
    text = WORLD + f"obstacle: {{{PERSON}, number: {number}, distribution: {distribution}}}\n"
    with pytest.raises(PlacementError) as caught:
        scene_of(text)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "placement-crowded"
    assert said in diagnostic.message
    assert "`clearance`" in diagnostic.fix
    (crowded,) = [item for item in validate(text=text).findings if item.code == "placement-crowded"]
    assert said in crowded.message


DOOR = """
world: {{width: 10, height: 6, time_limit: 60}}
robot: {{kinematics: {{name: diff}}, shape: {{name: circle, radius: {radius}}}, state: [2, 3, 0], goal: [8, 3],
        behavior: {{name: follow}}}}
obstacle:
  - {{shape: {{name: rectangle, length: 0.3, width: 2.5}}, state: [5, 1.25, 0]}}
  - {{shape: {{name: rectangle, length: 0.3, width: 2.5}}, state: [5, 4.75, 0]}}
"""


def test_a_goal_at_which_the_body_reaches_over_the_edge() -> None:
    (hint,) = [d for d in read(robot(goal=[9.9, 4], **SMALL)).diagnostics if d.code == "outside-world"]
    assert "reaches 0.2 m over the edge of the world" in hint.message
    assert "x from 0.3 to 9.7" in str(hint.fix)


def messages(radius: float) -> str:
    return " ".join(f"{item.message} {item.fix}" for item in irsim.validate(text=DOOR.format(radius=radius)).findings)


def test_a_door_of_one_metre_is_one_metre_wide() -> None:
    for radius in (0.45, 0.48, 0.55, 0.7):
        said = messages(radius)
        assert "gap of 1 m" in said, said
        assert "0.99" not in said


def test_lengths_have_centimetres_and_small_ones_two_digits() -> None:
    lengths = " ".join(metres(value) for value in (0.9991, 1.0004, 2.345, 0.0834, 12345.678))
    assert lengths == "1 m 1 m 2.35 m 0.083 m 12345.68 m"


def test_a_length_beside_a_similar_one_has_the_decimals_that_tell_them_apart() -> None:
    assert [metres(0.5991, unlike=0.6), metres(1, unlike=1.2), metres(1.0, unlike=1.0)] == ["0.599 m", "1 m", "1 m"]
