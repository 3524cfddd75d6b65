"""``irsim.util.random.set_seed``: scenes and noise are repeated where IR-SIM 2.12.0 repeats them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irsim
import irsim.util.random as random_numbers

Make = Callable[..., Any]
NOISY = """
world: {width: 10, height: 10, step_time: 0.1}
robot: {number: 2, distribution: {name: random}, kinematics: {name: diff, noise: true}, behavior: {name: dash},
        shape: {name: circle, radius: 0.2}, sensors: [{name: lidar2d, number: 3, noise: true, std: 0.5, range_max: 5}]}
"""


@pytest.fixture
def make(tmp_path: Path) -> Make:
    def made(text: str, seed: int | None = None) -> irsim.Env:
        (tmp_path / "world.yaml").write_text(text)
        return irsim.make(tmp_path / "world.yaml", headless=True, log_level="ERROR", seed=seed)

    return made


def _after_steps(env: Any) -> list[Any]:
    for _ in range(3):
        env.step()
    return [[view.state[:, 0].tolist(), view.lidar.range_data.tolist()] for view in env.robot_list]


@pytest.mark.parametrize("seed", [None, 3])
def test_set_seed_and_a_plain_reset_repeat_the_noise_of_2_12(make: Make, seed: int | None) -> None:
    env = make(NOISY, seed=seed)

    def episode() -> list[Any]:
        random_numbers.set_seed(7)
        env.reset()
        return _after_steps(env)

    first = episode()
    assert episode() == first
    env.reset()
    assert _after_steps(env) != first, "a reset alone goes on with other noise"
    env.reset(random=True)
    random_numbers.set_seed(8)
    env.reset()
    assert _after_steps(env) != first


def test_set_seed_before_make_seeds_the_scenes_of_unseeded_environments_as_in_2_12(make: Make) -> None:
    def scene(**options: Any) -> list[Any]:
        return [view.state[:, 0].tolist() for view in make(NOISY, **options).robot_list]

    unseeded = make(NOISY)  # the environment used last
    random_numbers.set_seed(7)
    first, second = scene(), scene()
    assert first != second
    unseeded.step()
    random_numbers.set_seed(7)
    assert [scene(), scene()] == [first, second]
    random_numbers.set_seed(7)
    assert scene(seed=3) != first, "a seed of its own counts"
    random_numbers.set_seed(7)
    env = make(NOISY, seed=4)
    random_numbers.set_seed(7)
    env.reset(random=True)
    assert [view.state[:, 0].tolist() for view in env.robot_list] == first


def test_set_seed_of_a_seeded_environment_leaves_others_to_chance_as_in_2_12(make: Make) -> None:
    states = []
    for _ in range(2):
        seeded = make(NOISY, seed=3)
        random_numbers.set_seed(7)
        states.append([view.state[:, 0].tolist() for view in make(NOISY).robot_list])
        assert seeded.robot_list[0].state[0, 0] == pytest.approx(7.2, abs=0.1)
    assert states[0] != states[1]
