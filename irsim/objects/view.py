"""Objects as scripts see them: a view holds the simulation and an id; every read is a fresh copy of its row."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from irsim.objects.avoidance import ObjectAvoidance
from irsim.objects.drawing.by_hand import ObjectDrawing
from irsim.objects.dynamics import ObjectMatter
from irsim.objects.extensions.hooks import ObjectHooks
from irsim.objects.geometry import ObjectBody, column
from irsim.objects.info import ObjectInfo, ObstacleInfo
from irsim.objects.sensors.contact import Contact2D
from irsim.objects.sensors.lidar import Lidar2D
from irsim.objects.sensors.sensors import attach_sensors, sensors_of
from irsim.objects.setters import HINTS, SETTINGS, BehaviorKeys, FixedList, behavior_keys, change, refuse
from irsim.objects.status import ObjectStatus

if TYPE_CHECKING:
    from irsim.components.kinematics._handler import KinematicsHandler
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["ObjectView", "set_views", "views"]

Floats = NDArray[np.float64]


class ObjectView(ObjectBody, ObjectHooks, ObjectMatter, ObjectStatus, ObjectAvoidance, ObjectDrawing):
    """One robot or obstacle.

    Arrays are columns, (n, 1), read-only snapshots: keep them as long as you like, write through ``set_state``,
    ``set_velocity`` and ``set_goal``.

    Attributes:
        id: Number in its environment, its own for ever.
        record: Its resolved scenario entry.
        world: World index in a batch.
        index: Place among the objects of its world, which changes when earlier ones are taken out.
        row: Row in the simulation's arrays.
        surroundings: The objects of the environment an object was made for, as long as it is not added.
    """

    record: ObjectRecord
    id: int
    name: str
    role: Literal["robot", "obstacle"]
    group: int
    group_name: str
    color: Any
    description: str | None
    static: bool
    unobstructed: bool
    goal_threshold: float
    arrive_mode: Literal["position", "state"]
    fov: float | None
    fov_radius: float | None
    fov_occlusion: bool
    wander: bool
    loop: bool
    tags: tuple[str, ...]
    state_dim: int
    vel_dim: int
    state_shape: tuple[int, int]
    vel_shape: tuple[int, int]
    wheelbase: float | None
    sensors: list[Any]
    lidar: Lidar2D | None

    _simulation: Simulation
    index: int
    world: int
    row: int
    _pose: Floats
    _pose_column: Floats

    def __init__(self, simulation: Simulation, index: int, world: int = 0) -> None:
        record = simulation.scenario.objects[index]
        self.describe(record)
        self.surroundings: Sequence[ObjectView] | None = None
        self.text: str | None = None
        self.goal_text: str | None = None
        self._plain = record.state_dim == 3
        own = self.__dict__
        own["sensors"] = []
        self.attach(simulation, index, world)
        self.contact = Contact2D(self, _contact_options(record.sensors))
        own["sensors"] = FixedList(sensors_of(simulation, self), f"`sensors` of {self.name!r}", HINTS["sensors"])
        own["lidar"] = next((s for s in self.sensors if isinstance(s, Lidar2D)), None)

    def describe(self, record: ObjectRecord) -> None:
        """Show this record from now on; what scripts may set of it goes through :mod:`irsim.objects.setters`."""
        self.record = record
        own = self.__dict__
        for name in _SHOWN:
            own[name] = getattr(record, name)
        own["state_shape"], own["vel_shape"] = (record.state_dim, 1), (record.vel_dim, 1)
        own["wheelbase"] = getattr(record.shape, "wheelbase", None)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in SETTINGS:
            change(self, name, value)
        elif name in _FIXED:
            refuse(repr(self.name), name, HINTS.get(name, "it can only be read"))
        else:
            object.__setattr__(self, name, value)

    def amend(self, record: ObjectRecord) -> None:
        """Go on with another record; see :func:`irsim.objects.lifecycle.amend`."""
        from irsim.objects.lifecycle import amend

        amend(self, record)

    def renumber(self, number: int) -> None:
        """Another id, for an object that is alone; an automatic name follows."""
        record = self.record
        name = f"{record.role}_{number}" if record.name == f"{record.role}_{record.id}" else record.name
        scenario = replace(self._simulation.scenario, objects=[replace(record, id=number, name=name)])
        self.__dict__.update(id=number, name=name)
        self._simulation.exchange(scenario, [(self._simulation, 0)])
        set_views(self._simulation, [self])

    def attach(self, simulation: Simulation, index: int, world: int = 0) -> None:
        """Look at another place from now on: rows move when objects come and go."""
        own, row = self.__dict__, world * simulation.objects + index  # without __setattr__: many do this at once
        own["_simulation"], own["index"], own["world"], own["row"] = simulation, index, world, row
        own["_pose"], own["_pose_column"] = simulation.pose[row], simulation.pose[row, :, None]
        if self.sensors:
            attach_sensors(simulation, self)
        self._take_part()

    @property
    def _handler(self) -> KinematicsHandler | None:
        """The drive, where a user wrote it."""
        drives = self._simulation.drives
        return None if drives is None else drives.handler(self.row)

    @property
    def kf(self) -> KinematicsHandler:
        """The drive: constructed by the engine where a user wrote it, else one that computes the same."""
        if (handler := self._handler) is not None:
            return handler
        from irsim.objects.handlers.kinematics import KinematicsFactory

        options: Any = self.record.kinematics
        if options is None:
            return KinematicsFactory.create_kinematics("static")
        return KinematicsFactory.create_kinematics(
            options.name, options.noise, options.alpha, options.mode, self.record.wheelbase, self.role, options.tau
        )

    @property
    def gf(self) -> Any:
        """The shape as a handler, where it stands now."""
        from irsim.objects.handlers.geometry import handler_of

        return handler_of(self)

    @property
    def obj_behavior(self) -> Any:
        """Its behavior as an object that can be asked."""
        from irsim.objects.handlers.behavior import Behavior

        if "_behavior" not in self.__dict__:
            made = self.__dict__["_behavior"] = Behavior(self.info, self.beh_config)
            made.follow(self.beh_config)
        return self.__dict__["_behavior"]

    # state -----------------------------------------------------------------------------------------------------------
    @property
    def state(self) -> Floats:
        """(3 or more, 1) x, y [m], heading [rad], then extra rows (steering angle of Ackermann drives)."""
        if self._plain:
            state = self._pose_column.copy()
        else:
            extra = self._simulation.extra[self.row, : self.state_dim - 3]
            state = np.concatenate([self._pose, extra])[:, None]
        state.setflags(write=False)
        return state

    @property
    def _state(self) -> Floats:
        """The state; setting it is ``set_state``."""
        return self.state

    @_state.setter
    def _state(self, state: Any) -> None:
        self.set_state(state)

    @property
    def _velocity(self) -> Floats:
        """The control; setting it is ``set_velocity``."""
        return self.velocity

    @_velocity.setter
    def _velocity(self, velocity: Any) -> None:
        self.set_velocity(velocity)

    @property
    def _goal(self) -> list[Floats]:
        """The goals; setting them is ``set_goal``."""
        return self.goals

    @_goal.setter
    def _goal(self, goal: Any) -> None:
        self.set_goal(goal)

    @property
    def init_state(self) -> Floats:
        """(state_dim, 1) the state that ``reset`` returns to."""
        return column(self._simulation.state.initial_state(self.row)[: self.state_dim])

    @property
    def position(self) -> Floats:
        """(2, 1) x, y [m], world frame."""
        return column(self._pose[:2])

    @property
    def orientation(self) -> float:
        """Heading of the body [rad]."""
        return float(self._pose[2])

    @property
    def heading(self) -> float:
        """Direction of travel of an ``omni`` drive, of the body otherwise [rad]."""
        if (handler := self._handler) is not None:
            return float(handler.compute_heading(self.state, self.velocity))
        if self.kinematics == "omni":
            forward, lateral = self._simulation.control[self.row, :2]
            return math.atan2(lateral, forward) + float(self._pose[2])
        return float(self._pose[2])

    @property
    def velocity(self) -> Floats:
        """(vel_dim, 1) executed control, in the command frame of the drive."""
        return column(self._simulation.control_of(self.row, self.vel_dim))

    @property
    def velocity_xy(self) -> Floats:
        """(2, 1) velocity in the world frame [m/s] that the present control gives."""
        if (handler := self._handler) is not None:
            return column(handler.velocity_to_xy(self.state, self.velocity))
        return column(self._simulation.state.velocity_world(self.row))

    @property
    def max_speed(self) -> float:
        """Highest speed the limits allow [m/s]; 0 for objects that never move."""
        top = self.record.vel_max
        if self.kinematics is None:
            return 0.0
        if (handler := self._handler) is not None:
            return float(handler.compute_max_speed(self.vel_max))
        if self.kinematics in ("omni", "omni_angular"):
            return math.hypot(*top[:2])
        return float(top[0])

    @property
    def trajectory(self) -> list[Floats]:
        """States after each executed step, (state_dim, 1) each, without the initial one."""
        states = [column(row[: self.state_dim]) for row in self._simulation.state.trajectory(self.row)]
        return FixedList(states, f"`trajectory` of {self.name!r}", HINTS["trajectory"])

    def set_state(self, state: Any = None, init: bool = False) -> None:
        """Put the object somewhere else.

        Args:
            state: ``state_dim`` numbers in any shape: x, y [m], heading [rad] (not wrapped), extra rows; None: zeros.
            init: Also what ``reset`` returns to.

        Raises:
            ValueError: Wrong number of numbers, or not finite.
        """
        values = np.zeros(self.state_dim) if state is None else np.asarray(state, dtype=np.float64).reshape(-1)
        if values.size != self.state_dim or not np.isfinite(values).all():
            raise ValueError(f"the state of {self.name!r} is {self.state_dim} finite numbers, not {state!r}")
        self._pose[:] = values[:3]
        self._simulation.extra[self.row, : self.state_dim - 3] = values[3:]
        if init:
            self._simulation.state.set_initial(self.row, pose=True, control=False)
        self._simulation.state.moved(self.row)

    def set_velocity(self, velocity: Any = None, init: bool = False) -> None:
        """Overwrite the present control (acceleration limits start from it).

        Args:
            velocity: ``vel_dim`` numbers in the command frame; None: zeros.
            init: Also what ``reset`` returns to.

        Raises:
            ValueError: Wrong number of numbers.
        """
        values = np.zeros(self.vel_dim) if velocity is None else np.asarray(velocity, dtype=np.float64).reshape(-1)
        if values.size != self.vel_dim:
            raise ValueError(f"the velocity of {self.name!r} is {self.vel_dim} numbers, not {velocity!r}")
        self._simulation.control[self.row, : min(3, self.vel_dim)] = values[:3]
        if self.vel_dim > 3:
            self._simulation.control_of(self.row, self.vel_dim)[:] = values
        if init:
            self._simulation.state.set_initial(self.row, pose=False, control=True)

    # goals -----------------------------------------------------------------------------------------------------------
    @property
    def goal(self) -> Floats | None:
        """(2 or 3, 1) the present goal, None without one."""
        goals = self._simulation.state.goals(self.row)
        return column(goals[0]) if goals else None

    @property
    def goals(self) -> list[Floats]:
        """The present goal and those still to come, (2 or 3, 1) each."""
        return [column(goal) for goal in self._simulation.state.goals(self.row)]

    def set_goal(self, goal: Any = None, init: bool = False) -> None:
        """Give a new goal.

        Args:
            goal: None for no goal; 2 or 3 numbers in any shape; or a list of such for waypoints.
            init: Also what ``reset`` returns to.

        Raises:
            ValueError: Not goals of 2 or 3 numbers.
        """
        self._simulation.state.set_goals(self.row, _goal_list(goal), init)

    def append_goal(self, goal: Any) -> None:
        """Add a goal behind those already there."""
        goals = [list(map(float, g)) for g in self._simulation.state.goals(self.row)]
        self._simulation.state.set_goals(self.row, goals + _goal_list(goal), False)

    # flags -----------------------------------------------------------------------------------------------------------
    @property
    def arrive(self) -> bool:
        """Whether the last goal is reached."""
        return bool(self._simulation.arrived[self.row])

    @property
    def collision(self) -> bool:
        """Whether the object touches something."""
        return bool(self._simulation.collided[self.row])

    @property
    def stop_flag(self) -> bool:
        """Whether the collision mode holds the object; may be set, and is evaluated anew in each step, as are these."""
        return bool(self._simulation.stopped[self.row])

    @stop_flag.setter
    def stop_flag(self, value: bool) -> None:
        self._simulation.stopped[self.row] = bool(value)

    @property
    def arrive_flag(self) -> bool:
        """The same as ``arrive``; may be set."""
        return self.arrive

    @arrive_flag.setter
    def arrive_flag(self, value: bool) -> None:
        self._simulation.arrived[self.row] = bool(value)

    @property
    def collision_flag(self) -> bool:
        """The same as ``collision``; may be set."""
        return self.collision

    @collision_flag.setter
    def collision_flag(self, value: bool) -> None:
        self._simulation.collided[self.row] = bool(value)

    @property
    def collision_obj(self) -> list[ObjectView]:
        """The objects it touches, ``unobstructed`` ones left out."""
        pairs = self._simulation.state.collision_pairs(self.world)
        others = [int(b if a == self.index else a) for a, b in pairs if self.index in (a, b)]
        objects = self.environment_objects
        return [objects[i] for i in others if not objects[i].unobstructed]

    def done(self) -> bool:
        """Whether the object has arrived or stopped."""
        return self.arrive or self.stop_flag

    # others ----------------------------------------------------------------------------------------------------------
    @property
    def environment_objects(self) -> list[ObjectView]:
        """All objects of its world, in the order of their rows."""
        return views(self._simulation, self.world) if self.surroundings is None else list(self.surroundings)

    @property
    def external_objects(self) -> list[ObjectView]:
        """All objects of its world but itself."""
        return [other for other in self.environment_objects if other is not self]

    @property
    def ego_object(self) -> ObjectView:
        """Itself."""
        return self

    # limits and description ------------------------------------------------------------------------------------------
    @property
    def vel_min(self) -> Floats:
        """(vel_dim, 1) lower control limits."""
        return column(self.record.vel_min)

    @property
    def vel_max(self) -> Floats:
        """(vel_dim, 1) upper control limits."""
        return column(self.record.vel_max)

    @property
    def acce(self) -> Floats:
        """(vel_dim, 1) limits on the change of each control per second."""
        return column(self.record.acce)

    def get_vel_range(self) -> tuple[Floats, Floats]:
        """(lower, upper) controls that the limits allow in the next step, (vel_dim, 1) each."""
        change = np.asarray(self.acce) * self._simulation.scenario.world.step_time
        now = self.velocity
        return column(np.maximum(self.vel_min, now - change)), column(np.minimum(self.vel_max, now + change))

    @property
    def abbr(self) -> str:
        """Short label: ``r0``, ``o3``."""
        return f"{self.role[0]}{self.id}"

    @property
    def goal_abbr(self) -> str:
        """Short label of the goal: ``G-r0``."""
        return f"G-{self.abbr}"

    @property
    def beh_config(self) -> BehaviorKeys:
        """The behavior's keys as written, or those of the group behavior; what is set of its own holds at once."""
        if "_keys" not in self.__dict__:
            self.__dict__["_keys"] = behavior_keys(self)
        keys: BehaviorKeys = self.__dict__["_keys"]
        return keys

    @beh_config.setter
    def beh_config(self, keys: Mapping[str, Any] | None) -> None:
        self.beh_config.assign(keys)

    @property
    def info(self) -> ObjectInfo:
        """A snapshot of what the object is."""
        return ObjectInfo.of(self)

    def get_info(self) -> ObjectInfo:
        """Same as ``info``."""
        return self.info

    def get_obstacle_info(self) -> ObstacleInfo:
        """Where the object is and how big."""
        return ObstacleInfo.of(self)

    def get_lidar_scan(self) -> dict[str, Any]:
        """Scan of the first lidar; see :meth:`irsim.objects.sensors.lidar.Lidar2D.get_scan`."""
        return self._first_lidar().get_scan()

    def get_lidar_points(self) -> Floats | None:
        """(2, K) points of the first lidar, sensor frame."""
        return self._first_lidar().get_points()

    def get_lidar_offset(self) -> list[float]:
        """[x, y, theta] of the first lidar, body frame."""
        return self._first_lidar().get_offset()

    def set_laser_color(self, laser_indices: Any, laser_color: str = "cyan", alpha: float = 0.3) -> None:
        """Draw some beams of the first lidar in another colour."""
        self._first_lidar().set_laser_color(laser_indices, laser_color, alpha)

    def get_fov_detected_objects(self) -> list[ObjectView]:
        """The other objects of which some part lies in the field of view, in id order; empty without one.

        The field of view is the sector of ``fov`` [rad] about the heading, ``fov_radius`` [m] from the object's origin.
        With ``fov_occlusion`` parts hidden behind what is not ``unobstructed`` do not count.
        """
        if self.fov is None or self.fov_radius is None:
            return []
        seen = self._simulation.state.in_view(self.row, self.fov, self.fov_radius, self.fov_occlusion)
        return [self.environment_objects[i] for i in seen]

    def fov_detect_object(self, detected_object: ObjectView) -> bool:
        """Whether some part of another object lies in the field of view."""
        return any(other.id == detected_object.id for other in self.get_fov_detected_objects())

    def set_text(self, text: str | None) -> None:
        """Label to draw instead of ``abbr``; None restores it."""
        self.text = text

    def set_goal_text(self, text: str | None) -> None:
        """Label of the goal; None restores it."""
        self.goal_text = text

    def __repr__(self) -> str:
        x, y, theta = self._pose
        return f"<{self.role} {self.name!r} at ({x:.3f}, {y:.3f}, {theta:.3f})>"

    # -----------------------------------------------------------------------------------------------------------------
    def _first_lidar(self) -> Lidar2D:
        if self.lidar is None:
            raise AttributeError(f"{self.name!r} has no lidar: add one under `sensors` in its scenario entry")
        return self.lidar


def views(simulation: Simulation, world: int = 0) -> list[ObjectView]:
    """The views of one world, made once per simulation."""
    cache: dict[int, list[ObjectView]] = simulation.__dict__.setdefault("_views", {})
    if world not in cache:
        cache[world] = [
            _view_class(record)(simulation, i, world) for i, record in enumerate(simulation.scenario.objects)
        ]
    return cache[world]


def _view_class(record: ObjectRecord) -> type[ObjectView]:
    if record.shape.name != "map":
        return ObjectView
    from irsim.objects.obstacle_map import ObstacleMap

    return ObstacleMap


def set_views(simulation: Simulation, shown: Sequence[ObjectView]) -> None:
    """Let these views show the rows of a simulation of one world, in this order."""
    for index, (view, record) in enumerate(zip(shown, simulation.scenario.objects, strict=True)):
        if view.record is not record:
            view.describe(record)
        view.attach(simulation, index)
    simulation.__dict__["_views"] = {0: list(shown)}


def _may_not_be_set(name: str) -> bool:
    kind = getattr(ObjectView, name, None)
    return not hasattr(ObjectView, name) or (isinstance(kind, property) and kind.fset is None)


_SHOWN = ("id", "name", "state_dim", "vel_dim", *(name for name in SETTINGS if not hasattr(ObjectView, name)))
"""Fields of the record that are attributes of the object."""
_FIXED = frozenset(name for name in {*HINTS, *dir(ObjectView)} - SETTINGS.keys() if _may_not_be_set(name))


def _contact_options(sensors: Sequence[Any]) -> Any:
    return next((sensor for sensor in sensors if getattr(sensor, "name", "") == "contact2d"), None)


def _goal_list(goal: Any) -> list[list[float]]:
    if goal is None:
        return []
    queue = hasattr(goal, "popleft")
    several = isinstance(goal, Sequence) and not isinstance(goal, str) and len(goal) > 0
    if queue or (several and all(isinstance(g, (Sequence, np.ndarray)) and np.size(g) in (2, 3) for g in goal)):
        goals = [np.asarray(g, dtype=np.float64).reshape(-1).tolist() for g in goal]
    else:
        goals = [np.asarray(goal, dtype=np.float64).reshape(-1).tolist()]
    if any(len(g) not in (2, 3) or not all(map(math.isfinite, g)) for g in goals):
        raise ValueError(f"a goal is 2 or 3 finite numbers (x, y, theta), not {goal!r}")
    return goals
