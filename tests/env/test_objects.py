"""Objects that are made, added and taken out while a world runs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.diagnostics.errors import ScenarioError
from irsim.objects.lifecycle import renumber
from tests.env.driving import Make, take_steps

WORLD = """
world: {width: 10, height: 10}
robot:
  - kinematics: {name: diff, noise: true}
    state: [1, 1, 0]
    goal: [9, 9, 0]
    behavior: {name: dash}
    sensors: [{type: lidar2d, range_max: 5, number: 8, noise: true}]
obstacle:
  - {number: 2, shape: {name: rectangle, length: 1, width: 0.5}, state: [[3, 6, 0], [8, 2, 1]]}
  - {number: 2, kinematics: {name: omni, noise: true}, behavior: {name: dash, wander: true}, state: [[2, 8], [8, 8]],
     shape: {name: circle, radius: 0.2}}
"""


def disc(radius: float) -> dict[str, Any]:
    return {"name": "circle", "radius": radius}


def box(length: float, width: float) -> dict[str, Any]:
    return {"name": "rectangle", "length": length, "width": width}


@pytest.fixture
def env(make: Make) -> Any:
    return make(WORLD)


def test_a_made_object_is_not_in_the_world(env: Any) -> None:
    made = env.create_obstacle(shape=disc(0.3), state=(4, 4, 0))
    assert made not in env.objects
    assert (made.id, made.name, made.role, made.static) == (5, "obstacle_5", "obstacle", True)
    assert (made.goal, made.external_objects) == (None, env.objects)
    assert env.create_robot().state[:, 0].tolist() == [0, 0, 0]
    made.set_state(np.array([[4.5], [4.5], [0.0]]))
    env.add_object(made)
    assert env.objects[-1] is made
    assert (made.state[:, 0].tolist(), made.init_state[:, 0].tolist()) == ([4.5, 4.5, 0], [4, 4, 0])
    assert made.external_objects == env.objects[:-1]


@pytest.mark.parametrize(("state", "touched"), [([7.2, 9.3, 0], "bar"), ([5, 4.4, 0], "disk"), ([5, 3.5, 0], None)])
def test_a_made_object_knows_what_it_would_touch(env: Any, state: list[float], touched: str | None) -> None:
    env.add_object(env.create_obstacle(shape=box(4, 0.2), state=[9, 9, 0], name="bar"))
    env.add_object(env.create_obstacle(shape=disc(0.3), state=[5, 5, 0], name="disk"))
    made = env.create_obstacle(shape=box(0.2, 1), state=[0, 0, 0])
    made.set_state(state)
    assert [other.name for other in made.possible_collision_objects] == ([touched] if touched else [])


def test_an_added_robot_drives_and_collides(env: Any) -> None:
    keys = {"shape": disc(0.2), "state": [5, 5, 0], "goal": [9, 5, 0], "behavior": {"name": "dash"}, "name": "late"}
    robot = env.create_robot({"name": "diff"}, **keys)
    wall = env.create_obstacle(shape=box(0.2, 2), state=[7, 5, 0])
    env.step()
    env.add_objects([robot, wall])
    assert env.robot_list == [env.robot, robot]
    take_steps(env, 40)
    assert (robot.collision_obj, robot.state[0, 0]) == ([wall], pytest.approx(6.8, abs=0.15))
    assert ("late", wall.name) in [(e.object, e.partner) for e in env.events if e.kind == "collision"]
    assert env.done("any")


@pytest.mark.parametrize("gone", [1, 3])
def test_others_go_on_as_if_nothing_had_happened(make: Make, gone: int) -> None:
    text = WORLD.replace("height: 10", "height: 10, collision_mode: unobstructed")
    env, twin = make(text), make(text)
    for each in (env, twin):
        take_steps(each, 5)
    env.delete_object(gone)
    env.add_object(env.create_obstacle(state=[5, -5, 0], shape=disc(0.1)))
    kept = [view.id for view in env.objects if view.id < 5]
    assert kept == [i for i in range(5) if i != gone]
    for _ in range(30):
        env.step()
        twin.step()
        for mine, other in [(env.get_object_by_id(i), twin.get_object_by_id(i)) for i in kept]:
            np.testing.assert_array_equal(mine.state, other.state)
            np.testing.assert_array_equal(mine.velocity, other.velocity)
            assert mine.goal is not None or other.goal is None
    np.testing.assert_array_equal(np.hstack(env.robot.trajectory), np.hstack(twin.robot.trajectory))
    env.reset()
    twin.reset()
    np.testing.assert_array_equal(env.robot.state, twin.robot.state)


def test_sensors_and_contacts_follow_their_objects(env: Any) -> None:
    near = env.create_obstacle(state=[2, 1, 0], shape=disc(0.5), name="near")
    env.add_object(near)
    assert near.id in env.robot.lidar.hits
    env.delete_object(1)
    assert near.id in env.robot.lidar.hits
    env.delete_object("near")
    assert set(env.robot.lidar.hits) <= {0, 2, 3, 4, -1}


def test_a_taken_out_object_stays_usable_and_comes_back(env: Any) -> None:
    take_steps(env, 3)
    mover = env.get_object_by_id(3)
    state, goal = mover.state, mover.goal
    env.delete_object(3)
    env.step()
    np.testing.assert_array_equal(mover.state, state)
    assert len(mover.trajectory) == 3
    env.add_object(mover)
    np.testing.assert_array_equal(mover.state, state)
    np.testing.assert_array_equal(mover.goal, goal)
    env.step()
    assert (mover.state != state).any()
    assert len(mover.trajectory) == 4


def test_resets(env: Any, make: Make) -> None:
    first = env.objects
    added = env.create_robot({"name": "omni"}, state=[5, 5, 0], goal=[6, 6, 0], behavior={"name": "dash"})
    env.add_object(added)
    env.delete_objects([1, 99])
    env.step()
    env.reset()
    assert [view.id for view in env.objects] == [0, 2, 3, 4, 5]
    assert added.state[:, 0].tolist() == [5, 5, 0]
    env.reset(random=True)
    assert env.objects == first
    assert env.create_obstacle().id == 5
    twin = make(WORLD)
    twin.reset(random=True)
    np.testing.assert_array_equal(env.simulation.pose, twin.simulation.pose)
    added.set_state([1, 2, 3])  # still an object of its own


def test_a_new_seed_draws_the_present_objects_anew(make: Make) -> None:
    text = "world: {width: 20}\nobstacle: {number: 3, distribution: {name: random}, shape: {name: circle, radius: 0.2}}"
    env, twin = make(text), make(text, seed=11)
    added = env.create_obstacle(state=[30, 30, 0])
    env.add_object(added)
    env.delete_object(0)
    env.set_random_seed(11)
    env.reset()
    np.testing.assert_array_equal(env.objects[-1].state[:, 0], [30, 30, 0])
    np.testing.assert_array_equal(env.objects[0].state, twin.objects[1].state)


def test_names_are_unique_and_nothing_is_added_twice(env: Any, make: Make) -> None:
    with pytest.raises(ValueError, match="'robot_0' already exists"):
        env.add_object(env.create_obstacle(name="robot_0"))
    fresh = env.create_obstacle(state=[20, 20, 0])
    with pytest.raises(ValueError, match="already exists"):
        env.add_objects([fresh, fresh])
    assert len(env.objects) == 5
    env.add_object(fresh)
    with pytest.raises(TypeError):
        env.add_object("robot")  # type: ignore[arg-type]
    env.validate_unique_names()
    other = make(WORLD)
    env.delete_object("robot_0")
    with pytest.raises(ValueError, match="in a world already"):
        env.add_object(other.objects[0])


def test_an_object_made_elsewhere_gets_an_id_of_its_own(make: Make) -> None:
    env, other = make(WORLD), make(WORLD)
    one, two = env.create_obstacle(state=[5, 5, 0]), other.create_obstacle(state=[6, 6, 0])
    assert one.id == two.id
    env.add_object(one)
    two.set_state([6, 6.5, 0])
    with pytest.raises(ValueError, match="already exists"):
        env.add_object(two)
    named = other.create_obstacle(state=[7, 7, 0], name="b")
    renumber(named, 0)
    env.add_object(named)
    assert sorted({view.id for view in env.objects}) == [0, 1, 2, 3, 4, 5, 6]
    assert env.get_object_by_name("b") is named


def test_keys_that_cannot_be_used(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    env = make(WORLD, log_level="WARNING")
    with pytest.raises(ScenarioError):
        env.create_robot({"name": "hovercraft"})
    robot = env.create_robot({"name": "diff"}, goal=[[1, 1], [2, 2, 0]], colour="red")
    assert "colour" in capsys.readouterr().out
    assert [goal.shape for goal in robot.goals] == [(2, 1), (3, 1)]


def test_different_state_sizes(env: Any) -> None:
    env.step()
    shape = {"name": "rectangle", "length": 0.8, "width": 0.4, "wheelbase": 0.5}
    car = env.create_robot({"name": "acker"}, shape=shape, state=[5, 5, 0, 0.3], vel_max=[2, 1])
    env.add_object(car)
    assert car.state.shape == (4, 1)
    env.step([1.0, 0.1], action_id=car.id)
    assert car.state[3, 0] != 0
    assert [len(view.trajectory[0]) for view in (env.robot, car)] == [3, 4]


def test_python_behaviors_follow_their_objects(make: Make) -> None:
    from irsim.lib import register_behavior

    seen = []

    @register_behavior("omni", "drift-along")
    def drift(ego_object: Any, external_objects: Any, **kwargs: Any) -> list[float]:
        seen.append((ego_object.name, len(external_objects)))
        return [0.5, 0.0]

    env = make(WORLD)
    drifter = env.create_robot({"name": "omni"}, behavior={"name": "drift-along"}, state=[5, 5, 0], name="drifter")
    env.add_object(drifter)
    env.delete_object(1)
    env.step()
    assert seen == [("drifter", 4)]
    assert drifter.state[0, 0] == pytest.approx(5.05)
    env.delete_object(drifter.id)
    env.step()
    assert len(seen) == 1


def test_a_group_keeps_its_behavior_when_its_first_member_goes(make: Make) -> None:
    env = make("""
world: {width: 20, height: 20}
robot:
  - {number: 3, kinematics: {name: omni}, state: [[1, 1, 0], [1, 5, 0], [1, 9, 0]], goal: [[9, 1], [9, 5], [9, 9]],
     group_behavior: [{name: orca}, null, null], shape: {name: circle, radius: 0.2}}
""")
    env.delete_object(0)
    env.add_object(env.create_robot({"name": "omni"}, state=[5, 5, 0], goal=[1, 1, 0]))
    take_steps(env, 5)
    assert [view.state[0, 0] > 1 for view in env.objects] == [True, True, True]
    assert env.objects[2].state[:, 0].tolist() == [5, 5, 0]


def test_random_places_and_shapes(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10}
robot: {kinematics: {name: diff}, state: [1, 1, 0], shape: {name: circle, radius: 0.2}}
obstacle:
  - {number: 4, kinematics: {name: acker}, shape: {name: circle, radius: 0.3}, state: [5, 5, 0, 0.2]}
  - {shape: {name: polygon, vertices: [[0, 0], [1, 0], [0, 1]]}, state: [8, 8, 0]}
""")
    env.random_obstacle_position([0, 0, 0], [3, 3, 0], ids=[1, 2, 3], non_overlapping=True)
    everyone = env.objects
    placed, polygon = everyone[1:4], everyone[5]
    assert all((view.state[:2] >= 0).all() and (view.state[:2] <= 3).all() for view in placed)
    assert all(view.state[3, 0] == 0.2 for view in placed)
    assert not any(a.geometry.intersects(b.geometry) for a in placed for b in everyone if a is not b)
    assert everyone[4].state[:2, 0].tolist() == [5, 5]
    env.step()
    env.reset()
    assert all((view.state[:2] <= 3).all() for view in placed)
    before = polygon.original_vertices
    env.random_polygon_shape(center_range=[0, 0, 0, 0], avg_radius_range=[0.5, 0.6], num_vertices_range=[5, 6])
    after = polygon.original_vertices
    assert after.shape == (2, 5)
    assert polygon.radius < 1.3
    for random, expected in ((False, after), (True, before)):
        env.reset(random=random)
        np.testing.assert_array_equal(polygon.original_vertices, expected)


def test_reload(env: Any, make: Make) -> None:
    env.add_object(env.create_obstacle())
    env.step()
    env.reload()
    assert [view.id for view in env.objects] == [0, 1, 2, 3, 4]
    assert (env.time, env.status) == (0, "None")
    twin = make(WORLD)
    env.step()
    twin.step()
    np.testing.assert_array_equal(env.robot.state, twin.robot.state)


def test_pictures_follow(make: Make, tmp_path: Any) -> None:
    env = make(WORLD, headless=False, display=False)

    def drawn() -> set[int]:
        return {mark.object for mark in env._env_plot.scene().marks}

    assert drawn() == {0, 1, 2, 3, 4}
    env.add_object(env.create_obstacle(state=[5, 5, 0]))
    env.delete_object(2)
    assert drawn() == {0, 1, 3, 4, 5}
    assert env.save_figure(tmp_path / "a.png") is not None
    env.reload()
    assert drawn() == {0, 1, 2, 3, 4}


def test_beside_a_map_and_walls(make: Make) -> None:
    env = make("""
world:
  {width: 10, height: 10, boundary: walls, obstacle_map: {name: perlin, resolution: 0.5, complexity: 0.1, seed: 2}}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [5, 5, 0]}
obstacle: {shape: {name: circle, radius: 0.1}, state: [5, 6, 0]}
""")
    walls, cells = env.get_object_by_name("boundary"), next(o for o in env.obstacle_list if o.shape == "map")
    pushed = env.create_robot({"name": "omni"}, shape=disc(0.2), state=[9.7, 5, 0])
    env.delete_object(1)
    env.add_object(pushed)
    for _ in range(3):
        env.step([1, 0], action_id=pushed.id)
    assert {walls, cells} & set(pushed.collision_obj)
    assert walls.check_collision(pushed) == (walls in pushed.collision_obj)
    before = [view.state.tolist() for view in env.obstacle_list]
    env.random_obstacle_position(non_overlapping=True)
    assert [view.state.tolist() for view in env.obstacle_list] == before
    env.delete_object(cells.id)
    env.step()
    assert cells.id not in [view.id for view in env.objects]
    env.add_object(cells)
    env.step()
    assert walls.possible_collision_objects is not None
