"""Robots that creep or drive to and fro without coming nearer to their goal."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from irsim.episodes.stuck import stalled_since
from irsim.simulation.events import Event

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.objects.view import ObjectView

__all__ = ["stalled_step"]


def stalled_step(env: Env, view: ObjectView, events: Iterable[Event]) -> int | None:
    """The step from which a robot hardly came nearer to its goal, up to the end; None if it made progress.

    Args:
        env: The environment after the last step.
        view: The robot.
        events: Events of the episode.
    """
    if view.goal is None or view.record.wander or view.record.loop:
        return None
    track = env.simulation.state.trajectory(view.row)[:, :2]
    offset = int(env.simulation.count[0]) - len(track) + 1  # step of the first row
    turn = max((e.step for e in events if e.kind == "waypoint" and e.object == view.name), default=0)
    begin = max(0, turn - offset)
    since = stalled_since(track[begin:], view.goal[:2, 0], env.step_time, view.max_speed)
    return None if since is None else offset + begin + since
