"""Builds the :class:`irsim.graphics.scene.scene.Scene` of one world; it reads the simulation and never writes to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.components.maps._grid import shades
from irsim.graphics.scene.bodies import Body, Pose, arrow, place, read_body
from irsim.graphics.scene.scene import (
    Fog,
    GridImage,
    Label,
    Mark,
    Picture,
    Scene,
    Stroke,
)
from irsim.graphics.scene.style import ObjectStyle, Palette, resolve_style, tint_of
from irsim.graphics.scene.tracks import Track
from irsim.graphics.scene.zones import DrawnZones, draw_zones
from irsim.objects.drawing.object_marks import (
    Tracks,
    goal_shape,
    name_label,
    shape_mark,
    text_label,
    trail_mark,
    trajectory_line,
    view_mark,
    view_sector,
)
from irsim.objects.drawing.signs import shows_motion
from irsim.objects.drawing.visible_sector import visible_sector
from irsim.objects.sensors.contact import Contact2D
from irsim.objects.sensors.drawing import draw_cone, draw_forces, draw_scan
from irsim.objects.sensors.gauge import Gauge
from irsim.objects.sensors.lidar import Lidar2D
from irsim.simulation.fog import FOG_COLOR

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.simulation.simulation import Simulation

__all__ = ["MODES", "SceneBuilder"]

MODES = ("dynamic", "static", "all")
"""Values of ``mode``, which selects the objects to which the overrides of a frame apply."""

_FOG_ZORDER = 2
_GRID_ZORDER = 0.0
WAITING_ALPHA = 0.4
"""Factor of the opacity of an object until its ``start_time``."""
GHOST_ALPHA = 0.15
"""Factor of the opacity of an object that is not in the world yet, where that is drawn at all."""
MIN_ARROW_SPEED = 1e-9
"""Speed [m/s] up to which the arrow of an ``omni`` drive shows the heading of the body."""


@dataclass(slots=True)
class _Drawn:
    """Marks, labels and picture of an object, kept as long as ``key`` does not change.

    Its goal is kept as long as ``goal_key`` does not change.
    """

    key: tuple[Any, ...]
    marks: list[Mark]
    labels: list[Label]
    picture: Picture | None
    goal_key: tuple[Any, ...] = ()
    goal: Mark | None = None


class SceneBuilder:
    """Makes scenes of one world.

    An object that has not changed since the last scene is represented by the identical marks, so that the figure need
    not update them.

    Args:
        simulation: The simulation.
        world: Index of the world.
        palette: Default colours.
        has_picture: Function that returns whether a description image exists; otherwise the body is drawn as a shape.
        ghosts: Draw objects that are not in the world yet, very pale and without an arrow, where they will appear;
            recorded people are left out.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        world: int = 0,
        palette: Palette | None = None,
        has_picture: Callable[[str], bool] | None = None,
        ghosts: bool = False,
    ) -> None:
        self.simulation = simulation
        self.ghosts = ghosts
        self.world = world
        self.palette = palette or Palette()
        self._has_picture = has_picture or (lambda name: False)
        self.reset()

    def reset(self) -> None:
        """Forget shapes, styles and snapshots after objects were added, deleted or reshaped."""
        self._bodies: dict[int, Body] = {}
        self._styles: dict[int, tuple[Any, ObjectStyle]] = {}
        self._drawn: dict[int, _Drawn] = {}
        self._tracks = Tracks(self.simulation.state)
        self._known: tuple[int, int] | None = None  # scene and revision
        self._grids: dict[int, GridImage] = {}
        self._zones: DrawnZones | None = None

    def build(
        self,
        *,
        status: str = "",
        viewpoint: str | Sequence[float] | None = None,
        mode: str = "all",
        overrides: Mapping[str, Any] | None = None,
    ) -> Scene:
        """Build the scene of the present state, with everything in it.

        Args:
            status: Status word for the title.
            viewpoint: Point x, y [m], or name of an object, on which the scene is centred.
            mode: Objects to which ``overrides`` apply: ``dynamic``, ``static`` or ``all``.
            overrides: Plot keys that hold for this scene only.
        """
        scene, tracks = self.frame(status=status, viewpoint=viewpoint, mode=mode, overrides=overrides)
        for track in tracks:
            scene.marks += track.marks()
        return scene

    def frame(
        self,
        *,
        status: str = "",
        viewpoint: str | Sequence[float] | None = None,
        mode: str = "all",
        overrides: Mapping[str, Any] | None = None,
    ) -> tuple[Scene, list[Track]]:
        """Build the scene of the present state without the tracks that only grow, which are returned beside it.

        See :meth:`build` for the arguments.
        """
        simulation = self.simulation
        known = int(simulation.state.scene[self.world]), simulation.revision
        if known != self._known:
            self.reset()
            self._known = known
        world = simulation.scenario.world
        x, y = float(world.offset[0]), float(world.offset[1])
        scene = Scene(
            time=float(simulation.count[self.world]) * float(world.step_time),
            status=status,
            extent=(x, x + float(world.width), y, y + float(world.height)),
            center=None,
            marks=[],
            beams=[],
            labels=[],
            pictures=[],
            fog=self._fog(),
        )
        overrides = overrides or {}
        tracks: list[Track] = []
        objects = simulation.views(self.world)
        poses = simulation.pose[objects[0].row : objects[-1].row + 1].tolist() if objects else []
        goals = simulation.goal[objects[0].row : objects[-1].row + 1].tolist() if objects else []
        for view, pose, goal in zip(objects, poses, goals, strict=True):
            chosen = mode == "all" or (mode == "static") == view.static
            self._add(scene, view, tuple(pose), goal, overrides if chosen else {}, tracks)
        self._add_beams(scene, objects, overrides, mode)
        if isinstance(viewpoint, str):
            scene.center = next(
                ((p[0], p[1]) for v, p in zip(objects, poses, strict=True) if v.name == viewpoint), None
            )
        elif viewpoint is not None:
            scene.center = float(viewpoint[0]), float(viewpoint[1])
        return scene, tracks

    def add_zones(self, scene: Scene) -> None:
        """Add the zones of the world to a scene."""
        if self._zones is None:
            self._zones = draw_zones(self.simulation.scenario.world.zones, self.palette.zone, scene.extent)
        self._zones.add_to(scene)

    # one object ------------------------------------------------------------------------------------------------------
    def body(self, view: ObjectView) -> Body:
        """Return the shape of an object in its body frame."""
        body = self._bodies.get(view.id)
        if body is None:
            body = self._bodies[view.id] = read_body(self.simulation.state, view.row)
        return body

    def style(self, view: ObjectView, overrides: Mapping[str, Any]) -> ObjectStyle:
        """Return the resolved plot keys of an object."""
        key = (view.record.plot, view.color, overrides)
        cached = self._styles.get(view.id)
        if cached is not None and cached[0][0] is key[0] and cached[0][1:] == key[1:]:
            return cached[1]
        body = self.body(view)
        style = resolve_style(
            view.record,
            color=view.color,
            shape=body.kind,
            radius=body.radius,
            width=body.width,
            palette=self.palette,
            overrides=overrides,
        )
        self._styles[view.id] = (view.record.plot, view.color, dict(overrides)), style
        return style

    def _add(
        self,
        scene: Scene,
        view: ObjectView,
        pose: Pose,
        goal: list[float],
        overrides: Mapping[str, Any],
        tracks: list[Track],
    ) -> None:
        if view.record.is_map:
            scene.grids.append(self.grid(view))
            return
        style, absent = self.style(view, overrides), self.simulation.appeared[view.row] < 0
        if absent and not (self.ghosts and self._will_appear(view)):
            return
        if absent:
            x, y, heading = self.simulation.state.initial_state(view.row)[:3].tolist()
            pose = (x, y, heading)
        if self.simulation.is_waiting(view.row):
            pale = GHOST_ALPHA if absent else WAITING_ALPHA
            style = replace(style, obj_alpha=pale * style.obj_alpha)
        if absent:
            style = replace(style, show_arrow=False, show_fov=False, show_goal=style.show_goal and view.role == "robot")
        heading = self.heading_of(view, pose) if style.show_arrow else pose[2]
        body = self.body(view)
        place_of_goal = str(goal) if style.show_goal else ""  # as text, because NaN differs from itself
        key = (style, body, pose, place_of_goal, heading, view.drawing.text, view.drawing.goal_text, view.description)
        drawn = self._drawn.get(view.id)
        if drawn is None or drawn.key != key:
            drawn = _draw(view, body, style, pose, heading, goal, key, self._has_picture, drawn)
            self._drawn[view.id] = drawn
        if style.show_fov and view.fov is not None and view.fov_radius is not None and view.fov_occlusion:
            seen = visible_sector(view, view.fov, view.fov_radius, pose)  # anew in each picture: others move
            scene.marks.append(view_mark(view.id, seen, style))
        scene.marks += drawn.marks
        scene.labels += drawn.labels
        if drawn.picture is not None:
            scene.pictures.append(drawn.picture)
        if not absent and (style.show_trajectory or style.show_trail):
            self._tracks.add(scene, tracks, view.id, view.row, body, style)

    def _will_appear(self, view: ObjectView) -> bool:
        """Whether an object that is not in the world yet has a place that a scenario says: recordings are too many."""
        recorded = view.record.recorded and view.role == "obstacle"
        return bool(self.simulation.state.takes_part[view.row]) and not recorded

    def grid(self, view: ObjectView) -> GridImage:
        """Return the image of a map, which is made once per scene."""
        if view.id not in self._grids:
            grid = self.simulation.scenario.grid
            cells = self.simulation.state.cells(view.row)
            assert grid is not None
            assert cells is not None
            drawn = grid.raster is None
            levels = cells.occupied * np.uint8(100) if drawn else shades(grid.values())
            (x, y), (nx, ny), (dx, dy) = cells.origin, cells.shape, cells.cell
            self._grids[view.id] = GridImage(view.id, levels, (x, x + nx * dx, y, y + ny * dy), _GRID_ZORDER)
        return self._grids[view.id]

    def heading_of(self, view: ObjectView, pose: Pose) -> float:
        """Where an object is heading [rad]: its heading, or the direction of its motion if its drive never turns it."""
        if not shows_motion(view.record):
            return pose[2]
        vx, vy = self.simulation.twist[view.row, :2].tolist()
        return math.atan2(vy, vx) if math.hypot(vx, vy) > MIN_ARROW_SPEED else pose[2]

    def drawn_alone(
        self,
        view: ObjectView,
        overrides: Mapping[str, Any],
        pose: Pose | None = None,
        goal: Sequence[float] | None = None,
    ) -> tuple[list[Mark], list[Label], Picture | None]:
        """Return body, goal, arrow, field of view, labels and image of one object.

        Args:
            view: The object.
            overrides: Plot keys in place of the object's own.
            pose: x, y [m], heading [rad]; by default the present pose.
            goal: x, y [m], heading [rad]; by default the present goal.
        """
        body, style = self.body(view), self.style(view, overrides)
        placed: Pose = tuple(self.simulation.pose[view.row].tolist()) if pose is None else pose
        heading = self.heading_of(view, placed) if pose is None and style.show_arrow else placed[2]
        shown = self.simulation.goal[view.row].tolist() if goal is None else list(goal)
        drawn = _draw(view, body, style, placed, heading, shown, (), self._has_picture)
        return drawn.marks, drawn.labels, drawn.picture

    def path_of(self, view: ObjectView, states: Floats, overrides: Mapping[str, Any]) -> Mark:
        """Return the line through states (N, 3 or more) of an object."""
        return trajectory_line(view.id, self.body(view), self.style(view, overrides), states)

    def trail_mark(self, view: ObjectView, pose: Pose, overrides: Mapping[str, Any]) -> Mark:
        """Return a snapshot of an object at a pose."""
        return trail_mark(view.id, self.body(view), self.style(view, overrides), pose)

    # sensors ---------------------------------------------------------------------------------------------------------
    def _add_beams(self, scene: Scene, objects: Sequence[ObjectView], overrides: Mapping[str, Any], mode: str) -> None:
        for view in objects:
            chosen = mode == "all" or (mode == "static") == view.static
            if self.simulation.appeared[view.row] < 0:
                continue
            if not view.sensors or not self.style(view, overrides if chosen else {}).show_sensor:
                continue
            lidars = ((i, sensor) for i, sensor in enumerate(view.sensors) if isinstance(sensor, Lidar2D))
            scene.beams += [draw_scan(lidar, i) for i, lidar in lidars]
            for i, sensor in enumerate(view.sensors):
                if isinstance(sensor, Contact2D):
                    marks, beams = draw_forces(sensor, i)
                    scene.marks += marks
                    scene.beams += beams
                elif isinstance(sensor, Gauge):
                    scene.marks += draw_cone(sensor)

    def _fog(self) -> Fog | None:
        explored = self.simulation.state.explored[self.world]
        if not explored.size:
            return None
        world = self.simulation.scenario.world
        x, y = float(world.offset[0]), float(world.offset[1])
        extent = x, x + float(world.width), y, y + float(world.height)
        return Fog(explored.astype(bool), extent, FOG_COLOR, 1.0, _FOG_ZORDER)


def _draw(
    view: ObjectView,
    body: Body,
    style: ObjectStyle,
    pose: Pose,
    heading: float,
    goal: list[float],
    key: tuple[Any, ...],
    has_picture: Callable[[str], bool],
    earlier: _Drawn | None = None,
) -> _Drawn:
    """Return all marks, labels and pictures of an object that follow from its pose and goal.

    The mark of a goal that has not changed since ``earlier`` is the same Python object.
    """
    drawn = _Drawn(key, [], [], None, (style, body, str(goal)) if style.show_goal else ())
    marks, number = drawn.marks, view.id
    if style.show_fov and view.fov is not None and view.fov_radius is not None and not view.fov_occlusion:
        marks.append(view_sector(number, view.fov, view.fov_radius, style, pose))
    has_goal = not math.isnan(goal[0])
    if style.show_goal and has_goal:
        if earlier is not None and earlier.goal_key == drawn.goal_key:
            drawn.goal = earlier.goal
        if drawn.goal is None:
            stroke, shape = Stroke(style.goal_color), goal_shape(body, (goal[0], goal[1], goal[2]))
            drawn.goal = shape_mark(
                number, "goal", shape, style.goal_color, stroke, style.goal_alpha, style.goal_zorder
            )
        marks.append(drawn.goal)
    if view.description and body.kind != "compound" and has_picture(view.description):
        area = (*body.low, body.length, body.width)
        drawn.picture = Picture(
            number,
            view.description,
            area,
            pose,
            style.obj_alpha,
            style.image_zorder,
            tint_of(view.record, view.description, style.obj_color),
        )
    else:
        stroke = Stroke(style.obj_color, style.obj_linewidth, style=style.obj_linestyle)
        body_now = place(body.geometry, pose)
        marks.append(shape_mark(number, "body", body_now, style.obj_color, stroke, style.obj_alpha, style.obj_zorder))
    if style.show_arrow:
        pointer = place(arrow(style.arrow_length, style.arrow_width), (pose[0], pose[1], heading))
        color = style.arrow_color
        marks.append(Mark(number, "arrow", pointer, color, Stroke(color), style.arrow_alpha, style.arrow_zorder))
    if style.show_text and view.shape != "walls":  # the walls round the world need no label
        text = view.drawing.label if view.drawing.text is None else view.drawing.text
        drawn.labels.append(name_label(number, text, body, style, pose))
        if style.show_goal and style.show_goal_text and has_goal:
            text = f"G-{view.drawing.label}" if view.drawing.goal_text is None else view.drawing.goal_text
            drawn.labels.append(text_label(number, "goal", goal[0], goal[1], text, style))
    return drawn
