"""What a snapshot draws otherwise than an ordinary picture, so that one look tells who is where and goes where."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from irsim.graphics.scene.bodies import Pose, arrow, bounds, picture_outline, place
from irsim.graphics.scene.scene import Beams, Geometry, Label, Mark, Region, Scene, Sector, Stroke
from irsim.objects.sensors.lidar import Lidar2D
from irsim.objects.view import views

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.simulation.simulation import Simulation

__all__ = ["make_legible"]

_MOST_LABELS = 60
_SAME_PLACE, _MOST_JOINED = 0.01, 3
"""Goals within this share of the picture's width have one label, which names them if they are so few."""
_LABEL_GAP = 0.01
"""Between a label and what it names, as a share of the picture's height."""
_SMALL_TEXT = 7.0
_FAINT = 0.5
"""Opacity of goals and paths of obstacles, as a share of that of robots."""
_ARROW = 0.025
"""Least length of an arrow, as a share of the picture's longer side."""
_ARROW_EDGE = Stroke("#333333", 0.6)
_PATH_WIDTH = 2.5
_MANY_BEAMS = 60
_PALER = 0.5
_MOVING = 1e-3
_FULL_TURN = 2 * math.pi - 0.05
_SECTOR_ZORDER = 2.0
_LABEL_ZORDER = 10.0


def make_legible(scene: Scene, simulation: Simulation, world: int) -> None:
    """Change a scene, made for a snapshot only, in place; its extent is what the picture shows.

    Paths become thin lines, arrows are never tiny and have an edge, what moves without a heading gets one towards
    where it moves or will, obstacles that move show their goals faintly, beams are paler, and sensors that see less
    than a full turn show between which directions. What cannot move and has no goal written shows none. Labels stand
    on what they name; where there are too many to be read, some are left out.
    """
    objects = {view.id: view for view in views(simulation, world)}
    parked = {view.id for view in objects.values() if simulation.scenario.is_parked(view.record)}
    scene.marks = [mark for mark in scene.marks if mark.part != "goal" or mark.object not in parked]
    scene.labels = [label for label in scene.labels if label.part != "goal" or label.object not in parked]
    scene.marks = [_legible(mark, objects[mark.object]) for mark in scene.marks if _is_shown(mark, objects)]
    scene.marks += _directions(scene, objects)
    scene.marks += _sectors(scene, objects)
    least = _ARROW * max(scene.extent[1] - scene.extent[0], scene.extent[3] - scene.extent[2])
    for mark in scene.marks:
        if mark.part == "arrow" and isinstance(mark.geometry, Region):
            mark.geometry = _at_least(mark.geometry, least)
    scene.beams = [_paler(beams) for beams in scene.beams]
    scene.labels = _thinned(_tidy(scene, objects), objects)


def _moves(view: ObjectView) -> bool:
    return not view.static and view.kinematics is not None


def _is_shown(mark: Mark, objects: dict[int, ObjectView]) -> bool:
    return mark.part != "goal" or objects[mark.object].role == "robot" or _moves(objects[mark.object])


def _legible(mark: Mark, view: ObjectView) -> Mark:
    alpha = mark.alpha if view.role == "robot" else mark.alpha * _FAINT
    if mark.part == "goal":
        return replace(mark, alpha=alpha)
    if mark.part == "trajectory" and "traj_width" not in view.record.plot.model_fields_set:
        return replace(mark, alpha=alpha, stroke=replace(mark.stroke, width=_PATH_WIDTH, metric=False))
    if mark.part == "arrow":
        return replace(mark, stroke=_ARROW_EDGE)
    return mark


def _directions(scene: Scene, objects: dict[int, ObjectView]) -> list[Mark]:
    """Arrows for what moves without having a heading: along its velocity, or towards its goal while it stands."""
    pointed = {mark.object for mark in scene.marks if mark.part == "arrow"}
    marks = []
    for view in objects.values():
        plot = view.record.plot
        if not _moves(view) or view.id in pointed or plot.show_arrow is not None:
            continue
        x, y = view.state[:2, 0].tolist()
        dx, dy = view.velocity_xy[:2, 0].tolist()
        if math.hypot(dx, dy) < _MOVING:
            if view.goal is None or view.arrive:
                continue
            dx, dy = view.goal[0, 0] - x, view.goal[1, 0] - y
        pose: Pose = x, y, math.atan2(dy, dx)
        shape = place(arrow(plot.arrow_length, plot.arrow_width), pose)
        zorder = plot.arrow_zorder
        marks.append(Mark(view.id, "arrow", shape, plot.arrow_color, _ARROW_EDGE, plot.arrow_alpha, zorder))
    return marks


def _at_least(shape: Region, length: float) -> Region:
    """An arrow that is at least so long [m], from where it begins."""
    ring = shape.rings[0]
    start = (ring[0] + ring[-1]) / 2
    long = float(np.hypot(*(ring[3] - start)))
    return shape if not 0 < long < length else Region([start + (ring - start) * (length / long)])


def _paler(beams: Beams) -> Beams:
    """Beams that let bodies, paths and labels be seen through them."""
    if beams.colors is not None:
        return replace(beams, colors=beams.colors * (1.0, 1.0, 1.0, _PALER))
    return replace(beams, alpha=beams.alpha * _PALER) if len(beams.ends) > _MANY_BEAMS else beams


def _sectors(scene: Scene, objects: dict[int, ObjectView]) -> list[Mark]:
    """Outlines of what the drawn sensors can see that do not see all round."""
    marks = []
    for beams in scene.beams:
        lidar = objects[beams.object].sensors[beams.sensor]
        if not isinstance(lidar, Lidar2D) or lidar.angle_max - lidar.angle_min > _FULL_TURN:
            continue
        (x, y), theta = beams.origin, float(lidar.lidar_origin[2, 0])
        shape = Sector(x, y, lidar.range_max, theta + lidar.angle_min, theta + lidar.angle_max)
        marks.append(Mark(beams.object, "fov", shape, None, Stroke(beams.color, 0.8, style=":"), 0.6, _SECTOR_ZORDER))
    return marks


def _tidy(scene: Scene, objects: dict[int, ObjectView]) -> list[Label]:
    """Labels on top of what they name; who has arrived gets one for itself and its goal."""
    x0, x1, y0, y1 = scene.extent
    pictures = {picture.object: picture for picture in scene.pictures}
    labels, shared = [], dict[tuple[int, int], list[Label]]()
    near = _SAME_PLACE * (x1 - x0)
    for label in scene.labels:
        view = objects[label.object]
        if label.part == "goal" and (view.arrive or not (view.role == "robot" or _moves(view))):
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
            label = replace(label, x=left, y=top + _LABEL_GAP * (y1 - y0), anchor=middle, zorder=_LABEL_ZORDER)
        if label.part == "goal" and view.role != "robot":
            label = replace(label, size=min(label.size, _SMALL_TEXT), alpha=label.alpha * _FAINT)
        elif label.part == "goal":
            shared.setdefault((round(label.x / near), round(label.y / near)), []).append(label)
            continue
        elif view.arrive and view.role == "robot" and any(scene.of(view.id, "goal")):
            label = replace(label, text=f"{label.text} at goal")
        labels.append(label)
    return labels + [_joined(of_one_place) for of_one_place in shared.values()]


def _joined(labels: list[Label]) -> Label:
    """One label for the goals at one place."""
    some = ", ".join(label.text for label in labels)
    return replace(labels[0], text=some if len(labels) <= _MOST_JOINED else f"{len(labels)} goals")


def _thinned(labels: list[Label], objects: dict[int, ObjectView]) -> list[Label]:
    """Where they are many: without goals of obstacles, or without obstacles, or only names of robots, or none."""
    robots = {label.object for label in labels if objects[label.object].role == "robot"}
    choices = (
        labels,
        [label for label in labels if label.object in robots or label.part == "name"],
        [label for label in labels if label.object in robots],
        [label for label in labels if label.object in robots and label.part == "name"],
    )
    return next((chosen for chosen in choices if len(chosen) <= _MOST_LABELS), [])
