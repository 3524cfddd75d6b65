"""Policies drive robots: decisions, what is held in between, who is asked, and what the scenario notices of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.diagnostics.errors import PolicyError
from irsim.policies import Episode, FunctionPolicy, Needs, Observations, Policy
from irsim.policies.driver import attach_policy
from irsim.simulation.simulation import Simulation
from tests.policies.scenes import simulation


class Straight(Policy):
    """Drives along x, and remembers what it was asked."""

    name = "straight"

    def __init__(self, answer: Any = None, **attributes: Any) -> None:
        self.answer = [1.0, 0.0] if answer is None else answer
        self.asked: list[Observations] = []
        self.episodes: list[Episode] = []
        self.draws: list[float] = []
        for key, value in attributes.items():
            setattr(self, key, value)

    def reset(self, episode: Episode, rng: np.random.Generator) -> None:
        self.episodes.append(episode)
        self.draws.append(float(rng.random()))

    def act(self, observations: Observations) -> Any:
        self.asked.append(observations)
        return np.tile(np.asarray(self.answer, dtype=float), (len(observations), 1))


class Swarm(Policy):
    """A velocity that depends on everything a robot sees and on the stream of its world."""

    name, output, decision_dt = "swarm", "velocity", 0.2
    needs = Needs(neighbors=3, scan=True, map=True)

    def __init__(self) -> None:
        self.rng: dict[int, np.random.Generator] = {}

    def reset(self, episode: Episode, rng: np.random.Generator) -> None:
        self.rng[episode.world] = rng

    def act(self, observations: Observations) -> Any:
        near, scan, maps = observations.neighbors, observations.scan, observations.maps
        noise = np.array([self.rng[world].normal(0.0, 0.1, 2) for world in observations.world.tolist()])
        away = np.where(near.mask[..., None], observations.pose[:, None, :2] - near.position, 0.0)[:, 0]
        free = scan.ranges[:, :1] / scan.range_max * (1 - maps[0].occupied.mean())
        return (observations.goal[:, :2] - observations.pose[:, :2]) * 0.2 * free + 0.2 * away + noise


CROWD = {
    "number": 4,
    "distribution": {"name": "random", "range_low": [1, 1, -3], "range_high": [9, 9, 3]},
    "kinematics": {"name": "diff", "noise": True},
    "sensors": [{"name": "lidar2d", "number": 8, "noise": True, "angle_range": 6.28}],
}
PEOPLE = {
    "number": 2,
    "kinematics": {"name": "omni", "noise": True},
    "distribution": {"name": "random", "range_low": [1, 1, -3], "range_high": [9, 9, 3]},
    "behavior": {"name": "dash", "wander": True, "target_roles": "obstacle"},
}


def crowd(*seeds: int, **keys: Any) -> Simulation:
    robots = {key: value for key, value in CROWD.items() if key not in keys}
    return simulation({**robots, **keys, "state": None, "goal": None}, obstacles=[PEOPLE], seeds=seeds)


def drive(made: Simulation, policy: Policy, steps: int = 1) -> Simulation:
    attach_policy(made, policy)
    for _ in range(steps):
        made.step()
    return made


def test_controls_are_executed_within_limits() -> None:
    made = drive(simulation({"vel_max": [0.5, 1]}), Straight([2.0, -0.25]))
    np.testing.assert_allclose(made.pose[0], [1.05, 0.975, 0.0])


def test_any_drive_follows_velocities() -> None:
    drives = [{"name": name} for name in ("diff", "omni", "omni_angular")]
    robots = [{"kinematics": one, "state": [1, 1 + 2 * k, 0]} for k, one in enumerate(drives)]
    robots.append({"kinematics": {"name": "acker", "wheelbase": 0.3}, "state": [1, 7, 0, 0]})
    policy = Straight([0.5, 0.0], output="velocity", drives=frozenset({"diff"}))  # drives do not matter for velocities
    made = drive(simulation(*robots), policy, 10)
    np.testing.assert_allclose(made.pose[:, 0], 1.5, atol=1e-9)
    assert [episode.drive for episode in policy.episodes] == ["mixed"]


def test_controls_of_different_drives_are_asked_for_apart() -> None:
    diff, policy = {"kinematics": {"name": "diff"}}, Straight([0.5, 0.1])
    drive(simulation(diff, {"state": [1, 5, 0]}, {**diff, "state": [1, 8, 0]}, seeds=(0, 1)), policy)
    assert [(one.world, one.robots, one.drive) for one in policy.episodes] == [
        (0, (0, 2), "diff"), (1, (0, 2), "diff"), (2, (1,), "omni"), (3, (1,), "omni"),
    ]  # fmt: skip
    assert [one.world.tolist() for one in policy.asked] == [[0, 0, 1, 1], [2, 3]]


def test_a_decision_is_kept_until_the_next_one() -> None:
    policy = Straight(decision_dt=0.3)
    drive(simulation({}), policy, 7)
    assert [round(one.time[0], 9) for one in policy.asked] == [0.0, 0.3, 0.6]
    assert [one.first[0] for one in policy.asked] == [True, False, False]
    assert policy.episodes[0].decision_steps == 3


def test_a_velocity_is_followed_anew_in_every_step() -> None:
    policy = Straight([0.0, 0.5], output="velocity", decision_dt=1.0)
    made = drive(simulation({"kinematics": {"name": "diff"}}), policy, 10)
    assert len(policy.asked) == 1
    assert made.pose[0, 2] == pytest.approx(1.0)  # it turns toward +y at 1 rad/s
    assert made.control[0, 0] > 0.35  # and is the faster the more it has turned


def test_nobody_decides_for_robots_that_cannot_move() -> None:
    policy = Straight()
    made = simulation({}, {"state": [1, 5, 0]}, {"state": [1, 8, 0]}, {"state": [5, 5, 0], "kinematics": None})
    made.start_step[1] = 2
    made.impose(2, [0.0, 0.5])
    attach_policy(made, policy)
    asked = []
    for _ in range(4):
        made.step()
        asked.append(policy.asked[-1].robot.tolist())
    assert asked == [[0], [0, 2], [0, 1, 2], [0, 1, 2]]
    assert made.pose[2, 1] == pytest.approx(8.05)
    assert policy.asked[2].first.tolist() == [False, True, False]


@pytest.mark.parametrize(("after", "still_asked"), [("freeze", False), ("yield", True)])
def test_robots_that_arrived_for_good_are_asked_only_if_they_still_move(after: str, still_asked: bool) -> None:
    policy = Straight()
    made = drive(simulation({"goal": [1.25, 1]}, after_arrival=after), policy, 6)
    assert made.arrived[0]
    assert [bool(one.arrived[0]) for one in policy.asked] == [False, False] + [True] * 4 * still_asked


def test_colliding_robots_are_not_asked_any_more() -> None:
    policy = Straight()
    wall = {"shape": {"name": "rectangle", "length": 0.2, "width": 4}, "state": [2, 1, 0]}
    made = drive(simulation({}, obstacles=[wall]), policy, 20)
    assert made.stopped[0]
    assert len(policy.asked) < 12


def test_a_batch_equals_single_worlds() -> None:
    together = drive(crowd(5, 6, 7), Swarm(), 30)
    for world, seed in enumerate((5, 6, 7)):
        alone = drive(crowd(seed), Swarm(), 30)
        rows = slice(world * alone.objects, (world + 1) * alone.objects)
        assert together.pose[rows].tobytes() == alone.pose.tobytes()


def test_worlds_that_start_again_are_told_apart() -> None:
    policy = Straight()
    made = drive(crowd(1, 2), policy, 2)
    assert [one.world for one in policy.episodes] == [0, 1]
    made.reset(np.array([False, True]), next_scene=True)
    made.step()
    assert [one.world for one in policy.episodes] == [0, 1, 1]
    assert policy.asked[-1].first.tolist() == [False] * 4 + [True] * 4
    made.reset()
    made.step()
    assert [one.world for one in policy.episodes] == [0, 1, 1, 0, 1]
    assert len(set(policy.draws)) == 5
    made.reseed([1, 2])  # the seeds of the first episodes: new episodes with the same draws
    made.reset()
    made.step()
    assert policy.draws[5:] == policy.draws[:2]


def test_the_policy_does_not_touch_the_scenario() -> None:
    """Obstacles, starts, goals and noise are the same whichever policy drives, and however much it draws."""
    own, driven = (crowd(3) for _ in range(2))
    for made in (own, driven):
        made.world.collision_mode = 1  # people do not stop when robots touch them
    attach_policy(driven, Swarm())
    for _ in range(25):
        own.step()
        driven.step()
    people = slice(4, 6)
    assert own.pose[people].tobytes() == driven.pose[people].tobytes()
    assert not np.array_equal(own.pose[:4], driven.pose[:4])
    for made in (own, driven):
        made.reset(next_scene=True)
    assert own.pose.tobytes() == driven.pose.tobytes()
    assert own.goal.tobytes() == driven.goal.tobytes()


def test_behaviors_of_the_robots_do_not_run() -> None:
    route = {"name": "follow", "planner": "rrt"}
    wall = {"shape": {"name": "rectangle", "length": 0.2, "width": 9.9}, "state": [5, 5, 0]}
    made = drive(simulation({"behavior": route}, obstacles=[wall]), Straight([0.1, 0.0]), 3)
    assert made.state.route(0) is None


def test_removing_the_policy_gives_robots_back_to_their_behaviors() -> None:
    made = drive(simulation({}), Straight([0.0, 0.5]))
    attach_policy(made, None)
    made.step()
    np.testing.assert_allclose(made.pose[0, :2], [1.1, 1.05], atol=1e-3)  # straight to the goal
    assert not made.in_python


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (None, r"returned None. Fix: return an array of shape \(2, 2\): controls of diff"),
        ([[1.0, 0.0]], r"returned shape \(1, 2\)"),
        ([1.0, 0.0], r"returned shape \(2,\)"),
        ([[1.0], [2.0]], r"returned shape \(2, 1\)"),
        ("left", "returned str"),
        ([[1.0, 0.0], [float("nan"), 0.0]], r"returned \[nan, 0.0\] for 'robot_1', which is not finite"),
        (KeyError("goal"), "raised KeyError: 'goal'"),
    ],
)
def test_bad_answers_name_the_policy_and_what_to_return(answer: Any, message: str) -> None:
    def bad(observations: Observations) -> Any:
        if isinstance(answer, Exception):
            raise answer
        return answer

    diff = {"kinematics": {"name": "diff"}}
    with pytest.raises(PolicyError, match=f"policy-failed: policy 'bad' {message}"):
        drive(simulation(diff, {**diff, "state": [1, 5, 0]}), FunctionPolicy(bad))


LIDAR = {"name": "lidar2d", "number": 8}


@pytest.mark.parametrize(
    ("robots", "attributes", "message"),
    [
        ([{}], {"drives": frozenset({"diff"})}, "controls diff, but 'robot_0' has the drive omni"),
        ([{}], {"needs": Needs(scan=True)}, "needs the scan of a lidar, but 'robot_0' has no lidar"),
        ([{"sensors": [LIDAR]}], {"needs": Needs(scan=True, beams=9)}, "was made for 9 beams, .* 'robot_0' has 8"),
        (
            [{"sensors": [LIDAR]}, {"sensors": [{**LIDAR, "range_max": 3}]}],
            {"needs": Needs(scan=True)},
            "needs equal lidars, but the lidars of 'robot_0' and 'robot_1' differ",
        ),
    ],
)
def test_policies_that_do_not_fit_are_refused_before_the_first_step(robots: Any, attributes: Any, message: str) -> None:
    made = simulation(*robots)
    with pytest.raises(PolicyError, match=f"policy-mismatch: policy 'straight' {message}"):
        attach_policy(made, Straight(**attributes))
    assert not made.in_python


def test_a_policy_of_velocities_sees_what_it_commanded_last_not_what_came_of_it() -> None:
    made = simulation(
        {"kinematics": {"name": "diff"}, "vel_max": [0.5, 1.0]},
        {"state": [1, 5, 0], "vel_max": [0.3, 0.3]},
        seeds=(0, 1),
    )
    policy = Straight([0.1, -0.75], output="velocity")
    attach_policy(made, policy)
    for _ in range(3):
        made.step()
    made.reset(np.array([True, False]))
    made.step()
    seen = [one.commanded.tolist() for one in policy.asked if one.commanded is not None]
    assert seen == [[[0, 0]] * 4, [[0.1, -0.75]] * 4, [[0.1, -0.75]] * 4, [[0, 0]] * 2 + [[0.1, -0.75]] * 2]
    controlled = Straight()
    attach_policy(made, controlled)
    made.reset(np.array([True, True]))
    made.step(), made.step()
    assert not np.concatenate([one.commanded for one in controlled.asked]).any()
