"""Marks and labels of one object: body, goal, field of view, texts; its trajectory and snapshots, read as they grow."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.scene.bodies import Body, Pose, bounds, box, ellipse, place, point_on
from irsim.graphics.scene.scene import SOLID, Circle, Geometry, Label, Line, Mark, Scene, Sector, Stroke
from irsim.graphics.scene.style import TEXT_GAP_M, ObjectStyle, default_text_position
from irsim.graphics.scene.tracks import GrowingLine, GrowingTrail, Track

if TYPE_CHECKING:
    from irsim._core import State

__all__ = [
    "Tracks",
    "goal_shape",
    "name_label",
    "shape_mark",
    "text_label",
    "trail_mark",
    "trajectory_line",
    "trajectory_points",
    "trajectory_stroke",
    "view_mark",
    "view_sector",
]


_MIN_GOAL_SHARE = 0.2
"""Least diameter of the disc at a goal without heading, as a share of the longer side of the body."""
MAX_SECTOR_ANGLE = 2 * math.pi - 0.01
"""Angle [rad] of the field of view from which on it is drawn as a circle."""


def shape_mark(
    number: int, part: str, geometry: Geometry, color: Any, stroke: Stroke, alpha: float, zorder: float
) -> Mark:
    """A mark of an object; lines have no fill."""
    return Mark(number, part, geometry, None if isinstance(geometry, Line) else color, stroke, alpha, zorder)


def text_label(number: int, part: str, x: float, y: float, text: str, style: ObjectStyle) -> Label:
    """A text beside a point x, y [m]."""
    dx, dy = style.text_position
    size, alpha = style.text_size, style.text_alpha
    return Label(number, part, x + dx, y + dy, (x, y), str(text), style.text_color, size, alpha, style.text_zorder)


def name_label(number: int, text: str, body: Body, style: ObjectStyle, pose: Pose) -> Label:
    """The name of an object, above its body, of which the pose may lie anywhere; a circle's is beside its centre."""
    if body.kind == "circle" or style.text_position != default_text_position(body.radius):
        return text_label(number, "name", pose[0], pose[1], text, style)
    shape = place(body.geometry, pose)
    if body.kind in ("linestring", "compound"):
        x, y = point_on(shape) or pose[:2]
        label = text_label(number, "name", x, y, text, style)
        label.x, label.y = x + TEXT_GAP_M, y + TEXT_GAP_M
        return label
    left, bottom, right, top = bounds(shape)
    label = text_label(number, "name", (left + right) / 2, (bottom + top) / 2, text, style)
    label.x, label.y = left, top + TEXT_GAP_M
    return label


def view_sector(number: int, angle: float, radius: float, style: ObjectStyle, pose: Pose) -> Mark:
    """The field of view of an opening angle [rad] and a radius [m]."""
    x, y, theta = pose
    shape: Geometry = Circle(x, y, radius)
    if angle < MAX_SECTOR_ANGLE:
        shape = Sector(x, y, radius, theta - angle / 2, theta + angle / 2)
    return view_mark(number, shape, style)


def view_mark(number: int, shape: Geometry, style: ObjectStyle) -> Mark:
    """A field of view of any outline."""
    return Mark(number, "fov", shape, style.fov_color, Stroke(style.fov_edge_color), style.fov_alpha, style.fov_zorder)


def goal_shape(body: Body, goal: Pose) -> Geometry:
    """The body at its goal; a disc about the goal for a body that may arrive with any heading (NaN)."""
    x, y, heading = goal
    centred = body.kind == "circle" and body.middle == (0.0, 0.0)
    if centred or not math.isnan(heading):
        return place(body.geometry, (x, y, 0.0 if math.isnan(heading) else heading))
    return Circle(x, y, max(min(body.length, body.width), _MIN_GOAL_SHARE * max(body.length, body.width)) / 2)


def trajectory_line(number: int, body: Body, style: ObjectStyle, states: Floats) -> Mark:
    """The line through the latest of (T, 3 or more) states."""
    kept = states[-int(style.keep_traj_length) :] if style.keep_traj_length else states
    stroke, line = trajectory_stroke(body, style), Line(trajectory_points(body, kept))
    return Mark(number, "trajectory", line, None, stroke, style.traj_alpha, style.traj_zorder)


def trajectory_points(body: Body, states: Floats) -> Floats:
    """The (T, 2) points of a trajectory, which runs along the middle of the body."""
    points = np.array(states[:, :2])
    if body.kind == "compound" and body.middle[1]:
        points += np.stack([-np.sin(states[:, 2]), np.cos(states[:, 2])], axis=1) * body.middle[1]
    return points


def trajectory_stroke(body: Body, style: ObjectStyle) -> Stroke:
    """The stroke of a trajectory, which is as wide as the body unless the style says otherwise."""
    return Stroke(
        style.traj_color,
        float(style.traj_width),
        metric=True,
        style=style.traj_style,
        round_caps=body.kind == "circle",
    )


def trail_mark(number: int, body: Body, style: ObjectStyle, pose: Pose) -> Mark:
    """A snapshot of a body at a pose."""
    shape = _trail_shape(body, style.trail_type)
    fill = style.trail_color if style.trail_fill and not isinstance(shape, Line) else None
    stroke = Stroke(style.trail_edgecolor, style.trail_linewidth)
    return Mark(number, "trail", place(shape, pose), fill, stroke, style.trail_alpha, style.trail_zorder)


def _trail_shape(body: Body, kind: str) -> Geometry:
    if kind == "ellipse":
        return ellipse(body)
    if kind == "rectangle" and body.kind != "polygon":
        return box(body)
    if kind == "circle" and body.kind != "circle":
        return Circle(*body.middle, body.radius)
    return body.geometry


@dataclass(slots=True)
class _Kept:
    """Kept for an object: its line or its trail, with their style and body and the number of states read."""

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
            if style.keep_traj_length or style.traj_style not in SOLID:
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
