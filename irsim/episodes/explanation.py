"""How an episode ended, in words: which robots arrived, which did not, and why."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.text import listed, quoted, seconds
from irsim.episodes.appearances import absence, appearances_message, is_absent
from irsim.episodes.between_steps import BetweenSteps, between_steps_message, others_between_steps_message
from irsim.episodes.detours import closeness_message, shunting_message
from irsim.episodes.incidents import Incidents, contacts_message, jumps_message, returns_message
from irsim.episodes.out_of_bounds import exits_message
from irsim.episodes.reverse import reverse_message
from irsim.episodes.scene_summary import called
from irsim.episodes.stalling import stalled_step
from irsim.episodes.stuck import (
    find_circling,
    find_obstruction,
    heading_message,
    is_moving_obstacle,
    jam_message,
    no_progress_since,
    no_way_message,
)
from irsim.episodes.watching import sights_message, zones_message
from irsim.results.run import HorizonSource, Left, RobotResult, ZoneResult
from irsim.simulation.events import Event
from irsim.simulation.explored import explored_share
from irsim.simulation.roles import HUMAN, kinds_of

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.objects.view import ObjectView
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["first_collision", "has_one_end", "others_arrived_message", "reason_message", "summary_message"]

_MAX_NAMED = 3
"""Number of robots that a sentence names."""
_MAX_POSES = 2_000_000
"""Number of poses, of all objects in all steps, up to which moving obstacles that stand still are looked for."""
_MAX_STANDING_SPEED = 1e-3
"""Speed [m/s] below which a robot stands still; for a very slow robot a tenth of its top speed."""
_LIMIT_SOURCES: dict[HorizonSource, str] = {
    "argument": "the steps asked for",
    "scenario": "world.time_limit",
    "default": "the default limit; world.time_limit sets another",
    "limits": "the maximum number of steps of one run here",
}
"""Where the time limit comes from, in words."""


def summary_message(
    env: Env,
    robots: list[RobotResult],
    hits: Sequence[Event],
    between: BetweenSteps,
    driven: str | None,
    parked: Sequence[str],
    held: dict[str, Event],
    events: Sequence[Event],
    left: Sequence[Left],
    incidents: Incidents,
    nearest: Mapping[str, float],
    zones: Mapping[str, ZoneResult],
) -> str:
    """Say what was touched between steps, which robots arrived, the first collision, and what else happened."""
    failed = any(robot.outcome != "success" for robot in robots)  # then the reason has the advice
    parts = list(filter(None, [between_steps_message(env, between, hits, brief=failed)]))
    parts.append(_arrivals_message(robots, env.sim_time, parked))
    parts += filter(None, [_waiting_message(env), appearances_message(env)])
    if hit := _first_collision_message(env.scenario, {robot.name for robot in robots}, hits):
        parts.append(hit + _standing_message(env, {robot.name for robot in robots}, hits))
    if out := exits_message(env.scenario, left):
        parts.append(out)
    if jumps := jumps_message(incidents.jumps, nearest):
        parts.append(jumps)
    if returns := returns_message(incidents.returns, {robot.name for robot in robots}):
        parts.append(returns)
    if gone := _departures_message(env, robots):
        parts.append(gone)
    if shunted := shunting_message(env, robots, parked):
        parts.append(shunted)
    pushes = env.scenario.world.collision_mode == "contact"  # which keeps bodies that push a rounding error apart
    if not pushes and (close := closeness_message(robots)):
        parts.append(close)
    if others := others_arrived_message(env.scenario, events):
        parts.append(others)
    if not incidents.human_contacts and _people_may_overlap(env.scenario):
        parts.append("no contacts between people")
    said = bool(held) or incidents.human_contacts[:1] == list(hits[:1])
    if touched := contacts_message(incidents.human_contacts, brief=said):
        parts.append(touched)
    if among := others_between_steps_message(between):
        parts.append(among)
    if jam := jam_message(env.simulation, held):
        parts.append(jam)
    if stand := others_standing_message(env, events):
        parts.append(stand)
    if zone := zones_message(zones):
        parts.append(zone)
    share = explored_share(env.simulation)
    if share is not None:
        parts.append(f"explored {100 * share:.0f} % of the area of the world, insides of obstacles included")
    if sight := sights_message(events):
        parts.append(sight)
    return ("" if driven is None else f"with {driven} for all robots: ") + "; ".join(parts)


def _people_may_overlap(scenario: ResolvedScenario) -> bool:
    """Whether several people move who pass through each other where they collide."""
    people = [
        record
        for record, kind in zip(scenario.objects, kinds_of(scenario.objects), strict=True)
        if kind == HUMAN and not record.static
    ]
    return len(people) > 1 and scenario.world.collision_mode == "unobstructed_obstacles"


def _arrivals_message(robots: list[RobotResult], sim_time: float, parked: Sequence[str]) -> str:
    """Say how many robots arrived and when, and how many of them after a collision."""
    if not robots:
        return f"no robots; {seconds(sim_time)} simulated"
    arrived = [robot.time_to_goal for robot in robots if robot.time_to_goal is not None]
    touched = sum(robot.outcome == "collision" for robot in robots if robot.time_to_goal is not None)
    if len(robots) > 1:
        all_arrived = len(arrived) == len(robots)
        when = f", the last at {seconds(max(arrived))}" if all_arrived else f" within {seconds(sim_time)}"
        share = "all" if touched == len(arrived) else str(touched)
        after = f", {share} of them after a collision" if touched else ""
        still = f", {len(parked)} {'is' if len(parked) == 1 else 'are'} parked" if parked else ""
        return f"{len(arrived)} of {len(robots)} robots arrived{when}{after}{still}"
    if arrived:
        return f"the robot arrived at {seconds(arrived[0])}{', after a collision' * touched}"
    if parked and robots[0].outcome == "timeout":
        return f"the robot is parked; {seconds(sim_time)} simulated"
    if robots[0].outcome == "collision":
        return "the robot collided"  # the message about what it hit says when
    return f"the robot did not arrive within {seconds(sim_time)}"


def _waiting_message(env: Env) -> str | None:
    """Say which objects have not started yet at the end because of their ``start_time``; None if there are none."""
    late = [
        view
        for view in env.objects
        if view.record.start_time and env.simulation.waits(view.row) and not is_absent(env, view)
    ]
    if not late:
        return None
    first = min(view.record.start_time for view in late)
    names = listed([quoted(view.name) for view in late], _MAX_NAMED)
    return f"{names} had not started (start_time {seconds(first)}{' and later' if len(late) > 1 else ''})"


def _departures_message(env: Env, robots: list[RobotResult]) -> str | None:
    """Say which robots arrived but are not at their goal at the end; None if there are none."""
    views = {view.name: view for view in env.robot_list}
    gone = [
        quoted(robot.name)
        for robot in robots
        if robot.outcome == "success" and not views[robot.name].arrive and has_one_end(views[robot.name].record)
    ]
    if len(gone) < 2:
        return f"{gone[0]} left its goal again" if gone else None
    return f"{listed(gone, _MAX_NAMED)} left their goals again"


def has_one_end(record: ObjectRecord) -> bool:
    """Whether an object has a fixed last goal."""
    return not (record.wander or record.loop)


def others_arrived_message(scenario: ResolvedScenario, events: Sequence[Event]) -> str | None:
    """Say how many of the moving obstacles that have a goal arrived; None if there are none.

    Args:
        scenario: The scenario.
        events: Events of the episode.
    """
    walking = {
        record.name
        for record in scenario.objects
        if is_moving_obstacle(record) and record.goals and has_one_end(record)
    }
    if not walking:
        return None
    arrived = walking & {event.object for event in events if event.kind == "arrival"}
    return f"{len(arrived)} of {len(walking)} moving obstacle{'s' * (len(walking) != 1)} arrived"


def others_standing_message(env: Env, events: Sequence[Event]) -> str | None:
    """Say how many moving obstacles stand short of their goal, which one first, and where; None if there are none.

    Obstacles that a collision has stopped do not count: other messages are about them.
    """
    simulation, scenario = env.simulation, env.scenario
    if simulation.objects * (int(simulation.count[0]) + 1) > _MAX_POSES:
        return None
    arrived = {event.object for event in events if event.kind == "arrival"}
    found = []
    for view in env.obstacle_list:
        record = view.record
        if not is_moving_obstacle(record) or not record.goals or view.goal is None:
            continue
        at_its_end = record.name in arrived and has_one_end(record)
        if at_its_end or simulation.stopped[view.row] or simulation.waits(view.row) or is_absent(env, view):
            continue
        track = simulation.state.trajectory(view.row)[:, :2]
        since = no_progress_since(track, env.step_time, view.max_speed)
        if since is not None:
            found.append((int(simulation.count[0]) - len(track) + 1 + since, view))
    if not found:
        return None
    step, view = min(found, key=lambda item: (item[0], item[1].row))
    left = float(np.hypot(*(view.goal[:2, 0] - view.position[:, 0]))) if view.goal is not None else 0.0
    place = f"{left:.2f} m from its goal since {seconds(step * env.step_time)}"
    count = sum(is_moving_obstacle(record) for record in scenario.objects)
    if len(found) == 1:
        return f"the moving obstacle {quoted(view.name)} has stood still {place}"
    first = f"(first {quoted(view.name)}, {place})"
    return f"{len(found)} of {count} moving obstacles stand still short of their goals {first}"


def reason_message(
    env: Env,
    robots: list[RobotResult],
    hits: Sequence[Event],
    between: BetweenSteps,
    events: Sequence[Event],
    source: HorizonSource,
    parked: Sequence[str],
    held: dict[str, Event],
) -> str:
    """Say why an episode failed: contacts between steps, the first collision, and what late robots were doing."""
    if not robots:
        return "there are no robots"
    reasons = list(filter(None, [between_steps_message(env, between, hits)]))
    collided = {robot.name for robot in robots if robot.outcome == "collision"}
    if hit := _first_collision_message(env.scenario, collided, hits):
        others = len(collided) - 1
        reasons.append(hit + (f" (in all {others + 1} robots collided)" if others else ""))
    views = {view.name: view for view in env.robot_list}
    late = [robot for robot in robots if robot.outcome == "timeout" and robot.name not in parked]
    if late:
        shown = late[:_MAX_NAMED]
        states = [f"{quoted(robot.name)} {_state(env, views[robot.name], robot, events, held)}" for robot in shown]
        rest = len(late) - _MAX_NAMED
        more = f" and {rest} more robot{'s' * (rest != 1)}" if rest > 0 else ""
        reasons.append(f"at {seconds(env.sim_time)} ({_LIMIT_SOURCES[source]}) {', '.join(states)}{more}")
    if still := [robot for robot in robots if robot.outcome == "timeout" and robot.name in parked]:
        names = listed([quoted(robot.name) for robot in still], _MAX_NAMED)
        reasons.append(f"{names} {'is' if len(still) == 1 else 'are'} parked (cannot move, no goal written)")
        if not (hit or late):
            reasons.append(f"the run ended at {seconds(env.sim_time)} ({_LIMIT_SOURCES[source]})")
    return "; ".join(reasons)


def first_collision(names: Collection[str], events: Sequence[Event]) -> Event | None:
    """The first collision of one of these objects; None if there was none."""
    return next((e for e in events if e.kind == "collision" and {e.object, str(e.partner)} & set(names)), None)


def _standing_message(env: Env, names: set[str], hits: Sequence[Event]) -> str:
    """Say who has stood still since the first collision stopped them; empty if nobody has."""
    first, rows = first_collision(names, hits), {record.name: k for k, record in enumerate(env.scenario.objects)}
    pair = [] if first is None else [rows[name] for name in (first.object, str(first.partner)) if name in rows]
    held = [
        env.scenario.objects[row].name
        for row in pair
        if env.simulation.stopped[row] and not env.simulation.arrived[row] and not env.scenario.objects[row].static
    ]
    return (
        ""
        if not held
        else ", and both have stood still since"
        if len(held) == 2
        else f", and {quoted(held[0])} has stood still since"
    )


def _first_collision_message(scenario: ResolvedScenario, names: set[str], events: Sequence[Event]) -> str | None:
    first = first_collision(names, events)
    if first is None:
        return None
    place = f"({first.x:.2f}, {first.y:.2f})"
    return (
        f"{called(scenario, first.object)} hit {called(scenario, first.partner)} at {seconds(first.time)} near {place}"
    )


def _state(env: Env, view: ObjectView, robot: RobotResult, events: Sequence[Event], held: dict[str, Event]) -> str:
    """Say what a robot that has not arrived is doing: ``stands still 3.21 m from its goal``."""
    record = view.record
    speed = float(np.linalg.norm(view.velocity_xy))
    standing = min(_MAX_STANDING_SPEED, view.max_speed / 10 or _MAX_STANDING_SPEED)
    place = "without a goal" if robot.distance_to_goal is None else f"{robot.distance_to_goal:.2f} m from its goal"
    if not _is_inside(env, robot):
        place += f", outside the world at ({robot.pose[0]:.2f}, {robot.pose[1]:.2f})"
    no_way = no_way_message(env.simulation, events, robot.name)
    if no_way is not None and speed < standing:
        return f"stands still {place}: {no_way.replace('to its goal', 'to it')}"
    if is_absent(env, view):
        return f"is not in the world yet, {place} ({absence(env, view)})"
    if env.simulation.waits(view.row):
        start = float(env.simulation.start_step[view.row]) * env.step_time
        when = "it starts at" if record.start_time else "its start is delayed to"
        return f"still waits {place} ({when} {seconds(start)})"
    if speed >= standing:
        if circle := _circling_message(env, view, events):
            return f"circles its goal: {circle}"
        if no_progress_since(env.simulation.state.trajectory(view.row)[:, :2], env.step_time, view.max_speed) is None:
            stalled = stalled_step(env, view, events)
            if stalled is not None and no_way is not None:
                return f"hardly moves {place}: {no_way}"
            since = "" if stalled is None else f", hardly nearer than at {seconds(stalled * env.step_time)}"
            return f"still moved at {speed:.2g} m/s, {place}{since}"
        return f"hardly moves {place}" + (f": {no_way}" if no_way else _obstruction_message(env, view, held))
    if record.kinematics is None:
        return f"has no kinematics, so it stands still {place}"
    if record.behavior is None and record.group_behavior is None:
        if not env.scenario.has_written_goal(record):
            return "has no behavior, so it stands still; no goal is written for it"
        return f"has no behavior, so it stands still {place}"
    row = view.row
    if off := heading_message(record, env.simulation.pose[row], env.simulation.state.goal[row]):
        return f"stands still {place}: {off}"
    if back := reverse_message(record, env.simulation.pose[row], env.simulation.state.goal[row]):
        return f"stands still {place}: {back}"
    return f"stands still {place}{_obstruction_message(env, view, held)}"


def _obstruction_message(env: Env, view: ObjectView, held: dict[str, Event]) -> str:
    """Say what is in the way of a robot: an object stopped by a collision, or one that its behavior cannot get around.

    Empty if there is no such object.
    """
    near = find_obstruction(env.simulation, view.row, held)
    if near is None or not (near.held or near.pushed or near.advice):
        return ""
    return f", and {near.message}" + (f" ({near.advice})" if near.advice else "")


def _circling_message(env: Env, view: ObjectView, events: Sequence[Event]) -> str | None:
    """Describe the circle that a robot drives around its goal; None if it does not."""
    if view.goal is None or not has_one_end(view.record):
        return None
    turns = (e.step for e in reversed(events) if e.kind == "waypoint" and e.object == view.name)
    track = env.simulation.state.trajectory(view.row)[next(turns, 0) :, :3]
    circle = find_circling(track, view.goal[:2, 0])
    return None if circle is None else circle.message


def _is_inside(env: Env, robot: RobotResult) -> bool:
    left, low, right, top = env.scenario.world.bounds
    return left <= robot.pose[0] <= right and low <= robot.pose[1] <= top
