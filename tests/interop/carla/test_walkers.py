"""Pedestrians in the town of a stand-in (not CARLA), through the official client."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.bridges.doctor import LEFT_CURVE
from tests.interop.carla.conftest import StandIn
from tests.interop.carla.scenes import CROWD, in_town

pytestmark = pytest.mark.interop
PLACE = (100.0, -50.0, 30.0)


def _walk(path: Path, town: StandIn, steps: int, more: str = "") -> tuple[Any, Any]:
    """Poses (steps + 1, N, 3) of the scenario, and its names."""
    path.write_text(CROWD.format(port=town.port, timeout=5, more=more))
    env = irsim.make(path, display=False)
    with irsim.connect(env) as connection:
        poses = [env.simulation.pose.copy()]
        for _ in range(steps):
            env.step()
            poses.append(env.simulation.pose.copy())
    return np.array(poses), connection


@pytest.mark.parametrize("drift", [0.0, 0.1])
def test_pedestrians_are_where_the_scenario_has_them(
    stand_in: Callable[..., StandIn], tmp_path: Path, drift: float
) -> None:
    town = stand_in(ground=0.3, drift=drift)
    poses, connection = _walk(tmp_path / "crowd.yaml", town, 60)
    names = connection.scene.names
    assert len(names) == 5
    for index, name in enumerate(names):
        if name == "pillar":
            continue
        walked = town.path_of(name)[-61:]
        wanted = in_town(poses[:, index, 0], poses[:, index, 1], PLACE)
        away = np.hypot(*(walked[:, :2] - wanted).T)
        assert away.max() < (0.001 if drift == 0 else 0.03)
        assert np.hypot(*(wanted[-1] - wanted[0])) > 2
        moves = wanted[1:] - wanted[:-1]
        going = np.hypot(*moves.T) > 0.05
        courses = np.degrees(np.arctan2(moves[:, 1], moves[:, 0]))
        assert np.abs(np.remainder(walked[1:, 2] - courses + 180, 360) - 180)[going].max() < (0.2 if drift == 0 else 10)
    assert connection.bridges[0].corrections == 0
    assert {event["blueprint"] for event in town.events("spawn")} == {
        "walker.pedestrian.0001",
        "walker.pedestrian.0002",
    }
    town.check_clean()


def test_one_batch_and_one_tick_in_each_step(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in()
    _walk(tmp_path / "crowd.yaml", town, 20)
    batches = town.events("batch")
    assert [event["kinds"] for event in batches[:-1]] == [[4] * 4] * 20
    assert batches[-1]["kinds"] == [1] * 4
    frames = [event["frame"] for event in batches[:-1]]
    assert np.diff(frames).tolist() == [1] * 19
    (settings,) = [event["settings"] for event in town.events("settings")[:1]]
    assert settings[:3] == [True, False, [True, 0.1]]


def test_a_pedestrian_that_falls_behind_is_put_back(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in(drift=0.9)
    poses, connection = _walk(tmp_path / "crowd.yaml", town, 40, ", correction: 0.3")
    assert connection.bridges[0].corrections == len(town.events("transform")) > 10
    walked = town.path_of("guide")[-41:]
    wanted = in_town(poses[:, 0, 0], poses[:, 0, 1], PLACE)
    assert np.hypot(*(walked[:, :2] - wanted).T).max() < 0.45  # the distance of a correction, and one step
    for event in town.events("transform"):
        assert event["pose"][0][2] == pytest.approx(event["before"][2])  # on the ground, where it was
    town.check_clean()


def test_short_ticks_in_long_steps(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in()
    poses, connection = _walk(tmp_path / "crowd.yaml", town, 10, ", tick: 0.05, rendering: false")
    assert connection.bridges[0].ticks == 20 + 10  # and half a second to fall
    walked = town.path_of("guide")[-21::2]
    np.testing.assert_allclose(walked[:, :2], in_town(poses[:, 0, 0], poses[:, 0, 1], PLACE), atol=1e-3)
    assert town.events("settings")[0]["settings"][:3] == [True, True, [True, 0.05]]
    town.check_clean()


def test_a_town_with_roads(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in(road=LEFT_CURVE, ground=-5.0)
    path = tmp_path / "crowd.yaml"
    text = CROWD.format(port=town.port, timeout=5, more=", town: StandInTown, ground: road")
    path.write_text(text.replace("x: 100, y: -50, yaw: 30", "x: 0, y: 10, yaw: 0"))
    env = irsim.make(path, display=False)
    with irsim.connect(env):
        env.step()
    assert {event["pose"][0][2] for event in town.events("spawn")} == {0.5}  # above the road, not above the ground
