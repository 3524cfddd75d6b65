"""Trajectories and trails of objects; only the states since the last picture are read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from irsim.graphics.scene.bodies import Body
from irsim.graphics.scene.scene import Scene
from irsim.graphics.scene.style import ObjectStyle
from irsim.graphics.scene.tracks import GrowingLine, GrowingTrail, Track
from irsim.objects.drawing.object_marks import trail_mark, trajectory_line, trajectory_points, trajectory_stroke

if TYPE_CHECKING:
    from irsim._core import State

__all__ = ["Tracks"]

_SOLID = ("-", "solid")


@dataclass(slots=True)
class _Kept:
    """What is kept of an object: its line or its trail, with their style and body and the number of states read."""

    style: ObjectStyle
    body: Body
    line: GrowingLine
    trail: GrowingTrail
    line_states: int = 0
    trail_states: int = 0


class Tracks:
    """The tracks of the objects of one scene.

    Args:
        state: Where the states are recorded.
    """

    def __init__(self, state: State) -> None:
        self._state = state
        self._kept: dict[int, _Kept] = {}

    def add(self, scene: Scene, tracks: list[Track], number: int, row: int, body: Body, style: ObjectStyle) -> None:
        """Add trajectory and trail of one object to a scene: to ``tracks`` if they only grow, else to the marks.

        Dashed lines and tracks of limited length do not only grow.
        """
        recorded = self._state.recorded(row)
        kept = self._kept.get(number)
        if (
            kept is None
            or kept.style is not style
            or kept.body is not body
            or max(kept.line_states, kept.trail_states - 1) > recorded
        ):
            kept = self._kept[number] = _new(number, body, style)
        if style.show_trajectory and recorded > 1:
            if style.keep_traj_length or style.traj_style not in _SOLID:
                scene.marks.append(trajectory_line(number, body, style, self._state.trajectory(row)))
            else:
                kept.line.extend(trajectory_points(body, self._state.trajectory(row, kept.line_states)))
                kept.line_states = recorded
                tracks.append(kept.line)
        if style.show_trail:
            self._extend_trail(kept, row, recorded)
            if style.keep_trail_length:
                scene.marks += kept.trail.snapshots[-style.keep_trail_length :]
            else:
                tracks.append(kept.trail)

    def _extend_trail(self, kept: _Kept, row: int, recorded: int) -> None:
        """Add the snapshots of the states since the last call; the first one is of the initial state."""
        every, done = kept.trail.every, kept.trail_states
        if recorded + 1 <= done:
            return
        states = self._state.trajectory(row, max(0, done - 1))[:, :3].tolist()
        if done == 0:
            states.insert(0, self._state.initial_state(row)[:3].tolist())
        for index in range(-(-done // every) * every, recorded + 1, every):
            x, y, theta = states[index - done]
            kept.trail.snapshots.append(trail_mark(kept.trail.object, kept.body, kept.style, (x, y, theta)))
        kept.trail_states = recorded + 1


def _new(number: int, body: Body, style: ObjectStyle) -> _Kept:
    line = GrowingLine(number, trajectory_stroke(body, style), style.traj_alpha, style.traj_zorder)
    trail = GrowingTrail(number, style.trail_zorder, max(1, int(style.trail_freq)))
    return _Kept(style, body, line, trail)
