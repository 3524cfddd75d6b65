"""From a finished environment to a :class:`irsim.results.results.RunResult`: who arrived, who did not, and why."""

from __future__ import annotations

import math
import shlex
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import clean, seconds
from irsim.episodes.episode import seed_of
from irsim.episodes.out_of_bounds import MOST_LEFT, left_told, left_world
from irsim.episodes.stuck import (
    circling,
    gets_nowhere_since,
    in_the_way,
    jam_told,
    jammed,
    lacks_heading,
    moves_by_itself,
)
from irsim.results.results import EventRecord, Finding, HorizonSource, Left, RobotResult, RunResult
from irsim.scenario.resolve.randomness import random_parts
from irsim.simulation.events import Event, first_events, passable_names
from irsim.simulation.outcome import robot_outcomes

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.metrics import Approach
    from irsim.objects.view import ObjectView
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["command", "has_one_end", "others_arrived", "overlay_words", "region_words", "run_result", "strip_words"]

_MAX_EVENTS = 100
_NAMED = 3
"""Robots named one by one in a sentence."""
_LONGEST_NAME = 40
_MOST_POSES = 2_000_000
"""Poses of all objects in all steps, up to which the least distances of robots are told."""
_STANDING = 1e-3
"""Slower than this is standing still [m/s], unless it is a tenth of its top speed."""
_NO_FILE = "scenario.yaml"
_LIMITS: dict[HorizonSource, str] = {
    "argument": "the steps asked for",
    "scenario": "world.time_limit",
    "default": "the default limit; world.time_limit sets another",
    "limits": "the most steps of one run here",
}


def run_result(
    env: Env,
    path: str | Path | None,
    *,
    horizon: int,
    source: HorizonSource,
    warnings: list[Finding],
    files: list[str],
    imports: Sequence[str] = (),
    strict: bool = False,
    behavior: str | None = None,
) -> RunResult:
    """What an episode came to.

    Args:
        env: The environment, run to its end.
        path: The scenario file, None for a text.
        horizon: Steps at most.
        source: Where the horizon comes from.
        warnings: What is odd about the scenario.
        files: Files written.
        imports: Modules that were imported for it.
        strict: Whether it was read strictly.
        behavior: What every robot followed instead of its own.
    """
    from irsim import __version__

    events = env.events
    hits, counts = _collisions(env, events)
    told = _without_repeats(env.scenario, events)
    held = jammed(env.simulation, events)
    parked = [record.name for record in env.scenario.robots() if env.scenario.is_parked(record)]
    robots = _robots(env, events, counts, parked)
    left = _left(env)
    ends = [robot.outcome for robot in robots]
    outcome: Literal["success", "collision", "timeout"] = "timeout"
    if ends and all(end == "success" for end in ends):
        outcome = "success"
    elif "collision" in ends:
        outcome = "collision"
    extra = () if behavior is None else ("--behavior", behavior)
    given = horizon if source in ("argument", "limits") else None
    return RunResult(
        scenario="(text)" if path is None else str(path),
        seed=env.seed,
        random=random_parts(env.scenario),
        behavior=behavior,
        outcome=outcome,
        summary=_summary(env, robots, hits, behavior, parked, held, events, left),
        reason=None if outcome == "success" else _reason(env, robots, hits, events, source, parked, held),
        steps=int(env.simulation.count[0]),
        sim_time=env.sim_time,
        time_limit=horizon * env.step_time,
        time_limit_from=source,
        robots=robots,
        parked=parked,
        jammed=list(held),
        left=left[:MOST_LEFT],
        events=[EventRecord(**{k: getattr(e, k) for k in EventRecord.model_fields}) for e in told[:_MAX_EVENTS]],
        event_count=len(told),
        warnings=warnings,
        files=files,
        version=__version__,
        reproduce=command("run", path, env, given, strict, imports, extra),
    )


def command(
    verb: str,
    path: str | Path | None,
    env: Env,
    steps: int | None,
    strict: bool,
    imports: Sequence[str] = (),
    extra: Sequence[str] = (),
) -> str:
    """The command line that does the same again; for a scenario without a file it says how to name one.

    It names the seed unless that decides nothing and is the one that the command takes by itself.
    """
    words = ["irsim", verb, _NO_FILE if path is None else str(path)]
    if random_parts(env.scenario) or env.seed != seed_of(env.scenario, None):
        words += ["--seed", str(env.seed)]
    if steps is not None:
        words += ["--steps", str(steps)]
    if strict:
        words.append("--strict")
    for name in imports:
        words += ["--import", name]
    text = shlex.join([*words, *extra])
    return text if path is not None else f"{text}  # the text, saved as {_NO_FILE}"


def region_words(region: Sequence[float] | None) -> list[str]:
    """The option of ``irsim render`` for the part of the world that is shown."""
    return [] if region is None else ["--region", *(f"{float(value):g}" for value in region)]


def overlay_words(overlays: Sequence[str] | None) -> list[str]:
    """The option of ``irsim render`` for what a picture shows besides bodies."""
    return [] if overlays is None else ["--overlays", ",".join(overlays)]


def strip_words(moments: int | None) -> list[str]:
    """The option of ``irsim render`` for several moments in one picture."""
    return [] if moments is None else ["--strip", str(moments)]


def _robots(env: Env, events: list[Event], counts: Counter[str], parked: Sequence[str]) -> list[RobotResult]:
    outcomes = robot_outcomes(env.simulation, events=events)
    arrivals = first_events(events, "arrival")
    robots = []
    nearest = _nearest(env, arrivals)
    for view in env.robot_list:
        approach = nearest.get(view.row)
        ended = outcomes[view.name]
        goal = None if view.name in parked else view.goal
        arrival = arrivals.get(view.name)
        robots.append(
            RobotResult(
                name=view.name,
                outcome="timeout" if ended == "running" else ended,
                time_to_goal=None if arrival is None else arrival.time,
                collision_count=counts[view.name],
                infeasible_steps=int(env.simulation.infeasible[view.row]) or None,
                path_length=_path_length(env, view.row),
                distance_to_goal=None if goal is None else math.dist(goal[:2, 0], view.position[:, 0]),
                min_clearance=None if approach is None else approach.distance,
                nearest=None if approach is None else approach.partner,
                pose=(float(view.state[0, 0]), float(view.state[1, 0]), float(view.state[2, 0])),
            )
        )
    return robots


def _nearest(env: Env, arrivals: dict[str, Event]) -> dict[int, Approach | None]:
    """For each robot, by row, what it came nearest to until it arrived; empty in very large runs."""
    from irsim.metrics.clearance import least

    state, rows, steps = env.simulation.state, [view.row for view in env.robot_list], int(env.simulation.count[0])
    if not rows or (steps + 1) * env.simulation.objects > _MOST_POSES:
        return {}
    tracks = [state.trajectory(row)[:, :3] for row in range(env.simulation.objects)]  # empty of what is static
    if any(len(track) not in (0, steps) for track in tracks):  # objects came or went
        return {}
    poses = np.empty((steps + 1, len(tracks), 3))
    for row, track in enumerate(tracks):
        poses[0, row] = state.initial_state(row)[:3]
        poses[1:, row] = track if len(track) else poses[0, row]
    ends = [arrivals[view.name].step + 1 if view.name in arrivals else steps + 1 for view in env.robot_list]
    return dict(zip(rows, least(poses, env.simulation, rows, ends), strict=True))


def _collisions(env: Env, events: list[Event]) -> tuple[list[Event], Counter[str]]:
    """The collisions of robots, and how many each had; passing through something ``unobstructed`` is none."""
    passable = passable_names(env.simulation)
    names = {view.name for view in env.robot_list}
    hits, counts = list[Event](), Counter[str]()
    for event in events:
        if event.kind == "collision":  # may be one of a million
            first, second = event.object, event.partner or ""
            mine, theirs = first in names and second not in passable, second in names and first not in passable
            if mine or theirs:
                hits.append(event)
            if mine:
                counts[first] += 1
            if theirs:
                counts[second] += 1
    return hits, counts


def _path_length(env: Env, row: int) -> float:
    track = env.simulation.state.trajectory(row)[:, :2]
    points = np.vstack([env.simulation.state.initial_state(row)[None, :2], track])
    with np.errstate(over="ignore", invalid="ignore"):  # steps may be as long as a number can say
        return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _left(env: Env) -> list[Left]:
    """Who left the world; in very large runs only robots."""
    simulation, large = env.simulation, (int(env.simulation.count[0]) + 1) * env.simulation.objects > _MOST_POSES
    records = env.scenario.objects

    def track(row: int) -> NDArray[np.float64]:
        past = [] if large and records[row].role != "robot" else [simulation.state.trajectory(row)[:, :3]]
        return np.vstack([simulation.state.initial_state(row)[None, :3], *past])

    return left_world(env.scenario, track, int(simulation.count[0]))


def _summary(
    env: Env,
    robots: list[RobotResult],
    hits: Sequence[Event],
    behavior: str | None,
    parked: Sequence[str],
    held: dict[str, Event],
    events: Sequence[Event],
    left: Sequence[Left],
) -> str:
    told = [_arrivals(robots, env.sim_time, parked)]
    if hit := _first_hit({robot.name for robot in robots}, hits):
        told.append(hit)
    if out := left_told(env.scenario, left):
        told.append(out)
    if gone := _gone_again(env, robots):
        told.append(gone)
    if others := others_arrived(env.scenario, events):
        told.append(others)
    if jam := jam_told(env.simulation, held):
        told.append(jam)
    changed = "" if behavior is None else f"with behavior {behavior} for all robots: "
    return changed + "; ".join(told)


def _arrivals(robots: list[RobotResult], sim_time: float, parked: Sequence[str]) -> str:
    """How many robots arrived, and by when; with or without a collision before."""
    if not robots:
        return f"no robots; {seconds(sim_time)} simulated"
    arrived = [robot.time_to_goal for robot in robots if robot.time_to_goal is not None]
    touched = sum(robot.outcome == "collision" for robot in robots if robot.time_to_goal is not None)
    if len(robots) > 1:
        everybody = len(arrived) == len(robots)
        when = f", the last at {seconds(max(arrived))}" if everybody else f" within {seconds(sim_time)}"
        who = "all" if touched == len(arrived) else str(touched)
        after = f", {who} of them after a collision" if touched else ""
        still = f", {len(parked)} {'is' if len(parked) == 1 else 'are'} parked" if parked else ""
        return f"{len(arrived)} of {len(robots)} robots arrived{when}{after}{still}"
    if arrived:
        return f"the robot arrived at {seconds(arrived[0])}{', after a collision' * touched}"
    if parked and robots[0].outcome == "timeout":
        return f"the robot is parked; {seconds(sim_time)} simulated"
    if robots[0].outcome == "collision":
        return "the robot collided"  # when is told by what it hit
    return f"the robot did not arrive within {seconds(sim_time)}"


def _gone_again(env: Env, robots: list[RobotResult]) -> str | None:
    """Who had arrived and is not at its goal at the end."""
    views = {view.name: view for view in env.robot_list}
    gone = [
        _quoted(robot.name)
        for robot in robots
        if robot.outcome == "success" and not views[robot.name].arrive and has_one_end(views[robot.name].record)
    ]
    if len(gone) < 2:
        return f"{gone[0]} left its goal again" if gone else None
    more = f" and {len(gone) - _NAMED} more" if len(gone) > _NAMED else ""
    return f"{', '.join(gone[:_NAMED])}{more} left their goals again"


def has_one_end(record: ObjectRecord) -> bool:
    """Whether it has a last goal that stays."""
    return not (record.wander or record.loop)


def others_arrived(scenario: ResolvedScenario, events: Sequence[Event]) -> str | None:
    """How many of the moving obstacles that have a goal arrived, in words; None if there are none.

    Args:
        scenario: Whose obstacles.
        events: What happened.
    """
    walking = {
        record.name for record in scenario.objects if moves_by_itself(record) and record.goals and has_one_end(record)
    }
    if not walking:
        return None
    arrived = walking & {event.object for event in events if event.kind == "arrival"}
    return f"{len(arrived)} of {len(walking)} moving obstacle{'s' * (len(walking) != 1)} arrived"


def _without_repeats(scenario: ResolvedScenario, events: Sequence[Event]) -> list[Event]:
    """Of the arrivals of an object at a goal that stays only the first: swinging about it gives many."""
    staying = {record.name for record in scenario.objects if has_one_end(record)}
    seen, kept = set[str](), []
    for event in events:
        if event.kind == "arrival" and event.object in staying:
            if event.object in seen:
                continue
            seen.add(event.object)
        kept.append(event)
    return kept


def _reason(
    env: Env,
    robots: list[RobotResult],
    hits: Sequence[Event],
    events: Sequence[Event],
    source: HorizonSource,
    parked: Sequence[str],
    held: dict[str, Event],
) -> str:
    """Why it is no success: the first collision, and who was still on the way."""
    if not robots:
        return "there are no robots"
    reasons = []
    collided = {robot.name for robot in robots if robot.outcome == "collision"}
    if hit := _first_hit(collided, hits):
        others = len(collided) - 1
        reasons.append(hit + (f" (in all {others + 1} robots collided)" if others else ""))
    views = {view.name: view for view in env.robot_list}
    late = [robot for robot in robots if robot.outcome == "timeout" and robot.name not in parked]
    if late:
        named = [
            f"{_quoted(robot.name)} {_state_of(env, views[robot.name], robot, events, held)}" for robot in late[:_NAMED]
        ]
        more = f" and {len(late) - _NAMED} robots more" if len(late) > _NAMED else ""
        reasons.append(f"at {seconds(env.sim_time)} ({_LIMITS[source]}) {', '.join(named)}{more}")
    if still := [robot for robot in robots if robot.outcome == "timeout" and robot.name in parked]:
        who = ", ".join(_quoted(robot.name) for robot in still[:_NAMED])
        who += f" and {len(still) - _NAMED} more" if len(still) > _NAMED else ""
        reasons.append(f"{who} {'is' if len(still) == 1 else 'are'} parked (cannot move, no goal written)")
        if len(reasons) == 1:
            reasons.append(f"the run ended at {seconds(env.sim_time)} ({_LIMITS[source]})")
    return "; ".join(reasons)


def _first_hit(names: set[str], events: Sequence[Event]) -> str | None:
    first = next((e for e in events if e.kind == "collision" and names & {e.object, str(e.partner)}), None)
    if first is None:
        return None
    place = f"({first.x:.2f}, {first.y:.2f})"
    return f"{_quoted(first.object)} hit {_quoted(first.partner)} at {seconds(first.time)} near {place}"


def _quoted(name: object) -> str:
    return f"'{clean(name, _LONGEST_NAME)}'"


def _state_of(env: Env, view: ObjectView, robot: RobotResult, events: Sequence[Event], held: dict[str, Event]) -> str:
    """What a robot is doing that has not arrived: ``stands still 3.21 m from its goal``."""
    record = view.record
    speed = float(np.linalg.norm(view.velocity_xy))
    standing = min(_STANDING, view.max_speed / 10 or _STANDING)
    last = events[-_MAX_EVENTS:]
    place = "without a goal" if robot.distance_to_goal is None else f"{robot.distance_to_goal:.2f} m from its goal"
    if not _inside(env, robot):
        place += f", outside the world at ({robot.pose[0]:.2f}, {robot.pose[1]:.2f})"
    if any(event.kind == "no_path" and event.object == robot.name for event in last) and speed < standing:
        return f"stands still {place}: there is no path to it"
    if speed >= standing:
        if circle := _circle(env, view, events):
            return f"circles its goal: {circle}"
        if gets_nowhere_since(env.simulation.state.trajectory(view.row)[:, :2], env.step_time, view.max_speed) is None:
            return f"still moved at {speed:.2g} m/s, {place}"
        return f"hardly moves {place}{_held_up(env, view, held)}"
    if record.kinematics is None:
        return f"has no kinematics, so it stands still {place}"
    if record.behavior is None and record.group_behavior is None:
        if not env.scenario.has_written_goal(record):
            return "has no behavior, so it stands still; no goal is written for it"
        return f"has no behavior, so it stands still {place}"
    row = view.row
    if off := lacks_heading(record, env.simulation.pose[row], env.simulation.state.goal[row]):
        return f"stands still {place}: {off}"
    return f"stands still {place}{_held_up(env, view, held)}"


def _held_up(env: Env, view: ObjectView, held: dict[str, Event]) -> str:
    """That someone who stands since a collision is in the way of a robot; empty if nobody is."""
    near = in_the_way(env.simulation, view.row, held) if held else None
    return f", and {near.told}" if near is not None and near.held else ""


def _circle(env: Env, view: ObjectView, events: Sequence[Event]) -> str | None:
    """Why a robot circles its goal, if it does."""
    if view.goal is None or not has_one_end(view.record):
        return None
    turns = (e.step for e in reversed(events) if e.kind == "waypoint" and e.object == view.name)
    track = env.simulation.state.trajectory(view.row)[next(turns, 0) :, :3]
    circle = circling(track, view.goal[:2, 0])
    return None if circle is None else circle.told


def _inside(env: Env, robot: RobotResult) -> bool:
    left, low, right, top = env.scenario.world.bounds
    return left <= robot.pose[0] <= right and low <= robot.pose[1] <= top
