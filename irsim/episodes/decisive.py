"""The step that decided an episode, and how near objects came to goals that they jumped over."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from irsim.episodes.between_steps import BetweenSteps
from irsim.episodes.explanation import first_collision, has_one_end
from irsim.episodes.stalling import stalled_step
from irsim.episodes.stuck import find_circling, find_obstruction, no_progress_since
from irsim.results.run import RobotResult
from irsim.simulation.events import Event

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.objects.view import ObjectView

__all__ = ["decisive_step", "nearest_to_goals"]

_MAX_ROBOTS = 50
"""Number of robots without success whose trajectories are searched."""


def decisive_step(
    env: Env,
    robots: Sequence[RobotResult],
    hits: Sequence[Event],
    between: BetweenSteps,
    events: Sequence[Event],
    parked: Sequence[str],
    held: Mapping[str, Event],
) -> int | None:
    """Find the step that decided the outcome; None on success, and if late robots moved on until the end.

    Args:
        env: The environment after the last step.
        robots: Results of the robots.
        hits: Collisions of robots.
        between: Contacts between steps.
        events: All events.
        parked: Robots that cannot arrive.
        held: Moving obstacles that a collision has stopped, from :func:`irsim.episodes.stuck.find_jammed`.
    """
    lost = {robot.name for robot in robots if robot.outcome != "success"}
    through = [e.step for e in between.of_robots if e.kind == "passed_through" and lost & {e.object, str(e.partner)}]
    first = first_collision({robot.name for robot in robots if robot.outcome == "collision"}, hits)
    if first is not None:
        return min([first.step, *through])
    if through:
        return through[0]
    late = [robot.name for robot in robots if robot.outcome == "timeout" and robot.name not in parked]
    views = {view.name: view for view in env.robot_list}
    steps = [step for name in late[:_MAX_ROBOTS] if (step := _end_of_progress(env, views[name], events, held))]
    return min(steps, default=None)


def _end_of_progress(env: Env, view: ObjectView, events: Sequence[Event], held: Mapping[str, Event]) -> int | None:
    """The step from which on a robot made no progress; None if it moved on until the end."""
    mine = [event for event in events if event.object == view.name]
    if (no_path := next((event for event in mine if event.kind == "no_path"), None)) is not None:
        return no_path.step
    track, count = env.simulation.state.trajectory(view.row)[:, :3], int(env.simulation.count[0])
    offset = count - len(track) + 1  # step of the first row
    if (since := no_progress_since(track[:, :2], env.step_time, view.max_speed)) is not None:
        near = find_obstruction(env.simulation, view.row, dict(held)) if held else None
        if near is not None and near.held:
            return min(event.step for event in held.values())
        return offset + since
    if (jump := next((event for event in mine if event.kind == "overshoot"), None)) is not None:
        return jump.step
    if view.goal is not None and has_one_end(view.record):
        if (circle := find_circling(track, view.goal[:2, 0])) is not None:
            return offset + circle.since
        return stalled_step(env, view, mine)
    return None


def nearest_to_goals(env: Env, jumps: Mapping[str, Event]) -> dict[str, float]:
    """Least distance [m] of objects to the goal that they jumped over, at any step from then on.

    Args:
        env: The environment after the last step.
        jumps: Name of each object -> its last event ``overshoot``.
    """
    found, count = dict[str, float](), int(env.simulation.count[0])
    for row, record in _rows(env, jumps):
        track = env.simulation.state.trajectory(row)[:, :2]
        start = max(0, jumps[record].step - 2 - (count - len(track)))
        goal = env.simulation.state.goal[row][:2]
        if len(track) > start and not np.isnan(goal).any():
            found[record] = float(np.hypot(*(track[start:] - goal).T).min())
    return found


def _rows(env: Env, names: Mapping[str, Event]) -> Iterable[tuple[int, str]]:
    return ((row, record.name) for row, record in enumerate(env.scenario.objects) if record.name in names)
