"""The base of every object: its row of the simulation, with the state, goals, flags and limits in that row."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.text import clean

MAX_LABEL = 24
"""Number of characters of a name that pictures show."""

if TYPE_CHECKING:
    from irsim.components.kinematics._handler import KinematicsHandler
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["SimObject", "column"]


def column(values: Any) -> Floats:
    """Return a read-only copy of numbers as a column (n, 1)."""
    copied = np.array(values, dtype=np.float64).reshape(-1, 1)
    copied.setflags(False)  # type: ignore[call-arg]  # NumPy takes it; named, it takes longer than the copy
    return copied


class SimObject:
    """The row of one object in a simulation; base class of the other parts of an object.

    Attributes:
        record: The resolved scenario entry of the object.
        id: Number of the object in its environment; it never changes.
        world: Index of the world in a batch.
        index: Index among the objects of the world; it changes when an object with a lower index is deleted.
        row: Row in the arrays of the simulation.
        surroundings: Until the object is added to the environment for which it was made, the objects of that
            environment; otherwise None.
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
    contact: Any
    surroundings: Sequence[Any] | None
    text: str | None
    goal_text: str | None

    index: int
    world: int
    row: int
    _simulation: Simulation
    _pose: Floats
    _pose_column: Floats
    _plain: bool

    @property
    def shape(self) -> str:
        """Name of the shape."""
        return str(getattr(self.record.shape, "name", ""))

    @property
    def kinematics(self) -> str | None:
        """Name of the drive; None without one."""
        return None if self.record.kinematics is None else str(getattr(self.record.kinematics, "name", ""))

    @property
    def _handler(self) -> KinematicsHandler | None:
        """The handler of a drive of user code; None for other drives."""
        drives = self._simulation.drives
        return None if drives is None else drives.handler(self.row)

    @property
    def abbr(self) -> str:
        """Short label: ``r0``, ``o3``."""
        return f"{self.role[0]}{self.id}"

    @property
    def label(self) -> str:
        """What pictures call the object: the name that the user gave, without one ``abbr``."""
        return self.abbr if self.name == f"{self.role}_{self.id}" else clean(self.name, MAX_LABEL)

    @property
    def goal_abbr(self) -> str:
        """Short label of the goal: ``G-r0``."""
        return f"G-{self.abbr}"

    def amend(self, record: ObjectRecord) -> None:
        """Replace the record by another one with the same id; :class:`irsim.objects.view.ObjectView` implements it."""
        raise NotImplementedError

    # state -----------------------------------------------------------------------------------------------------------
    @property
    def state(self) -> Floats:
        """State (3 or more, 1): x, y [m], heading [rad], then extra rows such as the steering angle of a car [rad]."""
        if self._plain:
            state = self._pose_column.copy()
        else:
            extra = self._simulation.extra[self.row, : self.state_dim - 3]
            state = np.concatenate([self._pose, extra])[:, None]
        state.setflags(False)  # type: ignore[call-arg]  # as in `column`
        return state

    @property
    def _state(self) -> Floats:
        """The state; assigning to it calls ``set_state``."""
        return self.state

    @_state.setter
    def _state(self, state: Any) -> None:
        self.set_state(state)

    @property
    def _velocity(self) -> Floats:
        """The control; assigning to it calls ``set_velocity``."""
        return self.velocity

    @_velocity.setter
    def _velocity(self, velocity: Any) -> None:
        self.set_velocity(velocity)

    @property
    def _goal(self) -> list[Floats]:
        """The goals; assigning to them calls ``set_goal``."""
        return self.goals

    @_goal.setter
    def _goal(self, goal: Any) -> None:
        self.set_goal(goal)

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
        """Direction of travel for an ``omni`` drive, heading of the body for others [rad]."""
        if (handler := self._handler) is not None:
            return float(handler.compute_heading(self.state, self.velocity))
        if not getattr(self.record.kinematics, "turns", True):
            forward, lateral = self._simulation.control[self.row, :2]
            return math.atan2(lateral, forward) + float(self._pose[2])
        return float(self._pose[2])

    @property
    def velocity(self) -> Floats:
        """Executed control in the command frame of the drive, (vel_dim, 1)."""
        return column(self._simulation.control_of(self.row, self.vel_dim))

    @property
    def velocity_xy(self) -> Floats:
        """Velocity in the world frame that follows from the present control, (2, 1) [m/s]."""
        if (handler := self._handler) is not None:
            return column(handler.velocity_to_xy(self.state, self.velocity))
        return column(self._simulation.state.velocity_world(self.row))

    @property
    def max_speed(self) -> float:
        """Largest speed that the limits allow [m/s]; 0 for objects without a drive."""
        top = self._simulation.limits(self.row)[1].tolist()
        if self.kinematics is None:
            return 0.0
        if (handler := self._handler) is not None:
            return float(handler.compute_max_speed(self.vel_max))
        if getattr(self.record.kinematics, "speeds", 0) == 2:
            return math.hypot(*top[:2])
        return float(top[0])

    def set_state(self, state: Any = None, init: bool = False) -> None:
        """Set the state of the object.

        Args:
            state: ``state_dim`` numbers in any shape: x, y [m], heading [rad] (not wrapped), extra rows; None sets
                zeros.
            init: Also make it the state to which ``reset`` returns.

        Raises:
            ValueError: The state does not have ``state_dim`` finite numbers.
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
        """Set the present control, from which acceleration limits are counted.

        Args:
            velocity: ``vel_dim`` numbers in the command frame; None sets zeros.
            init: Also make it the control to which ``reset`` returns.

        Raises:
            ValueError: The control does not have ``vel_dim`` numbers.
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
        self._simulation.state.set_goals(self.row, _goal_list(goal), init)

    def append_goal(self, goal: Any) -> None:
        """Add a goal after the present ones."""
        goals = [list(map(float, g)) for g in self._simulation.state.goals(self.row)]
        self._simulation.state.set_goals(self.row, goals + _goal_list(goal), False)

    # flags -----------------------------------------------------------------------------------------------------------
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

    @property
    def arrive_flag(self) -> bool:
        """Whether the object has reached its last goal; may be set, until the next step evaluates it again."""
        return self.arrive

    @arrive_flag.setter
    def arrive_flag(self, value: bool) -> None:
        self._simulation.arrived[self.row] = bool(value)

    @property
    def collision_flag(self) -> bool:
        """Whether the object touches something; may be set, until the next step evaluates it again."""
        return self.collision

    @collision_flag.setter
    def collision_flag(self, value: bool) -> None:
        self._simulation.collided[self.row] = bool(value)

    @property
    def collision_obj(self) -> list[Any]:
        """The objects that it touches, without ``unobstructed`` ones."""
        pairs = self._simulation.state.collision_pairs(self.world)
        others = [int(b if a == self.index else a) for a, b in pairs if self.index in (a, b)]
        objects = self.environment_objects
        return [objects[i] for i in others if not objects[i].unobstructed]

    def done(self) -> bool:
        """Return whether the object has arrived or has been stopped."""
        return self.arrive or self.stop_flag

    # others ----------------------------------------------------------------------------------------------------------
    @property
    def environment_objects(self) -> list[Any]:
        """All objects of the world, in the order of their rows."""
        return self._simulation.views(self.world) if self.surroundings is None else list(self.surroundings)

    @property
    def external_objects(self) -> list[Any]:
        """All other objects of the world."""
        return [other for other in self.environment_objects if other is not self]

    @property
    def ego_object(self) -> Any:
        """The object itself."""
        return self

    # limits and description ------------------------------------------------------------------------------------------
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

    def get_vel_range(self) -> tuple[Floats, Floats]:
        """Return the lowest and highest controls that all limits allow in the next step, (vel_dim, 1) each."""
        change = np.asarray(self.acce) * self._simulation.scenario.world.step_time
        now = self.velocity
        return column(np.maximum(self.vel_min, now - change)), column(np.minimum(self.vel_max, now + change))

    # environment -----------------------------------------------------------------------------------------------------
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
