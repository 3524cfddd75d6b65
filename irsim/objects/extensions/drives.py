"""Drives written in Python, which move the rows that the core does not move."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.components.kinematics._handler import KinematicsHandler, construct, handler_class
from irsim.components.options import BehaviorOptions
from irsim.diagnostics.errors import BehaviorError
from irsim.objects.base import SimObject, column
from irsim.options.registry import BEHAVIORS, CUSTOM_BEHAVIORS
from irsim.simulation.build import COLLISION_MODES, CORE_CONTROLS, group_behaviors

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["PythonDrives", "attach_python_drives", "diff_control", "handler_of", "heading", "max_speed", "velocity_xy"]

_CONTACT = COLLISION_MODES["contact"]
_ROUNDING = 1e-9
_DIFF = core.DiffOptions(noise=False, alpha=[0.0] * 4, track=1.0)


class ManyControls:
    """The controls of a drive that has more than three; the core stores only the first three.

    Attributes:
        command: Control for the next step, (n,).
        control: Control executed in the last step, (n,).
        drive: Control of the drive before contacts change it, (n,).
    """

    def __init__(self, record: ObjectRecord) -> None:
        self.record = record
        self.command = np.zeros(record.vel_dim)
        self.control = np.zeros(record.vel_dim)
        self.drive = np.zeros(record.vel_dim)
        self.reset()

    def reset(self) -> None:
        """Set the controls to their initial values."""
        self.command[:] = 0.0
        self.control[:] = self.drive[:] = self.record.velocity

    def impose(self, control: Sequence[float] | Floats, limits: tuple[Floats, Floats], dt: float) -> bool:
        """Set the command, and return whether the limits will cut it by more than a rounding error."""
        self.command[:] = control
        return bool((np.abs(self._limited(limits, dt) - self.command) > _ROUNDING).any())

    def limit(self, limits: tuple[Floats, Floats], dt: float, *, moves: bool) -> None:
        """Limit the command and make it the executed control; 0 for an object that does not move."""
        self.control[:] = self._limited(limits, dt) if moves else 0.0

    def _limited(self, limits: tuple[Floats, Floats], dt: float) -> Floats:
        change = np.asarray(self.record.acce) * dt
        low = np.maximum(limits[0], self.control - change)
        high = np.minimum(limits[1], self.control + change)
        return np.minimum(np.maximum(self.command, low), high)


class PythonDrives:
    """Moves the objects whose kinematics a user has registered, row by row, in every world."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._handlers: dict[tuple[int, int], KinematicsHandler] = {}
        self._wide: dict[tuple[int, int], ManyControls] = {}
        self._decided_by_core: set[int] = set()
        self.objects: list[int] = []

    def find(self) -> bool:
        """Find the objects with drives of user code; return whether there are any."""
        records = self._simulation.scenario.objects
        drives = [getattr(record.kinematics, "name", None) for record in records]
        self.objects = [index for index, name in enumerate(drives) if handler_class(name) is not None]
        grouped = group_behaviors(records)
        self._decided_by_core = {index for index in self.objects if _is_decided_by_core(records[index], grouped)}
        return bool(self.objects)

    def prepare(self, worlds: Sequence[int], *, anew: bool = False) -> None:
        """Construct handlers for objects without one, or for all.

        Raises:
            TypeError: A constructor does not take a key of the scenario.
        """
        records = self._simulation.scenario.objects
        for world in worlds:
            for index in self.objects:
                key = world, records[index].id
                if anew or key not in self._handlers:
                    self._handlers[key] = construct(
                        records[index].kinematics, self._simulation.scenario.world.integration
                    )
                if records[index].vel_dim > CORE_CONTROLS and (anew or key not in self._wide):
                    self._wide[key] = ManyControls(records[index])

    def handler(self, row: int) -> KinematicsHandler | None:
        """Return the handler of a row; None if the core moves the row."""
        return self._handlers.get(self._key(row))

    def wide(self, row: int) -> ManyControls | None:
        """Return the controls of a row with more than three controls; None for other rows."""
        return self._wide.get(self._key(row)) if self._wide else None

    def _key(self, row: int) -> tuple[int, int]:
        world, index = divmod(row, self._simulation.objects)
        return world, int(self._simulation.ids[index])

    def reset(self, worlds: Sequence[int]) -> None:
        """Set the controls in these worlds to their initial values."""
        for (world, _), wide in self._wide.items():
            if world in worlds:
                wide.reset()

    def memory(self) -> Any:
        """The state that the drives keep from step to step."""
        return self._handlers, self._wide

    def recall(self, memory: Any) -> None:
        """Continue from what :meth:`memory` returned."""
        self._handlers, self._wide = memory

    def _rows(self) -> list[int]:
        count = self._simulation.objects
        return [world * count + index for world in range(self._simulation.copies) for index in self.objects]

    def _of(self, row: int) -> tuple[ObjectRecord, KinematicsHandler]:
        key = self._key(row)
        return self._simulation.scenario.objects[row % self._simulation.objects], self._handlers[key]

    def follow(self) -> None:
        """Convert the velocities that native behaviors choose into controls."""
        simulation = self._simulation
        for row in self._rows():
            record, _ = self._of(row)
            wide = self.wide(row)
            if wide is not None and not simulation.given[row]:
                wide.command[:] = 0.0  # a command holds for one step
            stands = record.static or simulation.cannot_move(row)
            if row % simulation.objects in self._decided_by_core and not simulation.given[row] and not stands:
                simulation.impose(row, self.control_alone(row, simulation.command[row].copy()))

    def control_alone(self, row: int, wanted: Floats) -> Floats:
        """Return the control (n,) that realizes the choice of a native behavior; native drives return the choice."""
        if self._key(row) in self._handlers and row % self._simulation.objects not in self._decided_by_core:
            return np.zeros(self._of(row)[0].vel_dim)
        control = self.control_for(row, wanted)
        return wanted if control is None else control

    def control_for(self, row: int, velocity: Floats) -> Floats | None:
        """Return the control (n,) that follows a world-frame velocity (2,) [m/s]; None where the core moves the row."""
        if self._key(row) not in self._handlers:
            return None
        record, handler = self._of(row)
        control: Floats = control_from(handler, self.state(row, record), velocity[:2, None].copy())
        return control

    def state(self, row: int, record: ObjectRecord) -> Floats:
        """Return the state of a row, (state_dim, 1)."""
        extra = self._simulation.extra[row, : record.state_dim - 3]
        state: Floats = np.concatenate([self._simulation.pose[row], extra])[:, None]
        return state

    def move(self) -> None:
        """Move all rows with drives of user code by one period."""
        for row in self._rows():
            self.move_row(row)

    @contextmanager
    def resolving_contacts(self) -> Iterator[None]:
        """Apply velocity changes by contacts within the ``with`` block to the controls of these drives, too."""
        before = self._simulation.twist.copy()
        yield
        for row in self._rows():
            self._follow_contact(row, self._simulation.twist[row] - before[row])

    def _follow_contact(self, row: int, change: Floats) -> None:
        """Adapt the control of a row to a change (3,) of its velocity: world frame [m/s] and yaw rate [rad/s]."""
        if not change.any():
            return
        record, handler = self._of(row)
        felt = control_from(handler, self.state(row, record), change[:2, None].copy(), turning=False)
        if handler.yaw_rate_row is not None:
            felt[handler.yaw_rate_row] += change[2]
        wide = self.wide(row)
        if wide is not None:
            wide.control += felt
        kept = felt[:CORE_CONTROLS]
        self._simulation.control[row, : kept.size] += kept

    def move_row(self, row: int) -> None:
        """Move one row by one period, unless the core moves it."""
        if self._key(row) not in self._handlers:
            return
        record, handler = self._of(row)
        simulation = self._simulation
        dt = simulation.scenario.world.step_time
        stands = record.static or simulation.cannot_move(row)
        wide = self.wide(row)
        if wide is not None:
            wide.limit(simulation.limits(row), dt, moves=not stands and bool(simulation.given[row]))
            simulation.set_control(row, wide.control)
        if stands:
            return
        control = simulation.control[row, : record.vel_dim] if wide is None else wide.control
        if simulation.world.collision_mode == _CONTACT:
            drive = simulation.drive_of(row, record.vel_dim)
            gravity = simulation.scenario.world.gravity
            drive[:] = control[:] = respond(control, drive, handler.translation_rows, record, dt, gravity)
            simulation.control[row, : min(CORE_CONTROLS, control.size)] = control[:CORE_CONTROLS]
        velocity = control[:, None].copy()
        before = self.state(row, record)
        after = _checked(handler.step(before.copy(), velocity, dt), record)
        pose = simulation.pose[row]
        pose[: min(3, after.size)] = after[:3]
        pose[2] = _into(pose[2], *record.angle_range)
        rest = after[3 : record.state_dim]
        simulation.extra[row, : rest.size] = rest
        simulation.twist[row] = _twist(handler, before, self.state(row, record), velocity, dt)


def respond(
    command: Floats, drive: Floats, travel: Sequence[int], record: ObjectRecord, dt: float, gravity: float
) -> Floats:
    """Return the executed control in ``collision_mode: contact``, (n,), after the lag and the grip of the drive.

    Args:
        command: Limited control in the command frame, (n,).
        drive: Control of the drive in the last period before contacts changed it, (n,).
        travel: Indices of the components that are speeds [m/s].
        record: Record of the object, with its lag and friction.
        dt: Period [s].
        gravity: Gravitational acceleration [m/s^2].
    """
    target: Floats = command.copy()
    if record.drive_tau > 0.0:
        target = drive + min(1.0, dt / record.drive_tau) * (command - drive)
    rows = list(travel)
    change = target[rows] - drive[rows]
    max_change, size = record.friction * gravity * dt, float(np.linalg.norm(change))
    if size > max_change:
        target[rows] = drive[rows] + change * (max_change / size)
    return target


def control_from(handler: KinematicsHandler, state: Floats, velocity_xy: Floats, *, turning: bool = True) -> Floats:
    """Return the control (n,) with which a drive follows a world-frame velocity (2, 1) [m/s].

    The method ``velocity_from_xy`` of the handler decides. A drive of two controls without that method turns toward the
    velocity like a differential drive, if ``turning`` is True.

    Raises:
        BehaviorError: The handler has no ``velocity_from_xy`` and its number of controls is not 2.
    """
    if not turning or type(handler).velocity_from_xy is not KinematicsHandler.velocity_from_xy:
        return np.asarray(handler.velocity_from_xy(state, velocity_xy), dtype=np.float64).reshape(-1)
    if handler.action_dim != 2:
        raise BehaviorError(
            f"behavior-failed: kinematics {handler.name!r} has no velocity_from_xy, which built-in behaviors need"
        )
    return np.array(diff_control(state[:3, 0].tolist(), velocity_xy[:, 0].tolist()))


def diff_control(pose: Sequence[float], velocity_xy: Sequence[float]) -> list[float]:
    """Return forward speed [m/s] and yaw rate [rad/s] with which a differential drive follows a velocity [m/s]."""
    return list(core.drive_follow(_DIFF, pose, velocity_xy)[:2])


def _twist(handler: KinematicsHandler, before: Floats, after: Floats, velocity: Floats, dt: float) -> Floats:
    """Return the world-frame velocity [m/s] and the yaw rate [rad/s] in the period, (3,)."""
    change = (after[:3, 0] - before[:3, 0]) / dt
    yaw = math.remainder(float(after[2, 0] - before[2, 0]), 2 * math.pi) / dt
    known = type(handler).velocity_to_xy is not KinematicsHandler.velocity_to_xy
    if known:
        change[:2] = np.asarray(handler.velocity_to_xy(after, velocity), dtype=np.float64).reshape(-1)[:2]
    return np.array([change[0], change[1], yaw])


def _checked(state: Any, record: ObjectRecord) -> Floats:
    name = getattr(record.kinematics, "name", "")
    try:
        values = np.asarray(state, dtype=np.float64).reshape(-1)
    except (TypeError, ValueError):
        values = np.full(1, np.nan)
    if not values.size or not np.isfinite(values).all():
        raise BehaviorError(f"behavior-failed: kinematics {name!r} moved {record.name!r} to {state!r}; return a state")
    return values


def _into(angle: float, low: float, high: float) -> float:
    while angle < low:
        angle += 2 * math.pi
    while angle > high:
        angle -= 2 * math.pi
    return angle


def _is_decided_by_core(record: ObjectRecord, grouped: dict[int, BehaviorOptions]) -> bool:
    """Return whether a behavior of the core decides for an object."""
    if record.group in grouped:
        return True
    name = str(getattr(record.behavior, "name", ""))
    feature = BEHAVIORS.get(name) if record.behavior is not None else None
    own = CUSTOM_BEHAVIORS.has(getattr(record.kinematics, "name", None), name)
    return feature is not None and feature.kernel is not None and not own


def attach_python_drives(simulation: Simulation, *, anew: bool = False) -> None:
    """Let drives of user code move their objects; call it again after the objects have changed.

    Args:
        simulation: The simulation.
        anew: Construct the handlers again.
    """
    drives = simulation.drives
    if drives is None:
        drives = PythonDrives(simulation)
        if not drives.find():
            return
        simulation.drives = drives
        simulation.scene_drawn.append(lambda worlds: drives.prepare(worlds, anew=True))
    drives.find()
    drives.prepare(range(simulation.copies), anew=anew)


def handler_of(view: SimObject) -> KinematicsHandler | None:
    """Return the handler of a drive of user code; None for other drives."""
    drives = view._simulation.drives
    return None if drives is None else drives.handler(view.row)


def heading(view: SimObject) -> float:
    """Return the direction of travel for an ``omni`` drive, the heading of the body for other drives [rad]."""
    if (handler := handler_of(view)) is not None:
        return float(handler.compute_heading(view.state, view.velocity))
    simulation, row = view._simulation, view.row
    if not getattr(view.record.kinematics, "turns", True):
        forward, lateral = simulation.control[row, :2]
        return math.atan2(lateral, forward) + float(simulation.pose[row, 2])
    return float(simulation.pose[row, 2])


def velocity_xy(view: SimObject) -> Floats:
    """Return the velocity in the world frame that follows from the present control, (2, 1) [m/s]."""
    if (handler := handler_of(view)) is not None:
        return column(handler.velocity_to_xy(view.state, view.velocity))
    return column(view._simulation.state.velocity_world(view.row))


def wheels_slip(view: SimObject) -> bool:
    """Whether the body may move otherwise than its controls say, because of its drive or of the ground of zones."""
    options: Any = view.record.kinematics
    if options is None:
        return False
    return bool(options.slips or ("slip" in options.feels and view._simulation.scenario.world.has_grounds))


def body_twist(view: SimObject) -> tuple[float, float, float]:
    """Return forward and leftward speed [m/s] and yaw rate [rad/s] of an object whose drive slips, body frame."""
    vx, vy = view._simulation.state.velocity_world(view.row)
    heading = float(view._simulation.pose[view.row, 2])
    c, s = math.cos(heading), math.sin(heading)
    return c * vx + s * vy, c * vy - s * vx, float(view._simulation.twist[view.row, 2])


def max_speed(view: SimObject) -> float:
    """Return the largest speed that the limits allow [m/s]; 0 for objects without a drive."""
    top = view._simulation.limits(view.row)[1]
    if view.record.kinematics is None:
        return 0.0
    if (handler := handler_of(view)) is not None:
        return float(handler.compute_max_speed(column(top)))
    if getattr(view.record.kinematics, "speeds", 0) == 2:
        return math.hypot(*top[:2].tolist())
    return float(top[0])
