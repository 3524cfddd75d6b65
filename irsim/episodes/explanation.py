"""How an episode ended, in words: which robots arrived, which did not, and why."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.text import listed, plural, quoted, seconds
from irsim.episodes.between_steps import between_steps_message, others_between_steps_message
from irsim.episodes.facts import EpisodeFacts, first_collision
from irsim.episodes.incidents import (
    absence,
    appearances_message,
    closeness_message,
    contacts_message,
    exits_message,
    is_absent,
    jumps_message,
    nearest_to_goals,
    returns_message,
    shunting_message,
)
from irsim.episodes.obstructions import (
    find_obstruction,
    heading_message,
    is_moving_obstacle,
    jam_message,
    no_way_message,
    reverse_message,
)
from irsim.episodes.progress import find_circling, has_one_end, no_progress_since, stalled_step
from irsim.episodes.rounds import swings_message
from irsim.episodes.scene_summary import called
from irsim.episodes.watching import sights_message, zones_message
from irsim.results.episode import Left, RobotResult, ZoneResult
from irsim.results.run import HorizonSource
from irsim.simulation.events import Event
from irsim.simulation.outcome import is_over, moves_by_itself
from irsim.simulation.roles import name_of_humans

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["others_arrived_message", "reason_message", "summary_message"]

_MAX_NAMED = 3
"""Number of robots that a sentence names."""
_MAX_STANDING_SPEED = 1e-3
"""Speed [m/s] below which a robot stands still; for a very slow robot a tenth of its top speed."""
_LIMIT_SOURCES: dict[HorizonSource, str] = {
    "argument": "from the steps asked for",
    "scenario": "world.time_limit",
    "default": "the default; world.time_limit sets another",
    "limits": "the maximum number of steps of one run here",
}
"""Where the time limit comes from, in words."""


def summary_message(
    facts: EpisodeFacts,
    robots: list[RobotResult],
    driven: str | None,
    left: Sequence[Left],
    zones: Mapping[str, ZoneResult],
    rounds: str | None = None,
) -> str:
    """Say what was touched between steps, which robots arrived, the first collision, and what else happened.

    Args:
        facts: The episode.
        robots: Results of its robots.
        driven: The policy or behavior that drove robots, in words; None if each had its own.
        left: Objects that left the world.
        zones: Results of the zones.
        rounds: Message about robots that patrol or wander; None if there is nothing to say.
    """
    simulation, scenario, jumps = facts.simulation, facts.scenario, facts.incidents.jumps
    names = {robot.name for robot in robots}
    failed = any(robot.outcome != "success" for robot in robots)  # then the reason has the advice
    hit = _first_collision_message(scenario, names, facts.hits)
    pushes = scenario.world.collision_mode == "contact"  # which keeps bodies that push a rounding error apart
    contacts = facts.incidents.human_contacts
    said = bool(facts.jammed) or contacts[:1] == facts.hits[:1]
    share = facts.explored
    hit = hit and hit + _standing_message(facts, names)
    parts = [
        between_steps_message(simulation, facts.between, facts.hits, brief=failed),
        hit if failed else None,  # the cause before what follows from it
        rounds if rounds and len(robots) == 1 else _arrivals_message(facts, robots),
        rounds if len(robots) > 1 else None,
        _waiting_message(facts),
        appearances_message(simulation),
        None if failed else hit,
        exits_message(scenario, left),
        jumps_message(jumps, nearest_to_goals(simulation, jumps)),
        returns_message(facts.incidents.returns, names),
        swings_message(facts),
        _departures_message(facts, robots),
        shunting_message(simulation, robots, facts.parked),
        None if pushes else closeness_message(robots),
        others_arrived_message(scenario, facts.events),
        f"no contacts between {name_of_humans(facts.humans)}" if not contacts and _people_may_overlap(facts) else None,
        contacts_message(contacts, name_of_humans(_humans_in(facts, contacts)), brief=said) if contacts else None,
        others_between_steps_message(facts.between),
        jam_message(simulation, facts.jammed),
        _others_standing_message(facts),
        zones_message(zones),
        None
        if share is None
        else f"explored {100 * share:.0f} % of the area of the world, insides of obstacles included",
        sights_message(facts.events),
    ]
    return ("" if driven is None else f"with {driven}: ") + "; ".join(filter(None, parts))


def _humans_in(facts: EpisodeFacts, contacts: Sequence[Event]) -> list[ObjectRecord]:
    """The humans that take part in contacts."""
    names = {name for event in contacts for name in (event.object, event.partner)}
    return [record for record in facts.humans if record.name in names]


def _people_may_overlap(facts: EpisodeFacts) -> bool:
    """Whether several people move who pass through each other where they collide."""
    people = sum(not record.static for record in facts.humans)
    return people > 1 and facts.scenario.world.collision_mode == "unobstructed_obstacles"


def _arrivals_message(facts: EpisodeFacts, robots: list[RobotResult]) -> str:
    """Say how many robots arrived and when, and how many of them after a collision."""
    sim_time, parked = facts.time, facts.parked
    if not robots:
        idle = not sim_time and not any(map(moves_by_itself, facts.scenario.objects))
        return "no robots, and nothing moves" if idle else f"no robots; {seconds(sim_time)} simulated"
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
        return ""  # the message about what it hit says it all
    return f"the robot did not arrive within {seconds(sim_time)}"


def _waiting_message(facts: EpisodeFacts) -> str | None:
    """Say which objects have not started yet at the end because of their ``start_time``; None if all have."""
    simulation = facts.simulation
    late = [
        record
        for row, record in enumerate(facts.scenario.objects)
        if record.start_time and simulation.is_waiting(row) and not is_absent(simulation, row)
    ]
    if not late:
        return None
    first = min(record.start_time for record in late)
    names = listed([quoted(record.name) for record in late], _MAX_NAMED)
    return f"{names} had not started (start_time {seconds(first)}{' and later' if len(late) > 1 else ''})"


def _departures_message(facts: EpisodeFacts, robots: list[RobotResult]) -> str | None:
    """Say which robots arrived but are not at their goal at the end; None if all are."""
    arrived = {robot.name for robot in robots if robot.outcome == "success"}
    gone = [
        quoted(record.name)
        for row, record in facts.robots.items()
        if record.name in arrived and not facts.simulation.arrived[row] and has_one_end(record)
    ]
    if len(gone) < 2:
        return f"{gone[0]} left its goal again" if gone else None
    return f"{listed(gone, _MAX_NAMED)} left their goals again"


def others_arrived_message(scenario: ResolvedScenario, events: Sequence[Event]) -> str | None:
    """Say how many of the moving obstacles that have a goal arrived; None without such obstacles.

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
    return f"{len(arrived)} of {plural(len(walking), 'moving obstacle')} arrived"


def _others_standing_message(facts: EpisodeFacts) -> str | None:
    """Say how many moving obstacles stand short of their goal, which one first, and where; None if none does.

    Obstacles that a collision has stopped do not count: other messages are about them.
    """
    simulation, records = facts.simulation, facts.scenario.objects
    moving = [row for row, record in enumerate(records) if is_moving_obstacle(record)]
    if not facts.is_small:
        return None
    arrived = {event.object for event in facts.events if event.kind == "arrival"}
    standing = []
    for row in moving:
        record, goals = records[row], simulation.state.goals(row)
        at_its_end = record.name in arrived and has_one_end(record)
        if not record.goals or not goals or at_its_end or simulation.cannot_move(row):
            continue
        track = simulation.state.trajectory(row)[:, :2]
        since = no_progress_since(track, facts.step_time, simulation.views()[row].max_speed)
        if since is not None:
            standing.append((facts.steps - len(track) + 1 + since, row))
    if not standing:
        return None
    step, row = min(standing)
    name, goal = quoted(records[row].name), simulation.state.goals(row)[0]
    left = float(np.hypot(*(goal[:2] - simulation.pose[row, :2])))
    place = f"{left:.2f} m from its goal since {seconds(step * facts.step_time)}"
    if len(standing) == 1:
        return f"the moving obstacle {name} has stood still {place}"
    return f"{len(standing)} of {len(moving)} moving obstacles stand still short of their goals (first {name}, {place})"


def reason_message(facts: EpisodeFacts, robots: list[RobotResult], source: HorizonSource | None) -> str:
    """Say why an episode failed: contacts between steps, the first collision, and what late robots were doing.

    Args:
        facts: The episode.
        robots: Results of its robots.
        source: Where its time limit comes from; None if the first collision ended it before.
    """
    if not robots:
        return "there are no robots"
    reasons = list(filter(None, [between_steps_message(facts.simulation, facts.between, facts.hits)]))
    collided = {robot.name for robot in robots if robot.outcome == "collision"}
    if hit := _first_collision_message(facts.scenario, collided, facts.hits):
        others = len(collided) - 1
        reasons.append(hit + (f" (in all {others + 1} robots collided)" if others else "") + _horizons(facts, collided))
    rows = {record.name: row for row, record in facts.robots.items()}
    limit = f"{seconds(facts.time)}, when the run ended (until: first_collision),"
    if source is not None and is_over(facts.simulation):
        limit = f"{seconds(facts.time)}, when all robots rested,"
    elif source is not None:
        limit = f"the time limit of {seconds(facts.time)} ({_LIMIT_SOURCES[source]})"
    late = [robot for robot in robots if robot.outcome == "timeout" and robot.name not in facts.parked]
    if late:
        shown = late[:_MAX_NAMED]
        states = [f"{quoted(robot.name)} {_state(facts, rows[robot.name], robot)}" for robot in shown]
        rest = len(late) - _MAX_NAMED
        more = f" and {plural(rest, 'more robot')}" if rest > 0 else ""
        reasons.append(f"at {limit} {', '.join(states)}{more}")
    if still := [robot for robot in robots if robot.outcome == "timeout" and robot.name in facts.parked]:
        names = listed([quoted(robot.name) for robot in still], _MAX_NAMED)
        reasons.append(f"{names} {'is' if len(still) == 1 else 'are'} parked (cannot move, no goal written)")
        if not (hit or late):
            reasons.append(f"the run ended at {limit}")
    return "; ".join(reasons)


def _horizons(facts: EpisodeFacts, collided: Collection[str]) -> str:
    """How far ahead the robots of the first collision look, if their behaviors have such horizons; else empty."""
    first = first_collision(collided, facts.hits)
    if first is None or facts.policy is not None:
        return ""
    looks = []
    for record in facts.robots.values():
        options = record.active_behavior
        options = getattr(options, "local", None) or options
        ahead = getattr(options, "timeHorizon", None)
        if ahead is None or record.name not in (first.object, first.partner):
            continue
        still = getattr(options, "timeHorizonObst", ahead)
        static = "" if still == ahead else f", static ones {seconds(still)}"
        looks.append(f"{quoted(record.name)} under {options.name} avoids others {seconds(ahead)} ahead{static}")
    return f" ({'; '.join(looks)}: timeHorizon)" if looks else ""


def _standing_message(facts: EpisodeFacts, names: Collection[str]) -> str:
    """Say which objects have stood still since the first collision stopped them; empty if both move."""
    simulation, first = facts.simulation, first_collision(names, facts.hits)
    rows = {record.name: row for row, record in enumerate(facts.scenario.objects) if not record.static}
    pair = [] if first is None else [name for name in (first.object, str(first.partner)) if name in rows]
    held = [name for name in pair if simulation.stopped[rows[name]] and not simulation.arrived[rows[name]]]
    if facts.scenario.world.collision_mode == "unobstructed_obstacles":  # in which a touch ends
        mine = [name for name in pair if name in names]
        if held:
            return f", and {quoted(held[0])} stands as long as they touch, while obstacles move on"
        return ", stood while they touched, and then went on" if mine else ""
    if len(held) == 2:
        return ", and both have stood still since"
    return f", and {quoted(held[0])} has stood still since" if held else ""


def _first_collision_message(scenario: ResolvedScenario, names: Collection[str], events: Sequence[Event]) -> str | None:
    first = first_collision(names, events)
    if first is None:
        return None
    pair = f"{called(scenario, first.object)} hit {called(scenario, first.partner)}"
    return f"{pair} at {seconds(first.time)}, contact near ({first.x:.2f}, {first.y:.2f})"


def _state(facts: EpisodeFacts, row: int, robot: RobotResult) -> str:
    """Say what a robot that has not arrived is doing: ``stands still 3.21 m from its goal``."""
    simulation, record, view = facts.simulation, facts.robots[row], facts.simulation.views()[row]
    speed = float(np.linalg.norm(view.velocity_xy))
    standing = min(_MAX_STANDING_SPEED, view.max_speed / 10 or _MAX_STANDING_SPEED)
    place = "without a goal" if robot.distance_to_goal is None else f"{robot.distance_to_goal:.2f} m from its goal"
    if record.estimates and simulation.state.believes_arrived[row]:
        return f"rests {place}, where it believes its goal to be"
    x, y, _ = robot.pose
    west, south, east, north = facts.scenario.world.bounds
    if not (west <= x <= east and south <= y <= north):
        place += f", outside the world at ({x:.2f}, {y:.2f})"
    no_way = no_way_message(simulation, facts.events, robot.name)
    if no_way is not None and speed < standing:
        return f"stands still {place}: {no_way.replace('to its goal', 'to it')}"
    if is_absent(simulation, row):
        return f"is not in the world yet, {place} ({absence(simulation, row)})"
    if simulation.is_waiting(row):
        start = float(simulation.start_step[row]) * facts.step_time
        when = "it starts at" if record.start_time else "its start is delayed to"
        return f"still waits {place} ({when} {seconds(start)})"
    if speed >= standing:
        if circle := _circling_message(facts, row):
            return f"circles its goal: {circle}"
        if no_progress_since(simulation.state.trajectory(row)[:, :2], facts.step_time, view.max_speed) is None:
            stalled = stalled_step(simulation, view, facts.events)
            if stalled is not None and no_way is not None:
                return f"hardly moves {place}: {no_way}"
            moved = f"still moved at {speed:.2g} m/s, {place}"
            if stalled is None:
                return moved
            since = f", hardly nearer than at {seconds(stalled * facts.step_time)}"
            return moved + since + _obstruction_message(facts, row)
        return f"hardly moves {place}" + (f": {no_way}" if no_way else _obstruction_message(facts, row))
    if record.kinematics is None:
        return f"has no kinematics, so it stands still {place}"
    if facts.policy is not None:
        if remark := facts.policy.remarks().get(record.id):
            return f"stands still {place}: {remark}"
    elif record.behavior is None and record.group_behavior is None:
        if not facts.scenario.has_written_goal(record):
            return "has no behavior, so it stands still; no goal is written for it"
        return f"has no behavior, so it stands still {place}"
    pose, goal = simulation.pose[row], simulation.state.goal[row]
    if off := heading_message(record, pose, goal) or reverse_message(record, pose, goal):
        return f"stands still {place}: {off}"
    return f"stands still {place}{_obstruction_message(facts, row)}"


def _obstruction_message(facts: EpisodeFacts, row: int) -> str:
    """Say what is in the way of a robot: an object stopped by a collision, or one that its behavior cannot get around.

    Empty if there is no such object.
    """
    near = find_obstruction(facts.simulation, row, facts.jammed)
    if near is None or not (near.held or near.pushed or near.advice):
        return ""
    return f", and {near.message}" + (f" ({near.advice})" if near.advice else "")


def _circling_message(facts: EpisodeFacts, row: int) -> str | None:
    """Describe the circle that a robot drives around its goal; None if it does not."""
    state, record = facts.simulation.state, facts.robots[row]
    goals = state.goals(row)
    if not goals or not has_one_end(record):
        return None
    turns = (e.step for e in reversed(facts.events) if e.kind == "waypoint" and e.object == record.name)
    circle = find_circling(state.trajectory(row)[next(turns, 0) :, :3], np.asarray(goals[0][:2]))
    return None if circle is None else circle.message
