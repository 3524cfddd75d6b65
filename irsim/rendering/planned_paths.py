"""The paths of robots to their goals, with the least distance of the footprint along them; the overlay plan."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from shapely.affinity import affine_transform

from irsim.common.arrays import Floats
from irsim.graphics.scene.scene import Label, Line, Mark, Scene, Stroke
from irsim.graphics.scene.style import Color
from irsim.navigation.clearances import standing_distance
from irsim.navigation.geodesic import Geodesics, inscribed_radius
from irsim.objects.views import views
from irsim.rendering.clearance_map import FreeSpace

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["PathMargin", "PlannedPath", "draw_plans", "path_margin", "plan_paths", "poses_along", "remaining_goals"]


MAX_LEGS = 40
"""Number of legs (paths to one goal) after which no further robot is planned for."""
MIN_RADIUS_M = 0.01
"""Smallest radius [m] of a robot that paths are planned for."""
_CLEARANCE_TOLERANCE_M = 2e-3
"""A goal counts as free for a disc whose radius exceeds the clearance of the goal by less than this [m]."""
_LINE_WIDTH_PT = 1.4
_OUTLINE_WIDTH_PT = 1.0
_ALPHA = 0.9
_ZORDER = 2.5
_DASHES = (0, (5, 2.5))
_NO_PATH_COLOR = "#e03131"
_NO_PATH_DASHES = (0, (1, 2))
_DEFAULT_COLOR = "#333333"
_TEXT_SIZE_PT = 8.0
_TEXT_ZORDER = 10.0


@dataclass(frozen=True, eq=False)
class PlannedPath:
    """The path of one robot through its goals.

    Attributes:
        robot: Id of the robot.
        name: Name of the robot.
        points: (K, 2) corners of the path, from the present position to the last goal that can be reached [m].
        own: Whether the behavior of the robot has planned the path, at least to the present goal.
        own_points: Number of corners of that part of the path.
        lost: First goal that cannot be reached; None if all goals can be reached.
        margin: Where along the path the footprint of the robot is nearest to something that stands.
        outlines: (M, 2) outlines of the footprint there, and of the footprint enlarged by the margin; none if round.
    """

    robot: int
    name: str
    points: Floats
    own: bool
    own_points: int
    lost: tuple[float, float] | None
    margin: PathMargin
    outlines: tuple[Floats, ...]

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum())


def plan_paths(
    simulation: Simulation, world: int = 0, routes: Mapping[int, Sequence[Floats | None]] | None = None
) -> list[PlannedPath]:
    """Plan the paths of the robots that are there and have not arrived, until there are `MAX_LEGS` legs.

    Args:
        simulation: The simulation, at its present state.
        world: Index of the world.
        routes: Robot id -> paths that the behavior of the robot plans to its first goals, one after the other, or None
            where the behavior finds no path.
    """
    legs_left, geodesics = MAX_LEGS, Geodesics(simulation, world)
    spaces: dict[float, FreeSpace] = {}
    paths: list[PlannedPath] = []
    for view in _robots(simulation, world):
        if view.goal is None or view.arrive or legs_left <= 0:
            continue
        inner = max(inscribed_radius(simulation, view.row), MIN_RADIUS_M)
        if inner not in spaces:
            spaces[inner] = _free_space(simulation, world, inner)
        paths.append(_plan_path(simulation, view, geodesics, spaces[inner], inner, routes or {}))
        legs_left -= len(remaining_goals(view))
    return paths


def _plan_path(
    simulation: Simulation,
    view: ObjectView,
    geodesics: Geodesics,
    space: FreeSpace,
    inner: float,
    routes: Mapping[int, Sequence[Floats | None]],
) -> PlannedPath:
    outer = max(float(simulation.radius[view.row]), inner)
    points, lost, own = [view.state[:2, 0][None]], None, 0
    for number, goal in enumerate(remaining_goals(view)):
        start = points[-1][-1]
        planned = routes.get(view.id, ())
        if number < len(planned):
            leg = planned[number]
        else:
            leg = _shortest_path(geodesics, space, start, goal, (outer, inner))
            if leg is None or not _is_free(space, leg, inner):  # the shortest path knows no standing people
                leg = space.path(start, goal, inner, view.record.goal_threshold)
        if leg is None:
            lost = float(goal[0]), float(goal[1])
            break
        points.append(np.asarray(leg)[:, :2])
        own += len(leg) if number < len(planned) else 0
    line = np.concatenate(points if len(points) == 1 else points[1:])
    margin = path_margin(simulation, view, line, space)
    return PlannedPath(view.id, view.name, line, view.id in routes, own, lost, margin, _outlines(view, margin))


def _outlines(view: ObjectView, margin: PathMargin) -> tuple[Floats, ...]:
    """Return the footprint at the least margin, and its outline enlarged by that margin; nothing for a round robot."""
    if margin.nearest is None or getattr(view.record.shape, "name", "") == "circle":
        return ()
    x, y, heading = margin.pose
    cos, sin = math.cos(heading), math.sin(heading)
    body = affine_transform(view.body.original_geometry, (cos, -sin, sin, cos, x, y))
    areas = [body, body.buffer(margin.distance)] if margin.distance > 0 else [body]
    return tuple(np.asarray(area.exterior.coords) for area in areas if area.geom_type == "Polygon")


def _shortest_path(
    geodesics: Geodesics, space: FreeSpace, start: Floats, goal: Floats, radii: tuple[float, float]
) -> Floats | None:
    """Return the shortest path of a disc with the first radius for which a path exists, or None."""
    clearance = space.exact_distance((float(goal[0]), float(goal[1])))
    for radius in dict.fromkeys(radii):
        if clearance <= radius - _CLEARANCE_TOLERANCE_M:
            continue
        path = geodesics.path(start, goal, radius, coarse=True)
        if path is not None:
            return np.concatenate([[start], path[1:-1], [goal]])  # its ends are only the centres of cells
    return None


def _is_free(space: FreeSpace, path: Floats, radius: float) -> bool:
    """Whether a disc can move along a path, within the accuracy of the cells."""
    distances = space.distance_at(_densify(np.asarray(path)[:, :2], space.half_diagonal))
    return bool(distances.min() >= radius - 2 * space.half_diagonal)


def draw_plans(scene: Scene, paths: Sequence[PlannedPath]) -> None:
    """Add paths to a scene: solid where the behavior of the robot has planned them, dashed elsewhere.

    The footprint of a robot that is not round is outlined where its margin is least, and round it a dotted outline at
    the distance of that margin. A dotted straight line leads to a goal that cannot be reached; the goal is labelled
    "no path".

    Args:
        scene: Scene to add to.
        paths: Paths to add.
    """
    for path in paths:
        color = _color_of(scene, path.robot)
        own = path.own_points
        if own > 1:
            stroke = Stroke(color, _LINE_WIDTH_PT)
            scene.marks.append(Mark(path.robot, "plan", Line(path.points[:own]), None, stroke, _ALPHA, _ZORDER))
        rest = path.points[max(own - 1, 0) :]
        if len(rest) > 1:
            stroke = Stroke(color, _LINE_WIDTH_PT, style=_DASHES)
            scene.marks.append(Mark(path.robot, "plan", Line(rest), None, stroke, _ALPHA, _ZORDER))
        for outline, style in zip(path.outlines, ("-", _NO_PATH_DASHES), strict=False):
            stroke = Stroke(color, _OUTLINE_WIDTH_PT, style=style)
            scene.marks.append(Mark(path.robot, "plan", Line(outline), None, stroke, _ALPHA, _ZORDER))
        if path.lost is not None:
            line = np.array([path.points[-1], path.lost])
            stroke = Stroke(_NO_PATH_COLOR, _LINE_WIDTH_PT, style=_NO_PATH_DASHES)
            scene.marks.append(Mark(path.robot, "plan", Line(line), None, stroke, 1.0, _ZORDER))
            x, y = path.lost
            anchor = x, y
            label = Label(path.robot, "plan", x, y, anchor, "no path", _NO_PATH_COLOR, _TEXT_SIZE_PT, 1.0, _TEXT_ZORDER)
            scene.labels.append(label)


def _color_of(scene: Scene, robot: int) -> Color:
    """Return the colour in which a robot is drawn."""
    colors = [mark.fill for mark in scene.of(robot, "body")]
    colors += [picture.tint for picture in scene.pictures if picture.object == robot]
    return next((color for color in colors if color is not None), _DEFAULT_COLOR)


def remaining_goals(view: ObjectView) -> list[Floats]:
    """Return the positions (2,) of the present goal and the goals after it."""
    goals = [np.asarray(goal)[:2, 0] for goal in view.goals]
    assert view.goal is not None
    present = np.asarray(view.goal)[:2, 0]
    index = next((i for i, goal in enumerate(goals) if np.array_equal(goal, present)), None)
    return [present] if index is None else goals[index:]


def _robots(simulation: Simulation, world: int) -> list[ObjectView]:
    """Return the robots that are in the world; those with an ``appear_time`` are not there before."""
    return [view for view in views(simulation, world) if view.role == "robot" and simulation.appeared[view.row] >= 0]


def _free_space(simulation: Simulation, world: int, radius: float) -> FreeSpace:
    """Return the free space of the world, enlarged to contain all robots and their goals."""
    x0, y0, x1, y1 = simulation.scenario.world.bounds
    robots = _robots(simulation, world)
    positions = [view.state[:2, 0] for view in robots] + [
        goal for view in robots if view.goal is not None for goal in remaining_goals(view)
    ]
    points = np.array([(x0, y0), (x1, y1), *positions])
    (left, low), (right, top) = points.min(axis=0), points.max(axis=0)
    return FreeSpace(simulation, world, (float(left), float(low), float(right), float(top)), radius)


def _densify(line: Floats, step: float) -> Floats:
    """Return points along a line, at most ``step`` apart [m]."""
    pieces = [line[:1]]
    for a, b in itertools.pairwise(line):
        count = max(1, int(np.hypot(*(b - a)) / step))
        pieces.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.concatenate(pieces)


_MAX_TURN_RAD = 0.1
"""Largest difference between two headings of the footprint at a corner of the path [rad]."""
_MAX_STEERING_RAD = 1.5
"""Largest steering angle of a car that counts [rad]."""
_TOUCHING_M = 1e-3
"""Overlaps up to this depth count as a margin of 0 [m]."""
_MAX_POSES = 4000
"""Largest number of poses at which the footprint is placed."""


class PathMargin(NamedTuple):
    """Where along a path a robot comes nearest to something that stands.

    Attributes:
        distance: Distance between the footprints [m], negative where they overlap; infinity if nothing stands.
        pose: x, y [m] and heading [rad] of the robot there.
        nearest: Name of the other object; None if nothing stands.
    """

    distance: float
    pose: tuple[float, float, float]
    nearest: str | None


def path_margin(simulation: Simulation, view: ObjectView, line: Floats, space: FreeSpace) -> PathMargin:
    """Place the footprint of a robot along a path and find where it is nearest to something that stands.

    The footprint points along the path, except that drives which move in any direction keep their present heading.
    At corners other drives turn on the spot, and a car turns on its smallest circle. The path counts up to
    the place where its last goal is reached; a robot that cannot move has only its present place.

    Args:
        simulation: The simulation, at its present state.
        view: The robot.
        line: (K, 2) corners of the path [m].
        space: Distances to everything that stands.
    """
    poses = poses_along(view, line, space.half_diagonal)
    away = np.hypot(*(poses[:, :2] - line[-1]).T)
    outside = np.flatnonzero(away > view.record.goal_threshold)
    poses = poses[: 1 if view.record.static or not outside.size else int(outside[-1]) + 1]
    distances = space.distance_at(poses[:, :2])
    first = float(poses[0, 0]), float(poses[0, 1]), float(poses[0, 2])
    if not math.isfinite(float(distances.min())):
        return PathMargin(math.inf, first, None)
    reach = 2 * float(simulation.radius[view.row]) + 2 * space.half_diagonal
    poses = poses[distances <= distances.min() + reach]
    poses = poses[:: math.ceil(len(poses) / _MAX_POSES)]
    clearances, partners = standing_distance(simulation, view, poses)
    if np.isnan(clearances).all():
        return PathMargin(math.inf, first, None)
    best = int(np.nanargmin(clearances))
    x, y, heading = poses[best].tolist()
    distance = 0.0 if -_TOUCHING_M < clearances[best] <= 0 else float(clearances[best])
    return PathMargin(distance, (x, y, heading), simulation.scenario.objects[int(partners[best])].name)


def poses_along(view: ObjectView, line: Floats, step: float) -> Floats:
    """Return the (P, 3) poses of a robot along a path, at most ``step`` apart [m]."""
    drive: Any = view.record.kinematics
    heading = float(view.state[2, 0])
    poses = [(float(line[0, 0]), float(line[0, 1]), heading)]
    for a, b in itertools.pairwise(line):
        length = float(np.hypot(*(b - a)))
        if length == 0:
            continue
        ahead = heading if getattr(drive, "speeds", 0) == 2 else math.atan2(b[1] - a[1], b[0] - a[0])
        turn = math.remainder(ahead - heading, math.tau)
        turns = max(1, math.ceil(abs(turn) / _MAX_TURN_RAD))
        poses += [(a[0], a[1], heading + turn * k / turns) for k in range(1, turns)]
        count = max(1, math.ceil(length / step))
        poses += [(*(a + (b - a) * (k / count)), ahead) for k in range(1, count + 1)]
        heading = ahead
    result = np.asarray(poses, dtype=np.float64)
    return _turned_slowly(result, view.record) if getattr(drive, "steered", False) else result


def _turned_slowly(poses: Floats, record: ObjectRecord) -> Floats:
    """Let the heading of a car follow the direction of its path no faster than its smallest turning circle allows.

    The car turns half before and half after a corner: headings are the mean of two passes, ahead and back.
    """
    wheelbase, steering = record.wheelbase or 0.0, min(record.vel_max[1], _MAX_STEERING_RAD)
    curvature = math.tan(steering) / wheelbase if wheelbase > 0 else math.inf
    ahead = _limited(poses, poses[0, 2], curvature)
    back = _limited(poses[::-1], ahead[-1], curvature)[::-1]
    return np.column_stack([poses[:, :2], ahead + np.remainder(back - ahead + np.pi, math.tau) / 2 - np.pi / 2])


def _limited(poses: Floats, heading: float, curvature: float) -> Floats:
    """Headings that follow the headings of poses, from a first one on, by at most a curvature [1/m]."""
    moved = np.hypot(*np.diff(poses[:, :2], axis=0).T).tolist()
    headings = [heading]
    for wanted, length in zip(poses[1:, 2].tolist(), moved, strict=True):
        most = length * curvature if length > 0 else 0.0
        headings.append(headings[-1] + max(-most, min(most, math.remainder(wanted - headings[-1], math.tau))))
    return np.asarray(headings, dtype=np.float64)
