"""One world alone, in a batch, in a rollout, on any number of threads: the same numbers, bit for bit."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import irsim
from tests.effort import examples

Make = Callable[..., irsim.Env]
DRIVES = {
    "diff": ("[1.0, 1.5]", "circle, radius: 0.2"),
    "omni": ("[1.0, 1.0]", "rectangle, length: 0.4, width: 0.3"),
    "omni_angular": ("[1.0, 1.0, 1.0]", "circle, radius: 0.25"),
    "acker": ("[1.0, 0.6]", "rectangle, length: 0.6, width: 0.3, wheelbase: 0.4"),
}


@st.composite
def scenarios(draw: st.DrawFn) -> str:
    """Small random worlds: every drive, noise, lidars, wandering, random shapes and placements, zones, views."""
    mode = draw(st.sampled_from(["stop", "unobstructed", "unobstructed_obstacles"]))
    zones = (
        "[{name: line, line: [[6, 0], [6, 12]]}, {name: left, rectangle: [0, 0, 6, 12]}, "
        "{name: disc, circle: {center: [6, 6], radius: 3}}]"
    )
    lines = [f"world: {{height: 12, width: 12, collision_mode: {mode}, zones: {zones}}}", "robot:"]
    for drive in draw(st.lists(st.sampled_from(sorted(DRIVES)), min_size=1, max_size=3)):
        top, shape = DRIVES[drive]
        low = "[" + ", ".join("-" + v.strip() for v in top.strip("[]").split(",")) + "]"
        behavior = draw(
            st.sampled_from(
                [
                    "{name: dash}",
                    "{name: dash, loop: true}",
                    "{name: dash, wander: true, range_low: [1, 1, -3], range_high: [11, 11, 3]}",
                ]
            )
        )
        noise = draw(st.booleans())
        lines += [
            f"  - number: {draw(st.integers(1, 3))}",
            "    distribution: {name: random, range_low: [1, 1, -3], range_high: [11, 11, 3], min_distance: 0.5}",
            f"    kinematics: {{name: {drive}, noise: {str(noise).lower()}}}",
            f"    shape: {{name: {shape}}}",
            f"    vel_max: {top}",
            f"    vel_min: {low}",
            f"    behavior: {behavior}",
        ]
        if draw(st.booleans()):
            lines.append(f"    fov: 2\n    fov_radius: 4\n    fov_occlusion: {str(draw(st.booleans())).lower()}")
        if draw(st.booleans()):
            lines.append(f"    acce: [{', '.join(['2.0'] * len(top.split(',')))}]")
        if draw(st.booleans()):
            lines.append(
                "    sensors: [{name: lidar2d, number: 11, range_max: 5, angle_range: 3, noise: true, angle_std: 0.01}]"
            )
    lines += [
        "obstacle:",
        f"  - number: {draw(st.integers(0, 3))}",
        "    distribution: {name: random, range_low: [2, 2, -3], range_high: [10, 10, 3], min_distance: 0.5}",
        "    shape: [{name: polygon, random_shape: true, avg_radius_range: [0.2, 0.5]}]",
    ]
    return "\n".join(lines) + "\n"


@settings(max_examples=examples(25), suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(text=scenarios(), seed=st.integers(0, 2**64 - 4), threads=st.integers(2, 5))
def test_alone_in_batch_and_rolled_out_agree(tmp_path: Path, text: str, seed: int, threads: int) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(text)
    steps, seeds = 15, [seed, seed + 1, seed + 2]
    one = irsim.batch(str(path), 3, seeds=seeds, threads=1)
    many = irsim.batch(str(path), 3, seeds=seeds, threads=threads)
    envs = [irsim.make(str(path), seed=s, headless=True, log_level="CRITICAL") for s in seeds]
    rolled = irsim.make(str(path), seed=seed, headless=True, log_level="CRITICAL")
    for episode in range(3):
        trace = rolled.rollout(steps, until_done=False)
        for step in range(steps):
            one.step()
            many.step()
            for world, env in enumerate(envs):
                env.step()
                for name in ("pose", "extra", "arrived", "collided", "twist", "goal"):
                    alone = getattr(env.simulation, name)
                    batched = getattr(one, name)[world]
                    assert np.array_equal(alone, batched, equal_nan=True), (episode, step, world, name)
                assert np.array_equal(env.simulation.control, one.velocity[world])
                assert np.array_equal(env.simulation.ranges, one.ranges[world])
                assert env.events == one.events(world) == many.events(world)
            assert np.array_equal(trace.pose[step], envs[0].simulation.pose)
            assert [event for event in rolled.events if event.step <= step + 1] == envs[0].events
            for name in ("pose", "velocity", "ranges", "arrived", "collided"):
                assert np.array_equal(getattr(one, name), getattr(many, name))
        one.reset(np.ones(3, dtype=bool))
        many.reset(np.ones(3, dtype=bool))
        for env in [*envs, rolled]:
            env.reset(random=True)


def test_masked_reset_touches_only_its_worlds(make: Make, tmp_path: Path) -> None:
    text = "robot: [{number: 2, kinematics: {name: diff}, distribution: {name: random}, behavior: {name: dash}}]"
    env = make(text, seed=2)
    batch = irsim.batch(tmp_path / "scenario.yaml", 3, seeds=[1, 2, 3], threads=2)
    start = batch.pose.copy()
    for _ in range(5):
        batch.step()
    moved = batch.pose.copy()
    batch.reset([False, True, False])
    assert np.array_equal(batch.pose[[0, 2]], moved[[0, 2]])
    assert batch.count.tolist() == [5, 0, 5]
    assert not np.array_equal(batch.pose[1], start[1]), "the next scene is drawn"
    env.reset(random=True)
    assert np.array_equal(env.simulation.pose, batch.pose[1])


def test_the_seed_rules(make: Make) -> None:
    text = "world: {seed: 4}\n"
    text += "robot: {kinematics: {name: diff, noise: true}, distribution: {name: random}, behavior: {name: dash}}\n"

    def walk(env: irsim.Env) -> list[list[float]]:
        return [env.step() or env.simulation.pose[0].tolist() for _ in range(5)]

    assert [make(text, seed=seed).seed for seed in (None, 9)] == [4, 9]
    env = make(text, seed=None)
    start, first = env.simulation.pose.copy(), walk(env)
    env.reset()
    assert np.array_equal(env.simulation.pose, start), "reset keeps the scene"
    assert walk(env) != first, "but not the noise"
    env.reset(random=True)
    second = env.simulation.pose.copy()
    assert not np.array_equal(second, start)
    other = make(text, seed=None)
    other.reset(random=True)
    assert np.array_equal(other.simulation.pose, second), "the next scene is the same whatever happened before"
    env.set_random_seed(4)
    env.reset()
    assert np.array_equal(env.simulation.pose, start)
    assert walk(env) == first
    with pytest.raises(ValueError, match="64"):
        make(text, seed=-1)


def test_user_generator_follows_the_episode(make: Make) -> None:
    a, b = (make("robot: {kinematics: {name: diff}}\n", seed=3) for _ in range(2))
    first = a.rng.random(3).tolist()
    assert b.rng.random(3).tolist() == first
    a.reset()
    assert a.rng.random(3).tolist() != first
