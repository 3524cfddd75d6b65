"""Snapshots and copies of environments go on bit for bit."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from typing import Any

import pytest
import yaml

import irsim
from irsim.diagnostics.errors import InputError
from irsim.env.env_base import Env
from irsim.objects.extensions.registration import register_behavior_class
from irsim.options.registry import BEHAVIORS, CUSTOM_BEHAVIORS

TEMPLATES = sorted(path.parent.name for path in Path("templates").glob("*/scenario.yaml"))


def crowd(behavior: str) -> dict[str, Any]:
    """Robots with noise, lidars and random outlines that meet others on their ways."""
    lidar = {"name": "lidar2d", "number": 30, "noise": True, "std": 0.1, "range_max": 5.0}
    return {
        "world": {"width": 12, "height": 12, "collision_mode": "unobstructed"},
        "robot": {
            "number": 5,
            "kinematics": {"name": "diff", "noise": True},
            "distribution": {"name": "circle", "center": [6, 6], "radius": 4},
            "shape": {"name": "circle", "radius": 0.2},
            "behavior": {"name": behavior},
            "sensors": [lidar],
        },
        "obstacle": {
            "number": 3,
            "distribution": {"name": "random", "range_low": [3, 3, -3], "range_high": [9, 9, 3]},
            "shape": {"name": "polygon", "random_shape": True, "avg_radius_range": [0.1, 0.4]},
        },
    }


def opened(scenario: Any, tmp_path: Path, **options: Any) -> Env:
    if not isinstance(scenario, str):
        (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scenario), encoding="utf-8")
        scenario = str(tmp_path / "scene.yaml")
    return irsim.make(scenario, headless=True, log_level="CRITICAL", seed=5, **options)


def played(env: Env, steps: int = 25) -> list[Any]:
    """Everything that can be seen of some steps, of a reset and of the next scene."""
    seen: list[Any] = []

    def look() -> None:
        simulation = env._simulation
        arrays = (simulation.pose, simulation.control, simulation.ranges, simulation.goal, simulation.collided)
        seen.append([array.tobytes() for array in arrays])
        seen.append([env.time, env.status, [str(event) for event in env.events]])
        seen.append([view.trajectory[-1].tobytes() for view in env.robot_list if view.trajectory])

    for _ in range(steps):
        env.step()
        look()
    for random in (False, True):
        env.reset(random=random)
        env.step()
        look()
    seen.append(env.rng.random())
    return seen


def goes_on(env: Env, steps: int = 20) -> None:
    """Assert that a state can be restored after steps and resets, and that copies of it go on as it did."""
    for _ in range(steps):
        env.step()
    env.rng.random()
    taken = env.snapshot()
    copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    first = played(env)
    for again in (env, *copies):
        again.restore(taken)
        assert played(again) == first
    copied = copy.deepcopy(env)
    assert played(copied) == played(env)


@pytest.mark.parametrize("behavior", ["rvo", "orca", "avocado", "sfm", "footprint_orca", "dash"])
def test_environments_go_on_from_snapshots(behavior: str, tmp_path: Path) -> None:
    assert BEHAVIORS.get(behavior) is not None
    goes_on(opened(crowd(behavior), tmp_path))


@pytest.mark.slow(20)
@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_go_on_from_snapshots(name: str, tmp_path: Path) -> None:
    goes_on(opened(f"templates/{name}/scenario.yaml", tmp_path))


class Turning:
    """A behavior that remembers how often it was called, and its object."""

    def __init__(self, object_info: Any, **kwargs: Any) -> None:
        self.calls, self.info = 0, object_info

    def __call__(self, ego_object: Any, external_objects: Any, **kwargs: Any) -> Any:
        self.calls += 1
        return [[0.5], [0.1 * self.calls]]


@pytest.fixture
def turning(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    monkeypatch.setattr(CUSTOM_BEHAVIORS, "classes", {})
    register_behavior_class("diff", "turning")(Turning)
    return crowd("turning")


def test_behaviors_of_user_code_remember(turning: dict[str, Any], tmp_path: Path) -> None:
    goes_on(opened(turning, tmp_path))


def test_what_cannot_be_saved_is_said(turning: dict[str, Any], tmp_path: Path) -> None:
    env = opened(turning, tmp_path)
    env.step()
    (part,) = env._simulation.decisions
    next(iter(part._instances.values())).source = (number for number in range(3))  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="cannot be saved"):
        env.snapshot()


def test_snapshots_of_other_objects_are_refused(tmp_path: Path) -> None:
    env = opened(crowd("dash"), tmp_path)
    taken = env.snapshot()
    env.delete_object(0)
    with pytest.raises(InputError, match="other objects"):
        env.restore(taken)
    with pytest.raises(InputError, match="added or deleted"):
        copy.deepcopy(env)
    with pytest.raises(InputError, match="other objects"):
        opened("templates/cave/scenario.yaml", tmp_path).restore(taken)


def test_damaged_states_are_refused(tmp_path: Path) -> None:
    state = opened(crowd("orca"), tmp_path)._simulation.state
    whole = state.save()
    for data in (b"", whole[:-1], whole + b"x", whole[: len(whole) // 2], b"\xff" * len(whole)):
        with pytest.raises(ValueError, match="snapshot"):
            state.load(data)


@pytest.mark.parametrize(
    ("part", "key", "value"), [("world", "step_time", 0.5), ("world", "width", 50), ("robot", "shape", {"radius": 0.9})]
)
def test_snapshots_of_a_scenario_that_was_changed_are_refused(part: str, key: str, value: Any, tmp_path: Path) -> None:
    scenario = crowd("dash")
    taken = opened(scenario, tmp_path).snapshot()
    opened(scenario, tmp_path).restore(taken)
    scenario[part][key] = value | {"name": "circle"} if isinstance(value, dict) else value
    with pytest.raises(InputError, match="another scenario"):
        opened(scenario, tmp_path).restore(taken)
