"""Detectors and their tracks, and behaviors that decide from estimates and tracks instead of the truth."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from tests.core.test_gauges import place
from tests.core.worlds import DASH, DRIVES, circle, command, kernel, polygon, robot, scene

DETECTOR: dict[str, Any] = {
    "offset": [0, 0, 0], "range_max": 10.0, "angle_range": 2 * math.pi, "targets": "all", "probability": 1.0,
    "half_range": 0.0, "range_softness": 0.5, "occlusion": False, "min_visible": 0.3, "position_std": 0.0,
    "velocity_std": 0.0, "false_tracks": 0.0, "false_radius": 0.3, "id_switches": 0.0, "keep": 0.0, "max_tracks": 8,
}  # fmt: skip
OMNI = DRIVES["omni"]
ORCA = kernel("orca")


def detector(**overrides: Any) -> core.DetectorOptions:
    return core.DetectorOptions(**{**DETECTOR, **overrides})


def mover(x: float, y: float, **overrides: Any) -> core.ObjectSpec:
    base = {"drive": OMNI, "pose": [x, y, 0.0], "behavior": None, "parts": [circle(0.3)], "role": 1}
    return robot(**{**base, **overrides})


def tracks(state: core.State, slots: int = 8) -> np.ndarray:
    """The (K, 7) tracks that a detector reports."""
    rows = state.readings[: 7 * slots].reshape(slots, 7)
    return rows[~np.isnan(rows[:, 0])]


def watcher(*others: core.ObjectSpec, seeds: Any = (0,), dt: float = 0.1, **options: Any) -> Any:
    sensor = detector(**options)
    first = robot(sensors=[sensor], behavior=None, pose=[2.0, 3.0, 0.5], drive=OMNI)
    return scene(first, *others, seeds=seeds, mode=1, step_time=dt)


def test_an_ideal_detector_reports_places_and_velocities_in_the_frame_of_the_robot() -> None:
    world, state = watcher(mover(5.0, 4.0), mover(2.0, 8.0))
    command(state, (0, 0), (0.6, 0.2), (0, -1.0))
    core.advance(world, state, 1)
    seen = tracks(state)
    assert seen[:, 6].tolist() == [1, 2]
    turn = np.array([[math.cos(0.5), math.sin(0.5)], [-math.sin(0.5), math.cos(0.5)]])
    for row, velocity in zip(seen, ((0.6, 0.2), (0.0, -1.0)), strict=True):
        there = state.pose[int(row[6]), :2] - state.pose[0, :2]
        assert row[1:3] == pytest.approx(turn @ there, abs=1e-12)
        assert row[3:5] == pytest.approx(turn @ velocity, abs=1e-12)
        assert row[5] == pytest.approx(0.3)


def test_reach_angle_and_roles_limit_what_is_looked_for() -> None:
    others = mover(5.0, 4.6, role=0), mover(-1.0, 1.8), mover(14.0, 3.0)
    for options, expected in (
        ({}, [1, 2]),
        ({"range_max": 20.0}, [1, 2, 3]),
        ({"angle_range": math.pi}, [1]),
        ({"targets": "robot"}, [1]),
        ({"targets": "obstacle"}, [2]),
        ({"max_tracks": 1}, [2]),
    ):
        _, state = watcher(*others, **options)
        assert tracks(state, options.get("max_tracks", 8))[:, 6].tolist() == expected, options


@pytest.mark.parametrize(("hidden", "seen"), [(0.0, 1), (0.29, 0), (0.05, 1), (0.5, 0)])
def test_walls_hide_what_stands_behind_them(hidden: float, seen: int) -> None:
    wall = robot(static=True, parts=[polygon([0, -3], [0.1, -3], [0.1, hidden - 0.1], [0, hidden - 0.1])],
                 pose=[4.0, 3.0, 0.0], role=1, behavior=None, drive=None)  # fmt: skip
    first = robot(sensors=[detector(occlusion=True)], behavior=None, pose=[2.0, 3.0, 0.0], drive=OMNI)
    _, state = scene(first, mover(6.0, 3.0), wall, mode=1)
    assert len(tracks(state)) == seen


def test_detections_are_as_frequent_as_they_should_be() -> None:
    steps = 8000
    for options, expected in (
        ({"probability": 0.7}, 0.7),
        ({"probability": 0.9, "half_range": math.hypot(3, 1)}, 0.45),
        ({"probability": 0.9, "half_range": 2.0, "range_softness": 1.0}, 0.9 / (1 + math.exp(math.hypot(3, 1) - 2.0))),
    ):
        world, state = watcher(mover(5.0, 4.0), **options)
        hits = 0
        for _ in range(steps):
            core.advance(world, state, 1)
            hits += len(tracks(state))
        assert abs(hits - steps * expected) < 4 * math.sqrt(steps * expected * (1 - expected)), options


def test_noise_has_the_standard_deviations_that_are_asked_for() -> None:
    world, state = watcher(mover(5.0, 4.0), position_std=0.1, velocity_std=0.3)
    errors = []
    for _ in range(4000):
        core.advance(world, state, 1)
        there = state.pose[1, :2] - state.pose[0, :2]
        row = tracks(state)[0]
        turn = np.array([[math.cos(0.5), -math.sin(0.5)], [math.sin(0.5), math.cos(0.5)]])
        errors.append([*(turn @ row[1:3] - there), *(turn @ row[3:5])])
    values = np.array(errors) / [0.1, 0.1, 0.3, 0.3]
    assert np.abs(values.mean(axis=0)).max() < 4 / math.sqrt(len(values))
    assert values.std(axis=0) == pytest.approx(1.0, abs=0.05)


def test_a_lost_track_goes_on_for_a_while_and_keeps_its_id() -> None:
    world, state = watcher(mover(5.0, 4.0), keep=0.5, range_max=4.0)
    rows = []
    for step in range(30):
        command(state, (0, 0), (1.0, 0.0))
        core.advance(world, state, 1)
        rows.append((step, tracks(state)))
    alive = [step for step, seen in rows if len(seen)]
    inside = [step for step in range(30) if math.hypot(3 + 0.1 * (step + 1), 1.0) - 0.3 <= 4.0]
    assert alive == list(range(inside[-1] + 1 + 5))
    assert {row[0] for _, seen in rows for row in seen} == {0.0}
    last = rows[alive[-1]][1][0]  # it has moved on at its last velocity
    assert math.hypot(*last[1:3]) == pytest.approx(math.hypot(3 + 0.1 * (alive[-1] + 1), 1.0), abs=1e-9)


def test_false_tracks_begin_at_random_places_in_view() -> None:
    world, state = watcher(false_tracks=0.5, angle_range=math.pi / 2, range_max=5.0)
    places = []
    for _ in range(20000):
        core.advance(world, state, 1)
        places += tracks(state).tolist()
    rows = np.array(places)
    expected = 20000 * (1 - math.exp(-0.05))
    assert abs(len(rows) - expected) < 4 * math.sqrt(expected)
    distance, bearing = np.hypot(rows[:, 1], rows[:, 2]), np.arctan2(rows[:, 2], rows[:, 1])
    assert distance.max() <= 5.0
    assert np.abs(bearing).max() <= math.pi / 4 + 1e-9
    assert np.mean(distance**2) == pytest.approx(12.5, rel=0.05)  # evenly over the area
    assert set(rows[:, 6]) == {-1.0}
    assert len(set(rows[:, 0])) == len(rows)


def test_near_tracks_take_each_others_ids() -> None:
    world, state = watcher(mover(5.0, 4.0), mover(5.0, 5.0), mover(-4.0, 3.0), id_switches=0.5, keep=1.0)
    before, switches = None, 0
    for _ in range(2000):
        core.advance(world, state, 1)
        now = {int(row[6]): row[0] for row in tracks(state)}
        assert sorted(now.values()) == [0.0, 1.0, 2.0]
        assert now[3] == 2.0  # far from the two others
        switches += before is not None and before != now
        before = now
    expected = 2000 * (1 - math.exp(-0.05))
    assert abs(switches - expected) < 4 * math.sqrt(expected)


def two_that_meet(**watching: Any) -> tuple[core.World, core.State]:
    sensors = watching.pop("sensors", [])
    ego = robot(drive=OMNI, pose=[0.0, 0.0, 0.0], goals=[[8.0, 0.0]], behavior=ORCA, sensors=sensors, **watching)
    other = mover(8.0, 0.05, goals=[[0.0, 0.05]], behavior=DASH, parts=[circle(0.3)])
    return scene(ego, other, mode=1)


def touched(world: core.World, state: core.State, steps: int = 120) -> bool:
    hit = False
    for _ in range(steps):
        core.advance(world, state, 1)
        hit = hit or bool(state.collided[0])
    return hit


def test_a_behavior_avoids_what_its_detector_sees_and_nothing_else() -> None:
    assert not touched(*two_that_meet())
    assert not touched(*two_that_meet(sensors=[detector()], perceives_tracks=True))
    assert touched(*two_that_meet(sensors=[detector(probability=0.0)], perceives_tracks=True))
    assert not touched(*two_that_meet(sensors=[detector(probability=0.0)]))


def test_true_tracks_and_a_true_estimate_change_next_to_nothing() -> None:
    plain = two_that_meet()
    world, state = two_that_meet(sensors=[detector(), place()], perceives_tracks=True, perceives_estimate=True)
    for _ in range(60):
        core.advance(*plain, 1)
        core.advance(world, state, 1)
        assert state.pose == pytest.approx(plain[1].pose, abs=1e-6)


def test_a_false_track_is_avoided() -> None:
    sensor = detector(false_tracks=3.0, keep=3.0, probability=0.0, angle_range=0.2, range_max=4.0)
    ego = robot(drive=OMNI, pose=[0.0, 0.0, 0.0], goals=[[8.0, 0.0]], behavior=ORCA, sensors=[sensor],
                perceives_tracks=True)  # fmt: skip
    world, state = scene(ego, mover(0.0, 50.0), mode=1)
    aside = 0.0
    for _ in range(60):
        core.advance(world, state, 1)
        aside = max(aside, abs(float(state.pose[0, 1])))
    assert aside > 0.05
    assert state.pose[1] == pytest.approx([0.0, 50.0, 0.0])  # the row that it borrowed is as it was
    assert state.appeared[1] == 0


@pytest.mark.parametrize("kind", sorted(DRIVES))
def test_a_robot_rests_where_it_believes_its_goal_to_be(kind: str) -> None:
    sensor = place(position_std=0.3, time=1e12)  # an error that stays
    near = 1.6 if kind == "angular" else 0.2  # this car has a turning circle of 0.95 m
    spec = robot(drive=DRIVES[kind], pose=[1.0, 1.0, 0.0], goals=[[6.0, 3.0]], goal_threshold=near, sensors=[sensor],
                 perceives_estimate=True, behavior=DASH, vel_max=[1.0, 0.4, 1.0],
                 vel_min=[-1.0, -0.4, -1.0])  # fmt: skip
    for seed in range(6):
        world, state = scene(spec, seeds=(seed,), mode=1)
        error = state.readings[:2] - state.pose[0, :2]
        steps = 0
        while not state.believes_arrived[0] and steps < 400:
            core.advance(world, state, 1)
            steps += 1
        assert state.believes_arrived[0], (kind, seed)
        believed = state.pose[0, :2] + error
        assert np.linalg.norm(believed - [6.0, 3.0]) < near
        kinds = [event[0] for event in state.events(0, 0)]
        assert "believed_arrival" in kinds
        truly = np.linalg.norm(state.pose[0, :2] - [6.0, 3.0]) < near
        assert bool(state.arrived[0]) == truly
        assert state.done(0)


def test_beliefs_do_not_depend_on_threads_or_on_other_worlds() -> None:
    def spec() -> Any:
        sensors = [place(position_std=0.1), detector(probability=0.6, position_std=0.1, false_tracks=1.0, keep=0.4)]
        ring = []
        for k in range(6):
            angle = 2 * math.pi * k / 6
            x, y = 4 * math.cos(angle), 4 * math.sin(angle)
            ring.append(robot(drive=OMNI, pose=[x, y, 0.0], goals=[[-x, -y]], behavior=ORCA, sensors=sensors,
                              perceives_tracks=True, perceives_estimate=True, parts=[circle(0.2)]))  # fmt: skip
        return ring

    seeds = tuple(range(8))
    world, state = scene(*spec(), seeds=seeds, mode=1)
    core.advance(world, state, 80, threads=2)
    for seed in seeds:
        alone, one = scene(*spec(), seeds=(seed,), mode=1)
        core.advance(alone, one, 80, threads=1)
        assert np.array_equal(state.pose[6 * seed : 6 * seed + 6], one.pose)


def test_python_sees_a_belief_only_in_its_context() -> None:
    sensor = detector(position_std=0.2)
    ego = robot(drive=OMNI, pose=[0.0, 0.0, 0.0], sensors=[sensor, place(position_std=0.5)], perceives_tracks=True,
                perceives_estimate=True, behavior=None)  # fmt: skip
    world, state = scene(ego, mover(3.0, 1.0), mover(30.0, 1.0), mode=1)
    truth = state.pose.copy()
    with core.Belief(world, state, 0):
        assert np.linalg.norm(state.pose[0, :2] - truth[0, :2]) > 0.05
        assert np.linalg.norm(state.pose[1, :2] - state.pose[0, :2]) == pytest.approx(math.hypot(3, 1), abs=0.7)
        assert np.isnan(state.pose[2, :2]).all()
        assert state.appeared[2] < 0
    assert np.array_equal(state.pose, truth)
    with pytest.raises(KeyError), core.Belief(world, state, 0):
        raise KeyError
    assert np.array_equal(state.pose, truth)


def test_an_object_needs_the_sensor_that_it_decides_from() -> None:
    for key in ("perceives_estimate", "perceives_tracks"):
        with pytest.raises(ValueError, match="without"):
            scene(robot(**{key: True}), mode=1)
