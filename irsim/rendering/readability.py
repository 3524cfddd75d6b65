"""Changes that make a scene legible as a snapshot: one look shows where all objects are and where they go."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from irsim.graphics.scene.bodies import Pose, arrow, bounds, picture_outline, place, point_on
from irsim.graphics.scene.scene import Beams, Geometry, Label, Mark, Region, Scene, Sector, Stroke
from irsim.objects.sensors.lidar import Lidar2D
from irsim.objects.views import views

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.simulation.simulation import Simulation

__all__ = ["can_move", "make_legible"]

MAX_LABELS = 60
"""If there are more labels, the less important ones are left out."""
_SAME_GOAL_SHARE = 0.01
"""Goals closer together than this share of the width of the picture have one common label."""
MAX_JOINED_NAMES = 3
"""A common label lists at most this many names; for more goals it gives only their number."""
_LABEL_GAP_SHARE = 0.01
"""Distance between a label and the thing that it names, as a share of the height of the picture."""
_SMALL_TEXT_PT = 7.0
_OBSTACLE_ALPHA = 0.5
"""Opacity of goals and paths of obstacles, as a share of the same for robots."""
MIN_ARROW_SHARE = 0.025
"""Smallest length of an arrow, as a share of the longer side of the picture."""
_ARROW_EDGE = Stroke("#333333", 0.6)
_PATH_WIDTH_PT = 2.5
MAX_OPAQUE_BEAMS = 60
"""A scan with more beams is drawn paler."""
_BEAM_ALPHA = 0.5
"""Opacity of pale beams, as a share of their usual opacity."""
MIN_SPEED_M_S = 1e-3
"""A slower object counts as stopped [m/s]."""
_FULL_TURN = 2 * math.pi - 0.05
"""A sensor with a larger field of view [rad] sees all around."""
_HOLLOW = ("linestring", "compound")
"""Shapes whose bounding box may be mostly empty, so that their name stands at a point of them."""
_SECTOR_ZORDER = 2.0
_LABEL_ZORDER = 10.0


def make_legible(scene: Scene, simulation: Simulation, world: int) -> None:
    """Change a scene in place so that it is legible as a snapshot.

    - Trajectories become thin lines.
    - Arrows have an edge and a minimum length. Moving objects without a heading get an arrow in the direction of
      their velocity or goal.
    - Obstacles that move show their goals, faintly. Goals of objects that never move are left out.
    - Beams are paler, and sensors with a limited field of view show its outline.
    - Labels are above the things that they name. If there are too many to read, some are left out.

    Args:
        scene: The scene; its extent is the area that the picture shows.
        simulation: The simulation that the scene shows.
        world: Index of the world.
    """
    objects = {view.id: view for view in views(simulation, world)}
    parked = {view.id for view in objects.values() if simulation.scenario.is_parked(view.record)}
    scene.marks = [mark for mark in scene.marks if mark.part != "goal" or mark.object not in parked]
    scene.labels = [label for label in scene.labels if label.part != "goal" or label.object not in parked]
    scene.marks = [_make_mark_legible(mark, objects[mark.object]) for mark in scene.marks if _is_shown(mark, objects)]
    scene.marks += _direction_arrows(scene, objects)
    scene.marks += _sectors(scene, objects)
    min_length = MIN_ARROW_SHARE * max(scene.extent[1] - scene.extent[0], scene.extent[3] - scene.extent[2])
    for mark in scene.marks:
        if mark.part == "arrow" and isinstance(mark.geometry, Region):
            mark.geometry = _lengthen(mark.geometry, min_length)
    scene.beams = [_make_paler(beams) for beams in scene.beams]
    scene.labels = _thin_out(_arrange(scene, objects), objects)


def can_move(view: ObjectView) -> bool:
    """Whether an object may move."""
    return not view.static and view.kinematics is not None


def _is_shown(mark: Mark, objects: dict[int, ObjectView]) -> bool:
    return mark.part != "goal" or objects[mark.object].role == "robot" or can_move(objects[mark.object])


def _make_mark_legible(mark: Mark, view: ObjectView) -> Mark:
    alpha = mark.alpha if view.role == "robot" else mark.alpha * _OBSTACLE_ALPHA
    if mark.part == "goal":
        return replace(mark, alpha=alpha)
    if mark.part == "trajectory" and "traj_width" not in view.record.plot.model_fields_set:
        return replace(mark, alpha=alpha, stroke=replace(mark.stroke, width=_PATH_WIDTH_PT, metric=False))
    if mark.part == "arrow":
        return replace(mark, stroke=_ARROW_EDGE)
    return mark


def _direction_arrows(scene: Scene, objects: dict[int, ObjectView]) -> list[Mark]:
    """Return arrows for moving objects without one: along the velocity, or towards the goal while stopped."""
    with_arrow = {mark.object for mark in scene.marks if mark.part == "arrow"}
    marks = []
    for view in objects.values():
        plot = view.record.plot
        if not can_move(view) or view.id in with_arrow or plot.show_arrow is not None:
            continue
        x, y = view.state[:2, 0].tolist()
        if math.isnan(x):  # it is not in the world yet
            continue
        dx, dy = view.velocity_xy[:2, 0].tolist()
        if math.hypot(dx, dy) < MIN_SPEED_M_S:
            if view.goal is None or view.arrive:
                continue
            dx, dy = view.goal[0, 0] - x, view.goal[1, 0] - y
        pose: Pose = x, y, math.atan2(dy, dx)
        shape = place(arrow(plot.arrow_length, plot.arrow_width), pose)
        zorder = plot.arrow_zorder
        marks.append(Mark(view.id, "arrow", shape, plot.arrow_color, _ARROW_EDGE, plot.arrow_alpha, zorder))
    return marks


def _lengthen(shape: Region, min_length: float) -> Region:
    """Scale an arrow from its start, so that it has at least this length [m]."""
    ring = shape.rings[0]
    start = (ring[0] + ring[-1]) / 2
    length = float(np.hypot(*(ring[3] - start)))
    return shape if not 0 < length < min_length else Region([start + (ring - start) * (min_length / length)])


def _make_paler(beams: Beams) -> Beams:
    """Reduce the opacity of beams, so that bodies, paths and labels stay visible behind them."""
    if beams.colors is not None:
        return replace(beams, colors=beams.colors * (1.0, 1.0, 1.0, _BEAM_ALPHA))
    return replace(beams, alpha=beams.alpha * _BEAM_ALPHA) if len(beams.ends) > MAX_OPAQUE_BEAMS else beams


def _sectors(scene: Scene, objects: dict[int, ObjectView]) -> list[Mark]:
    """Return the outlines of the fields of view of drawn sensors that do not see all around."""
    marks = []
    for beams in scene.beams:
        lidar = objects[beams.object].sensors[beams.sensor]
        if not isinstance(lidar, Lidar2D) or lidar.angle_max - lidar.angle_min > _FULL_TURN:
            continue
        (x, y), theta = beams.origin, float(lidar.scan_origin[2, 0])
        shape = Sector(x, y, lidar.range_max, theta + lidar.angle_min, theta + lidar.angle_max)
        marks.append(Mark(beams.object, "fov", shape, None, Stroke(beams.color, 0.8, style=":"), 0.6, _SECTOR_ZORDER))
    return marks


def _arrange(scene: Scene, objects: dict[int, ObjectView]) -> list[Label]:
    """Return the labels above the things that they name; an object that has arrived shares a label with its goal."""
    x0, x1, y0, y1 = scene.extent
    pictures = {picture.object: picture for picture in scene.pictures}
    labels, by_place = [], dict[tuple[int, int], list[Label]]()
    cell = _SAME_GOAL_SHARE * (x1 - x0)
    for label in scene.labels:
        view = objects[label.object]
        if label.part == "goal" and (view.arrive or not (view.role == "robot" or can_move(view))):
            continue
        shapes: list[Geometry] = [m.geometry for m in scene.of(view.id, "goal" if label.part == "goal" else "body")]
        if not shapes and view.id in pictures:
            shapes = [picture_outline(pictures[view.id])]
        if shapes:
            left, bottom, right, top = bounds(shapes[0])
            left, right, bottom, top = max(left, x0), min(right, x1), max(bottom, y0), min(top, y1)
            if left > right or bottom > top:
                continue
            middle = (left + right) / 2, (bottom + top) / 2
            if label.part == "name" and view.shape in _HOLLOW:
                point = point_on(shapes[0], (x0, y0, x1, y1))
                if point is None:
                    continue
                middle, (left, top) = point, point
                left += _LABEL_GAP_SHARE * (y1 - y0)
            label = replace(label, x=left, y=top + _LABEL_GAP_SHARE * (y1 - y0), anchor=middle, zorder=_LABEL_ZORDER)
        if label.part == "goal" and view.role != "robot":
            label = replace(label, size=min(label.size, _SMALL_TEXT_PT), alpha=label.alpha * _OBSTACLE_ALPHA)
        elif label.part == "goal":
            by_place.setdefault((round(label.x / cell), round(label.y / cell)), []).append(label)
            continue
        elif view.arrive and view.role == "robot" and any(scene.of(view.id, "goal")):
            label = replace(label, text=f"{label.text} at goal")
        labels.append(label)
    return labels + [_join(same_place) for same_place in by_place.values()]


def _join(labels: list[Label]) -> Label:
    """Replace the labels of goals at one place by a single label."""
    names = ", ".join(label.text for label in labels)
    return replace(labels[0], text=names if len(labels) <= MAX_JOINED_NAMES else f"{len(labels)} goals")


def _thin_out(labels: list[Label], objects: dict[int, ObjectView]) -> list[Label]:
    """Leave out labels if there are too many: goals of obstacles first, then obstacles, goals of robots, and all."""
    robots = {label.object for label in labels if objects[label.object].role == "robot"}
    choices = (
        labels,
        [label for label in labels if label.object in robots or label.part == "name"],
        [label for label in labels if label.object in robots],
        [label for label in labels if label.object in robots and label.part == "name"],
    )
    return next((chosen for chosen in choices if len(chosen) <= MAX_LABELS), [])
