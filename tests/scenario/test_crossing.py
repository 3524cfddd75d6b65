"""The distributions circle_crossing and square_crossing, from the file to the scene."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.diagnostics.errors import PlacementError
from irsim.env import Env
from irsim.scenario.open import read_scenario
from irsim.validation.validate import validate
from tests.scenario.test_checks import findings, robot

WORLD = "world: {width: 12, height: 12, offset: [-6, -6], step_time: 0.25}\n"
PERSON = "kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, behavior: {name: dash}"


def scene_of(text: str, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    env = Env(read_scenario(text=text, strict=True)[0], seed=seed, display=False, log_level="ERROR")
    try:
        starts = np.array([one.state[:2, 0] for one in env.objects])
        return starts, np.array([one.goal[:2, 0] for one in env.objects])
    finally:
        env.end()


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


def crossing(name: str = "circle_crossing", number: int = 5, **keys: Any) -> dict[str, Any]:
    disc = {"name": "circle", "radius": 0.3}
    return robot(number=number, shape=disc, distribution={"name": name, **keys})


@pytest.mark.parametrize(
    ("number", "code"), [(5, None), (15, None), (20, "placement-tight"), (60, "placement-impossible")]
)
def test_a_full_circle_is_found_by_arithmetic(number: int, code: str | None) -> None:
    codes = [c for _, c, _ in findings(crossing(number=number, radius=4))]
    assert [c for c in codes if c.startswith("placement")] == ([code] if code else [])
    codes = [c for _, c, _ in findings(crossing("square_crossing", 2 * number, width=5))]
    assert [c for c in codes if c.startswith("placement")] == ([code] if code else [])


def test_a_circle_beyond_the_world_and_keys_without_effect() -> None:
    assert ("hint", "outside-world", ("robot", 0, "distribution")) in findings(crossing(radius=5))
    assert ("hint", "outside-world", ("robot", 0, "distribution")) in findings(crossing("square_crossing", width=11))
    data = crossing(radius=3)
    data["robot"][0]["goal"] = [1, 1]
    assert ("warning", "ignored-key", ("robot", 0, "goal")) in findings(data)


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
