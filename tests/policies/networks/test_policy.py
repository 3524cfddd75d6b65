"""Networks as policies: what they decide, alone and in batches, over time, in all meanings of their output."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.policies import Observations
from irsim.policies.networks import Network, PolicyInputError, mlp, network_policy, save_network
from tests.policies.networks.examples import crowd, filled
from tests.policies.networks.observed import observations, rows, same_bits


def raw(output: dict[str, Any], units: int = 2, **options: Any) -> Network:
    """A network that returns the goal in the own frame: x, y [m] and 1."""
    weights = np.eye(3, units)
    parts = [{"name": "goal", "features": ["x", "y", "present"], "distance_max": 1.0, "clip": False}]
    options = {"drives": ["diff"], **options} if output.get("returns") != "velocity" else options
    return mlp([(weights, np.zeros(units))], parts, output=output, precision="float64", **options)


def ahead(x: float, y: float, **changed: Any) -> Observations:
    """One robot at (1, 2) that looks along y, with a goal at (x, y) in its own frame."""
    one = rows(observations(), [1])
    goal = np.array([[1.0 - y, 2.0 + x, 0.0]])
    return replace(one, pose=np.array([[1.0, 2.0, np.pi / 2]]), goal=goal, **changed)


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_a_decision_is_the_same_alone_and_in_any_batch(opened: Any, precision: str) -> None:
    network = filled({**crowd(), "precision": precision})
    for count in (1, 2, 5, 17):
        whole = [replace(observations(count, seed), first=np.full(count, seed == 0)) for seed in range(3)]
        together, apart = opened(network), [opened(network) for _ in range(count)]
        order = np.random.default_rng(count).permutation(count)
        shuffled = opened(network)
        for seen in whole:
            controls = together.act(seen)
            assert controls.shape == (count, 2)
            assert same_bits(shuffled.act(rows(seen, order)), controls[order])
            for k in range(count):
                assert same_bits(apart[k].act(rows(seen, [k])), controls[k : k + 1])


def test_many_robots_are_computed_in_portions(opened: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    network, seen = filled(crowd()), [observations(50), observations(50, 1)]
    whole = opened(network)
    expected = [whole.act(one) for one in seen]
    monkeypatch.setattr(network_policy, "_NUMBERS_AT_ONCE", 3000)
    portions = opened(network)
    assert 1 < portions._rows < 50
    assert all(same_bits(portions.act(one), result) for one, result in zip(seen, expected, strict=True))


def test_a_perceptron_computes_what_plain_numpy_computes(opened: Any) -> None:
    rng = np.random.default_rng(0)
    w0, b0, w1, b1, w2, b2 = (rng.normal(size=size) for size in ((11, 64), 64, (64, 64), 64, (64, 2), 2))
    parts = [
        {"name": "goal", "features": ["distance", "cos", "sin"]},
        {"name": "neighbors", "count": 2, "features": ["x", "y", "gap", "present"]},
    ]
    policy = opened(mlp([(w0, b0), (w1, b1), (w2, b2)], parts, activation="tanh", drives=["diff"]))
    seen = observations(50)
    away = seen.goal[:, :2] - seen.pose[:, :2]
    distance, bearing = np.hypot(*away.T), np.arctan2(away[:, 1], away[:, 0]) - seen.pose[:, 2]
    observed = [np.minimum(distance, 4) / 4, np.cos(bearing), np.sin(bearing)]
    for k in range(2):
        rel = seen.neighbors.position[:, k] - seen.pose[:, :2]
        c, s = np.cos(seen.pose[:, 2]), np.sin(seen.pose[:, 2])
        gap = np.hypot(*rel.T) - seen.radius - seen.neighbors.radius[:, k]
        own = [rel[:, 0] * c + rel[:, 1] * s, rel[:, 1] * c - rel[:, 0] * s, gap]
        there = seen.neighbors.mask[:, k]
        observed += [np.where(there, np.clip(value / 4, -1, 1), 0) for value in own] + [there.astype(float)]
    x = np.stack(observed, axis=1)[:-1]  # the last robot has no goal
    expected = np.tanh(np.tanh(x @ w0 + b0) @ w1 + b1) @ w2 + b2
    np.testing.assert_allclose(policy.act(seen)[:-1], expected, rtol=1e-4, atol=1e-4)


CROWD = """
world: {width: 8, height: 8}
robot:
  - number: 4
    distribution: {name: random, range_low: [1, 1, -3], range_high: [7, 7, 3]}
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    vel_max: [1, 3]
    vel_min: [-1, -3]
    sensors: [{name: lidar2d, number: 40, range_max: 4}]
obstacle:
  - {shape: {name: rectangle, length: 1, width: 2}, state: [4, 4, 0.3]}
"""


def test_worlds_of_a_batch_are_those_of_single_environments(tmp_path: Path) -> None:
    data = crowd()
    data["layout"]["parts"] += [{"name": "scan", "sectors": 8}, {"name": "map", "cells": 6, "size": 3.0}]
    data["network"][0]["inputs"] += ["scan", "map"]
    save_network(tmp_path / "crowd.npz", filled(data))
    scene, path = tmp_path / "scene.yaml", str(tmp_path / "crowd.npz")
    scene.write_text(CROWD)
    batch = irsim.batch(scene, 3, seeds=[5, 6, 7], policy=path)
    batch.advance(15)
    assert abs(batch.velocity[:, :4, 1]).min() > 0
    for k, seed in enumerate(batch.seeds):
        env = irsim.make(scene, headless=True, seed=seed, policy=path)
        for _ in range(15):
            env.step()
        assert env.simulation.pose.tobytes() == batch.pose[k].tobytes()
        env.end()


def test_memory_belongs_to_a_robot_and_ends_with_its_episode(opened: Any) -> None:
    network = filled(crowd())
    policy, other = opened(network), opened(network)
    seen = observations(6)
    first = replace(seen, first=np.ones(6, dtype=bool))
    fresh = policy.act(first)
    later = policy.act(seen)
    assert not np.array_equal(fresh, later)
    assert same_bits(policy.act(first), fresh)
    half = np.arange(6) < 3
    policy.act(replace(seen, first=half))
    mixed = policy.act(seen)
    assert same_bits(mixed[:3], later[:3])
    other.act(rows(first, [0]))
    assert same_bits(other.act(rows(seen, [0, 4])), np.stack([later[0], fresh[4]])), "a robot that comes later is new"


def test_numbers_become_controls_between_limits(opened: Any) -> None:
    output = {"squash": "clip", "low": [0, -3], "high": [1, 3]}
    np.testing.assert_allclose(opened(raw(output)).act(ahead(0.5, -2)), [[0.75, -3]])
    soft = opened(raw({**output, "squash": "tanh"})).act(ahead(0.5, -2))
    np.testing.assert_allclose(soft, [[(np.tanh(0.5) + 1) / 2, -3 * np.tanh(2)]])
    limits = {"low": np.array([[-0.2, -1.0, 0.0]]), "high": np.array([[0.8, 1.0, 0.0]])}
    bounded = opened(raw({"squash": "clip", "limits": True}))
    np.testing.assert_allclose(bounded.act(ahead(0.5, -2, **limits)), [[0.55, -1]])
    with pytest.raises(PolicyInputError, match="a robot has infinite limits"):
        bounded.act(ahead(0.5, -2, high=np.full((1, 3), np.inf)))
    np.testing.assert_allclose(opened(raw({})).act(ahead(0.5, -2)), [[0.5, -2]])


def test_increments_are_added_to_the_last_control_or_the_velocity(opened: Any) -> None:
    executed = np.array([[0.3, 0.1, 0.0]])
    more = opened(raw({"increment": True})).act(ahead(0.5, -2, control=executed))
    np.testing.assert_allclose(more, [[0.8, -1.9]])
    output = {"returns": "velocity", "frame": "own", "increment": True}
    faster = opened(raw(output)).act(ahead(0.5, 0.25, velocity=np.array([[1.0, 1.0]])))
    np.testing.assert_allclose(faster, [[0.75, 1.5]])


@pytest.mark.parametrize(
    ("frame", "expected"), [("world", [0.5, 0.25]), ("own", [-0.25, 0.5]), ("goal", [-0.4472136, 0.3354102])]
)
def test_velocities_are_returned_in_the_world_frame(opened: Any, frame: str, expected: list[float]) -> None:
    policy = opened(raw({"returns": "velocity", "frame": frame}))
    assert (policy.output, policy.drives) == ("velocity", None)
    np.testing.assert_allclose(policy.act(ahead(0.5, 0.25)), [expected], atol=1e-7)


def test_the_best_choice_is_taken_and_the_first_of_equal_ones(opened: Any) -> None:
    policy = opened(raw({"choices": [[0, 0], [1, 0], [0, 1]]}, units=3))
    assert policy.act(ahead(2, 0)).tolist() == [[0, 0]]
    assert policy.act(ahead(0, 2)).tolist() == [[1, 0]]
    assert policy.act(ahead(0, 0)).tolist() == [[0, 1]]
    assert policy.act(ahead(0.5, 3)).tolist() == [[1, 0]]
    without = replace(ahead(0, 0), goal=np.full((1, 3), np.nan))
    assert policy.act(without).tolist() == [[0, 0]]


def test_no_robots_and_no_goal(opened: Any) -> None:
    policy = opened(filled(crowd()))
    assert policy.act(rows(observations(), np.zeros(0, dtype=int))).shape == (0, 2)
    assert np.isfinite(policy.act(replace(observations(5), goal=np.full((5, 3), np.nan)))).all()
