"""Draws of tasks for each episode: ranges, independence of everything but the seed, and what each draw does."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.bundled.templates.fill import fill
from irsim.bundled.templates.store import load
from irsim.learning import Env, ParallelEnv, VectorEnv
from irsim.learning.tasks.files import TaskError
from irsim.learning.worlds import Worlds
from tests.learning.tasks import (
    EVERYTHING,
    LIDAR,
    NOISY,
    PARTS,
    RANDOM,
    ROBOT,
    STARTS,
    corridor,
    crowd,
    lidar_among_boxes,
    rich,
    task,
)

FLAT_OUT = np.array([[1.0, 0.0]])
PEOPLE = {
    "number": 3,
    "tags": ["walkers"],
    "shape": {"name": "circle", "radius": 0.3},
    "kinematics": {"name": "omni"},
    "behavior": {"name": "sfm"},
    "distribution": {"name": "circle_crossing", "center": [5, 5], "radius": 4},
    "vel_max": [1, 1],
    "acce": [2, 2],
}


def drawn_over(worlds: Worlds, episodes: int) -> dict[str, Any]:
    """(episodes * n, ...) of everything that is drawn."""
    drawn = []
    for _ in range(episodes):
        drawn.append(dict(worlds.drawn))
        worlds.reset()
    return {name: np.concatenate([one[name] for one in drawn]) for name in drawn[0]}


# draws ----------------------------------------------------------------------------------------------------------------
def test_draws_keep_to_their_ranges_and_reach_both_ends() -> None:
    drawn = drawn_over(Worlds(rich(), 100, seed=1), 10)
    counts = np.bincount(drawn["number.obstacle[0]"], minlength=5)
    assert (len(counts), counts.min() > 150) == (5, True)
    assert np.bincount(drawn["latency.learners"].ravel()).min() > 200
    for quantity in ("size", "speed", "acceleration", "sensor_noise"):
        [(objects, (low, high))] = EVERYTHING[quantity].items()
        values = drawn[f"{quantity}.{objects}"]
        assert low <= values.min() < low + 0.02 * (high - low)
        assert high - 0.02 * (high - low) < values.max() <= high
        assert values.mean() == pytest.approx((low + high) / 2, abs=0.05 * (high - low))


def test_draws_of_quantities_and_objects_are_independent() -> None:
    drawn = drawn_over(Worlds(rich(), 200, seed=3), 5)
    columns = [drawn["number.obstacle[0]"], *drawn["size.obstacle[0]"].T]
    columns += [drawn[f"{name}.learners"][:, 0] for name in ("speed", "acceleration", "sensor_noise", "latency")]
    assert np.abs(np.corrcoef(np.array(columns, dtype=float)) - np.eye(len(columns))).max() < 0.12


def test_any_of_the_objects_may_be_the_absent_ones() -> None:
    worlds = Worlds(lidar_among_boxes(randomize={"number": {"obstacle[0]": [1, 3]}}), 200, seed=2)
    here = worlds.simulation.state.takes_part.reshape(200, -1)
    assert here[:, 0].all()
    assert (here[:, 1:].sum(axis=1) == worlds.drawn["number.obstacle[0]"]).all()
    assert here[:, 1:].mean(axis=0) == pytest.approx(0.5, abs=0.15)


def test_what_happened_before_does_not_matter() -> None:
    worlds, again = Worlds(rich(), 3, seed=4), Worlds(rich(), 3, seed=50)
    first = drawn_over(worlds, 3)
    again.step(np.ones((3, 2)))
    again.reset(np.array([True, False, True]))
    again.reset(seeds=[4, 5, 6])
    for name, values in drawn_over(again, 3).items():
        assert np.array_equal(values, first[name])


def test_a_task_without_the_keys_draws_nothing_more() -> None:
    plain, empty = Worlds(lidar_among_boxes(), 3, seed=1), Worlds(lidar_among_boxes(randomize={}), 3, seed=1)
    assert plain.drawn == {}
    assert not plain.varies
    unchanged = {"size": {"obstacle[0]": [1, 1]}, "speed": {"robots": [1, 1]}}
    ones = Worlds(lidar_among_boxes(randomize=unchanged), 3, seed=1)
    for _ in range(60):
        for worlds in (plain, empty, ones):
            worlds.step(np.ones((3, 2)))
        for worlds in (empty, ones):
            assert np.array_equal(plain.simulation.pose, worlds.simulation.pose)
            assert np.array_equal(plain.observe(), worlds.observe())


# what each draw does --------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("mode", ["stop", "contact"])
def test_absent_objects_have_no_effect(mode: str) -> None:
    boxes = {"number": 5, "distribution": RANDOM, "shape": {"name": "rectangle", "length": 1, "width": 1}}
    parts = [{"name": "scan", "sectors": 9}, *PARTS, {"name": "neighbors", "count": 4, "range": 9.0, "static": True}]
    reward = [{"name": "progress"}, {"name": "clearance", "margin": 3.0}, {"name": "social", "distance": 2.0}]
    keys = {"observation": parts, "reward": reward, "world": {"collision_mode": mode}, "horizon": 8}
    robot = {"distribution": RANDOM, "number": 2, "sensors": [NOISY]}
    walkers = {**PEOPLE, "number": 2, "tags": ["others"], "distribution": RANDOM}
    none = {"number": {"obstacle[1]": [0, 0], "walkers": [0, 0]}}
    made = task(robot, obstacles=[walkers, boxes, PEOPLE], randomize=none, **keys)
    without = task(robot, obstacles=[walkers], **keys)
    a, b = Worlds(made, 4, seed=2), Worlds(without, 4, seed=2)
    b.reset(seeds=[2, 3, 4, 5])
    rng = np.random.default_rng(0)
    for step in range(90):
        if step == 80:
            a.reset()
            b.reset()
        actions = rng.uniform(-1, 1, (8, 2))
        one, other = a.step(actions), b.step(actions)
        assert np.array_equal(a.observe(), b.observe())
        assert np.array_equal(one.terms, other.terms)
        for name in ("terminated", "truncated", "over", "collided"):
            assert np.array_equal(getattr(one, name), getattr(other, name))
        n = b.simulation.objects
        for name in ("pose", "twist", "collided", "ranges"):
            mine, its = (getattr(worlds.simulation, name).reshape(4, -1) for worlds in (a, b))
            assert np.array_equal(mine[:, : its.shape[1]], its), name
        assert (a.simulation.collided.reshape(4, -1)[:, n:] == 0).all()


def test_absent_learners_are_slots_that_wait() -> None:
    made = crowd(4, randomize={"number": {"learners": [1, 4]}}, horizon=3)
    env = VectorEnv(made, 32, seed=3)
    seen, info = env.reset()
    here = env.worlds.present.reshape(-1)
    assert 8 <= here.sum() < 32
    assert (info["drawn"]["number.learners"] == np.repeat(env.worlds.present.sum(axis=1), 4)).all()
    assert (seen[~here] == 0).all()
    for step in range(1, 31):
        seen, reward, terminated, truncated, info = env.step(np.ones((32, 2)))
        assert np.isfinite(reward).all()
        assert not np.array([reward, info["active"], terminated])[:, ~here].any()
        assert truncated[~here].all() == (step == 30)


def test_agents_that_are_absent_are_not_in_the_parallel_environment() -> None:
    env = ParallelEnv(crowd(4, randomize={"number": {"learners": [1, 4]}}, horizon=1), seed=3)
    sizes = set()
    for _ in range(12):
        seen, infos = env.reset()
        assert set(seen) == set(infos) == set(env.agents)
        assert len(env.agents) == infos[env.agents[0]]["drawn"]["number.learners"]
        sizes.add(len(env.agents))
        while env.agents:
            seen, *_ = env.step({agent: np.ones(2, dtype=np.float32) for agent in env.agents})
            assert all(np.isfinite(row).all() for row in seen.values())
    assert sizes == {1, 2, 3, 4}


@pytest.mark.parametrize("steps", [0, 1, 4])
def test_actions_are_executed_some_steps_later(steps: int) -> None:
    worlds = Worlds(task(randomize={"latency": {"learners": [steps, steps]}}), 2, seed=0)
    speeds = np.array([0.5, -0.25, 1.0, 0.125, 0.75, -0.5, 0.25, 1.0, 0.5, 0.5])
    for _ in range(2):  # the actions of an episode do not reach the next one
        for k, speed in enumerate(speeds):
            worlds.step(np.array([[speed, 0.0]] * 2))
            arrived = speeds[: max(0, k + 1 - steps)]
            executed = arrived[-1] if len(arrived) else 0.0
            assert worlds.simulation.control[worlds.rows, 0].tolist() == [executed] * 2
            assert worlds.simulation.pose[worlds.rows, 0] == pytest.approx(1 + 0.1 * arrived.sum())
        worlds.reset()


def test_each_learner_has_its_own_latency_or_all_share_one() -> None:
    made = {"latency": {"learners": [0, 9]}, "speed": {"learners": [0.5, 1.0]}}
    one = Worlds(crowd(3, randomize=made), 20, seed=1)
    assert one.drawn["latency.learners"].shape == (20, 3)
    assert (np.ptp(one.drawn["latency.learners"], axis=1) > 0).mean() > 0.8
    same = Worlds(crowd(3, randomize={**made, "same": ["latency"]}), 20, seed=1)
    assert same.drawn["latency.learners"].shape == (20,)
    assert (np.ptp(same.simulation.state.latency.reshape(20, 3), axis=1) == 0).all()
    assert np.array_equal(same.drawn["latency.learners"], one.drawn["latency.learners"][:, 0])


def test_limits_are_scaled() -> None:
    made = task({"acce": [0.5, 1.0]}, {**ROBOT, "state": [1, 2, 0]}, obstacles=[PEOPLE])
    slower = {"robot[0]": [0.5, 0.5], "people": [0.25, 0.25]}
    made["randomize"] = {"speed": slower, "acceleration": {"robot[0]": [2, 2]}}
    worlds = Worlds(made, 1, seed=0)
    state = worlds.simulation.state
    assert state.vel_max[:2].tolist() == [[0.5, 2.0, 0.0], [1.0, 2.0, 0.0]]  # turn rates are not speeds
    assert state.vel_min[0].tolist() == [-0.5, -2.0, 0.0]
    for _ in range(3):
        worlds.step(np.array([[1.0, 0.0], [1.0, 0.0]]))
    assert worlds.simulation.control[:2, 0] == pytest.approx([0.3, 1.0])  # 2 * 0.5 m/s^2 for 0.3 s
    for _ in range(20):
        worlds.step(np.array([[1.0, 0.0], [1.0, 0.0]]))
        assert (np.abs(worlds.simulation.control[2:, :2]) <= 0.25 + 1e-12).all()
    assert worlds.simulation.control[0, 0] == 0.5


def test_footprints_are_scaled() -> None:
    box = {"shape": {"name": "rectangle", "length": 1, "width": 2}, "state": [5, 5, 0]}
    disc = {"shape": {"name": "circle", "radius": 0.5}, "state": [5, 8, 0]}
    made = task({"sensors": [{**LIDAR, "number": 1}]}, obstacles=[box, disc])
    made["randomize"] = {"size": {"obstacle[0]": [2, 2], "obstacle[1]": [0.5, 0.5], "robots": [1.5, 1.5]}}
    worlds = Worlds(made, 2, seed=0)
    assert worlds.simulation.radius.reshape(2, 3) == pytest.approx(np.array([[0.3, np.sqrt(5), 0.25]] * 2))
    assert worlds.simulation.ranges == pytest.approx([3.0, 3.0])
    while not worlds.step(np.repeat(FLAT_OUT, 2, axis=0)).over.any():
        pass
    assert worlds.simulation.collided[0]
    assert worlds.simulation.pose[0, 0] == pytest.approx(3.7, abs=0.11)


def test_noise_of_sensors_is_scaled() -> None:
    wall = {"shape": {"name": "rectangle", "length": 1, "width": 60}, "state": [3.5, 5, 0]}
    sensor = {**LIDAR, "number": 400, "angle_range": 0.2, "noise": True, "std": 0.05}
    deviations = []
    for scale in (0, 1, 2):
        made = task({"sensors": [sensor]}, obstacles=[wall], randomize={"sensor_noise": {"learners": [scale, scale]}})
        worlds = Worlds(made, 1, seed=5)
        deviations.append(worlds.simulation.ranges - 2 / np.cos(np.linspace(-0.1, 0.1, 400)))
    assert deviations[0] == pytest.approx(np.zeros(400), abs=1e-9)
    assert deviations[1].std() == pytest.approx(0.05, rel=0.1)
    assert deviations[2] == pytest.approx(2 * deviations[1], abs=1e-9)


# variants -------------------------------------------------------------------------------------------------------------
def test_parameters_of_a_template_are_drawn_as_variants(tmp_path: Path) -> None:
    worlds = Worlds(corridor(), 60, seed=1)
    width, variant = worlds.drawn["parameters.width"], worlds.drawn["variant"]
    assert sorted(set(width.tolist())) == pytest.approx([1.3, 1.8, 2.3, 2.8, 3.3])
    assert len(set(zip(variant.tolist(), width.tolist(), strict=True))) == 5
    pose = worlds.simulation.pose.reshape(60, -1, 3)
    assert pose[:, 2, 1] - pose[:, 3, 1] == pytest.approx(width + 0.3)  # the walls are 0.3 m thick
    file = tmp_path / "filled.yaml"
    file.write_text(fill(load("corridor-passing"), {"width": float(width[0])}))
    assert np.array_equal(irsim.make(file, seed=1).simulation.pose, pose[0])
    env = VectorEnv(corridor(), 120, seed=1)
    _, info = env.reset()
    assert np.array_equal(info["drawn"]["parameters.width"], np.repeat(width, 2))


def test_worlds_with_variants_move_like_their_variants() -> None:
    worlds = Worlds(corridor(), 6, seed=1)
    for i, width in enumerate(worlds.drawn["parameters.width"].tolist()):
        made = corridor(parameters={"width": width})
        del made["randomize"]
        alone = Worlds(made, 1, seed=1 + i)
        worlds.reset(np.arange(6) == i, seeds=[1 + k for k in range(6)])
        for step in range(100):
            actions = np.array([[1.0, 0.3 * np.sin(step)], [1.0, -0.5 * np.cos(step)]])
            alone.step(actions)
            worlds.step(np.tile(actions, (6, 1)))
            rows = slice(i * alone.simulation.objects, (i + 1) * alone.simulation.objects)
            assert np.array_equal(worlds.simulation.pose[rows], alone.simulation.pose)
            assert np.array_equal(worlds.simulation.collided[rows], alone.simulation.collided)


# what is shown --------------------------------------------------------------------------------------------------------
def test_env_tells_what_was_drawn() -> None:
    env = Env(rich(), seed=5)
    _, info = env.reset()
    assert set(info) == {"drawn", "level"}
    assert info["drawn"].keys() == {f"{quantity}.{word}" for quantity, words in EVERYTHING.items() for word in words}
    _, again = Env(rich(), seed=99).reset(seed=5)
    for told in (info, env.step(np.zeros(2, dtype=np.float32))[-1]):
        assert all(np.array_equal(told["drawn"][name], value) for name, value in again["drawn"].items())
    assert Env(lidar_among_boxes()).reset()[1] == {}


def test_draws_are_observed_only_if_asked() -> None:
    plain = Worlds(rich(), 4, seed=1)
    asked = Worlds(rich(randomize={**EVERYTHING, "observed": ["latency", "speed", "number.obstacle[0]"]}), 4, seed=1)
    assert asked.eyes.size == plain.eyes.size + 3
    for _ in range(2):
        seen = asked.observe()
        assert np.array_equal(seen[:, :-3], plain.observe())
        drawn = asked.drawn
        assert seen[:, -3] == pytest.approx(drawn["latency.learners"][:, 0] / 3)
        assert seen[:, -2] == pytest.approx(drawn["speed.learners"][:, 0] - 0.5)
        assert seen[:, -1] == pytest.approx(drawn["number.obstacle[0]"] / 4)
        plain.reset()
        asked.reset()


# perturbed starts -----------------------------------------------------------------------------------------------------
DISTANCE = [{"name": "goal", "features": ["distance", "sin"], "distance_max": 10}]


def test_starts_differ_and_goals_stay() -> None:
    seen = Worlds(task(perturb=STARTS, observation=DISTANCE), 200, seed=1).observe()
    distances = 10 * seen[:, 0]  # the way from (1, 5) to (9, 5)
    assert (distances.min(), distances.max()) == pytest.approx((7.5, 8.5), abs=0.05)
    turned = np.degrees(np.arcsin(seen[:, 1]))
    assert 18 < np.abs(turned).max() < 24


def test_every_episode_draws_again_alone_as_in_a_batch() -> None:
    given = task(perturb=STARTS, observation=DISTANCE, horizon=0.3)
    batch, alone = VectorEnv(given, 3), VectorEnv(given, 1)
    seen, _ = batch.reset(seed=7)
    starts = [seen[2]]
    single, _ = alone.reset(seed=9)
    over = False
    for _ in range(9):
        np.testing.assert_array_equal(single[0], seen[2])
        seen, _, _, cut, _ = batch.step(np.zeros((3, 2)))
        single = alone.step(np.zeros((1, 2)))[0]
        if over:  # this step has begun the next episode
            starts.append(seen[2])
        over = bool(cut[2])
    assert len({tuple(one) for one in starts}) == len(starts) > 1


def test_unknown_objects_are_refused() -> None:
    with pytest.raises(TaskError, match=r"(?s)name, tag or role 'robto'.*did you mean robot"):
        Worlds(task(perturb=[{"position": 0.5, "objects": ["robto"]}]))
