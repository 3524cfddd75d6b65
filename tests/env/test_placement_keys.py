"""Keys of distributions: where a circle begins, what random places keep clear of, how far goals are."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import ScenarioError
from tests.env.driving import Make

SEEDS = range(25)

CIRCLE = """
world: {{width: 10, height: 10}}
robot: {{number: 4, distribution: {{name: circle, radius: 3, {keys}}}, kinematics: {{name: omni}},
  shape: {{name: circle, radius: 0.2}}, behavior: {{name: dash}}}}
"""


def places(env: Any) -> Any:
    return np.array([view.state[:, 0] for view in env.robot_list])


def test_a_circle_begins_at_its_start_angle(make: Make) -> None:
    plain, turned = places(make(CIRCLE.format(keys=""))), make(CIRCLE.format(keys="start_angle: 1.5708"))
    np.testing.assert_allclose(plain[:, :2], [[8, 5], [5, 8], [2, 5], [5, 2]], atol=1e-9)
    np.testing.assert_allclose(places(turned)[:, :2], [[5, 8], [2, 5], [5, 2], [8, 5]], atol=1e-4)
    top = turned.robot_list[0]
    assert top.heading == pytest.approx(-math.pi / 2, abs=1e-4), "objects face the middle"
    np.testing.assert_allclose(top.goal[:2, 0], [5, 2], atol=1e-4)
    assert (places(make(CIRCLE.format(keys="start_angle: 0.0"))) == plain).all()


def test_the_third_number_of_a_centre_is_reported() -> None:
    findings = irsim.validate(text=CIRCLE.format(keys="center: [5, 5, 1.5708]")).findings
    assert ("ignored-key", "start_angle: 1.5708 turns the objects around the circle") in {
        (f.code, f.fix) for f in findings
    }
    assert "ignored-key" not in {f.code for f in irsim.validate(text=CIRCLE.format(keys="center: [5, 5, 0]")).findings}


CLUTTER = """
world: {width: 10, height: 10}
robot: {kinematics: {name: diff}, shape: {name: rectangle, length: 1, width: 0.4}, state: [1, 1, 0], goal: [9, 9],
  behavior: {name: dash}, name: scout}
obstacle: {number: 12, shape: {name: circle, radius: 0.4}, group_name: clutter,
  distribution: {name: random, range_low: [0.5, 0.5, 0], range_high: [9.5, 9.5, 0],
    keep_clear: [{object: scout, radius: 1.0}, {point: [5, 5], radius: 1.5}]}}
"""


def test_random_obstacles_keep_clear_of_points_and_of_starts_and_goals(make: Make) -> None:
    import shapely

    env, near = make(CLUTTER, seed=0), []
    body = env.robot.original_geometry
    at_goal = shapely.affinity.translate(shapely.affinity.rotate(body, 0), 9, 9)
    for _ in SEEDS:
        env.reset(random=True)
        for view in env.obstacle_list:
            centre = shapely.Point(*view.state[:2, 0])
            assert centre.distance(env.robot.geometry) - 0.4 >= 1.0 - 1e-9
            assert centre.distance(at_goal) - 0.4 >= 1.0 - 1e-9
            assert centre.distance(shapely.Point(5, 5)) - 0.4 >= 1.5 - 1e-9
            near.append(centre.distance(shapely.Point(5, 5)))
    assert min(near) < 2.2, "places right outside the radius are drawn"


def test_without_the_key_obstacles_come_near(make: Make) -> None:
    text = CLUTTER.replace("keep_clear: [{object: scout, radius: 1.0}, {point: [5, 5], radius: 1.5}]", "keep_clear: []")
    env, nearest = make(text, seed=0), []
    for _ in SEEDS:
        env.reset(random=True)
        nearest += [math.dist(view.state[:2, 0], (5, 5)) for view in env.obstacle_list]
    assert min(nearest) < 1.0


CROWD = """
world: {width: 12, height: 12}
robot:
  - {number: 2, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}, name: [a, b],
     group_name: team, distribution: {name: random, goal_distance: 8}}
  - {number: 4, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: dash},
     distribution: {name: random, keep_clear: [{object: team, radius: 1.5}], goal_distance: 5}}
"""


def test_goals_are_far_from_starts_and_clear_of_a_group(make: Make) -> None:
    env = make(CROWD, seed=3)
    for _ in SEEDS:
        env.reset(random=True)
        team, others = env.robot_list[:2], env.robot_list[2:]
        assert all(math.dist(view.state[:2, 0], view.goal[:2, 0]) >= 8 for view in team)
        for view in others:
            assert math.dist(view.state[:2, 0], view.goal[:2, 0]) >= 5
            for mate in team:
                assert math.dist(view.state[:2, 0], mate.state[:2, 0]) >= 1.9 - 1e-9
                for place in (mate.state, mate.goal):
                    assert math.dist(view.goal[:2, 0], place[:2, 0]) >= 1.9 - 1e-9


STREAM = """
world: {width: 20, height: 8}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: dash},
  distribution: {name: random, range_low: [1, 2, 0], range_high: [1, 6, 0], goal_low: [19, 4, 0],
    goal_high: [19, 4, 0]}}
obstacle: {number: 8, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: dash},
  distribution: {name: random, range_low: [1, 1, 0], range_high: [5, 7, 0], goal_low: [14, 1, 3], goal_high: [19, 7, 3],
    goal_distance: 12}}
"""


def test_goals_lie_where_their_own_bounds_say(make: Make) -> None:
    env, starts, goals = make(STREAM, seed=1), [], []
    for _ in SEEDS:
        env.reset(random=True)
        assert env.robot.goal[:2, 0] == pytest.approx([19, 4])
        starts.append(float(env.robot.state[1, 0]))
        for view in env.obstacle_list:
            assert 1 <= view.state[0, 0] <= 5
            assert 14 <= view.goal[0, 0] <= 19
            assert view.goal[2, 0] == 3
            assert math.dist(view.state[:2, 0], view.goal[:2, 0]) >= 12
            goals.append(float(view.goal[1, 0]))
    assert min(starts) < 2.5
    assert max(starts) > 5.5
    assert min(goals) < 1.5
    assert max(goals) > 6.5


def test_batches_draw_what_single_worlds_draw(make: Make, tmp_path: Any) -> None:
    path = tmp_path / "crowd.yaml"
    path.write_text(CROWD)
    batch = irsim.batch(path, 3, seeds=[3, 4, 5])
    for world, seed in enumerate((3, 4, 5)):
        single = make(CROWD, seed=seed)
        assert (np.array(batch.pose[world]) == single.simulation.pose).all()


def problems(distribution: str, first: str = "") -> list[tuple[str, str, Any]]:
    text = f"""
world: {{width: 10, height: 10}}
robot:
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, name: scout,
     behavior: {{name: dash}}{first}}}
  - {{number: 2, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, behavior: {{name: dash}},
     distribution: {distribution}}}
"""
    return [(f.severity, f.code, f.fix) for f in irsim.validate(text=text).findings if f.severity != "hint"]


def test_mistakes_in_keep_clear_are_reported() -> None:
    assert problems("{name: random, keep_clear: [{object: scuot, radius: 1}]}") == [
        ("error", "unknown-object", "object: scout")
    ]
    for item in ("{radius: 1}", "{object: scout, point: [1, 1], radius: 1}"):
        ((severity, code, _),) = problems(f"{{name: random, keep_clear: [{item}]}}")
        assert (severity, code) == ("error", "keep-clear")
    ((_, code, fix),) = problems("{name: random, keep_clear: [{object: robot_1, radius: 1}]}")
    assert (code, "min_distance" in fix) == ("keep-clear", True)
    ((_, code, fix),) = problems("{name: random, keep_clear: [{point: [1, 1]}]}")
    assert code == "missing-key"
    assert problems("{name: random, keep_clear: [{object: scout, radius: 1}]}", ", distribution: {name: random}") == []


CIRCLE_AFTER = """
world: {width: 12, height: 12}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: dash},
  distribution: {name: random, keep_clear: [{object: walkers, radius: 1}]}}
obstacle: {number: 3, group_name: walkers, kinematics: {name: omni}, shape: {name: circle, radius: 0.2},
  behavior: {name: dash}, distribution: {name: circle_crossing, radius: 4}}
"""


def test_objects_that_cross_make_way_for_nobody_that_was_placed_before() -> None:
    [finding] = [f for f in irsim.validate(text=CIRCLE_AFTER).findings if f.severity == "error"]
    assert finding.code == "keep-clear"
    assert "'walkers' is placed after this entry" in finding.message


SEVERAL = """
world: {width: 12, height: 12}
robot:
  - {number: 3, name: [a, b, c], kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, behavior: {name: dash},
     distribution: {name: random%s}}
  - {name: fixed, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 1, 0], goal: [6, 6],
     behavior: {name: dash}}
obstacle:
  - {number: 6, group_name: posts, shape: {name: circle, radius: 0.4}, distribution: {name: random%s}}
  - {number: 4, kinematics: {name: omni}, shape: {name: rectangle, length: 0.8, width: 0.4}, behavior: {name: dash},
     distribution: {name: random}}
"""


@pytest.mark.parametrize(
    ("robots", "posts"),
    [
        ("", ", keep_clear: [{object: a, radius: 1.5}, {object: b, radius: 1.5}]"),
        (", keep_clear: [{object: posts, radius: 1.5}]", ""),
    ],
    ids=["of an entry before", "of an entry after"],
)
def test_random_objects_keep_clear_of_starts_and_goals_of_other_random_objects(
    make: Make, robots: str, posts: str
) -> None:
    env = make(SEVERAL % (robots, posts), seed=1)
    for _ in SEEDS:
        env.reset(random=True)
        for robot in env.robot_list[:2]:
            for post in env.obstacle_list[:6]:
                for place in (robot.state, robot.goal):
                    assert math.dist(place[:2, 0], post.state[:2, 0]) >= 0.3 + 0.4 + 1.5 - 1e-9


def test_goals_of_different_entries_do_not_overlap(make: Make) -> None:
    import shapely

    env = make(SEVERAL % ("", ""), seed=1)
    for _ in SEEDS:
        env.reset(random=True)
        bodies = []
        for view in [*env.robot_list, *env.obstacle_list[6:]]:
            heading = view.goal[2, 0] if len(view.goal) > 2 else 0.0
            body = shapely.affinity.rotate(view.original_geometry, heading, (0, 0), use_radians=True)
            bodies.append(shapely.affinity.translate(body, *view.goal[:2, 0]))
        assert not any(a.intersects(b) for k, a in enumerate(bodies) for b in bodies[:k])


def test_a_scene_does_not_depend_on_the_scenes_before_it(make: Make) -> None:
    text = SEVERAL % ("", ", keep_clear: [{object: a, radius: 1.5}]")
    env = make(text, seed=9)
    env.set_random_seed(4)
    env.reset(random=True)
    assert (env.simulation.pose == make(text, seed=4).simulation.pose).all()


def test_a_goal_distance_that_nothing_can_keep_is_an_error() -> None:
    assert [(s, c) for s, c, _ in problems("{name: random, goal_distance: 20}")] == [("error", "placement-crowded")]
    assert {(s, c) for s, c, _ in problems("{name: random, goal_distance: 12}")} == {("warning", "placement-tight")}
    assert problems("{name: random, goal_distance: 9}") == []


def test_a_scene_without_room_says_which_keys_to_lower(make: Make) -> None:
    text = CLUTTER.replace("{point: [5, 5], radius: 1.5}", "{point: [5, 5], radius: 12}")
    with pytest.raises(ScenarioError, match="must hold keep_clear"):
        make(text, seed=1)


def test_a_name_means_the_object_and_not_the_group_of_the_same_name(make: Make) -> None:
    env = make(
        """
world: {width: 10, height: 10}
robot: {number: 2, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [[1, 1], [5, 5]],
  goal: [[2, 1], [6, 5]], behavior: {name: dash}}
obstacle: {number: 30, shape: {name: circle, radius: 0.2},
  distribution: {name: random, min_distance: 0.5, keep_clear: [{object: robot_0, radius: 2}]}}
""",
        seed=2,
    )
    places = np.array([view.state[:2, 0] for view in env.obstacle_list])
    assert np.linalg.norm(places - [1, 1], axis=1).min() >= 2.4 - 1e-9
    assert np.linalg.norm(places - [5, 5], axis=1).min() < 2.0, "robot_1 is of the group robot_0"


def test_mistakes_in_the_bounds_of_goals_are_reported() -> None:
    far = "range_low: [1, 1, 0], range_high: [2, 9, 0]"
    assert problems(f"{{name: random, {far}, goal_low: [8, 1, 0], goal_high: [9, 9, 0], goal_distance: 6}}") == []
    ((severity, code, fix),) = problems(f"{{name: random, {far}, goal_low: [8, 5, 0], goal_high: [9, 3, 0]}}")
    assert (severity, code, "raise goal_high" in fix) == ("error", "range-order", True)
    ((_, code, _),) = problems(f"{{name: random, {far}, goal_low: [8, 5, 0], goal_high: [8, 5.5, 0]}}")
    assert code == "placement-crowded", "two goals a metre apart do not fit"
    ((_, code, _),) = problems(f"{{name: random, {far}, goal_low: [3, 4, 0], goal_high: [4, 6, 0], goal_distance: 7}}")
    assert code == "placement-crowded"
    text = STREAM.replace("goal_high: [19, 7, 3]", "goal_high: [29, 7, 3]")
    (finding,) = [f for f in irsim.validate(text=text).findings if f.code == "outside-world"]
    assert "random goals have x from 14 to 29" in finding.message
    text = STREAM.replace("behavior: {name: dash},\n", "behavior: {name: dash}, goal: [9, 9],\n", 1)
    (finding,) = [f for f in irsim.validate(text=text).findings if f.code == "ignored-key"]
    assert "goal_low and goal_high" in str(finding.fix)
