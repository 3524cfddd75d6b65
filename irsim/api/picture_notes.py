"""What a picture does not show by itself: that its view is moved, or its moment later than the end of the episode."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.simulation.build import steps_until
from irsim.simulation.events import first_collisions, first_events
from irsim.simulation.outcome import robot_outcomes

if TYPE_CHECKING:
    from irsim.env import Env

__all__ = ["ended_before", "extent_of", "moved_view"]


def moved_view(env: Env) -> tuple[float, float, float, float] | None:
    """x_min, x_max, y_min, y_max [m] of a view that ``world.plot.viewpoint`` moves away from the world; else None.

    Args:
        env: The environment at the moment of the picture.
    """
    world = env.scenario.world
    point = world.plot.viewpoint
    if point is None:
        return None
    if isinstance(point, str):
        place = next((view.position[:, 0] for view in env.objects if view.name == point), None)
        if place is None:
            return None
        point = place.tolist()
    x, y = (float(value) for value in point[:2])
    view = (x - world.width / 2, x + world.width / 2, y - world.height / 2, y + world.height / 2)
    left, low, right, top = world.bounds
    return None if view == (left, right, low, top) else view


def extent_of(env: Env) -> tuple[float, float, float, float]:
    """x_min, x_max, y_min, y_max [m] of the world."""
    left, low, right, top = env.scenario.world.bounds
    return left, right, low, top


def ended_before(env: Env) -> int | None:
    """Step in which ``irsim run`` ends the episode, if the environment is beyond it; else None.

    It ends when every robot has arrived or been stopped, or at ``world.time_limit``.

    Args:
        env: The environment at the moment of the picture.
    """
    count, limit, ends = int(env.simulation.count[0]), env.scenario.world.time_limit, list[int]()
    outcomes = robot_outcomes(env.simulation, events=env.events)
    if outcomes and "running" not in outcomes.values():
        arrivals = first_events(env.events, "arrival")
        hits = first_collisions(env.simulation, env.events)
        ends.append(max((arrivals[name] if name in arrivals else hits[name]).step for name in outcomes))
    if limit is not None:
        ends.append(steps_until(limit, env.step_time))
    ended = min(ends, default=count)
    return ended if ended < count else None
