"""Small pictures for a quick look."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from irsim.render import render_scene

ROOMS = {
    "square": "world: {width: 10, height: 10}",
    "wide": "world: {width: 60, height: 4}",
    "tall": "world: {width: 3, height: 30, offset: [-1, -20]}",
}
ENTRY = """
robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [2, 3, 0], behavior: {name: dash}, shape: {name: circle}}
obstacle: {state: [1, 2, 0], shape: {name: rectangle, length: 1, width: 0.5}}
"""


@pytest.mark.parametrize("room", ROOMS)
@pytest.mark.parametrize("size", [300, 600])
def test_snapshots_fit_and_are_small(make: Callable[..., Any], room: str, size: int, tmp_path: Path) -> None:
    env = make(f"{ROOMS[room]}\n{ENTRY}")
    for _ in range(10):
        env.step()
    data = render_scene(env.simulation, tmp_path / "out" / "look.png", size_px=size)
    assert (tmp_path / "out" / "look.png").read_bytes() == data
    with Image.open(io.BytesIO(data)) as image:
        assert max(image.size) == size
        assert image.mode == "P"
        assert image.format == "PNG"
    assert len(data) < 60_000


def test_snapshots_name_everything_and_show_goals_of_robots(make: Callable[..., Any]) -> None:
    env = make(ENTRY)
    with_labels = render_scene(env.simulation)
    without = render_scene(env.simulation, labels=False)
    assert len(with_labels) > len(without)
    assert render_scene(env.simulation) == with_labels


def test_a_snapshot_leaves_the_environment_alone(make: Callable[..., Any]) -> None:
    env = make(ENTRY)
    render_scene(env.simulation)
    assert env._plot is None or not env._plot.made
    before = env.simulation.pose.copy()
    render_scene(env.simulation, viewpoint=[1, 1], title="here", overrides={"obj_color": "r"})
    assert (env.simulation.pose == before).all()


def test_crowds_are_not_labelled(make: Callable[..., Any]) -> None:
    crowd = "robot: {kinematics: {name: diff}, number: %d, distribution: {name: random}, shape: {name: circle}}"
    few, many = (make("world: {width: 40, height: 40}\n" + crowd % number) for number in (20, 70))
    assert render_scene(few.simulation) != render_scene(few.simulation, overrides={"show_text": False})
    assert render_scene(many.simulation) == render_scene(many.simulation, overrides={"show_text": False})
