"""Metrics of paths that can be worked out by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

import irsim
from irsim.metrics import EPISODE_METRICS, METRICS, episode_metrics, robot_metrics
from irsim.scenario.open import read_scenario
from irsim.simulation.events import Event
from irsim.simulation.trace import Trace

ROBOT = (
    "  - {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.2}}, state: {state}, goal: {goal}, "
    "vel_max: {top}}}\n"
)
NAN = math.nan


def scenario(
    *robots: tuple[list[float], list[float]], rest: str = "", world: str = "width: 20, height: 20", drive="omni"
):
    top = [1, 0, 1] if drive == "omni_angular" else [1, 0]
    entries = [ROBOT.format(drive=drive, state=state, goal=goal, top=top) for state, goal in robots]
    text = f"world: {{{world}}}\nrobot:\n" + "".join(entries) + rest
    return read_scenario(text=text, strict=True)[0]


def trace(
    resolved,
    pose,
    goal,
    *,
    collided: Sequence[tuple[int, int]] = (),
    stopped: Sequence[tuple[int, int]] = (),
    dt: float = 0.1,
) -> Trace:
    """pose (T, N, 2 or 3), goal (N, 2) of the first objects; rows and objects that touched, that were stopped."""
    pose = np.asarray(pose, dtype=float)
    rows, count = pose.shape[:2]
    if pose.shape[2] == 2:
        pose = np.concatenate([pose, np.zeros((rows, count, 1))], axis=2)
    goals = np.full((rows, count, 3), NAN)
    goals[:, : len(goal), :2] = goal
    flags = np.zeros((rows, count), dtype=bool)
    hits, stops = flags.copy(), flags.copy()
    for table, where in ((hits, collided), (stops, stopped)):
        for row, robot in where:
            table[row, robot] = True
    step = np.arange(rows)
    names = tuple(record.name for record in resolved.objects)
    return Trace(step, step * dt, pose, np.zeros_like(pose), goals, flags, hits, stops, {}, names, dt)


def event(kind: str, step: int, name: str, partner: str | None = None) -> Event:
    return Event(kind, step * 0.1, step, name, partner, 0.0, 0.0)  # type: ignore[arg-type]


def measured(resolved, pose, goal, events: Sequence[Event] = (), **flags) -> list[dict[str, float]]:
    """The metrics of each robot on paths; flags as of `trace`."""
    return robot_metrics(trace(resolved, pose, goal, **flags), resolved, events)


def assert_metrics(metrics, **expected: float) -> None:
    assert {key: metrics[key] for key in expected} == pytest.approx(expected, nan_ok=True)


def arrival(resolved, step: int) -> Event:
    """The first robot arrives."""
    return event("arrival", step, resolved.objects[0].name)


def straight(steps: int, speed: float = 1.0, start: float = 1.0) -> np.ndarray:
    """(T, 2) along x at y = 5."""
    x = start + 0.1 * speed * np.arange(steps + 1)
    return np.stack([x, np.full_like(x, 5.0)], axis=1)


def test_a_straight_drive_to_the_goal() -> None:
    resolved = scenario(([1, 5], [5, 5]))
    metrics = measured(resolved, straight(40)[:, None], [[5, 5]], [arrival(resolved, 40)])[0]
    expected = {
        "success": 1,
        "goal_reached": 1,
        "collision_count": 0,
        "timeout": 0,
        "time_to_goal": 4.0,
        "path_length": 4.0,
        "spl": 1.0,
        "velocity_min": 1.0,
        "velocity_avg": 1.0,
        "velocity_max": 1.0,
        "acceleration_max": 0.0,
        "jerk_max": 0.0,
        "stalled_time": 0.0,
        "failure_to_progress": 0,
        "path_efficiency": 1.0,
        "path_irregularity": 0.0,
        "curvature": 0.0,
        "motion_energy": 4.0,
        "stl": 1.0,
        "barn_score": 0.5,
        "final_distance_to_goal": 0.0,
        "distance_to_human_min": NAN,
        "space_compliance": NAN,
        "clearing_distance_min": NAN,
        "time_to_collision_min": NAN,
    }
    assert {key: metrics[key] for key in expected} == pytest.approx(expected, nan_ok=True, abs=1e-9)


def test_every_key_and_no_other() -> None:
    resolved = scenario(([1, 5], [5, 5]))
    metrics = episode_metrics(trace(resolved, straight(3)[:, None], [[5, 5]]), resolved, [])
    assert list(metrics.robots[0]) == [metric.key for metric in METRICS]
    assert list(metrics.episode) == [*metrics.robots[0], *(metric.key for metric in EPISODE_METRICS)]
    assert len({metric.key for metric in METRICS}) == len(METRICS)


def test_after_the_arrival_nothing_counts() -> None:
    resolved = scenario(([1, 5], [5, 5]), ([1, 9], [9, 9]))
    one, other = (record.name for record in resolved.objects)
    path = np.stack([straight(60), straight(60) + np.array([0, 4])], axis=1)
    path[41:, 0] = path[40, 0] + np.array([0, 3])  # pushed away
    events = [event("arrival", 40, one), event("collision", 50, one, other)]
    robots = robot_metrics(trace(resolved, path, [[5, 5], [9, 9]], stopped=[(60, 1)]), resolved, events)
    assert_metrics(robots[0], success=1, collision_count=0, path_length=4.0)
    assert robots[1]["agent_collisions"] == robots[1]["collision_count"] == 1
    assert (robots[1]["success"], robots[1]["goal_reached"], robots[1]["timeout"]) == (0, 0, 0)


def test_contacts_by_partner_and_steps_in_contact() -> None:
    rest = "obstacle:\n  - {shape: {name: circle, radius: 0.2}, state: [9, 9]}\n"
    rest += "  - {shape: {name: circle, radius: 0.2}, kinematics: {name: omni}, state: [2, 9]}\n"
    rest += "  - {shape: {name: circle, radius: 0.2}, state: [3, 9], unobstructed: true}\n"
    resolved = scenario(([1, 5], [9, 5]), rest=rest)
    robot, wall, human, ghost = (record.name for record in resolved.objects)
    pose = np.concatenate([straight(30)[:, None], np.tile([[9.0, 9], [2, 9], [3, 9]], (31, 1, 1))], axis=1)
    events = [
        event("collision", 3, wall, robot),
        event("collision", 9, robot, human),
        event("collision", 12, robot, wall),
        event("collision", 14, robot, ghost),
    ]
    hits = [(3, 0), (4, 0), (9, 0), (12, 0)]
    metrics = measured(resolved, pose, [[9, 5]], events, collided=hits)[0]
    keys = ("collision_count", "collision_steps", "wall_collisions", "agent_collisions", "human_collisions")
    assert [metrics[key] for key in keys] == [3, 4, 2, 0, 1]
    assert (metrics["success"], metrics["timeout"], metrics["spl"]) == (0, 1, 0)  # it drove on
    assert measured(resolved, pose, [[9, 5]], events, collided=hits, stopped=[(30, 0)])[0]["timeout"] == 0


def test_speeds_accelerations_and_jerks() -> None:
    resolved = scenario(([1, 5], [15, 5]))
    time = 0.1 * np.arange(31)
    x = 1 + 0.5 * 0.4 * time**2  # constant acceleration
    metrics = measured(resolved, np.stack([x, 0 * x + 5], 1)[:, None], [[15, 5]])[0]
    assert_metrics(metrics, acceleration_min=0.4, acceleration_max=0.4)
    assert metrics["jerk_max"] == pytest.approx(0.0, abs=1e-9)
    assert_metrics(metrics, velocity_max=0.4 * 2.95, velocity_avg=0.5 * 0.4 * 3.0, timeout=1)
    assert math.isnan(metrics["time_to_goal"])
    cubic = 1 + time**3 / 6  # constant jerk
    metrics = measured(resolved, np.stack([cubic, 0 * x + 5], 1)[:, None], [[15, 5]])[0]
    assert metrics["jerk_avg"] == pytest.approx(1.0)
    for rows, unknown in ((1, "velocity_avg"), (2, "acceleration_avg"), (3, "jerk_avg")):
        short = measured(resolved, straight(rows - 1)[:, None], [[15, 5]])[0]
        assert math.isnan(short[unknown])


def test_stalls_freezing_and_no_progress() -> None:
    resolved = scenario(([1, 5], [15, 5]))
    part = straight(50)
    path = np.concatenate([part, np.repeat(part[-1:], 120, 0), part[-1:] + straight(30)[1:] - straight(0)])
    path = np.concatenate([path, np.repeat(path[-1:], 10, 0)])
    metrics = measured(resolved, path[:, None], [[15, 5]])[0]
    assert_metrics(metrics, stalled_time=13.0, freezing_count=1, freezing_time=12.0)
    assert metrics["failure_to_progress"] == 2  # of the windows from 0, 5, 10, 15 s those from 5 and 10
    turning = np.zeros((21, 1, 3))
    turning[:, 0] = 1, 5, 0
    turning[:, 0, 2] = 0.1 * np.arange(21)
    metrics = measured(resolved, turning, [[15, 5]])[0]
    assert metrics["stalled_time"] == 0
    assert metrics["cumulative_heading_change"] == 0  # an omni that turns where it stands goes no other way
    resolved = scenario(([1, 5], [15, 5]), drive="diff")
    metrics = measured(resolved, turning, [[15, 5]])[0]
    assert metrics["cumulative_heading_change"] == pytest.approx(2.0)


ARC = 0.05 * np.arange(31)  # of a circle of radius 2, 1.5 rad of it in 3 s


def on_an_arc(drive: str, heading: np.ndarray) -> dict[str, float]:
    """Metrics of a drive from (2, 0) round (0, 0), shifted to (5, 5), with a goal at its end."""
    path = 5 + 2 * np.stack([np.cos(ARC), np.sin(ARC)], axis=1)
    resolved = scenario(([*path[0].tolist(), float(heading[0])], path[-1].tolist()), drive=drive)
    return measured(resolved, np.column_stack([path, heading])[:, None], [path[-1]], [arrival(resolved, 30)])[0]


@pytest.mark.parametrize("drive", ["omni", "omni_angular"])
@pytest.mark.parametrize("looking", [0.0, 0.3])
def test_who_need_not_turn_to_move_turns_where_its_path_does(drive: str, looking: float) -> None:
    metrics = on_an_arc(drive, looking * np.arange(31))
    length = 30 * 4 * math.sin(0.025)
    assert metrics["path_length"] == pytest.approx(length)
    assert metrics["cumulative_heading_change"] == pytest.approx(29 * 0.05)  # from chord to chord
    assert_metrics(metrics, angle_over_length=29 * 0.05 / length, curvature=0.5)
    assert metrics["path_irregularity"] == pytest.approx(29 * 0.05)  # the shortest way is straight


def test_who_must_turn_to_move_is_measured_by_its_heading() -> None:
    metrics = on_an_arc("diff", ARC + math.pi / 2)
    assert metrics["cumulative_heading_change"] == pytest.approx(1.5)
    # the chord leads 0.75 rad to the left of the first heading
    assert metrics["path_irregularity"] == pytest.approx(1.5 - 0.75)


@pytest.mark.parametrize("heading", [0.0, 1.0, math.pi])
def test_a_straight_drive_sideways_or_backwards_is_not_irregular(heading: float) -> None:
    resolved = scenario(([9, 5, heading], [1, 5]))
    metrics = measured(
        resolved, np.insert(straight(80)[::-1, None], 2, heading, axis=2), [[1, 5]], [arrival(resolved, 80)]
    )[0]
    assert (metrics["path_irregularity"], metrics["cumulative_heading_change"]) == (0, 0)


@pytest.mark.parametrize("drive", ["omni", "omni_angular", "diff"])
@pytest.mark.parametrize("goal", [[1, 5], [15, 5], [12, 9]])
def test_a_straight_run_at_full_speed_is_perfect(drive: str, goal: list[float]) -> None:
    heading = math.atan2(goal[1] - 5, goal[0] - 9) if drive == "diff" else 0.0
    robot = f"{{kinematics: {{name: {drive}}}, state: [9, 5, {heading}], goal: {goal}, behavior: {{name: dash}}}}"
    result = irsim.benchmark(f"world: {{width: 20, height: 20}}\nrobot: {robot}\n", "as-written", 1, workers=1)
    metrics = result.rows[0].metrics
    expected = {"stl": 1.0, "spl": 1.0, "path_irregularity": 0.0, "velocity_max": 1.0}
    assert {key: metrics[key].mean for key in expected} == pytest.approx(expected, abs=1e-6)


def test_a_detour_costs_what_it_is_longer() -> None:
    resolved = scenario(([1, 5], [4, 9]))
    corner = np.concatenate([straight(30), [[4.0, 5 + 0.1 * k] for k in range(1, 41)]])
    metrics = measured(resolved, corner[:, None], [[4, 9]], [arrival(resolved, 70)])[0]
    assert_metrics(metrics, path_length=7.0, spl=5 / 7, path_efficiency=7 / 5, stl=5 / 7, barn_score=2.5 / 7)


@pytest.mark.parametrize(
    ("seconds", "score"),
    [(4.0, 0.5), (2.0, 0.5), (8.0, 0.25), (16.0, 0.125), (30.0, 0.125)],  # T* = 4 m / (2 m/s) = 2 s
)
def test_the_score_of_barn_is_the_time_at_2_metres_a_second_over_one_between_2_and_8_times_it(
    seconds: float, score: float
) -> None:
    resolved = scenario(([1, 5], [5, 5]))
    steps = round(seconds / 0.1)
    path = straight(steps, speed=4 / seconds)[:, None]
    at_goal = arrival(resolved, steps)
    metrics = measured(resolved, path, [[5, 5]], [at_goal])[0]
    assert metrics["barn_score"] == pytest.approx(score)
    metrics = measured(resolved, path, [[5, 5]])[0]
    assert metrics["barn_score"] == 0.0
    walled = scenario(([1, 5], [5, 5]), world="width: 20, height: 20, boundary: walls")
    names = [record.name for record in walled.objects]
    both = np.concatenate([path, np.zeros_like(path)], axis=1)
    contact = event("collision", 1, *names)
    metrics = robot_metrics(trace(walled, both, [[5, 5]]), walled, [contact, at_goal])[0]
    assert metrics["barn_score"] == 0.0


WALL = "obstacle:\n  - {shape: {name: rectangle, length: 0.5, width: 6}, state: [10, 10, 0]}\n"


def test_the_shortest_way_goes_round_walls() -> None:
    resolved = scenario(([6, 10], [14, 10]), rest=WALL)
    x = np.linspace(6, 14, 81)
    y = 10 + 4 * np.sin((x - 6) / 8 * np.pi)
    path = np.stack([x, y], axis=1)
    metrics = measured(resolved, np.stack([path, np.full((81, 2), 10.0)], axis=1), [[14, 10]], [arrival(resolved, 80)])[
        0
    ]
    # tangents to the corners grown by the radius
    ideal = 2 * math.hypot(4 - 0.25, 3.2) + 0.5
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert metrics["spl"] == pytest.approx(ideal / length, rel=0.02)
    assert metrics["path_efficiency"] == pytest.approx(length / ideal, rel=0.02)
    assert metrics["clearing_distance_min"] == pytest.approx(
        np.hypot(np.maximum(abs(x - 10) - 0.25, 0), np.maximum(abs(y - 10) - 3, 0)).min() - 0.2
    )


def test_a_goal_walled_in_is_flagged() -> None:
    box = "obstacle:\n"
    for state in ([14, 12, 0], [14, 8, 0], [12, 10, 1.5707963], [16, 10, 1.5707963]):
        box += f"  - {{shape: {{name: rectangle, length: 4.6, width: 0.4}}, state: {state}}}\n"
    resolved = scenario(([6, 10], [14, 10]), rest=box)
    path = np.stack([np.linspace(6, 14, 81), np.full(81, 10.0)], axis=1)
    pose = np.concatenate([path[:, None], np.zeros((81, 4, 2))], axis=1)
    at_goal = arrival(resolved, 80)
    for events in ([at_goal], []):
        metrics = episode_metrics(trace(resolved, pose, [[14, 10]]), resolved, events)
        assert metrics.flags == [["unreachable"]]
        for key in ("spl", "stl", "barn_score", "path_efficiency", "path_irregularity"):
            assert math.isnan(metrics.robots[0][key])


HUMAN = "obstacle:\n  - {shape: {name: circle, radius: 0.3}, kinematics: {name: omni}, state: [5, 5]}\n"


def passing(gap: float) -> dict[str, float]:
    """Metrics of a straight drive past a standing human whose surface is `gap` to the side."""
    resolved = scenario(([1, 5], [9, 5]), rest=HUMAN)
    human = np.tile([5.0, 5.0 + 0.5 + gap], (81, 1))
    path = np.stack([straight(80), human], axis=1)
    return measured(resolved, path, [[9, 5]], [arrival(resolved, 80)])[0]


def test_distance_to_a_human_is_that_of_the_surfaces() -> None:
    metrics = passing(0.4)
    x = 1 + 0.1 * np.arange(81)
    away = np.hypot(x - 5, 0.9) - 0.5
    assert_metrics(
        metrics,
        distance_to_human_min=0.4,
        distance_to_human_avg=away.mean(),
        personal_space_intrusion_ratio=(away < 0.5).mean(),
        space_compliance=(away >= 0.5).mean(),
    )
    shares = [metrics[f"proxemics_{zone}_ratio"] for zone in ("intimate", "personal", "social", "public")]
    assert sum(shares) == pytest.approx(1.0)
    assert shares[0] == pytest.approx((away < 0.45).mean())
    assert metrics["near_misses"] == 0
    assert math.isnan(metrics["time_to_collision_min"])  # it would never meet him


def test_a_time_to_collision_that_never_was_is_flagged() -> None:
    resolved = scenario(([1, 5], [9, 5]), rest=HUMAN)
    for gap, flags in ((0.1, [["no_approach"]]), (-0.1, [[]])):
        path = np.stack([straight(20), np.tile([5.0, 5.5 + gap], (21, 1))], axis=1)
        assert episode_metrics(trace(resolved, path, [[9, 5]]), resolved, []).flags == flags
    alone = scenario(([1, 5], [9, 5]))  # no person to meet
    assert episode_metrics(trace(alone, straight(20)[:, None], [[9, 5]]), alone, []).flags == [[]]


def test_a_near_miss_and_discomfort() -> None:
    metrics = passing(0.1)
    x = 1 + 0.1 * np.arange(81)
    away = np.hypot(x - 5, 0.6) - 0.5
    close = away[away < 0.2]
    assert_metrics(metrics, near_misses=1, discomfort_ratio=len(close) / 81, discomfort_min_dist=close.mean())
    assert passing(-0.1)["near_misses"] == 0  # a contact does not count


def test_near_misses_are_of_humans() -> None:
    resolved = scenario(([1, 5], [9, 5]), ([9, 5.5], [1, 5.5]))
    path = np.stack([straight(80), straight(80)[::-1] + np.array([0, 0.5])], axis=1)
    robots = measured(resolved, path, [[9, 5], [1, 5.5]])
    assert robots[0]["min_clearance"] == pytest.approx(0.1)
    assert all(math.isnan(robot["near_misses"]) for robot in robots)


def test_time_to_collision_head_on() -> None:
    resolved = scenario(([1, 5], [9, 5]), rest=HUMAN)
    human = np.stack([9 - 0.1 * 0.5 * np.arange(31), np.full(31, 5.0)], axis=1)
    metrics = measured(resolved, np.stack([straight(30), human], 1), [[9, 5]])[0]
    # after the last step: 3.5 m between centres, 0.5 m of radii, closing at 1.5 m/s
    assert metrics["time_to_collision_min"] == pytest.approx((3.5 - 0.5) / 1.5)


def test_robots_of_an_episode_together() -> None:
    resolved = scenario(([1, 5], [5, 5]), ([1, 9], [9, 9]))
    one, other = (record.name for record in resolved.objects)
    path = np.stack([straight(40), straight(40, 0.5) + np.array([0, 4])], axis=1)
    done = trace(resolved, path, [[5, 5], [9, 9]])
    metrics = episode_metrics(done, resolved, [event("arrival", 40, one)]).episode
    assert_metrics(metrics, success=0, timeout=1, path_length=3.0)
    assert (metrics["velocity_min"], metrics["velocity_max"]) == pytest.approx((0.5, 1.0))
    assert metrics["time_to_goal"] == pytest.approx(4.0)  # of robots that have one
    assert math.isnan(metrics["aggregated_time"])
    both = episode_metrics(done, resolved, [event("arrival", 40, one), event("arrival", 30, other)]).episode
    assert (both["success"], both["aggregated_time"]) == (1, pytest.approx(4.0))
    hit = episode_metrics(done, resolved, [event("collision", 20, one, other), event("arrival", 40, one)]).episode
    assert (hit["success"], hit["timeout"]) == (0, 0)
