"""Answers of IR-SIM 2.12.0 to calls at the edge of its interface; every one was compared with the original."""

from __future__ import annotations

import inspect
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import ScenarioError
from irsim.gui import KeyboardControl
from irsim.lib.path_planners import AStarPlanner, JPSPlanner
from irsim.util import random as random_numbers
from irsim.world import World
from irsim.world.object_base import ObjectBase
from tests.env.driving import Make, take_steps

TEXT = """
world: {width: 10, height: 10}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 2, 0], goal: [8, 8, 0], acce: [0.5, 0.5]}
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 5, 0], goal: [8, 5, 0],
     behavior: {name: dash}, sensors: [{name: fmcw_lidar2d, number: 5}], plot: {show_text: true}}
obstacle:
  - {number: 3, distribution: {name: random, range_low: [3, 3, 0], range_high: [7, 7, 0]},
     shape: {name: circle, radius: 0.3}}
"""
POSE = np.array([[1.0], [2.0], [0.5]])


# arguments ------------------------------------------------------------------------------------------------------------
@pytest.fixture
def env(make: Make) -> Any:
    return make(TEXT, log_level="WARNING")


def test_env_base_takes_its_arguments_by_position(make: Make, tmp_path: Path) -> None:
    names = list(inspect.signature(irsim.EnvBase.__init__).parameters)[1:12]
    assert names == [
        *("world_name", "display", "disable_all_plot", "save_ani", "ani_kwargs", "full"),
        *("log_file", "log_level", "seed", "step_mode", "headless"),
    ]
    make(TEXT)
    path = tmp_path / "scenario.yaml"
    env = irsim.EnvBase(path, False, False, True, {"suffix": ".gif"}, False, None, "ERROR", 5, "external", True)
    assert (env.display, env.save_ani, env.ani_kwargs, env.seed) == (False, True, {"suffix": ".gif"}, 5)
    assert (env.step_mode, env.headless) == ("external", True)


def test_object_base_takes_its_arguments_by_position(env: Any) -> None:
    circle, acce = {"name": "circle", "radius": 0.3}, [0.7, 0.8]
    made = ObjectBase(
        *(circle, {"name": "diff"}, [1, 2, 0], [0, 0], [5, 5, 0], "robot", "r"),
        *(False, 3.0, 0.4, None, 0.1, [-1, -2], [1, 2], acce, [-math.pi, math.pi], {"name": "dash"}, None, 0.2),
        *([{"name": "lidar2d", "number": 7}], "position", None, 4, "guards", 3, 2, True, 1.0, 2.0, "guard"),
    )
    env.add_object(made)
    assert (made.role, made.color, made.name, made.group, made.group_name) == ("robot", "r", "guard", 4, "guards")
    assert (made.mass, made.friction, made.goal_threshold, made.lidar.number) == (3.0, 0.4, 0.2, 7)
    assert (made.fov, made.fov_radius, made.unobstructed, made.info.acce[:, 0].tolist()) == (1.0, 2.0, True, acce)
    with pytest.raises(TypeError, match="two values for 'static'"):
        ObjectBase(circle, None, None, None, None, "obstacle", "k", True, static=False)


# descriptions ---------------------------------------------------------------------------------------------------------
def test_properties_added_to_info_stay(env: Any) -> None:
    first, second = env.robot_list
    first.info.add_property("x", 3)
    first.info.y = 4
    env.step()
    assert (first.info.x, first.info.y, env.get_robot_info(0).x) == (3, 4, 3)
    assert not hasattr(second.info, "x")
    first.get_obstacle_info().add_property("x", 3)
    assert not hasattr(first.get_obstacle_info(), "x")


# objects --------------------------------------------------------------------------------------------------------------
def test_set_laser_color_without_lidar_warns(env: Any, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = env.robot_list
    first.set_laser_color([0])
    assert "robot_0: it has no lidar" in capsys.readouterr().out
    second.set_laser_color([0, 2])
    assert sorted(second.lidar.colors) == [0, 2]
    with pytest.raises(AttributeError, match="lidar"):
        first.get_lidar_scan()


def test_gen_behavior_vel_without_behavior_is_zero_and_warns_once(
    make: Make, capsys: pytest.CaptureFixture[str]
) -> None:
    env = make(TEXT, log_level="WARNING")
    robot = env.robot
    take_steps(env, 10, [0.4, 0.4])
    capsys.readouterr()
    assert robot.velocity[:, 0].tolist() == pytest.approx([0.4, 0.4])
    for _ in range(2):
        assert robot.gen_behavior_vel().tolist() == [[0], [0]], "the limits of acceleration do not matter"
    assert capsys.readouterr().out.count("it has no behavior") == 1
    assert robot.gen_behavior_vel([1, 0])[:, 0].tolist() == pytest.approx([0.45, 0.35])
    assert env.obstacle_list[0].gen_behavior_vel().tolist() == [[0]] * 3


def test_keyboard_control_without_environment_reads_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib.pyplot as plt
    from matplotlib.backend_bases import KeyEvent

    plt.close("all")  # older versions warn when they close figures themselves
    plt.switch_backend("Agg")
    keyboard = KeyboardControl(backend="mpl", key_lv_max=2.0)
    canvas = plt.gcf().canvas
    canvas.callbacks.process("key_press_event", KeyEvent("key_press_event", canvas, "w"))
    assert keyboard.key_vel[:, 0].tolist() == [2, 0, 0]
    for key in ("r", "escape", " ", "x", "y", "c", "alt+1"):
        keyboard.press(key)  # these act on an environment, and there is no environment
    assert (keyboard.key_id, keyboard.key_ang_max) == (1, 1.2)
    keyboard.stop()
    plt.close()


# randomness -----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("seed", [None, 3])
def test_the_same_seed_draws_the_same_scene_at_a_random_reset(make: Make, seed: int | None) -> None:
    env = make(TEXT, seed=seed)

    def scene(drawn: Any) -> list[Any]:
        random_numbers.set_seed(drawn)
        env.reset(random=True)
        return [view.state[:, 0].tolist() for view in env.obstacle_list]

    first = scene(7)
    assert scene(7) == first
    assert scene(8) != first
    env.reset(random=True)
    assert [view.state[:, 0].tolist() for view in env.obstacle_list] != scene(8)
    random_numbers.set_seed(7)
    env.reset()
    assert [view.state[:, 0].tolist() for view in env.obstacle_list] == scene(8), "only a random reset draws a scene"
    assert scene(2**70) == scene(2**70)


NOISY = """
world: {width: 10, height: 10, step_time: 0.1}
robot: {number: 2, distribution: {name: random}, kinematics: {name: diff, noise: true}, behavior: {name: dash},
        shape: {name: circle, radius: 0.2}, sensors: [{name: lidar2d, number: 3, noise: true, std: 0.5, range_max: 5}]}
"""


def _after_steps(env: Any) -> list[Any]:
    take_steps(env, 3)
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
        return [view.state[:, 0].tolist() for view in make(NOISY, **{"seed": None, **options}).robot_list]

    unseeded = make(NOISY, seed=None)  # the environment used last
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
        states.append([view.state[:, 0].tolist() for view in make(NOISY, seed=None).robot_list])
        assert seeded.robot_list[0].state[0, 0] == pytest.approx(7.2, abs=0.1)
    assert states[0] != states[1]


# writing through the environment --------------------------------------------------------------------------------------
def test_a_status_that_is_written_is_shown_until_the_next_step(make: Make) -> None:
    env = make(TEXT, headless=False, display=False)
    env._world.status = "Mine"
    env.render()
    assert env.status == env._world.status == "Mine"
    assert "Mine" in env._env_plot.ax.get_title()
    env.step()
    assert env._world.status == "Running"
    env.end(ending_time=0)
    assert World(status="Ready").status == "Ready"


def test_the_step_mode_of_the_world_may_be_written(env: Any) -> None:
    env._world.step_mode = "external"
    assert env.step_mode == env.world_param.step_mode == env._world.step_mode == "external"
    with pytest.raises(ValueError, match=r"takes no actions.*set step_mode to 'internal'"):  # D21: the write counts
        env.step([0.5, 0.1])
    with pytest.raises(ValueError, match="sideways"):
        env._world.step_mode = "sideways"


def test_what_is_drawn_of_an_object_may_be_written(make: Make) -> None:
    from irsim.objects.drawing.scene_builder import SceneBuilder

    env = make(TEXT, seed=1)
    robot = env.robot_list[1]
    assert (robot.show_goal, robot.show_goal_text, robot.show_sensor) == (False, False, True)
    assert (robot.show_trail, robot.trail_freq) == (False, 2)
    take_steps(env, 12)
    builder = SceneBuilder(env.simulation)

    def drawn() -> dict[str, int]:
        scene = builder.build()
        parts = [mark.part for mark in scene.marks if mark.object == robot.id]
        labels = [label.part for label in scene.labels if label.object == robot.id]
        return {
            "goal": parts.count("goal"),
            "goal text": labels.count("goal"),
            "trail": parts.count("trail"),
            "beams": len(scene.beams),
        }

    assert drawn() == {"goal": 0, "goal text": 0, "trail": 0, "beams": 1}
    robot.show_goal = robot.show_goal_text = robot.show_trail = True
    robot.show_sensor = False
    assert drawn() == {"goal": 1, "goal text": 1, "trail": 7, "beams": 0}
    robot.trail_freq = 4
    assert drawn()["trail"] == 4
    env.reset()
    assert (robot.show_goal, robot.trail_freq) == (True, 4)
    with pytest.raises(ValueError, match="trail_freq"):
        robot.trail_freq = 0
    with pytest.raises(ValueError, match="show_goal"):
        robot.show_goal = "often"


def test_colours_and_widths_of_an_fmcw_lidar(make: Make) -> None:
    from irsim.objects.sensors.drawing import draw_scan

    env = make(TEXT)
    lidar = env.robot_list[1].lidar
    assert (lidar.no_hit_color.tolist(), lidar.zero_velocity_color.shape) == (pytest.approx([0.82745098] * 3), (3,))
    lidar.no_hit_color, lidar.no_hit_alpha = np.array([1.0, 0.0, 0.0]), 0.5
    lidar.no_hit_linewidth = 3.0
    beams = draw_scan(lidar)
    assert not lidar.valid[4]
    assert (beams.widths[4], beams.colors[4].tolist()) == (3.0, [1, 0, 0, 0.5])
    lidar.positive_velocity_color = "g"
    assert lidar.positive_velocity_color.tolist() == [0, 0.5, 0]
    with pytest.raises(ValueError, match="velocity_color_max"):
        lidar.velocity_color_max = 0.0
    with pytest.raises(ValueError, match="no_hit_color"):
        lidar.no_hit_color = "no such colour"


# maps -----------------------------------------------------------------------------------------------------------------
GRID = "world: {width: 10, height: 8, obstacle_map: {name: perlin, resolution: 0.1, seed: 3}}"


@pytest.mark.parametrize(
    ("resolution", "kept", "cells", "warning"),
    [
        (0.3, 0.3, (33, 27), "0.303 m x 0.2963 m"),
        (3, 3, (3, 3), "3.333 m x 2.667 m"),
        (0.2, 0.2, (50, 40), "0.2 m$"),
        (0.05, 0.05, (100, 80), "cannot be divided"),
        (math.inf, 0.1, (100, 80), "means nothing"),
    ],
)
def test_maps_whose_resolution_does_not_divide_warn(
    make: Make, resolution: float, kept: float, cells: tuple[int, int], warning: str
) -> None:
    env = make(GRID)
    with pytest.warns(UserWarning, match=warning):
        made = env.get_map(resolution)
    assert (made.resolution, made.grid.shape) == (kept, cells)
    for planner in (AStarPlanner(made), JPSPlanner(made)):
        assert planner.resolution == pytest.approx(10 / cells[0])
        assert (planner.x_width, planner.y_width) == cells


def test_planners_have_the_resolution_of_a_map_without_grid(make: Make) -> None:
    planner = AStarPlanner(make(TEXT).get_map(0.3))
    assert (planner.resolution, planner.x_width, planner.y_width) == (0.3, 33, 33)


# worlds ---------------------------------------------------------------------------------------------------------------
def test_a_world_takes_its_arguments_by_place() -> None:
    world = World("w", 8, 10, 0.2)
    assert (world.name, world.height, world.width, world.step_time) == ("w", 8, 10, 0.2)
    assert World().grid_map is None
    with pytest.raises(ScenarioError, match="step_tim"):
        World(step_tim=0.1)


def test_a_world_takes_an_array_as_its_map() -> None:
    values = np.eye(4) * 100
    world = World("w", 4, 6, obstacle_map=values)
    assert (world.grid_map == values).all()
    assert (world.reso.ravel().tolist(), world.obstacle_positions.shape) == ([1.5, 1.0], (2, 4))
