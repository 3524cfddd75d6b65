"""What every object has: its row of the simulation, and the state, goals, flags and limits in that row."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from irsim.components.kinematics._handler import KinematicsHandler
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["SimObject", "column"]

Floats = NDArray[np.float64]


def column(values: Any) -> Floats:
    """(n, 1) read-only copy."""
    copied = np.array(values, dtype=np.float64).reshape(-1, 1)
    copied.setflags(write=False)
    return copied


class SimObject:
    """One row of a simulation: what the other parts of an object build on.

    Attributes:
        record: The resolved scenario entry of the object.
        id: Number in its environment; it never changes.
        world: World index in a batch.
        index: Place among the objects of its world, which changes when earlier ones are taken out.
        row: Row in the simulation's arrays.
        surroundings: Objects of the environment that the object was made for, until it is added there; else None.
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
        """Name of the drive; None for objects that have none."""
        return None if self.record.kinematics is None else str(getattr(self.record.kinematics, "name", ""))

    @property
    def _handler(self) -> KinematicsHandler | None:
        """The drive, where a user wrote it."""
        drives = self._simulation.drives
        return None if drives is None else drives.handler(self.row)

    @property
    def abbr(self) -> str:
        """Short label: ``r0``, ``o3``."""
        return f"{self.role[0]}{self.id}"

    @property
    def goal_abbr(self) -> str:
        """Short label of the goal: ``G-r0``."""
        return f"G-{self.abbr}"

    def amend(self, record: ObjectRecord) -> None:
        """Go on with another record of the same id; :class:`irsim.objects.view.ObjectView` knows how."""
        raise NotImplementedError

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
    def collision_obj(self) -> list[Any]:
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
    def environment_objects(self) -> list[Any]:
        """All objects of its world, in the order of their rows."""
        return self._simulation.views(self.world) if self.surroundings is None else list(self.surroundings)

    @property
    def external_objects(self) -> list[Any]:
        """All objects of its world but itself."""
        return [other for other in self.environment_objects if other is not self]

    @property
    def ego_object(self) -> Any:
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

    # what it belongs to ----------------------------------------------------------------------------------------------
    @property
    def env_param(self) -> Any:
        """``env_param`` of its environment; None for an object that is in none."""
        return getattr(self._simulation.owner(), "env_param", None)

    @property
    def world_param(self) -> Any:
        """``world_param`` of its environment; None for an object that is in none."""
        return getattr(self._simulation.owner(), "world_param", None)

    @property
    def logger(self) -> Any:
        """The logger of its environment; None for an object that is in none."""
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
