"""Names beside the loop: worlds, maps, factories and classes by themselves, loggers, mouse and keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from matplotlib.figure import Figure

import irsim
from irsim.common.log import Logger
from irsim.env.env_plot import draw_patch, geometry_to_path, linewidth_from_data_units, set_patch_property
from irsim.world import ObjectBase, ObjectGroup, World
from irsim.world.map import FogMap, ObstacleMap, grid_collision_geometry
from tests.env.driving import Make

YAML = """
world: {width: 10, height: 8}
robot:
  - kinematics: {name: acker}
    shape: {name: rectangle, length: 1, width: 0.5, wheelbase: 0.6}
    state: [3, 4, 0.5, 0.2]
    goal: [9, 7, 0]
    sensors: [{name: lidar2d, number: 5}]
    behavior: {name: dash}
obstacle:
  - {shape: {name: circle, radius: 0.3}, state: [6, 6, 0]}
custom: {note: 3}
"""


@pytest.fixture
def env(make: Make) -> Any:
    return make(YAML)


# worlds and maps
def test_a_world_gives_maps() -> None:
    world = World("small", width=6, height=4, step_time=0.2, offset=[1, 2])
    assert world.gen_grid_map(None) == (None, None, None)
    values = np.zeros((6, 4))
    values[2, 3] = 100
    grid, index, centres = world.gen_grid_map(values)
    assert (grid.shape, world.gen_grid_map(values, 2)[0].shape) == ((6, 4), (3, 2))
    assert (index.tolist(), centres.tolist()) == ([[2], [3]], [[3.5], [5.5]])
    made = world.get_map(0.5, [shapely.Point(3, 3).buffer(0.5)])
    assert (made.resolution, made.world_offset) == (0.5, (1, 2))
    assert made.is_collision(shapely.Point(3.4, 3).buffer(0.2))
    assert not made.is_collision(shapely.Point(5, 5).buffer(0.2))


def test_a_fog_map_answers_like_a_map() -> None:
    fog = FogMap(4, 2, 0.5)
    assert (fog.grid, fog.grid_occupied(1, 1)) == (None, None)
    assert not fog.is_collision(shapely.Point(1, 1).buffer(0.2))
    assert fog.is_collision(shapely.Point(0.1, 1).buffer(0.2))
    fog.obstacle_list = [shapely.Point(1, 1)]
    assert fog.is_collision(shapely.Point(1, 1).buffer(0.2))
    fog.obstacle_list, fog.grid = [], np.zeros((8, 4))
    fog.grid[4, 2] = 100
    assert (fog.grid_occupied(2.2, 1.2), fog.grid_occupied(1.2, 1.2)) == (True, False)
    assert fog.is_collision(shapely.Point(2.2, 1.2).buffer(0.1))


@pytest.mark.parametrize(("x", "touches"), [(0.55, True), (0.69, True), (0.71, False), (9.0, False)])
def test_a_geometry_meets_cells(x: float, touches: bool) -> None:
    grid = np.zeros((20, 20))
    grid[5, 5] = 100
    assert grid_collision_geometry(grid, (0.1, 0.1), shapely.Point(x, 0.55).buffer(0.1)) is touches
    assert not grid_collision_geometry(None, (0.1, 0.1), shapely.Point(x, 0.55).buffer(0.1))


def test_cells_become_one_obstacle(env: Any) -> None:
    factory, grid = env.object_factory, np.zeros((4, 4))
    grid[3, 0] = 100
    assert factory.create_from_map(np.empty((2, 0)), [0.5, 0.5]) == []
    (made,) = factory.create_from_map(np.array([[1.25], [2.25]]), np.array([[0.5], [0.5]]))
    assert isinstance(made, ObstacleMap)
    assert (made.role, made.shape, made.static, made.grid_map.shape) == ("obstacle", "map", True, (20, 16))
    assert [made.is_collision(shapely.Point(1.2, y)) for y in (2.2, 1.8)] == [True, False]
    (other,) = factory.create_from_map(np.array([[1.75], [0.25]]), [0.5, 0.5], grid, [0, 0])
    assert other.grid_map[3, 0] == 100
    assert len({made.id, other.id, *(o.id for o in env.objects)}) == 4


# the environment
def test_the_configuration_has_every_section(env: Any, tmp_path: Path) -> None:
    config = env.env_config
    assert sorted(env.config) == ["custom", "gui", "obstacle", "robot", "world"]
    assert (env.config["gui"], env.config["custom"], config.parse) == ({}, {"note": 3}, env.config)
    assert config.world_name == str(config.world_file_path) == str(tmp_path / "scenario.yaml")
    env.add_object(env.create_obstacle())
    assert (len(config.reload_objects()), len(config.reload_yaml_objects())) == (2, 2)


def test_a_section_that_is_missing_is_none(make: Make) -> None:
    assert make("world: {width: 20}").env_config.parse["obstacle"] is None


def test_behaviors_are_told_as_written(env: Any) -> None:
    assert (env.robot.beh_config, env.robot.obj_behavior.behavior_dict) == ({"name": "dash"}, {"name": "dash"})


def test_objects_are_initialized_anew(env: Any) -> None:
    env.step()
    world, objects, plot, robots, obstacles, maps, groups = env.env_config.initialize_objects()
    assert (world.count, plot, maps) == (0, None, [])
    assert objects == env.objects == [*robots, *obstacles]
    assert [group.number for group in groups] == [1, 1]
    assert groups[0].logger is env.logger


def test_a_closed_logger_writes_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    logger = Logger()
    logger.info("before")
    logger.close()
    logger.error("after")
    assert "before" in (told := capsys.readouterr().out)
    assert "after" not in told


def test_lidars_tell_angles_and_carrier(env: Any) -> None:
    lidar = env.robot.lidar
    np.testing.assert_array_equal(lidar.cast_angles, lidar.angle_list)
    np.testing.assert_array_equal(lidar.state, env.robot.state[:3])


def test_what_a_subclass_overrides_is_called(env: Any) -> None:
    called = []

    class Logged(irsim.Env):
        def add_objects(self, objs):
            called.append("add")
            super().add_objects(objs)

        def delete_objects(self, target_ids):
            called.append("delete")
            super().delete_objects(target_ids)

        def end(self, ending_time=3.0, **kwargs):
            called.append("end")
            super().end(ending_time, **kwargs)

    logged = Logged(env.scenario, headless=True, log_level="ERROR")
    logged.add_object(logged.create_obstacle(state=[3, 3, 0], name="disc"))
    logged.delete_object("disc")
    logged.objects.append(logged.create_obstacle(state=[3, 3, 0]))
    logged.objects.pop()
    with pytest.raises(SystemExit):
        logged.quit()
    assert called == ["add", "delete", "add", "delete", "end"]


def test_objects_with_a_constructor_of_their_own(make: Make) -> None:
    env = make("robot: {kinematics: {name: diff}, goal: [5, 5, 0], behavior: {name: dash}}")
    assert isinstance(env.robot, ObjectBase)
    made = ObjectBase({"name": "circle", "radius": 0.3}, {"name": "omni"}, [4, 4, 0], goal=[[1, 1], [2, 2]])
    assert (made.id, made.name, made.role, made.color) == (1, "obstacle_1", "obstacle", "k")
    assert (len(made.goals), made.external_objects) == (2, env.objects)
    env.add_object(made)
    env.step([0.5, 0], action_id=made.id)
    assert (made.state[0, 0], ObjectBase().radius) == (pytest.approx(4.05), 1)
    ObjectBase.reset_id_iter(40)
    assert env.create_robot().id == 40


def test_objects_and_groups_of_a_class_of_ones_own(make: Make) -> None:
    class Counter(ObjectBase):
        calls = 0

        def post_process(self) -> None:
            self.calls += 1

    env = make("robot: {kinematics: {name: diff}, goal: [5, 5, 0], behavior: {name: dash}}")
    own = Counter(kinematics={"name": "diff"}, state=[8, 8, 0], role="robot")
    env.add_object(own)
    env.step()
    assert own.calls == 1
    group = ObjectGroup(env.robot_list, 0)
    assert (group.number, group.role, group.kinematics) == (2, "robot", "diff")
    assert [velocity.shape for velocity in group.gen_group_vel()] == [(2, 1), (2, 1)]
    before = env.robot.state
    group.step([None, [1, 0]])
    assert (env.robot.state != before).any()
    assert own.state[0, 0] == pytest.approx(8.1)


@pytest.mark.parametrize(
    ("name", "kinematics"),
    [
        ("ObjectStatic", None),
        ("ObstacleDiff", "diff"),
        ("ObstacleOmni", "omni"),
        ("RobotDiff", "diff"),
        ("RobotOmni", "omni"),
        ("RobotAcker", "acker"),
    ],
)
def test_deprecated_classes(name: str, kinematics: str | None) -> None:
    with pytest.warns(DeprecationWarning, match=name):
        made = getattr(irsim.world, name)(state=[1, 2, 0])
    assert (made.role, made.kinematics) == ("robot" if name.startswith("Robot") else "obstacle", kinematics)


def test_the_factory(make: Make) -> None:
    env = make("world: {width: 20, height: 20}\nrobot: {kinematics: {name: diff}}")
    factory, disc = env.object_factory, {"name": "circle", "radius": 0.1}
    pair = factory.create_object("obstacle", number=2, state=[[1, 1, 0], [2, 2, 0]], shape=disc)
    assert [(view.id, view.state[0, 0]) for view in pair] == [(1, 1), (2, 2)]
    env.add_objects(pair)
    env.step()
    entries = [{"kinematics": {"name": "omni"}}, {"number": 2, "name": ["a", "b"]}]
    parsed = factory.create_from_parse(entries, "robot", 3)
    assert [(view.name, view.group) for view in parsed] == [("robot_3", 3), ("a", 4), ("b", 4)]
    assert factory.create_robot({"name": "diff"}, state=[3, 3, 0]).role == "robot"
    states, goals = factory.generate_state_list(3, {"name": "circle", "radius": 4, "center": [5, 5, 0]})
    assert np.hypot(*(np.array(states)[:, :2] - 5).T) == pytest.approx([4, 4, 4])
    assert len(goals) == 3


@pytest.mark.parametrize(
    ("shape", "keys"),
    [
        ("circle", {"radius": 2}),
        ("rectangle", {"width": 2, "height": 1}),
        ("ellipse", {"width": 2, "height": 1}),
        ("wedge", {"radius": 1, "theta1": 0, "theta2": 90}),
        ("polygon", {"vertices": [[0, 1, 1], [0, 0, 1]]}),
    ],
)
def test_patches_are_drawn_into_any_axes(shape: str, keys: dict[str, Any]) -> None:
    ax = Figure().add_subplot()
    set_patch_property(draw_patch(ax, shape, state=[3, 3, 0.5], **keys), alpha=0.5, color=None)
    assert len(ax.patches) == 1


def test_helpers_of_patches() -> None:
    ax = Figure().add_subplot()
    with pytest.raises(ValueError, match="blob"):
        draw_patch(ax, "blob")
    ring = shapely.Polygon([(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 1), (2, 1), (2, 2)]])
    assert len(geometry_to_path(ring).vertices) == 5 + 4
    assert linewidth_from_data_units(1, ax) > 0
