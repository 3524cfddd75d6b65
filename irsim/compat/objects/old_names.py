"""The names of IR-SIM 2.12 that :class:`irsim.objects.view.ObjectView` does not have."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from operator import attrgetter
from typing import Any

from irsim.common.arrays import Floats
from irsim.compat.objects.info import ObjectInfo, ObstacleInfo
from irsim.components.kinematics._handler import KinematicsHandler
from irsim.objects.behavior import BehaviorKeys, ObjectBehavior
from irsim.objects.body import Body
from irsim.objects.drawing.drawing import PLOT_KEYS, Drawing
from irsim.objects.extensions.drives import handler_of
from irsim.objects.sensors.lidar import Lidar2D
from irsim.objects.shapely_geometry import from_shapely
from irsim.objects.surroundings import Surroundings
from irsim.objects.view import ObjectView
from irsim.simulation.active_env import last_used

__all__ = ["OldNames"]


def _of(part: str, member: Any) -> Any:
    """Return a property that reads the property ``member`` of a part, and has its docstring."""
    return property(attrgetter(f"{part}.{member.fget.__name__}"), doc=member.__doc__)


class OldNames(ObjectView):
    """Names of 2.12; part of :class:`irsim.compat.objects.view.ScriptObject`."""

    mass = _of("body", Body.mass)
    friction = _of("body", Body.friction)
    restitution = _of("body", Body.restitution)
    inertia = _of("body", Body.inertia)
    inv_mass = _of("body", Body.inv_mass)
    inv_inertia = _of("body", Body.inv_inertia)
    gyration = _of("body", Body.gyration)
    pushable = _of("body", Body.pushable)
    friction_force = _of("body", Body.friction_force)
    original_vertices = _of("body", Body.original_vertices)
    part_vertices = _of("body", Body.part_vertices)
    original_part_vertices = _of("body", Body.original_part_vertices)
    original_geometry = _of("body", Body.original_geometry)
    centroid = _of("body", Body.centroid)
    original_centroid = _of("body", Body.original_centroid)
    goal_vertices = _of("body", Body.goal_vertices)
    abbr = _of("drawing", Drawing.short_label)
    label = _of("drawing", Drawing.label)
    show_goal = _of("drawing", Drawing.show_goal)
    show_goal_text = _of("drawing", Drawing.show_goal_text)
    show_sensor = _of("drawing", Drawing.show_sensor)
    show_trail = _of("drawing", Drawing.show_trail)
    trail_freq = _of("drawing", Drawing.trail_freq)
    rl = _of("behavior", ObjectBehavior.range_low)
    rh = _of("behavior", ObjectBehavior.range_high)
    group_behavior_dict = _of("behavior", ObjectBehavior.group_keys)
    environment_objects = _of("surroundings", Surroundings.objects)
    external_objects = _of("surroundings", Surroundings.others)
    possible_collision_objects = _of("surroundings", Surroundings.near)
    collision_obj = _of("surroundings", Surroundings.touched)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in PLOT_KEYS:
            setattr(self.drawing, name, value)
        else:
            super().__setattr__(name, value)

    # handlers and descriptions ---------------------------------------------------------------------------------------
    @property
    def kf(self) -> KinematicsHandler:
        """Handler of the drive: for a drive of user code the one in use, otherwise one with the same results."""
        from irsim.compat.handlers.kinematics import KinematicsFactory  # few scripts use handlers, and they load slowly

        if (handler := handler_of(self)) is not None:
            return handler
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
        from irsim.compat.handlers.geometry import handler_of as shape_handler

        return shape_handler(self)

    @property
    def obj_behavior(self) -> Any:
        """The behavior as an object with the method ``gen_vel``."""
        from irsim.compat.handlers.behavior import Behavior

        if "_behavior" not in self.__dict__:
            made = self.__dict__["_behavior"] = Behavior(self.info, self.beh_config)
            made.follow(self.beh_config)
        return self.__dict__["_behavior"]

    @property
    def beh_config(self) -> BehaviorKeys:
        """Keys of the behavior as written, which may be set, or else keys of the group behavior."""
        return self.behavior.keys

    @beh_config.setter
    def beh_config(self, keys: Mapping[str, Any] | None) -> None:
        self.behavior.keys.assign(keys)

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

    @property
    def env_param(self) -> Any:
        """``env_param`` of the environment; None for an object without an environment."""
        return getattr(self._simulation.owner(), "env_param", None)

    @property
    def world_param(self) -> Any:
        """``world_param`` of the environment; None for an object without an environment."""
        return getattr(self._simulation.owner(), "world_param", None)

    @property
    def logger(self) -> Any:
        """The logger of the environment; None for an object without an environment."""
        return getattr(self._simulation.owner(), "logger", None)

    # sensors ---------------------------------------------------------------------------------------------------------
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

    def get_fov_detected_objects(self) -> list[Any]:
        """Return ``surroundings.seen``: the other objects of which a part lies in the field of view."""
        return self.surroundings.seen

    def fov_detect_object(self, detected_object: ObjectView) -> bool:
        """Return whether a part of another object lies in the field of view."""
        return any(other.id == detected_object.id for other in self.surroundings.seen)

    def sensor_step(self) -> None:
        """Update the sensors for the present poses."""
        self._simulation.state.look()
        self._simulation.measure()

    def refresh(self, sensor_step: bool = True) -> None:
        """Update the object after its state was set; the geometry needs no update.

        Args:
            sensor_step: Update the sensors.
        """
        if sensor_step:
            self.sensor_step()

    def _first_lidar(self) -> Lidar2D:
        if self.lidar is None:
            raise AttributeError(f"{self.name!r} has no lidar: add one under `sensors` in its scenario entry")
        return self.lidar

    # changes ---------------------------------------------------------------------------------------------------------
    def set_original_geometry(self, geometry: Any) -> None:
        """Replace the body of the object until the next scene.

        Args:
            geometry: shapely polygon, line, or collection of them, in the body frame [m].
        """
        self._simulation.reshape(self.row, from_shapely(geometry))

    @property
    def text(self) -> str | None:
        """Text that is drawn in place of ``label``; None shows ``label``."""
        return self.drawing.text

    @text.setter
    def text(self, text: str | None) -> None:
        self.drawing.text = text

    @property
    def goal_text(self) -> str | None:
        """Text that is drawn at the goal in place of ``G-`` and ``label``; None shows these."""
        return self.drawing.goal_text

    @goal_text.setter
    def goal_text(self, text: str | None) -> None:
        self.drawing.goal_text = text

    def set_text(self, text: str | None) -> None:
        """Set the text that is drawn in place of ``label``; None restores ``label``."""
        self.drawing.text = text

    def set_goal_text(self, text: str | None) -> None:
        """Set the text that is drawn at the goal in place of ``G-`` and ``label``; None restores that."""
        self.drawing.goal_text = text

    def remove(self) -> None:
        """Do nothing; kept for compatibility. ``env.delete_object`` deletes objects."""

    @property
    def ego_object(self) -> Any:
        """The object itself."""
        return self

    @staticmethod
    def reset_id_iter(start: int = 0, step: int = 1) -> None:
        """Restart the ids of new objects in the environment used last."""
        if (env := last_used()) is not None:
            env.env_param.id_iter = count(start, step)
