"""Makes the :class:`irsim.results.run.RunResult` of a finished environment."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.common.text import clean
from irsim.common.version import version
from irsim.diagnostics.errors import CodedError
from irsim.episodes.between_steps import BetweenSteps, find_between_steps
from irsim.episodes.decisive import decisive_step, nearest_to_goals
from irsim.episodes.explanation import has_one_end, reason_message, summary_message
from irsim.episodes.incidents import find_incidents
from irsim.episodes.out_of_bounds import MAX_LISTED_EXITS, find_exits
from irsim.episodes.reproduce import reproduce_command
from irsim.episodes.scene_summary import called
from irsim.episodes.stuck import find_jammed
from irsim.episodes.watching import goal_visibility, watched_metrics, zone_results
from irsim.results.findings import Finding
from irsim.results.run import EventRecord, HorizonSource, Left, RobotResult, RunResult
from irsim.scenario.resolve.randomness import random_parts
from irsim.simulation.events import BETWEEN_STEPS, SIGHTS, Event, first_events, passable_names
from irsim.simulation.explored import explored_share
from irsim.simulation.history import all_poses
from irsim.simulation.outcome import robot_outcomes

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.metrics import Approach
    from irsim.policies.policy import Policy
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["run_result"]

_MAX_EVENTS = 100
"""Number of events that a result lists."""
_LOST = {"bridge-lost": "program of a bridge", "policy-lost": "policy"}
"""What was lost, by the code of the error."""
_MAX_POSES = 2_000_000
"""Number of poses, of all objects in all steps, up to which clearances of robots are computed."""


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
    policy: Policy | None = None,
    perturb: Sequence[str] = (),
    bridges: Sequence[str] = (),
    lost: CodedError | None = None,
) -> RunResult:
    """Make the result of an episode.

    Args:
        env: The environment after the last step.
        path: The scenario file, None for a text.
        horizon: Maximum number of steps.
        source: Where the horizon comes from.
        warnings: Warnings about the scenario.
        files: Files that were written.
        imports: Modules that were imported for the scenario.
        strict: Whether the scenario was read strictly.
        behavior: Behavior that every robot had instead of its own.
        policy: Policy in Python that drove the robots.
        perturb: Perturbations of the scenario, as on the command line.
        bridges: Bridges besides those of the scenario, as on the command line.
        lost: Why the policy or the program of a bridge could not go on, which ended the run.
    """
    events = env.events
    hits, counts = _collisions(env, events)
    listed = _without_repeats(env.scenario, events)
    held = find_jammed(env.simulation, events)
    parked = [record.name for record in env.scenario.robots() if env.scenario.is_parked(record)]
    between = find_between_steps(events, {view.name for view in env.robot_list}, passable_names(env.simulation))
    robots = _robots(env, events, counts, between, parked)
    left, incidents = _exits(env), find_incidents(env.scenario.objects, events)
    zones = zone_results(env, events)
    ends = [robot.outcome for robot in robots]
    outcome: Literal["success", "collision", "timeout"] = "timeout"
    if ends and all(end == "success" for end in ends):
        outcome = "success"
    elif "collision" in ends:
        outcome = "collision"
    extra = [] if behavior is None else ["--behavior", behavior]
    if policy is not None:
        extra += ["--policy", policy.text or policy.name]
    for perturbation in perturb:
        extra += ["--perturb", perturbation]
    for bridge in bridges:
        extra += ["--bridge", bridge]
    because: str | None = None
    if outcome != "success":
        ended = None if lost is None else f"{lost.message}; the run ended"
        because = ended or reason_message(env, robots, hits, between, events, source, parked, held)
    summary = summary_message(
        env,
        robots,
        hits,
        between,
        _driven_by(behavior, policy),
        parked,
        held,
        events,
        left,
        incidents,
        nearest_to_goals(env, incidents.jumps),
        zones,
    )
    given = horizon if source in ("argument", "limits") else None
    return RunResult(
        scenario="(text)" if path is None else str(path),
        seed=env.seed,
        random=random_parts(env.scenario),
        behavior=behavior,
        policy=None if policy is None else policy.text or policy.name,
        policy_digest=None if policy is None else policy.digest,
        perturb=list(perturb),
        outcome=outcome,
        summary=summary + ("" if lost is None else f"; the {_LOST[_lost_code(lost)]} was lost, which ended the run"),
        reason=because,
        lost=None if lost is None else lost.message,
        lost_code=None if lost is None else _lost_code(lost),
        decisive_step=decisive_step(env, robots, hits, between, events, parked, held),
        steps=int(env.simulation.count[0]),
        sim_time=env.sim_time,
        time_limit=horizon * env.step_time,
        time_limit_from=source,
        robots=robots,
        parked=parked,
        jammed=list(held),
        left=left[:MAX_LISTED_EXITS],
        jumped=list(incidents.jumps)[:MAX_LISTED_EXITS],
        explored=explored_share(env.simulation),
        human_contacts=len(incidents.human_contacts),
        contacts_between_steps=len(between),
        zones=zones,
        events=[EventRecord(**event._asdict()) for event in _first(listed)],
        event_count=len(listed),
        warnings=warnings,
        files=files,
        version=version(),
        reproduce=reproduce_command("run", path, env, given, strict, imports, extra),
    )


def _robots(
    env: Env, events: list[Event], counts: Counter[str], between: BetweenSteps, parked: Sequence[str]
) -> list[RobotResult]:
    outcomes = robot_outcomes(env.simulation, events=events)
    arrivals = first_events(events, "arrival")
    robots = []
    small = (int(env.simulation.count[0]) + 1) * env.simulation.objects <= _MAX_POSES
    nearest = _approaches(env, arrivals) if small else {}
    watched = watched_metrics(env, events, arrivals)
    visible = goal_visibility(env, arrivals) if small else {}
    for view in env.robot_list:
        approach, approach_place = nearest.get(view.row, (None, None))
        ended = outcomes[view.name]
        goal = None if view.name in parked else view.goal
        arrival = arrivals.get(view.name)
        place = (view.init_state if env.simulation.appeared[view.row] < 0 else view.state)[:3, 0]
        robots.append(
            RobotResult(
                name=view.name,
                outcome="timeout" if ended == "running" else ended,
                time_to_goal=None if arrival is None else arrival.time,
                collision_count=counts[view.name],
                contacts_between_steps=between.counts[view.name],
                passed_through=between.passed.get(view.name, []),
                infeasible_steps=int(env.simulation.infeasible[view.row]) or None,
                path_length=_path_length(env, view.row),
                distance_to_goal=None if goal is None else math.dist(goal[:2, 0], place[:2]),
                min_clearance=None if approach is None else approach.distance,
                nearest=None if approach is None else approach.partner,
                nearest_called=None if approach is None else called(env.scenario, approach.partner),
                nearest_at=approach_place,
                heading_error=None if goal is None else _heading_error(view.record, goal[:, 0], float(place[2])),
                goal_visible_ratio=visible.get(view.name),
                **watched[view.name],
                pose=(float(place[0]), float(place[1]), float(place[2])),
            )
        )
    return robots


def _approaches(env: Env, arrivals: dict[str, Event]) -> dict[int, tuple[Approach | None, tuple[float, float] | None]]:
    """Find what each robot, by row, came nearest to until it arrived, and where it was then.

    Empty if objects came or went.
    """
    from irsim.navigation.clearances import least

    rows, steps = [view.row for view in env.robot_list], int(env.simulation.count[0])
    poses = all_poses(env.simulation) if rows else None
    if poses is None:
        return {}
    ends = [arrivals[view.name].step + 1 if view.name in arrivals else steps + 1 for view in env.robot_list]
    found: dict[int, tuple[Approach | None, tuple[float, float] | None]] = {}
    for row, approach in zip(rows, least(poses, env.simulation, rows, ends), strict=True):
        place = None if approach is None else (float(poses[approach.row, row, 0]), float(poses[approach.row, row, 1]))
        found[row] = approach, place
    return found


def _heading_error(record: ObjectRecord, goal: Floats, heading: float) -> float | None:
    """Difference between a heading and that of a goal [rad]; None where the heading does not count."""
    return abs(math.remainder(heading - float(goal[2]), math.tau)) if record.heading_counts(goal.tolist()) else None


def _collisions(env: Env, events: list[Event]) -> tuple[list[Event], Counter[str]]:
    """Return the collisions of robots and the number of each robot; ``unobstructed`` objects do not collide."""
    passable = passable_names(env.simulation)
    names = {view.name for view in env.robot_list}
    hits, counts = list[Event](), Counter[str]()
    for event in events:
        if event.kind == "collision":  # cheapest test first: there may be a million events
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
    with np.errstate(over="ignore", invalid="ignore"):  # steps may be as long as a float allows
        return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _exits(env: Env) -> list[Left]:
    """Find the objects that left the world; in very large runs only robots."""
    simulation, large = env.simulation, (int(env.simulation.count[0]) + 1) * env.simulation.objects > _MAX_POSES
    records = env.scenario.objects

    def track(row: int) -> NDArray[np.float64]:
        past = [] if large and records[row].role != "robot" else [simulation.state.trajectory(row)[:, :3]]
        return np.vstack([simulation.state.initial_state(row)[None, :3], *past])

    return find_exits(env.scenario, track, int(simulation.count[0]))


def _lost_code(error: CodedError) -> Literal["bridge-lost", "policy-lost"]:
    return "bridge-lost" if error.code == "bridge-lost" else "policy-lost"


def _driven_by(behavior: str | None, policy: Policy | None) -> str | None:
    """What drives all robots instead of their own behaviors, in words; None if nothing does."""
    if policy is not None:
        return f"policy {clean(policy.text or policy.name)}"
    return None if behavior is None else f"behavior {behavior}"


def _without_repeats(scenario: ResolvedScenario, events: Sequence[Event]) -> list[Event]:
    """Drop repeated arrivals of an object at a fixed goal, around which it may oscillate."""
    staying = {record.name for record in scenario.objects if has_one_end(record)}
    seen, kept = set[str](), []
    for event in events:
        if event.kind == "arrival" and event.object in staying:
            if event.object in seen:
                continue
            seen.add(event.object)
        kept.append(event)
    return kept


def _first(events: list[Event]) -> list[Event]:
    """The events that a result lists, in order: if there are too many, contacts between steps stay and sights go first.

    Within a rank the first events stay.
    """
    ranks = sorted(range(len(events)), key=lambda place: _rank(events[place].kind))  # a stable sort
    return [events[place] for place in sorted(ranks[:_MAX_EVENTS])]


def _rank(kind: str) -> int:
    return 0 if kind in BETWEEN_STEPS else 2 if kind in SIGHTS else 1
