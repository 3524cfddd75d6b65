"""Names of IR-SIM that its documentation shows, and the classes behind them."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import pytest

Make = Callable[..., Any]

NAMES = {
    "irsim": "make __version__ EnvBase EnvBase3D",
    "irsim.env": "EnvBase EnvBase3D",
    "irsim.env.env_base": "EnvBase",
    "irsim.env.env_config": "EnvConfig",
    "irsim.env.env_plot": "EnvPlot draw_patch set_patch_property linewidth_from_data_units geometry_to_path",
    "irsim.env.env_plot3d": "EnvPlot3D",
    "irsim.env.env_logger": "EnvLogger",
    "irsim.world": "World ObjectBase ObjectFactory ObjectStatic ObstacleDiff ObstacleOmni ObstacleAcker RobotDiff "
    "RobotOmni RobotAcker SensorFactory",
    "irsim.world.object_base": "ObjectBase ObjectInfo ObstacleInfo",
    "irsim.world.object_group": "ObjectGroup",
    "irsim.world.object_factory": "ObjectFactory",
    "irsim.world.map": "Map EnvGridMap FogMap ObstacleMap GridMapGenerator ImageGridGenerator PerlinGridGenerator "
    "resolve_obstacle_map build_grid_from_generator",
    "irsim.world.sensors": "Lidar2D FMCWLidar2D SensorFactory",
    "irsim.util": "bind_env plot_only resolve_message_targets "
    "WrapToPi WrapToRegion relative_position distance dist_hypot omni_to_diff diff_to_omni time_it "
    "time_it2 transform_point_with_state vertices_transform geometry_transform is_convex_and_ordered "
    "gen_inequal_from_vertex cross_product random_point_range file_check find_file is_2d_list",
    "irsim.util.util": "WrapTo2Pi get_transform to_numpy traj_to_xy_list points_to_xy_list convert_list_length "
    "check_unknown_kwargs normalize_actions validate_shape validate_length ensure_numpy ensure_column_vector "
    "log_warning log_error get_affine_transform is_list_of_numbers is_list_of_dicts is_list_of_lists",
    "irsim.util.random": "rng set_seed random_uniform",
    "irsim.config": "env_param world_param path_param palette_param",
    "irsim.gui": "MouseControl KeyboardControl",
    "irsim.msg": "Header Point Vector3 Quaternion Pose PoseWithCovariance Twist TwistWithCovariance Odometry LaserScan "
    "ContactState ObjectState WorldState",
}


@pytest.mark.parametrize(("module", "name"), [(m, n) for m, names in NAMES.items() for n in names.split()])
def test_name_can_be_imported(module: str, name: str) -> None:
    assert getattr(import_module(module), name) is not None


def test_names_that_nothing_has() -> None:
    with pytest.raises(AttributeError, match="Wrld"):
        _ = import_module("irsim.world").Wrld


def test_objects_with_a_constructor_of_their_own(make: Make) -> None:
    from irsim.world import ObjectBase, ObjectGroup

    env = make("robot: {kinematics: {name: diff}, goal: [5, 5, 0], behavior: {name: dash}}")
    assert isinstance(env.robot, ObjectBase)
    made = ObjectBase({"name": "circle", "radius": 0.3}, {"name": "omni"}, [4, 4, 0], goal=[[1, 1], [2, 2]])
    assert (made.id, made.name, made.role, made.color) == (1, "obstacle_1", "obstacle", "k")
    assert len(made.goals) == 2
    assert made.external_objects == env.objects
    env.add_object(made)
    env.step([0.5, 0], action_id=made.id)
    assert made.state[0, 0] == pytest.approx(4.05)
    assert ObjectBase().radius == 1

    class Counter(ObjectBase):
        calls = 0

        def post_process(self) -> None:
            self.calls += 1

    own = Counter(kinematics={"name": "diff"}, state=[8, 8, 0], role="robot")
    assert not isinstance(made, Counter)
    env.add_object(own)
    env.step()
    assert own.calls == 1
    ObjectBase.reset_id_iter(40)
    assert env.create_robot().id == 40
    group = ObjectGroup(env.robot_list, 0)
    assert (group.number, group.role, group.kinematics) == (2, "robot", "diff")
    assert [velocity.shape for velocity in group.gen_group_vel()] == [(2, 1), (2, 1)]
    before = env.robot.state
    group.step([None, [1, 0]])
    assert (env.robot.state != before).any()
    assert own.state[0, 0] == pytest.approx(8.1)


@pytest.mark.parametrize(
    "name", ["ObjectStatic", "ObstacleDiff", "ObstacleOmni", "RobotDiff", "RobotOmni", "RobotAcker"]
)
def test_deprecated_classes(name: str) -> None:
    kind = getattr(import_module("irsim.world"), name)
    with pytest.warns(DeprecationWarning, match=name):
        made = kind(state=[1, 2, 0])
    assert made.role == ("robot" if name.startswith("Robot") else "obstacle")
    assert made.kinematics == {"Diff": "diff", "Omni": "omni", "Acker": "acker"}.get(
        name.removeprefix("Robot").removeprefix("Obstacle")
    )


def test_the_factory(make: Make) -> None:
    env = make("world: {width: 20, height: 20}\nrobot: {kinematics: {name: diff}}")
    factory = env.object_factory
    pair = factory.create_object(
        "obstacle", number=2, state=[[1, 1, 0], [2, 2, 0]], shape={"name": "circle", "radius": 0.1}
    )
    assert [view.state[0, 0] for view in pair] == [1, 2]
    assert [view.id for view in pair] == [1, 2]
    env.add_objects(pair)
    env.step()
    parsed = factory.create_from_parse(
        [{"kinematics": {"name": "omni"}}, {"number": 2, "name": ["a", "b"]}], "robot", 3
    )
    assert [view.name for view in parsed] == ["robot_3", "a", "b"]
    assert [view.group for view in parsed] == [3, 4, 4]
    assert factory.create_robot({"name": "diff"}, state=[3, 3, 0]).role == "robot"
    states, goals = factory.generate_state_list(3, {"name": "circle", "radius": 4, "center": [5, 5, 0]})
    assert np.hypot(*(np.array(states)[:, :2] - 5).T) == pytest.approx([4, 4, 4])
    assert len(goals) == 3


def test_the_configuration(make: Make) -> None:
    env = make("world: {width: 20}\nrobot: {kinematics: {name: diff}}")
    config = env.env_config
    assert config.parse["world"] == {"width": 20}
    assert config.parse["obstacle"] is None
    assert config.world_file_path.endswith(".yaml")
    assert config.world_name == str(config.world_file_path)
    env.add_object(env.create_obstacle())
    assert len(config.reload_objects()) == 1
    assert len(config.reload_yaml_objects()) == 1


def test_a_world_by_itself() -> None:
    from irsim.world import World

    world = World("hall", width=4, height=3, offset=[1, 2])
    assert (world.name, world.x_range, world.y_range, world.time) == ("hall", [1, 5], [2, 5], 0)


def test_patches() -> None:
    import matplotlib.pyplot as plt
    import shapely

    from irsim.env.env_plot import draw_patch, geometry_to_path, linewidth_from_data_units, set_patch_property

    figure, ax = plt.subplots()
    ax.set_xlim(0, 10)
    ax.set_ylim(0, 10)
    for shape, keys in {
        "circle": {"radius": 2},
        "rectangle": {"width": 2, "height": 1},
        "ellipse": {"width": 2, "height": 1},
        "wedge": {"radius": 1, "theta1": 0, "theta2": 90},
        "polygon": {"vertices": [[0, 1, 1], [0, 0, 1]]},
    }.items():
        set_patch_property(draw_patch(ax, shape, state=[3, 3, 0.5], **keys), alpha=0.5, color=None)
    assert len(ax.patches) == 5
    with pytest.raises(ValueError, match="blob"):
        draw_patch(ax, "blob")
    ring = shapely.Polygon([(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 1), (2, 1), (2, 2)]])
    assert len(geometry_to_path(ring).vertices) == 5 + 4
    assert linewidth_from_data_units(1, ax) > 0
    plt.close(figure)
