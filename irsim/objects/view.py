"""The objects that scripts use; each is a view of one row of a simulation, and every read returns a copy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from irsim.common.arrays import Floats
from irsim.objects.avoidance import ObjectAvoidance
from irsim.objects.base import column
from irsim.objects.drawing.by_hand import ObjectDrawing
from irsim.objects.drawing.plot_keys import PLOT_KEYS, ObjectPlotKeys, with_plot_key
from irsim.objects.dynamics import ObjectDynamics
from irsim.objects.extensions.hooks import ObjectHooks
from irsim.objects.info import ObjectInfo, ObstacleInfo
from irsim.objects.lifecycle import amend, draw_as, set_views
from irsim.objects.sensors.contact import Contact2D
from irsim.objects.sensors.lidar import Lidar2D
from irsim.objects.sensors.sensors import attach_sensors, sensors_of
from irsim.objects.setters import HINTS, SETTINGS, BehaviorKeys, FixedList, behavior_keys, change, refuse
from irsim.objects.status import ObjectStatus

if TYPE_CHECKING:
    from irsim.components.kinematics._handler import KinematicsHandler
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["ObjectView"]


class ObjectView(ObjectHooks, ObjectDynamics, ObjectStatus, ObjectAvoidance, ObjectDrawing, ObjectPlotKeys):
    """One robot or obstacle.

    Arrays are columns (n, 1) and read-only copies, which never change. ``set_state``, ``set_velocity`` and
    ``set_goal`` change the object.

    Attributes:
        id: Number of the object in its environment; it never changes.
        record: The resolved scenario entry of the object.
        world: Index of the world in a batch.
        index: Index among the objects of the world; it changes when an object with a lower index is deleted.
        row: Row in the arrays of the simulation.
        surroundings: Until the object is added to the environment for which it was made, the objects of that
            environment; otherwise None.
    """

    lidar: Lidar2D | None

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
        """Take the attributes of the object from a record; scripts set them through :mod:`irsim.objects.setters`."""
        self.record = record
        own = self.__dict__
        for name in _SHOWN:
            own[name] = getattr(record, name)
        own["state_shape"], own["vel_shape"] = (record.state_dim, 1), (record.vel_dim, 1)
        own["wheelbase"] = getattr(record.shape, "wheelbase", None)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in SETTINGS:
            change(self, name, value)
        elif name in PLOT_KEYS:
            draw_as(self, with_plot_key(self.record, name, value))
        elif name in _FIXED:
            refuse(repr(self.name), name, HINTS.get(name, "it can only be read"))
        else:
            object.__setattr__(self, name, value)

    def amend(self, record: ObjectRecord) -> None:
        """Replace the record of the object; see :func:`irsim.objects.lifecycle.amend`."""
        amend(self, record)

    def renumber(self, number: int) -> None:
        """Change the id of an object in a simulation of its own, and its name if that was generated from the id."""
        record = self.record
        name = f"{record.role}_{number}" if record.name == f"{record.role}_{record.id}" else record.name
        scenario = replace(self._simulation.scenario, objects=[replace(record, id=number, name=name)])
        self.__dict__.update(id=number, name=name)
        self._simulation.exchange(scenario, [(self._simulation, 0)])
        set_views(self._simulation, [self])

    def attach(self, simulation: Simulation, index: int, world: int = 0) -> None:
        """Attach the object to a row of a simulation; its row changes when objects are added or deleted."""
        own, row = self.__dict__, world * simulation.objects + index  # without __setattr__: many do this at once
        own["_simulation"], own["index"], own["world"], own["row"] = simulation, index, world, row
        own["_pose"], own["_pose_column"] = simulation.pose[row], simulation.pose[row, :, None]
        if self.sensors:
            attach_sensors(simulation, self)
        self._take_part()

    @property
    def kf(self) -> KinematicsHandler:
        """Handler of the drive: for a drive of user code the one in use, otherwise one with the same results."""
        if (handler := self._handler) is not None:
            return handler
        from irsim.objects.handlers.kinematics import KinematicsFactory

        options: Any = self.record.kinematics
        if options is None:
            return KinematicsFactory.create_kinematics("static")
        handler = KinematicsFactory.create_kinematics(
            options.name, options.noise, options.alpha, options.mode, self.record.wheelbase, self.role, options.tau
        )
        handler.integration = self._simulation.scenario.world.integration
        return handler

    @property
    def gf(self) -> Any:
        """Handler of the shape, placed at the present pose."""
        from irsim.objects.handlers.geometry import handler_of

        return handler_of(self)

    @property
    def obj_behavior(self) -> Any:
        """The behavior as an object with the method ``gen_vel``."""
        from irsim.objects.handlers.behavior import Behavior

        if "_behavior" not in self.__dict__:
            made = self.__dict__["_behavior"] = Behavior(self.info, self.beh_config)
            made.follow(self.beh_config)
        return self.__dict__["_behavior"]

    @property
    def trajectory(self) -> list[Floats]:
        """States after each executed step, (state_dim, 1) each, without the initial state."""
        states = [column(row[: self.state_dim]) for row in self._simulation.state.trajectory(self.row)]
        return FixedList(states, f"`trajectory` of {self.name!r}", HINTS["trajectory"])

    # description ---------------------------------------------------------------------------------------------------
    @property
    def beh_config(self) -> BehaviorKeys:
        """Keys of the behavior as written, which may be set, or else keys of the group behavior."""
        if "_keys" not in self.__dict__:
            self.__dict__["_keys"] = behavior_keys(self)
        keys: BehaviorKeys = self.__dict__["_keys"]
        return keys

    @beh_config.setter
    def beh_config(self, keys: Mapping[str, Any] | None) -> None:
        self.beh_config.assign(keys)

    @property
    def info(self) -> ObjectInfo:
        """Description of the object at the present time."""
        return ObjectInfo.of(self)

    def get_info(self) -> ObjectInfo:
        """Return the description of the object at the present time."""
        return self.info

    def get_obstacle_info(self) -> ObstacleInfo:
        """Return the position and the size of the object."""
        return ObstacleInfo.of(self)

    def get_lidar_scan(self) -> dict[str, Any]:
        """Return the scan of the first lidar; see :meth:`irsim.objects.sensors.lidar.Lidar2D.get_scan`."""
        return self._first_lidar().get_scan()

    def get_lidar_points(self) -> Floats | None:
        """Return the points of the first lidar in the sensor frame, (2, K) [m]; None without a hit."""
        return self._first_lidar().get_points()

    def get_lidar_offset(self) -> list[float]:
        """Return the pose [x, y, theta] of the first lidar in the body frame [m, m, rad]."""
        return self._first_lidar().get_offset()

    def set_laser_color(self, laser_indices: Any, laser_color: str | None = None, alpha: float = 0.3) -> None:
        """Draw some beams of the first lidar in another colour; an object without a lidar logs a warning."""
        if self.lidar is not None:
            self.lidar.set_laser_color(laser_indices, laser_color, alpha)
        elif self.logger is not None:
            self.logger.warning(f"{self.name}: it has no lidar whose beams could be coloured")

    def get_fov_detected_objects(self) -> list[ObjectView]:
        """Return the other objects of which a part lies in the field of view, ordered by id; empty without one.

        The field of view is a sector of the angle ``fov`` [rad] about the heading and of the radius ``fov_radius`` [m]
        about the origin of the object. With ``fov_occlusion``, parts behind objects that are not ``unobstructed`` are
        hidden and do not count.
        """
        if self.fov is None or self.fov_radius is None:
            return []
        seen = self._simulation.state.in_view(self.row, self.fov, self.fov_radius, self.fov_occlusion)
        return [self.environment_objects[i] for i in seen]

    def fov_detect_object(self, detected_object: ObjectView) -> bool:
        """Return whether a part of another object lies in the field of view."""
        return any(other.id == detected_object.id for other in self.get_fov_detected_objects())

    def set_text(self, text: str | None) -> None:
        """Set the text that is drawn in place of ``label``; None restores ``label``."""
        self.text = text

    def set_goal_text(self, text: str | None) -> None:
        """Set the text that is drawn at the goal in place of ``G-`` and ``label``; None restores that."""
        self.goal_text = text

    def __repr__(self) -> str:
        x, y, theta = self._pose
        return f"<{self.role} {self.name!r} at ({x:.3f}, {y:.3f}, {theta:.3f})>"

    # -----------------------------------------------------------------------------------------------------------------
    def _first_lidar(self) -> Lidar2D:
        if self.lidar is None:
            raise AttributeError(f"{self.name!r} has no lidar: add one under `sensors` in its scenario entry")
        return self.lidar


def _may_not_be_set(name: str) -> bool:
    kind = getattr(ObjectView, name, None)
    return not hasattr(ObjectView, name) or (isinstance(kind, property) and kind.fset is None)


_SHOWN = ("id", "name", "state_dim", "vel_dim", *(name for name in SETTINGS if not hasattr(ObjectView, name)))
"""Fields of the record that are attributes of the object."""
_FIXED = frozenset(name for name in {*HINTS, *dir(ObjectView)} - SETTINGS.keys() if _may_not_be_set(name))


def _contact_options(sensors: Sequence[Any]) -> Any:
    return next((sensor for sensor in sensors if getattr(sensor, "name", "") == "contact2d"), None)
