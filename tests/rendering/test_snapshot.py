"""Small pictures for a quick look."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from irsim.graphics.scene.scene import Line, Region, Sector
from irsim.rendering import Scene, SceneBuilder, render_scene
from irsim.rendering.readability import make_legible
from irsim.rendering.snapshot import legible_scene
from tests.env.driving import Make, take_steps

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
def test_snapshots_fit_and_are_small(make: Make, room: str, size: int, tmp_path: Path) -> None:
    env = make(f"{ROOMS[room]}\n{ENTRY}")
    take_steps(env, 10)
    data = render_scene(env.simulation, tmp_path / "out" / "look.png", size_px=size)
    assert (tmp_path / "out" / "look.png").read_bytes() == data
    with Image.open(io.BytesIO(data)) as image:
        assert (max(image.size), image.mode, image.format) == (size, "P", "PNG")
    assert len(data) < 60_000


def test_snapshots_name_everything_and_are_always_the_same(make: Make) -> None:
    simulation = make(ENTRY).simulation
    labelled = render_scene(simulation)
    assert len(labelled) > len(render_scene(simulation, labels=False))
    assert render_scene(simulation) == labelled


def test_a_snapshot_leaves_the_environment_alone(make: Make) -> None:
    env = make(ENTRY)
    before = env.simulation.pose.copy()
    render_scene(env.simulation, viewpoint=[1, 1], title="here", overrides={"obj_color": "r"})
    assert env._plot is None or not env._plot.made
    assert (env.simulation.pose == before).all()


def test_crowds_are_not_labelled(make: Make) -> None:
    crowd = "robot: {kinematics: {name: diff}, number: %d, distribution: {name: random}, shape: {name: circle}}"
    few, many = (make("world: {width: 40, height: 40}\n" + crowd % number) for number in (20, 70))
    assert render_scene(few.simulation) != render_scene(few.simulation, overrides={"show_text": False})
    assert render_scene(many.simulation) == render_scene(many.simulation, overrides={"show_text": False})


def look(env: Any) -> Scene:
    """The scene of a snapshot."""
    keys = {"show_text": True, "show_goal": True, "show_goal_text": True, "show_trajectory": True}
    scene = SceneBuilder(env.simulation).build(overrides=keys)
    make_legible(scene, env.simulation, 0)
    return scene


def pointing(scene: Scene, number: int) -> tuple[float, float]:
    """Where the arrow of an object points: from its start to its tip [m]."""
    (mark,) = scene.of(number, "arrow")
    assert isinstance(mark.geometry, Region)
    ring = mark.geometry.rings[0]
    x, y = ring[3] - (ring[0] + ring[-1]) / 2
    return float(x), float(y)


def test_one_label_for_a_robot_that_has_arrived(make: Make) -> None:
    env = make(
        "robot: {kinematics: {name: diff}, number: 2, state: [[1, 1, 0], [3, 3, 0]], goal: [[1, 1, 0], [8, 8, 0]]}"
    )
    env.step()
    assert [label.text for label in look(env).labels] == ["r0 at goal", "r1", "G-r1"]
    hidden = SceneBuilder(env.simulation).build(overrides={"show_text": True})
    make_legible(hidden, env.simulation, 0)
    assert [label.text for label in hidden.labels] == ["r0", "r1"]


def test_goals_at_one_place_share_a_label(make: Make) -> None:
    robot = "{kinematics: {name: diff}, state: [1, %d, 0], goal: [5, 5, 0]}"
    few, many = (make(f"robot: [{', '.join(robot % y for y in range(1, 1 + number))}]") for number in (3, 5))
    assert [label.text for label in look(few).labels] == ["r0", "r1", "r2", "G-r0, G-r1, G-r2"]
    assert look(many).labels[-1].text == "5 goals"


WALKERS = """
robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [9, 9, 0], shape: {name: circle, radius: 0.3}}
obstacle:
  - {kinematics: {name: omni}, state: [5, 5, 0], goal: [5, 1, 0], behavior: {name: dash}, shape: {name: circle}}
  - {state: [8, 2, 0], goal: [8, 8, 0], shape: {name: circle, radius: 0.3}}
"""


def test_walkers_show_where_they_go(make: Make) -> None:
    env = make(WALKERS)
    scene = look(env)
    along, up = pointing(scene, 1)
    assert abs(along) < 1e-9
    assert up < 0
    (of_robot,), (of_walker,) = scene.of(0, "goal"), scene.of(1, "goal")
    assert 0 < of_walker.alpha < of_robot.alpha
    assert not list(scene.of(2, "goal")), "what stands still goes nowhere"
    assert not list(scene.of(2, "arrow"))
    assert "G-o1" in [label.text for label in scene.labels]
    take_steps(env, 60)
    assert not list(look(env).of(1, "arrow")), "it has arrived"


def test_arrows_are_never_tiny(make: Make) -> None:
    far = make("world: {width: 200, height: 50}\n" + WALKERS)
    assert np.hypot(*pointing(look(far), 0)) == pytest.approx(5.0)
    near = make(WALKERS)
    assert np.hypot(*pointing(look(near), 0)) == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("plot", "stroke"), [("", (2.5, False)), ("plot: {traj_width: 0.2}, ", (0.2, True))], ids=["default", "as said"]
)
def test_paths_are_lines_that_can_be_seen_through(make: Make, plot: str, stroke: tuple[float, bool]) -> None:
    env = make(ENTRY.replace("robot: {", f"robot: {{{plot}"))
    take_steps(env, 5)
    (path,) = look(env).of(0, "trajectory")
    assert isinstance(path.geometry, Line)
    assert (path.stroke.width, path.stroke.metric) == stroke
    assert path.alpha < 1


@pytest.mark.parametrize(
    ("kind", "turn", "outlines"), [("lidar2d", 1.5, 1), ("fmcw_lidar2d", 1.5, 1), ("lidar2d", 6.2832, 0)]
)
def test_what_a_sensor_can_see_has_an_outline(make: Make, kind: str, turn: float, outlines: int) -> None:
    sensor = f"{{type: {kind}, number: 9, range_max: 4, angle_range: {turn}}}"
    env = make(f"robot: {{kinematics: {{name: diff}}, state: [5, 5, 1], sensors: [{sensor}]}}")
    sectors = [mark.geometry for mark in look(env).marks if isinstance(mark.geometry, Sector)]
    assert len(sectors) == outlines
    for sector in sectors:
        assert (sector.x, sector.y, sector.radius) == pytest.approx((5, 5, 4))
        assert (sector.start, sector.end) == pytest.approx((0.25, 1.75))


def test_colors_of_arrows_survive_many_beams(make: Make) -> None:
    lidar = "sensors: [{type: lidar2d, number: 360, range_max: 8, angle_range: 6.2832}]"
    env = make(
        f"robot: {{kinematics: {{name: diff}}, state: [5, 5, 0], {lidar}, shape: {{name: circle, radius: 0.3}}}}"
    )
    with Image.open(io.BytesIO(render_scene(env.simulation))) as image:
        colors = {color: count for count, color in image.convert("RGB").getcolors(100_000) or []}
    assert colors[0xF0, 0xE4, 0x42] > 20
    assert max(colors, key=lambda color: colors[color]) == (255, 255, 255)


def test_names_of_obstacles_under_the_fog_are_hidden(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10, fog_map: true}
robot: {name: scout, kinematics: {name: omni_angular}, state: [1, 1, 0], goal: [9, 9, 1.57], arrive_mode: state,
  sensors: [{name: lidar2d, range_max: 3}]}
obstacle: [{name: far, state: [8, 3]}, {name: near, state: [3, 2]}]
""")
    env.step()
    scene, _ = legible_scene(env.simulation)
    assert {"scout"} <= {label.text for label in scene.labels} <= {"scout", "near", "G-scout"}
    _, of_goal = scene.of(0, "arrow")  # one on the robot, one on its goal, whose heading counts
    (goal,) = scene.of(0, "goal")
    assert of_goal.zorder > goal.zorder > scene.fog.zorder
