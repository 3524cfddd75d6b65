"""The objects that programs use; each is a view of one row of a simulation, and every read returns a copy."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from irsim.common.arrays import Floats
from irsim.objects import setters
from irsim.objects.base import column
from irsim.objects.behavior import ObjectBehavior
from irsim.objects.body import Body
from irsim.objects.drawing.drawing import Drawing
from irsim.objects.extensions.drives import heading, max_speed, velocity_xy
from irsim.objects.extensions.hooks import (
    limited_control,
    overridable,
    renew_goal,
    step_alone,
    take_part,
    wrapped_state,
)
from irsim.objects.lifecycle import amend
from irsim.objects.sensors.contact import Contact2D
from irsim.objects.sensors.lidar import Lidar2D
from irsim.objects.sensors.sensors import attach_sensors, sensors_of
from irsim.objects.setters import HINTS, SETTINGS
from irsim.objects.surroundings import Surroundings

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["ObjectView"]


class ObjectView:
    """One robot or obstacle.

    Arrays are columns (n, 1) and read-only copies, which never change. ``set_state``, ``set_velocity`` and
    ``set_goal`` change the object.

    Attributes:
        id: Number of the object in its environment; it never changes.
        record: The resolved scenario entry of the object.
        world: Index of the world in a batch.
        index: Index among the objects of the world; it changes when an object with a lower index is deleted.
        row: Row in the arrays of the simulation.
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
    wheelbase: float | None
    sensors: list[Any]
    lidar: Lidar2D | None
    contact: Contact2D
    index: int
    world: int
    row: int
    _simulation: Simulation
    _pose: Floats
    _pose_column: Floats
    _made_beside: Sequence[Any] | None
    _read_only: ClassVar[frozenset[str]] = frozenset()

    def __init__(self, simulation: Simulation, index: int, world: int = 0) -> None:
        record = simulation.scenario.objects[index]
        self._describe(record)
        own = self.__dict__
        own["_made_beside"] = None
        own["sensors"] = []
        self._attach(simulation, index, world)
        contact = next((sensor for sensor in record.sensors if getattr(sensor, "name", "") == "contact2d"), None)
        own["contact"] = Contact2D(self, contact)
        made = sensors_of(simulation, self)
        own["sensors"] = setters.FixedList(made, f"`sensors` of {self.name!r}", HINTS["sensors"])
        own["lidar"] = next((s for s in self.sensors if isinstance(s, Lidar2D)), None)

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        cls._read_only = setters.names_only_read(cls)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in SETTINGS:
            setters.change(self, name, value)
        elif name in self._read_only:
            setters.refuse(repr(self.name), name, HINTS.get(name, "it can only be read"))
        else:
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        x, y, theta = self._pose
        return f"<{self.role} {self.name!r} at ({x:.3f}, {y:.3f}, {theta:.3f})>"

    def _describe(self, record: ObjectRecord) -> None:
        """Take the attributes of the object from a record; scripts set them through :mod:`irsim.objects.setters`."""
        own = self.__dict__
        own["record"] = record
        for name in _SHOWN:
            own[name] = getattr(record, name)
        own["wheelbase"] = getattr(record.shape, "wheelbase", None)

    def _attach(self, simulation: Simulation, index: int, world: int = 0) -> None:
        """Attach the object to a row of a simulation; its row changes when objects are added or deleted."""
        own, row = self.__dict__, world * simulation.objects + index  # without __setattr__: many do this at once
        own["_simulation"], own["index"], own["world"], own["row"] = simulation, index, world, row
        own["_pose"], own["_pose_column"] = simulation.pose[row], simulation.pose[row, :, None]
        if self.sensors:
            attach_sensors(simulation, self)
        take_part(self)

    def amend(self, record: ObjectRecord) -> None:
        """Replace the record of the object; see :func:`irsim.objects.lifecycle.amend`."""
        amend(self, record)

    # parts -----------------------------------------------------------------------------------------------------------
    @cached_property
    def body(self) -> Body:
        """Outline, extent and mass."""
        return Body(self)

    @cached_property
    def drawing(self) -> Drawing:
        """How pictures show the object."""
        return Drawing(self)

    @cached_property
    def behavior(self) -> ObjectBehavior:
        """Keys of the behavior, which may be written."""
        return ObjectBehavior(self)

    @cached_property
    def surroundings(self) -> Surroundings:
        """The other objects of the world."""
        return Surroundings(self)

    # the entry -------------------------------------------------------------------------------------------------------
    @property
    def shape(self) -> str:
        """Name of the shape."""
        return str(getattr(self.record.shape, "name", ""))

    @property
    def kinematics(self) -> str | None:
        """Name of the drive; None without one."""
        return None if self.record.kinematics is None else str(getattr(self.record.kinematics, "name", ""))

    @property
    def radius(self) -> float:
        """Radius of the smallest circle round the body [m]."""
        return self.body.radius

    @property
    def length(self) -> float:
        """Extent of the body along its x axis [m]."""
        return self.body.length

    @property
    def width(self) -> float:
        """Extent of the body along its y axis [m]."""
        return self.body.width

    @property
    def vertices(self) -> Floats | None:
        """Outline in the world frame, (2, M) [m]: 64 points for a circle, None for a compound or a map."""
        return self.body.vertices

    @property
    def geometry(self) -> Any:
        """The body as a shapely geometry, world frame (circles as polygons of 64 vertices)."""
        return self.body.geometry

    @property
    def vel_min(self) -> Floats:
        """Lower limits of the control, (vel_dim, 1)."""
        return column(self._simulation.limits(self.row)[0])

    @property
    def vel_max(self) -> Floats:
        """Upper limits of the control, (vel_dim, 1)."""
        return column(self._simulation.limits(self.row)[1])

    @property
    def acce(self) -> Floats:
        """Limits on the change of each control per second, (vel_dim, 1)."""
        return column(self.record.acce)

    @property
    def max_speed(self) -> float:
        """Largest speed that the limits allow [m/s]; 0 for objects without a drive."""
        return max_speed(self)

    # state -----------------------------------------------------------------------------------------------------------
    @property
    def state(self) -> Floats:
        """State (3 or more, 1): x, y [m], heading [rad], then extra rows such as the steering angle of a car [rad]."""
        if self.state_dim == 3:
            state = self._pose_column.copy()
        else:
            extra = self._simulation.extra[self.row, : self.state_dim - 3]
            state = np.concatenate([self._pose, extra])[:, None]
        state.setflags(False)  # type: ignore[call-arg]  # as in `column`
        return state

    @property
    def init_state(self) -> Floats:
        """The state to which ``reset`` returns, (state_dim, 1)."""
        return column(self._simulation.state.initial_state(self.row)[: self.state_dim])

    @property
    def position(self) -> Floats:
        """Position x, y [m] in the world frame, (2, 1)."""
        return column(self._pose[:2])

    @property
    def orientation(self) -> float:
        """Heading of the body [rad]."""
        return float(self._pose[2])

    @property
    def heading(self) -> float:
        """Direction of travel for an ``omni`` drive, heading of the body for other drives [rad]."""
        return heading(self)

    @property
    def velocity(self) -> Floats:
        """Executed control in the command frame of the drive, (vel_dim, 1)."""
        return column(self._simulation.control_of(self.row, self.vel_dim))

    @property
    def velocity_xy(self) -> Floats:
        """Velocity in the world frame that follows from the present control, (2, 1) [m/s]."""
        return velocity_xy(self)

    @property
    def trajectory(self) -> list[Floats]:
        """States after each executed step, (state_dim, 1) each, without the initial state."""
        states = [column(row[: self.state_dim]) for row in self._simulation.state.trajectory(self.row)]
        return setters.FixedList(states, f"`trajectory` of {self.name!r}", HINTS["trajectory"])

    def set_state(self, state: Any = None, init: bool = False) -> None:
        """Set the state of the object.

        Args:
            state: ``state_dim`` numbers in any shape: x, y [m], heading [rad] (not wrapped), extra rows; None sets
                zeros.
            init: Also make it the state to which ``reset`` returns.

        Raises:
            ValueError: The state does not have ``state_dim`` finite numbers.
        """
        setters.set_state(self, state, init)

    def set_velocity(self, velocity: Any = None, init: bool = False) -> None:
        """Set the present control, from which acceleration limits are counted.

        Args:
            velocity: ``vel_dim`` numbers in the command frame; None sets zeros.
            init: Also make it the control to which ``reset`` returns.

        Raises:
            ValueError: The control does not have ``vel_dim`` numbers.
        """
        setters.set_velocity(self, velocity, init)

    # goals and flags -------------------------------------------------------------------------------------------------
    @property
    def goal(self) -> Floats | None:
        """The present goal x, y [m] and possibly heading [rad], (2 or 3, 1); None without one."""
        goals = self._simulation.state.goals(self.row)
        return column(goals[0]) if goals else None

    @property
    def goals(self) -> list[Floats]:
        """The present goal and the goals after it, (2 or 3, 1) each."""
        return [column(goal) for goal in self._simulation.state.goals(self.row)]

    def set_goal(self, goal: Any = None, init: bool = False) -> None:
        """Set the goal, or several goals that are visited in order.

        Args:
            goal: 2 or 3 numbers in any shape (x, y [m], heading [rad]), a list of such goals, or None for no goal.
            init: Also make it the goal to which ``reset`` returns.

        Raises:
            ValueError: A goal does not have 2 or 3 finite numbers.
        """
        self._simulation.state.set_goals(self.row, setters.goal_list(goal), init)

    def append_goal(self, goal: Any) -> None:
        """Add a goal after the present ones."""
        goals = [list(map(float, g)) for g in self._simulation.state.goals(self.row)]
        self._simulation.state.set_goals(self.row, goals + setters.goal_list(goal), False)

    @property
    def arrive(self) -> bool:
        """Whether the object has reached its last goal."""
        return bool(self._simulation.arrived[self.row])

    @property
    def collision(self) -> bool:
        """Whether the object touches something."""
        return bool(self._simulation.collided[self.row])

    @property
    def contacts_between_steps(self) -> int:
        """Number of contacts of the episode that began and ended within one step, so that ``collision`` tells none."""
        return int(self._simulation.between_steps[self.row])

    @property
    def stop_flag(self) -> bool:
        """Whether the collision mode has stopped the object; may be set, until the next step evaluates it again."""
        return bool(self._simulation.stopped[self.row])

    @stop_flag.setter
    def stop_flag(self, value: bool) -> None:
        self._simulation.stopped[self.row] = bool(value)

    def done(self) -> bool:
        """Return whether the object has arrived or has been stopped."""
        return self.arrive or self.stop_flag

    def reset(self) -> None:
        """Reset the object to its initial state, control and goals, and clear its flags and trajectory."""
        self._simulation.state.reset_row(self.row)

    # a step: user code may override these methods in subclasses or on instances ---------------------------------------
    @overridable
    def pre_process(self) -> None:
        """Renew the goals of an arrived object with ``wander`` or ``loop``; called before the object decides."""
        renew_goal(self)

    @overridable
    def gen_behavior_vel(self, velocity: Any = None) -> Floats:
        """Return the control of the next step.

        Args:
            velocity: Desired control; None lets the behavior choose.

        Returns:
            Control (vel_dim, 1) within the limits of speed and acceleration. An object without a behavior stops at
            once, whatever its limits; for a robot this is logged once.
        """
        return limited_control(self, velocity)

    @overridable
    def mid_process(self, state: Any) -> Floats:
        """Wrap the heading into ``angle_range``; called after the motion, before its result takes effect.

        Args:
            state: State that results from the motion.

        Returns:
            State (state_dim, 1) that takes effect; rows that ``state`` lacks keep their values.
        """
        return wrapped_state(self, state)

    @overridable
    def post_process(self) -> None:
        """Do nothing; called after the object has moved."""

    @overridable
    def step(self, velocity: Any = None, sensor_step: bool = True, **_: Any) -> Floats:
        """Advance this object alone by one period, without advancing the time of the environment.

        Args:
            velocity: Control, ``vel_dim`` numbers in the command frame; None lets the behavior choose.
            sensor_step: Also update the sensors.

        Returns:
            The new state, (state_dim, 1).
        """
        return step_alone(self, velocity, sensor_step)


_SHOWN = ("id", "name", "state_dim", "vel_dim", *(name for name in SETTINGS if not hasattr(ObjectView, name)))
"""Fields of the record that are attributes of the object."""
ObjectView._read_only = setters.names_only_read(ObjectView)
