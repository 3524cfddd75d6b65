"""Methods of objects that user code may override in subclasses or on instances, and that a step then calls."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from types import MethodType
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.diagnostics.errors import InputError
from irsim.objects.base import SimObject

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = [
    "HOOKS",
    "Hooks",
    "limited_control",
    "overridable",
    "overridden",
    "renew_goal",
    "step_alone",
    "take_part",
    "wrapped_state",
]

HOOKS = ("step", "pre_process", "gen_behavior_vel", "mid_process", "post_process")
Method = TypeVar("Method", bound=Callable[..., Any])


class overridable(Generic[Method]):
    """Descriptor of a method that the steps of an environment call as soon as it is overridden."""

    def __init__(self, default: Method) -> None:
        self.default = default
        self.name = default.__name__
        self.__doc__ = default.__doc__

    def __get__(self, view: Any, owner: type | None = None) -> Any:
        if view is None:
            return self.default
        return view.__dict__.get(self.name) or MethodType(self.default, view)

    def __set__(self, view: Any, method: Any) -> None:
        view.__dict__[self.name] = method
        take_part(view)

    def __delete__(self, view: Any) -> None:
        del view.__dict__[self.name]


def take_part(view: Any) -> None:
    """Register an object with its simulation if one of its methods is overridden."""
    if overridden(view):
        hooks = view._simulation.hooks
        if hooks is None:
            hooks = view._simulation.hooks = Hooks(view._simulation)
        hooks.add(view)


def overridden(view: Any) -> frozenset[str]:
    """Return the names of the methods of an object that user code has overridden, in its class or on itself."""
    own = view.__dict__
    kind: Any = type(view)
    return overridden_by(kind) | {name for name in HOOKS if name in own}


@cache
def overridden_by(kind: Any) -> frozenset[str]:
    """Return the names of the methods that a class of objects overrides."""
    return frozenset(name for name in HOOKS if not isinstance(_found(kind, name), overridable))


# what the methods do that are not overridden ---------------------------------------------------------------------
def renew_goal(view: SimObject) -> None:
    """Renew the goals of an arrived object with ``wander`` or ``loop``."""
    if view._simulation.arrived[view.row]:
        core.renew_row(view._simulation.world, view._simulation.state, view.row)


def limited_control(view: SimObject, velocity: Any) -> Floats:
    """Return the control that an object wants, or that it is given, within its limits, (vel_dim, 1)."""
    simulation, row = view._simulation, view.row
    hooks = simulation.hooks
    wanted: NDArray[np.float64]
    if velocity is not None:
        wanted = np.asarray(velocity, dtype=np.float64).reshape(-1)
        if wanted.size != view.vel_dim:
            raise InputError(f"a control of this object is {view.vel_dim} numbers, not {velocity!r}")
    elif hooks is not None and row in hooks.decided:
        wanted = hooks.decided[row]
    elif _has_no_behavior(view):
        _warn_of_standing(view)
        return simulation.decide_alone(view)[:, None]  # a drive stops at once, a passive body coasts
    else:
        wanted = simulation.decide_alone(view)
    now, (least, most) = simulation.control_of(row, view.vel_dim), simulation.limits(row)
    if view.record.actuation is not None:  # its actuators limit changes, after the dead time
        return np.minimum(np.maximum(wanted, least), most)[:, None]
    change = np.asarray(view.record.acce) * simulation.scenario.world.step_time
    low, high = np.maximum(least, now - change), np.minimum(most, now + change)
    control: Floats = np.minimum(np.maximum(wanted, low), high)[:, None]
    return control


def _has_no_behavior(view: SimObject) -> bool:
    """Return whether neither a behavior nor a group behavior drives the object."""
    own = view.record
    if own.behavior is not None:
        return False
    records = view._simulation.scenario.objects
    return not any(r.joined and r.group == own.group and r.group_behavior is not None for r in records)


def _warn_of_standing(view: SimObject) -> None:
    env = view._simulation.owner()
    if env is not None and view.role == "robot" and env.world_param.control_mode == "auto":
        env.logger.warning_once(f"{view.name}: it has no behavior and got no action, so it stands still")


def wrapped_state(view: SimObject, state: Any) -> Floats:
    """Return a state with the heading in ``angle_range``, (state_dim, 1); rows that it lacks keep their values."""
    values = np.asarray(state, dtype=np.float64).reshape(-1)
    out = view._simulation.row_state(view.row, view.state_dim)
    out[: values.size] = values[: view.state_dim]
    low, high = view.record.angle_range
    while out[2] < low:
        out[2] += 2 * math.pi
    while out[2] > high:
        out[2] -= 2 * math.pi
    return out[:, None]


def step_alone(view: Any, velocity: Any, sensor_step: bool) -> Floats:
    """Advance one object by one period, and return its new state, (state_dim, 1)."""
    simulation, row = view._simulation, view.row
    within = simulation.hooks is not None and row in simulation.hooks.stepping
    if view.static or simulation.cannot_move(row):
        simulation.set_control(row, np.zeros(view.vel_dim))
        return simulation.row_state(row, view.state_dim)[:, None]  # type: ignore[no-any-return]
    if not within:
        view.pre_process()
    simulation.impose(row, view.gen_behavior_vel(velocity).reshape(-1))
    before = simulation.row_state(row, view.state_dim), simulation.control_of(row, view.vel_dim).copy()
    simulation.move_alone(row)
    if "mid_process" in overridden(view):
        _settle(view, before)
    view.post_process()
    if not within:
        simulation.given[row] = 0
        core.remember_row(simulation.world, simulation.state, row)
        if sensor_step:
            core.sense(simulation.world, simulation.state)
            simulation.measure()
    return simulation.row_state(row, view.state_dim)[:, None]  # type: ignore[no-any-return]


class Hooks:
    """Calls the overridden methods of objects in each step.

    Attributes:
        stepping: Rows whose overridden ``step`` the environment is calling.
        decided: Controls that were decided, by row.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._views: list[Any] = []
        self.stepping: set[int] = set()
        self.decided: dict[int, Floats] = {}
        self._slots: dict[int, Floats | None] = {}
        self._before: dict[int, tuple[Floats, Floats, Floats, Floats]] = {}

    def add(self, view: Any) -> None:
        """Call the overridden methods of this object, too."""
        if not any(view is known for known in self._views):
            self._views.append(view)

    def _present(self) -> list[Any]:
        """Return the objects of the simulation with overridden methods, in the order of their rows."""
        simulation = self._simulation
        there = [view for view in self._views if view._simulation is simulation and overridden(view)]
        return sorted(there, key=lambda view: view.row)

    def decide(self) -> None:
        """Renew goals and run native behaviors, with the overridden ``pre_process`` of objects that have one."""
        simulation = self._simulation
        self.decided.clear()
        self._slots.clear()
        renewed = []
        for view in self._present():
            row = view.row
            if "pre_process" in overridden(view) and not (view.static or simulation.cannot_move(row)):
                view.pre_process()
                renewed.append((row, int(simulation.arrived[row])))
            if not self._views_own_step(view):
                continue
            given = bool(simulation.given[row])
            self._slots[row] = simulation.command_of(row, view.vel_dim)[:, None].copy() if given else None
        for row, _ in renewed:
            simulation.arrived[row] = 0
        core.decide(simulation.world, simulation.state)
        for row, arrived in renewed:
            simulation.arrived[row] = arrived

    @staticmethod
    def _views_own_step(view: Any) -> bool:
        return bool(overridden(view) & {"step", "gen_behavior_vel"})

    def before_motion(self) -> None:
        """Call ``gen_behavior_vel``, and save the state of objects whose ``step`` or ``mid_process`` is overridden."""
        simulation = self._simulation
        self._before.clear()
        for view in self._present():
            row, own = view.row, overridden(view)
            if view.static or simulation.cannot_move(row):
                continue
            if own & {"step", "gen_behavior_vel"}:
                self.decided[row] = simulation.command_of(row, view.vel_dim).copy()
                if "step" not in own:
                    simulation.impose(row, np.asarray(view.gen_behavior_vel(self._slots.get(row))).reshape(-1))
            if own & {"step", "mid_process"}:
                size = view.vel_dim
                control, drive = simulation.control_of(row, size).copy(), simulation.drive_of(row, size).copy()
                own_actuators = simulation.state.actuated[row : row + 1].copy()
                self._before[row] = simulation.row_state(row, view.state_dim), control, drive, own_actuators

    def after_motion(self) -> None:
        """Call the overridden ``step``, ``mid_process`` and ``post_process``."""
        simulation = self._simulation
        for view in self._present():
            row, own = view.row, overridden(view)
            if simulation.is_waiting(row):
                continue
            if "step" in own:
                if row in self._before:
                    state, control, drive, own_actuators = self._before[row]
                    simulation.set_row_state(row, state)
                    simulation.set_control(row, control)
                    simulation.drive_of(row, view.vel_dim)[:] = drive
                    simulation.state.actuated[row : row + 1] = own_actuators
                self.stepping.add(row)
                try:
                    view.step(self._slots.get(row), False)
                finally:
                    self.stepping.discard(row)
                continue
            if view.static or simulation.stopped[row]:
                continue
            if "mid_process" in own:
                _settle(view, self._before[row][:2])
            view.post_process()
        self.decided.clear()


def _settle(view: Any, before: tuple[Floats, Floats]) -> None:
    """Call ``mid_process`` with the object in its previous state, then set the state that it returns."""
    simulation, row = view._simulation, view.row
    reached = simulation.row_state(row, view.state_dim)
    control = simulation.control_of(row, view.vel_dim).copy()
    simulation.set_row_state(row, before[0])
    simulation.set_control(row, before[1])
    settled = np.asarray(view.mid_process(reached[:, None].copy()), dtype=np.float64).reshape(-1)
    reached[: settled.size] = settled[: reached.size]
    simulation.set_row_state(row, reached)
    simulation.set_control(row, control)


def _found(cls: type, name: str) -> Any:
    return next((base.__dict__[name] for base in cls.__mro__ if name in base.__dict__), None)
