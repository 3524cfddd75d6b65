"""Turns a validated scenario into one record per object: spreads lists, applies defaults, assigns ids."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

from pydantic import BaseModel

from irsim.components.maps._grid import MapCells, MapGrid, Walls
from irsim.components.options import KinematicsOptions, behavior_fields
from irsim.components.shapes.circle import Circle
from irsim.diagnostics.diagnostic import Path
from irsim.options.colors import OBSTACLE_COLOR, PUSHABLE_COLOR, ROBOT_COLOR, cycle_color
from irsim.options.registry import DISTRIBUTIONS
from irsim.scenario.model.plot import ObjectPlot
from irsim.scenario.model.scenario import Entry, Scenario, WorldModel
from irsim.scenario.resolve.per_object import kind_of, spread
from irsim.scenario.resolve.resolved import ObjectRecord, Placement, ResolvedScenario

__all__ = ["SPREAD_KEYS", "named", "resolve"]

Role = Literal["robot", "obstacle"]
DEFAULT_STATE = [1.0, 1.0, 0.0]
DEFAULT_GOAL = [1.0, 9.0, 0.0]
DEFAULT_RADIUS = 1.0
NO_GROUP = -1
"""Group of the objects that no entry makes: the map and the walls round the world."""
_STATIC_CONTROLS = 3
"""Control components of an object that never moves, as in IR-SIM."""


def resolve(
    scenario: Scenario,
    *,
    name: str = "world",
    document: dict[str, Any] | None = None,
    source: str | None = None,
    text: str | None = None,
    grid: MapGrid | None = None,
) -> ResolvedScenario:
    """Resolve a scenario: every object gets its own value of every key.

    Robots get their ids first, in file order, then obstacles, then the map if any of its cells is occupied, then the
    walls round the world.

    Args:
        scenario: A validated scenario.
        name: Name of the world unless the scenario gives one.
        document: The scenario as parsed, kept for ``env.config``.
        source: Path of the file, kept.
        text: Text of the file, kept.
        grid: The map.
    """
    objects: list[ObjectRecord] = []
    placements: list[Placement] = []
    first_group = 0
    for role in ("robot", "obstacle"):
        for path, entry in scenario.entries(role):
            group = entry.group
            if group is None:
                group = first_group + int(path[1]) if len(path) > 1 else 0
            made = _Maker(scenario.world, role, path, entry, group, len(objects))
            objects += made.records()
            if (placement := made.placement()) is not None:
                placements.append(placement)
        if objects:
            first_group = max(record.group for record in objects) + 1
    for placement in placements:
        for name, radius in placement.clear_of:
            placement.kept += [(record.id, radius) for record in named(objects, name)]
    if grid is not None and grid.occupied != 0:
        objects.append(_scenery(scenario.world, len(objects), MapCells(grid), f"obstacle_{len(objects)}"))
    if scenario.world.boundary == "walls":
        objects.append(_scenery(scenario.world, len(objects), Walls(scenario.world.bounds), "boundary"))
    return ResolvedScenario(
        name=scenario.world.name or name,
        world=scenario.world,
        objects=objects,
        placements=placements,
        gui=scenario.gui,
        custom=scenario.custom,
        bridges=list(scenario.bridges),
        document=document if document is not None else {},
        source=source,
        text=text,
        grid=grid,
    )


def named(objects: Sequence[ObjectRecord], name: str) -> list[ObjectRecord]:
    """The object of that name or, without one, the members of the group of that name."""
    own = [record for record in objects if record.name == name]
    return own or [record for record in objects if record.group_name == name]


def _scenery(world: WorldModel, object_id: int, shape: MapCells | Walls, name: str) -> ObjectRecord:
    """The record of a static object that no entry makes: the map, or the walls round the world."""
    return ObjectRecord(
        id=object_id,
        role="obstacle",
        name=name,
        group=NO_GROUP,
        group_name=shape.name,
        path=("world", "obstacle_map" if isinstance(shape, MapCells) else "boundary"),
        index=0,
        kinematics=None,
        shape=shape,
        state=[0.0, 0.0, 0.0],
        goals=[],
        velocity=[0.0] * _STATIC_CONTROLS,
        vel_min=[-1.0] * _STATIC_CONTROLS,
        vel_max=[1.0] * _STATIC_CONTROLS,
        acce=[math.inf] * _STATIC_CONTROLS,
        state_dim=3,
        vel_dim=_STATIC_CONTROLS,
        angle_range=(-math.pi, math.pi),
        goal_threshold=0.1,
        arrive_mode="position",
        static=True,
        unobstructed=False,
        behavior=None,
        group_behavior=None,
        wander=False,
        loop=False,
        range_low=[*world.bounds[:2], -math.pi],
        range_high=[*world.bounds[2:], math.pi],
        target_roles="all",
        sensors=[],
        plot=ObjectPlot(),
        color=OBSTACLE_COLOR,
        description=None,
        fov=None,
        fov_radius=None,
        fov_occlusion=False,
        wheelbase=None,
        mass=math.inf,
        friction=world.friction,
        inertia=None,
        restitution=world.restitution,
        drive_tau=0.0,
    )


class _Maker:
    """Makes the objects of one entry."""

    def __init__(self, world: WorldModel, role: Role, path: Path, entry: Entry, group: int, first_id: int) -> None:
        self.world, self.role, self.path, self.entry, self.group = world, role, path, entry, group
        self.first_id, self.count = first_id, entry.number
        self.columns = {key: spread(getattr(entry, key), entry.number, kind_of(key)) for key in SPREAD_KEYS}

    def records(self) -> list[ObjectRecord]:
        """One record per object."""
        placed = self._compute_places()
        return [self._record(i, placed[i] if placed is not None else None) for i in range(self.count)]

    def placement(self) -> Placement | None:
        """The random placement of the entry, if it has one."""
        if not self._is_random() or not self.count:
            return None
        options: Any = self.entry.distribution
        drawn = options.drawn_in(self.world)
        return Placement(
            objects=list(range(self.first_id, self.first_id + self.count)),
            range_low=drawn.low,
            range_high=drawn.high,
            min_distance=drawn.min_distance,
            path=self.path,
            distribution=options.name,
            options=drawn.kernel,
            clear_of=drawn.clear_of,
        )

    def _is_random(self) -> bool:
        options = self.entry.distribution
        if options is None:
            return False
        feature = DISTRIBUTIONS.get(options.name)
        return feature is not None and feature.kernel is not None

    def _compute_places(self) -> list[tuple[list[float], list[float]]] | None:
        """Start and goal of each object where the distribution computes them now."""
        options = self.entry.distribution
        feature = DISTRIBUTIONS.get(options.name) if options is not None else None
        if feature is None or feature.function is None or not self.count:
            return None
        poses: list[tuple[list[float], list[float]]] | None = feature.function(options, self.count, self.world)
        return poses

    def _record(self, i: int, placed: tuple[list[float], list[float]] | None) -> ObjectRecord:
        entry, role, object_id = self.entry, self.role, self.first_id + i
        value = {key: column[i] for key, column in self.columns.items()}
        vanish_time = self._follow_recording(value)
        kinematics = _drive(value["kinematics"])
        shape = value["shape"] if value["shape"] is not None else Circle(radius=DEFAULT_RADIUS)
        state_dim = entry.state_dim or (len(kinematics.state_rows) if kinematics else 3)
        vel_dim = entry.vel_dim or (len(kinematics.control_rows) if kinematics else _STATIC_CONTROLS)
        random = self._is_random()
        state = placed[0] if placed is not None else self.world.center if random else value["state"]
        options = value["behavior"] if value["behavior"] is not None else value["group_behavior"]
        mass = value["mass"]
        angles = value["angle_range"] or [-math.pi, math.pi]
        fov, fov_radius = _view(entry, value["sensors"] or [])
        return ObjectRecord(
            id=object_id,
            role=role,
            name=value["name"] if value["name"] is not None else f"{role}_{object_id}",
            group=self.group,
            group_name=value["group_name"] or f"{role}_{self.group}",
            path=self.path,
            index=i,
            kinematics=kinematics,
            shape=shape,
            state=_with_length(DEFAULT_STATE if state is None else state, state_dim),
            goals=[] if random else self._goals(value, placed),
            velocity=_control(value["velocity"], 0.0, vel_dim, kinematics),
            vel_min=_limit(value["vel_min"], "vel_min", vel_dim, kinematics),
            vel_max=_limit(value["vel_max"], "vel_max", vel_dim, kinematics),
            acce=_control(_usual(value["acce"], "acce", vel_dim, kinematics), math.inf, vel_dim, kinematics),
            state_dim=state_dim,
            vel_dim=vel_dim,
            angle_range=(angles[0], angles[0] + 2 * math.pi) if value["angle_range"] else (-math.pi, math.pi),
            goal_threshold=entry.goal_threshold,
            arrive_mode=value["arrive_mode"],
            static=entry.static or (kinematics is None and not (mass is not None and math.isfinite(mass))),
            unobstructed=entry.unobstructed,
            behavior=value["behavior"],
            group_behavior=value["group_behavior"],
            **behavior_fields(options, self.world.bounds),
            sensors=list(value["sensors"] or []),
            plot=value["plot"],
            color=self._color(i, value, kinematics),
            description=_picture(value["description"], role, kinematics),
            fov=fov,
            fov_radius=fov_radius,
            fov_occlusion=entry.fov_occlusion,
            wheelbase=_wheelbase(kinematics, shape),
            mass=(1.0 if kinematics else math.inf) if mass is None else mass,
            friction=self.world.friction if value["friction"] is None else value["friction"],
            inertia=value["inertia"],
            restitution=self.world.restitution if value["restitution"] is None else value["restitution"],
            drive_tau=self._tau(kinematics),
            actuation=value["actuation"],
            perceives=value["perceives"],
            tags=tuple(value["tags"]),
            watches=entry.fov is not None,
            start_time=value["start_time"],
            appear_time=value["appear_time"],
            vanish_time=vanish_time,
            reflectivity=DEFAULT_REFLECTIVITY if entry.reflectivity is None else entry.reflectivity,
            material=entry.material,
        )

    def _follow_recording(self, value: dict[str, Any]) -> float | None:
        """Fill in what follows from a recording that the object replays; the time of its end, if it vanishes then."""
        options = value["behavior"]
        if getattr(options, "name", None) != "replay" or not options.times:
            return None
        limits = options.limits(self.world.step_time)
        if value["kinematics"] is not None and value["kinematics"].speeds == 2:
            rows = len(value["kinematics"].control_rows)
            value["vel_max"] = value["vel_max"] or limits[:rows]
            value["vel_min"] = value["vel_min"] or [-limit for limit in limits[:rows]]
        value["state"] = value["state"] or options.start
        if value["goal"] is None and value["waypoints"] is None:
            value["goal"] = options.poses[-1]
        if not options.vanish or self.role == "robot":
            return None
        value["appear_time"] = value["appear_time"] or options.times[0]
        return float(options.times[-1])

    def _tau(self, kinematics: KinematicsOptions | None) -> float:
        if kinematics is None:
            return 0.0
        return self.world.drive_tau if kinematics.tau is None else kinematics.tau

    def _goals(self, value: dict[str, Any], placed: tuple[list[float], list[float]] | None) -> list[list[float]]:
        if value["waypoints"] is not None:
            return [list(point) for point in value["waypoints"]]
        goal = value["goal"]
        if goal is None and isinstance(self.entry.goal, list):
            return []  # null in a list of goals: this object has no goal
        if goal is None:
            return [placed[1] if placed is not None else list(DEFAULT_GOAL)]
        return [list(point) for point in goal] if isinstance(goal[0], list) else [list(goal)]

    def _color(self, i: int, value: dict[str, Any], kinematics: KinematicsOptions | None) -> Any:
        color = value["color"]
        if color == "cycle":
            return cycle_color(i)
        if color is not None:
            return color
        if kinematics is None:
            pushable = not self.entry.static and value["mass"] is not None and math.isfinite(value["mass"])
            return PUSHABLE_COLOR if pushable else OBSTACLE_COLOR
        if kinematics.usual_colors is not None:
            return kinematics.usual_colors[self.role == "obstacle"]
        if self.role == "obstacle":
            return OBSTACLE_COLOR
        return ROBOT_COLOR


DEFAULT_REFLECTIVITY = 0.8
"""Share of the light of lidars that a surface throws back: of light plaster and paint."""
SPREAD_KEYS = (
    "name", "tags", "state", "goal", "waypoints", "start_time", "appear_time", "velocity", "kinematics", "shape",
    "behavior", "group_behavior", "sensors", "plot", "color", "description", "vel_min", "vel_max", "acce", "actuation",
    "perceives", "angle_range", "arrive_mode", "group_name", "mass", "friction", "inertia", "restitution",
)  # fmt: skip
"""Keys of an entry that may hold a list with one value per object."""


def _drive(options: Any) -> KinematicsOptions | None:
    return None if options is None or options.name == "static" else options


def _control(values: list[float] | None, default: float, size: int, kinematics: Any) -> list[float]:
    """A vector of control components. Without a drive it is unused, so any length is cut or padded to ``size``."""
    if values is None:
        return [default] * size
    return list(values) if kinematics is not None else (list(values) + [default] * size)[:size]


def _limit(values: list[float] | None, key: Literal["vel_min", "vel_max"], size: int, kinematics: Any) -> list[float]:
    """Limits of the control components; a single number applies to all of them."""
    if values is not None and len(values) == 1:
        return list(values) * size
    return _control(_usual(values, key, size, kinematics), 1.0 if key == "vel_max" else -1.0, size, kinematics)


def _usual(values: list[float] | None, key: str, size: int, kinematics: Any) -> list[float] | None:
    """The values as written, else the default values of the drive, else None."""
    usual: tuple[float, ...] = getattr(kinematics, f"usual_{key}", ())
    return list(usual) if values is None and len(usual) == size else values


def _with_length(values: Sequence[float], length: int) -> list[float]:
    """The values cut, or padded with zeros, to ``length`` numbers."""
    return [*(float(v) for v in values[:length]), *([0.0] * (length - len(values)))]


def _picture(given: str | None, role: Role, kinematics: KinematicsOptions | None) -> str | None:
    return kinematics.picture if given is None and role == "robot" and kinematics is not None else given


def _wheelbase(kinematics: KinematicsOptions | None, shape: BaseModel) -> float | None:
    own = kinematics.wheelbase if kinematics is not None else None
    return own if own is not None else getattr(shape, "wheelbase", None)


def _view(entry: Entry, sensors: Sequence[Any]) -> tuple[float | None, float | None]:
    """Angle and radius of the field of view: the entry's, else the lidar's; a radius without an angle is ignored."""
    lidar = next((sensor for sensor in sensors if getattr(sensor, "is_lidar", False)), None)
    reach = lidar.range_max if lidar is not None else None
    if entry.fov is None:
        return (lidar.angle_range if lidar is not None else None), reach
    return entry.fov, entry.fov_radius if entry.fov_radius is not None else reach
