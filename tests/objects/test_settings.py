"""A value that scripts write to objects, lidars or the world holds at once, or is an error that says what to do."""

import numpy as np
import pytest

import irsim
from irsim.compat.objects.view import ScriptObject
from irsim.diagnostics.errors import ScenarioError
from irsim.objects.setters import HINTS, SETTINGS
from irsim.objects.views import views
from irsim.options.registry import CUSTOM_BEHAVIORS

TWO = """
world: {height: 10, width: 10}
robot:
  - {kinematics: {name: diff}, state: [1, 1, 0], goal: [9, 1, 0], shape: {name: circle, radius: 0.3},
     behavior: {name: dash}, sensors: [{name: lidar2d, number: 5, range_max: 4, angle_range: 1}]}
  - {kinematics: {name: omni}, state: [1, 5, 0], goal: [9, 5, 0], shape: {name: circle, radius: 0.3},
     behavior: {name: dash}}
obstacle:
  - {shape: {name: circle, radius: 0.5}, state: [4, 1, 0]}
  - {shape: {name: circle, radius: 0.5}, state: [6, 8, 0]}
"""


@pytest.fixture
def env(make):
    env = make(TWO, log_level="WARNING")
    go(env, 3)
    return env


def go(env, steps):
    for _ in range(steps):
        env.step()


def x_of(env):
    return round(float(env.robot.state[0, 0]), 6)


def test_without_a_write_the_obstacle_stops_it(env):
    go(env, 30)
    assert (x_of(env), env.robot.collision) == (3.2, True)


def test_goal_threshold(env):
    env.robot.goal_threshold = 6.45
    go(env, 30)
    assert env.robot.arrive
    assert x_of(env) == pytest.approx(2.6)
    assert env.robot.check_arrive([2, 1])
    assert env.robot.info.goal_threshold == 6.45


def test_unobstructed_and_back(env):
    obstacle = env.objects[2]
    obstacle.unobstructed = True
    env.refresh()
    assert env.get_lidar_scan()["ranges"].min() == 4.0
    go(env, 25)
    assert (x_of(env), env.robot.collision) == (3.8, False)
    obstacle.unobstructed = False
    go(env, 1)
    assert env.robot.collision


def test_static_and_back(env):
    env.robot.static = True
    assert env.robot in env.static_objects
    go(env, 5)
    assert x_of(env) == 1.3
    assert (env.robot.velocity == 0).all()
    env.robot.static = False
    go(env, 5)
    assert x_of(env) == 1.8


@pytest.mark.parametrize("value", [[0.5, 0.5], np.array([[0.5], [0.5]]), (0.5, 0.5)])
def test_limits(env, value):
    env.robot.vel_max = value
    go(env, 10)
    assert x_of(env) == 1.8
    assert env.robot.vel_max.tolist() == [[0.5], [0.5]]
    env.robot.acce = [1.0, 1.0]
    env.robot.vel_max = [5, 1]
    go(env, 1)
    assert env.robot.velocity[0, 0] == pytest.approx(0.6)
    env.robot.acce, env.robot.vel_min = [np.inf, np.inf], [0.9, -1]
    env.step([0, 0])
    assert env.robot.velocity[0, 0] == 0.9


def test_flags(env):
    flags = ("stop_flag", "arrive_flag", "collision_flag")
    for name in flags:
        setattr(env.robot, name, True)
        assert getattr(env.robot, name) is True
    assert env.done("any")
    assert env.robot.collision
    assert env.robot.arrive
    go(env, 1)
    assert not any(getattr(env.robot, name) for name in flags), "they are evaluated anew"


def test_state_under_its_private_names(env):
    env.robot._state = np.c_[[1.0, 9, 0.5]]
    env.robot._goal = [2, 9]
    env.robot._velocity = [0.25, 0]
    assert env.robot.state.ravel().tolist() == [1, 9, 0.5] == env.robot._state.ravel().tolist()
    assert env.robot._goal[0].ravel().tolist() == [2, 9]
    assert env.robot._velocity.ravel().tolist() == env.robot.velocity.ravel().tolist() == [0.25, 0]


AVOIDING = {"name": "rvo", "turning": "fixed"}
"""A behavior that turns as in 2.12."""


@pytest.mark.parametrize(
    "write",
    [
        lambda robot: robot.beh_config.update(AVOIDING),
        lambda robot: [robot.beh_config.__setitem__(key, value) for key, value in AVOIDING.items()],
        lambda robot: setattr(robot, "beh_config", AVOIDING),
        lambda robot: robot.obj_behavior.behavior_dict.update(AVOIDING),
        lambda robot: setattr(robot.obj_behavior, "behavior_dict", AVOIDING),
    ],
)
def test_behavior(env, write):
    write(env.robot)
    assert env.robot.beh_config == AVOIDING == env.robot.obj_behavior.behavior_dict
    go(env, 25)
    assert env.robot.state.ravel() == pytest.approx([2.992, 0.912, -0.299], abs=2e-3)  # as of 2.12


def test_a_behavior_that_cannot_be_leaves_all_as_it_was(env, capsys):
    with pytest.raises(ScenarioError, match="neighbor_threshold"):
        env.robot.beh_config.update(name="rvo", neighbor_threshold="far")
    assert env.robot.beh_config == {"name": "dash"}
    env.robot.beh_config["angle_tolrance"] = 0.3  # a slip, which IR-SIM ignores
    assert env.robot.beh_config == {"name": "dash"}
    assert "angle_tolrance" in capsys.readouterr().out
    env.robot.beh_config.clear()  # none: it stands
    go(env, 3)
    assert x_of(env) == 1.3
    env.robot.beh_config |= {"name": "dash"}
    go(env, 3)
    assert x_of(env) == 1.6
    with pytest.raises(AttributeError, match="has no drive"):
        env.objects[2].beh_config["name"] = "dash"


def test_a_registered_class_is_constructed_for_the_object_that_gets_it(env, monkeypatch):
    monkeypatch.setattr(CUSTOM_BEHAVIORS, "classes", {})
    made = []

    @irsim.lib.register_behavior_class("diff", "mine")
    class Mine:
        def __init__(self, info, **keys):
            made.append((info.name, keys.get("speed")))
            self.speed = keys.get("speed", 0.5)

        def __call__(self, ego_object, external_objects, **keys):
            return [self.speed, 0.0]

    env.robot.beh_config = {"name": "mine", "speed": 0.25}
    go(env, 4)
    assert x_of(env) == 1.4
    env.robot.beh_config["speed"] = 0.5
    go(env, 2)
    assert x_of(env) == 1.5
    assert made == [("robot_0", 0.25), ("robot_0", 0.5)]


def test_wander_and_loop(env):
    env.robot.set_goal([[1.5, 1], [1.7, 1]])
    env.robot.loop = True
    go(env, 6)
    assert not env.robot.arrive
    env.robot.loop = False
    env.robot.wander = True
    here = env.robot.position.ravel().tolist()
    env.robot.set_goal(here)
    go(env, 3)
    assert env.robot.goal.ravel()[:2].tolist() != here


def test_role(env):
    env.robot_list[1].role = "obstacle"
    assert (env.robot_number, env.obstacle_number) == (1, 3)
    env.robot.set_state([8.95, 1, 0])
    go(env, 1)
    assert env.status == "Arrived"


def test_lidar_options(env):
    lidar = env.robot.lidar
    lidar.range_max = 1.0
    assert env.get_lidar_scan()["ranges"].tolist() == [1.0] * 5
    assert env.get_lidar_scan()["range_max"] == 1.0
    lidar.range_max = 3.0
    lidar.number = 3
    scan = env.get_lidar_scan()
    assert scan["ranges"].shape == (3,)
    assert lidar.angle_list.tolist() == [-0.5, 0.0, 0.5]
    assert scan["ranges"][1] == pytest.approx(2.2)
    lidar.offset = [0.2, 0, 0]
    assert env.get_lidar_scan()["ranges"][1] == pytest.approx(2.0)
    lidar.noise, lidar.std = True, 0.05
    env.refresh()
    assert env.get_lidar_scan()["ranges"][1] != pytest.approx(2.0, abs=1e-9)
    go(env, 2)
    assert lidar.range_data.shape == (3,)
    env.reset()
    assert lidar.number == 3
    assert env.get_lidar_scan()["ranges"].shape == (3,)


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("range_max", -1.0, ValueError),
        ("number", 0, ValueError),
        ("noise", "yes", ValueError),
        ("offset", "x", ValueError),
        ("range_data", np.zeros(5), AttributeError),  # it follows from the options
        ("angle_list", np.zeros(5), AttributeError),
    ],
)
def test_what_a_lidar_does_not_take_is_refused(env, name, value, error):
    before = getattr(env.robot.lidar, name)
    with pytest.raises(error, match=name):
        setattr(env.robot.lidar, name, value)
    assert np.all(getattr(env.robot.lidar, name) == before)
    go(env, 1)


def test_objects_come_and_go_with_the_list(env):
    objects = env.objects
    objects.append(env.create_obstacle(shape={"name": "circle", "radius": 0.5}, state=[2.5, 1, 0]))
    assert len(objects) == len(env.objects) == 5
    go(env, 10)
    assert x_of(env) == 1.7
    env.objects.remove(env.objects[-1])
    objects = env.env_param.objects
    gone = objects.pop(2)
    objects += [env.create_obstacle(name="late", shape={"name": "circle"}, state=[9, 9, 0])]
    assert env.names == ["robot_0", "robot_1", "obstacle_3", "late"]
    go(env, 26)
    assert x_of(env) == 4.2
    assert gone.name == "obstacle_2"
    with pytest.raises(ValueError, match="not in list"):
        env.objects.remove(gone)
    for refused in (lambda: env.objects.sort(), lambda: env.objects.insert(0, gone), lambda: objects.reverse()):
        with pytest.raises(TypeError, match="order"):
            refused()
    del env.objects[2:]
    assert env.names == ["robot_0", "robot_1"]


def test_the_world(env):
    assert env.world_param.count == 3
    env._world.count = 0
    assert (env.time, env.world_param.count, env._world.time) == (0, 0, 0)
    env.world_param.step_time = 0.05
    assert (env.step_time, env._world.step_time, env.world_param.step_time) == (0.05, 0.05, 0.05)
    go(env, 2)
    assert (x_of(env), env.time) == (1.4, 0.1)
    with pytest.raises(AttributeError, match="reset"):
        env._world.step_time = 0.1
    env._world.sample_time = 0.1
    assert env._world.steps_per_sample == 2
    assert env._world.sampling
    env.reset()
    env._world.step_time = 0.1
    go(env, 1)
    assert (x_of(env), env.time) == (1.1, 0.1)
    for name in ("width", "offset", "grid_map"):
        with pytest.raises(AttributeError, match="scenario"):
            setattr(env._world, name, None)
    with pytest.raises(AttributeError, match="scenario"):
        env.world_param.gravity = 1.0
    with pytest.raises(ValueError, match="control mode"):
        env.world_param.control_mode = "joystick"


def test_the_step_mode(env):
    env.step_mode = "external"
    go(env, 2)
    assert (x_of(env), env.world_param.step_mode) == (1.3, "external")
    env.world_param.step_mode = "internal"
    go(env, 2)
    assert x_of(env) == 1.5
    with pytest.raises(AttributeError):
        env.seed = 5


@pytest.mark.parametrize("name", sorted(HINTS))
def test_what_cannot_be_written_says_what_to_do(env, name):
    with pytest.raises(AttributeError, match="cannot be set"):
        setattr(env.robot, name, 1)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("static", "no"),
        ("goal_threshold", -1),
        ("goal_threshold", float("nan")),
        ("vel_max", [1]),
        ("vel_min", [float("nan"), 1]),
        ("acce", [-1, 1]),
        ("role", "car"),
        ("arrive_mode", "pose"),
        ("fov", -1.0),
    ],
)
def test_values_are_checked(env, name, value):
    before = env.robot.record
    with pytest.raises((TypeError, ValueError), match=name):
        setattr(env.robot, name, value)
    assert env.robot.record is before


def test_every_property_of_an_object_is_written_or_refused():
    """Nothing public keeps a value that the engine does not know of."""
    written = {"stop_flag", "arrive_flag", "collision_flag", "beh_config", "ax", "text", "goal_text"}
    for name in dir(ScriptObject):
        kind = getattr(ScriptObject, name)
        if isinstance(kind, property) and kind.fset is not None:
            assert name in written or name.startswith("_")
    assert not SETTINGS.keys() & HINTS.keys()


def test_attributes_of_ones_own(env):
    env.robot.my_data, env.robot.lidar.my_note = {"a": 1}, 1
    go(env, 1)
    env.robot.static = True
    assert (env.robot.my_data, env.robot.lidar.my_note) == ({"a": 1}, 1)


def test_lists_that_follow_from_the_world_cannot_be_changed(env):
    for refused in (lambda: env.robot.sensors.append(1), lambda: env.robot.trajectory.clear()):
        with pytest.raises(TypeError, match="cannot be changed"):
            refused()
    assert len(env.robot.trajectory) == 3
    assert isinstance(env.robot.sensors, list)


def test_settings_survive_a_reset_and_keep_everything_else(env):
    before = [view.state for view in env.objects]
    env.robot.goal_threshold = 0.5
    env.objects[3].unobstructed = True
    assert all((view.state == state).all() for view, state in zip(env.objects, before, strict=True))
    assert (env.time, len(env.robot.trajectory), len(env.events)) == (0.3, 3, 0)
    env.reset()
    assert (env.robot.goal_threshold, env.objects[3].unobstructed, x_of(env)) == (0.5, True, 1.0)


def test_an_object_by_itself(env):
    made = env.create_robot(kinematics={"name": "diff"}, state=[1, 3, 0], goal=[9, 3], behavior={"name": "dash"})
    made.vel_max = [0.5, 1]
    made.goal_threshold = 0.4
    env.add_object(made)
    go(env, 2)
    assert made.state[0, 0] == pytest.approx(1.1)
    assert made.goal_threshold == 0.4


def test_objects_of_a_batch_share_their_scenario(make, tmp_path):
    make(TWO)
    simulation = irsim.batch(tmp_path / "scenario.yaml", 2)._simulation
    with pytest.raises(AttributeError, match="batch"):
        views(simulation)[0].goal_threshold = 1.0
