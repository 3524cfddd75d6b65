"""Recomputes arrivals, the outcome and the main metrics of a recorded run."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.common.event_kinds import BETWEEN_STEPS
from irsim.results.audit import AuditedRobot
from irsim.runs.audit.artifact import Artifact, Body
from irsim.runs.audit.compare_beliefs import compare_beliefs, distances_to, on_last_goal
from irsim.runs.audit.record import EventFacts, RobotFacts
from irsim.runs.audit.report import Report
from irsim.runs.audit.shapes import Shape, signed_gap

__all__ = ["audited_robots", "compare_arrivals", "compare_result"]

_ROUNDING = 1e-9
_TOLERANCE = 1e-6


def compare_arrivals(artifact: Artifact, report: Report) -> None:
    """Compare the flags and events of arrival with the distances to the recorded goals."""
    report.begin("arrivals")
    events: dict[tuple[str, str], set[int]] = {}
    for event in artifact.events:
        events.setdefault((event.kind, event.object), set()).add(event.step)
    for row, body in enumerate(artifact.bodies):
        _compare_goals(artifact, body, row, report)
        distance = _to_goal(artifact, body, row)
        flags, threshold = artifact.arrived[:, row], body.options.goal_threshold
        known = ~np.isnan(distance)
        if body.estimates:
            known &= on_last_goal(artifact, body)  # it goes on to its next goal where it believes to be at this one
        report.compared(int(known.sum()))
        steps = np.arange(artifact.first, artifact.last + 1)
        passing = np.isin(steps, list(events.get(("waypoint", body.name), ())))
        stays = np.concatenate([[False], flags[:-1]]) & artifact.settles(body)
        early = flags & ~stays & ~(distance < threshold + _ROUNDING)
        late = known & ~flags & ~passing & (distance < threshold - _ROUNDING) & (not body.replays)
        for wrong, what in ((early, "has not arrived"), (late, "has arrived")):
            for place in np.flatnonzero(wrong).tolist():
                step = int(steps[place])
                _differ(report, body, step, f"'{body.name}' {what} in step {step}", float(distance[place]), threshold)
        begins = flags & ~np.concatenate([[False], flags[:-1]])
        recomputed, recorded = set(steps[begins].tolist()), events.get(("arrival", body.name), set())
        recorded = {step for step in recorded if artifact.first <= step <= artifact.last}
        for step in sorted(recomputed ^ recorded):
            has = "an arrival" if step in recorded else "no arrival"
            what = f"the record has {has} of '{body.name}' in step {step}, unlike its flags"
            report.differ("audit-arrival", what, object=body.name, step=step, recorded=step in recorded,
                          recomputed=step in recomputed)  # fmt: skip
        for step in sorted(events.get(("waypoint", body.name), set())):
            place = step - artifact.first
            if 0 < place < len(flags):
                away = _distance(body, artifact.pose[place, row], artifact.goal[place - 1, row])
                if not away < threshold + _ROUNDING and not (body.options.wander or body.estimates):
                    _differ(report, body, step, f"'{body.name}' is not at its waypoint in step {step}", away, threshold)
    report.end(compare_beliefs(artifact, report))


def _differ(report: Report, body: Body, step: int, what: str, distance: float, threshold: float) -> None:
    far = distance if math.isfinite(distance) else None
    report.differ(
        "audit-arrival",
        f"{what}: it is {distance:.9g} m from its goal, the threshold is {threshold:g} m",
        object=body.name,
        step=step,
        recorded=far,
        recomputed=threshold,
        tolerance=_ROUNDING,
    )


def _compare_goals(artifact: Artifact, body: Body, row: int, report: Report) -> None:
    """Compare the goals of the trace with the goals in the scenario; objects that loop or wander have further ones."""
    options = artifact.meta.options
    if body.endless or not body.facts.goals or options.get("bridges") or options.get("imports"):
        return
    given = np.array([[*goal[:2]] for goal in body.facts.goals if len(goal) > 1], dtype=np.float64).reshape(-1, 2)
    goal = artifact.goal[:, row, :2]
    strange = ~np.isnan(goal[:, 0]) & (np.abs(goal[:, None] - given).max(axis=2) > _ROUNDING).all(axis=1)
    report.compared(len(goal))
    if strange.any():
        place = int(strange.argmax())
        step, name = artifact.first + place, body.name
        what = f"the scenario does not give '{name}' its goal of step {step}"
        report.differ("audit-arrival", what, object=name, step=step, recorded=goal[place].tolist(),
                      recomputed=given[0].tolist(), tolerance=_ROUNDING)  # fmt: skip


def _to_goal(artifact: Artifact, body: Body, row: int) -> Floats:
    """(T,) distance of a body from its goal, with the heading where it counts; NaN without a goal."""
    return np.array(distances_to(body, artifact.pose[:, row], artifact.goal[:, row]))


def _distance(body: Body, pose: Floats, goal: Floats) -> float:
    return float(distances_to(body, pose[None], goal[None])[0])


def audited_robots(artifact: Artifact, shapes: Sequence[Shape]) -> list[AuditedRobot]:
    """The numbers of each robot, from poses, flags and events."""
    passable = {body.name for body in artifact.bodies if body.options.unobstructed}
    hits, between = list[EventFacts](), Counter[str]()
    for event in artifact.events:
        if event.kind == "collision":
            hits.append(event)
        elif event.kind in BETWEEN_STEPS:
            between.update({event.object, str(event.partner)})
    robots = []
    for row, body in enumerate(artifact.bodies):
        if not body.is_robot:
            continue
        mine = [event for event in hits if _hits(event, body.name, passable)]
        reached = next(
            (event for event in artifact.events if event.kind == "arrival" and event.object == body.name), None
        )
        on = body.endless and not body.options.static and _until(artifact) == "time_limit"
        outcome = _outcome(artifact, row, mine, reached, on)
        end = len(artifact.pose) if reached is None or on else reached.step - artifact.first + 1
        travelled, until = _path(artifact.pose[:, row]), _path(artifact.pose[:end, row])
        lasted = (np.count_nonzero(~np.isnan(artifact.pose[:end, row, 0])) - 1) * artifact.step_time
        clearance, nearest = _least_clearance(artifact, shapes, row, end)
        robots.append(
            AuditedRobot(
                name=body.name,
                outcome=outcome,
                time_to_goal=None if reached is None else reached.time,
                path_length=travelled,
                path_to_goal=until,
                mean_speed=until / lasted if lasted > 0 else None,
                min_clearance=clearance,
                nearest=nearest,
                contacts=len(mine),
                contacts_between_steps=between[body.name],
            )
        )
    return robots


def _until(artifact: Artifact) -> str:
    return "done" if artifact.result is None else artifact.result.until


def _hits(event: EventFacts, name: str, passable: set[str]) -> bool:
    """Whether an event is a collision of an object with something that is in its way."""
    if name == event.object:
        return str(event.partner) not in passable
    return name == event.partner and event.object not in passable


def _outcome(artifact: Artifact, row: int, hits: Sequence[EventFacts], reached: EventFacts | None, on: bool) -> Any:
    """``success``: arrived without a collision before; ``collision``: arrived after one, or one has stopped it."""
    if on and hits:
        return "collision"
    if reached is not None:
        return "collision" if hits and hits[0].step <= reached.step else "success"
    return "collision" if hits and artifact.stopped[-1, row] else "timeout"


def _path(pose: Floats) -> float:
    """Length of a path [m]."""
    there = pose[~np.isnan(pose[:, 0])]
    return float(np.hypot(*np.diff(there[:, :2], axis=0).T).sum()) if len(there) > 1 else 0.0


def _least_clearance(
    artifact: Artifact, shapes: Sequence[Shape], row: int, end: int
) -> tuple[float | None, str | None]:
    """The smallest distance of a robot to any object that is in its way, and the name of that object."""
    pose, best, nearest = artifact.pose[:end], math.inf, None
    for other, body in enumerate(artifact.bodies):
        if other == row or body.options.unobstructed or not shapes[other].is_known:
            continue
        bound = _lower_bound(pose[:, row], pose[:, other], body, shapes[row], shapes[other])
        for place in np.argsort(bound, kind="stable").tolist():
            if not bound[place] < best:
                break
            apart = signed_gap(shapes[row].at(pose[place, row].tolist()), shapes[other].at(pose[place, other].tolist()))
            if apart < best:
                best, nearest = apart, body.name
    return (None, None) if nearest is None else (best, nearest)


def _lower_bound(mine: Floats, theirs: Floats, body: Body, shape: Shape, other: Shape) -> Floats:
    """(T,) a number that is not larger than the distance between two bodies; infinite where one is absent [m]."""
    absent: NDArray[np.bool_] = np.isnan(mine[:, 0]) | (np.isnan(theirs[:, 0]) & (not other.is_map))
    if body.options.static or other.is_map:
        there = np.flatnonzero(~absent)
        if not len(there):
            return np.full(len(mine), math.inf)
        box = other.box(theirs[there[0]].tolist())
        off = np.maximum(np.maximum(box[:2] - mine[:, :2], mine[:, :2] - box[2:]), 0.0)
        inside = (off == 0).all(axis=1)
        bound = np.where(inside, -math.inf, np.hypot(*off.T) - shape.reach)
    else:
        bound = np.hypot(*(mine[:, :2] - theirs[:, :2]).T) - shape.reach - other.reach
    return np.where(absent, math.inf, bound)


def compare_result(artifact: Artifact, robots: Sequence[AuditedRobot], report: Report) -> str | None:
    """Compare outcome and metrics with the result of the run; returns the recomputed outcome."""
    result = artifact.result
    if result is None:
        report.skip("outcome", "the run has no result: it was interrupted")
        return None
    if artifact.last < result.steps:
        report.skip("outcome", f"the record ends with step {artifact.last} of {result.steps}")
        return None
    ends = [robot.outcome for robot in robots]
    outcome = "timeout"
    if ends and all(end == "success" for end in ends):
        outcome = "success"
    elif "collision" in ends:
        outcome = "collision"
    report.begin("outcome")
    _same(report, "outcome", None, result.outcome, outcome)
    _same(report, "steps", None, result.steps, artifact.last)
    _near(report, "sim_time", None, result.sim_time, artifact.last * artifact.step_time)
    _compare_end(artifact, report)
    recorded = {robot.name: robot for robot in result.robots}
    if set(recorded) != {robot.name for robot in robots}:
        what = "the result has other robots than the scenario"
        report.differ("audit-outcome", what, recorded=", ".join(sorted(recorded))[:200])
    for robot in robots:
        if (known := recorded.get(robot.name)) is not None:
            _same(report, "outcome", robot.name, known.outcome, robot.outcome)
    report.end()
    report.begin("metrics")
    for row, robot in zip((row for row, body in enumerate(artifact.bodies) if body.is_robot), robots, strict=True):
        if (known := recorded.get(robot.name)) is not None:
            _compare_robot(artifact, row, known, robot, report)
    report.end()
    return outcome


def _compare_end(artifact: Artifact, report: Report) -> None:
    """Whether the run ended when it should: all robots arrived or stopped, or the time was over."""
    result = artifact.result
    robots = [row for row, body in enumerate(artifact.bodies) if body.is_robot]
    if result is None or not robots or result.lost is not None or artifact.meta.options.get("bridges"):
        return
    done = np.flatnonzero(artifact.at_rest[:, robots].all(axis=1))
    report.compared()
    first = artifact.first + int(done[0]) if len(done) and result.until != "time_limit" else artifact.meta.horizon
    if result.until != "first_collision" and min(first, artifact.meta.horizon) != artifact.last:
        what = f"the run ends in step {artifact.last}; all robots have ended, or the time is over, in step {first}"
        report.differ("audit-outcome", what, step=artifact.last, recorded=artifact.last, recomputed=first)


def _compare_robot(artifact: Artifact, row: int, known: RobotFacts, robot: AuditedRobot, report: Report) -> None:
    body, name = artifact.bodies[row], robot.name
    _same(report, "collision_count", name, known.collision_count, robot.contacts)
    _same(report, "contacts_between_steps", name, known.contacts_between_steps, robot.contacts_between_steps)
    _near(report, "time_to_goal", name, known.time_to_goal, robot.time_to_goal)
    _near(report, "path_length", name, known.path_length, robot.path_length)
    pose = artifact.pose[-1, row]
    if not np.isnan(pose).any():
        for key, one, other in zip(("x", "y", "heading"), known.pose, pose.tolist(), strict=True):
            _near(report, f"pose.{key}", name, one, other)
        goal = artifact.goal[-1, row]
        if known.distance_to_goal is not None and not np.isnan(goal[0]):
            _near(report, "distance_to_goal", name, known.distance_to_goal, math.dist(pose[:2], goal[:2]))
    if known.min_clearance is None or not all(b.options.vanish_time is None for b in artifact.bodies):
        return
    least, other = robot.min_clearance, known.nearest
    with_map = any(one.name == other and one.drawn.outlines and one.drawn.outlines[0].kind == "cells"
                   for one in artifact.bodies)  # fmt: skip
    if with_map and known.min_clearance < 0 and least is not None and least <= _TOLERANCE:
        report.compared()  # how deep something is in a map is not recomputed
        return
    del body
    _near(report, "min_clearance", name, known.min_clearance, least)


def _same(report: Report, key: str, name: str | None, recorded: Any, recomputed: Any) -> None:
    report.compared()
    if recorded != recomputed:
        _tell(report, key, name, recorded, recomputed, None)


def _near(report: Report, key: str, name: str | None, recorded: float | None, recomputed: float | None) -> None:
    report.compared()
    if recorded is None or recomputed is None:
        if recorded is not recomputed:
            _tell(report, key, name, recorded, recomputed, None)
        return
    tolerance = _TOLERANCE * max(1.0, abs(recorded))
    if not abs(recorded - recomputed) <= tolerance:
        _tell(report, key, name, recorded, recomputed, tolerance)


def _tell(report: Report, key: str, name: str | None, recorded: Any, recomputed: Any, tolerance: float | None) -> None:
    whose = "of the run" if name is None else f"of '{name}'"
    report.differ(
        "audit-outcome" if key in ("outcome", "steps", "sim_time") else "audit-metric",
        f"{key} {whose} is {recomputed}, the result says {recorded}",
        object=name,
        recorded=recorded,
        recomputed=recomputed,
        tolerance=tolerance,
    )
