"""Behaviors written in Python as in IR-SIM 2.12: they return the control of an object, or of each group member."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import BehaviorError, ScenarioError
from irsim.objects.surroundings import Surroundings
from irsim.options.registry import BEHAVIORS, CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS, CustomBehaviors
from irsim.simulation.build import group_behaviors

if TYPE_CHECKING:
    from irsim.objects.base import SimObject
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = [
    "PythonBehaviors",
    "attach_python_behaviors",
    "call",
    "construct",
    "forget_behavior",
]


class PythonBehaviors:
    """Calls user code for the controls of objects and groups in every world; all calls see the same state.

    Attributes:
        objects: Indices, within a world, of the objects whose `behavior` is user code or is not registered yet.
        groups: Indices of the members of each group whose first member has such a `group_behavior`.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._instances: dict[tuple[int, int, str], Any] = {}
        self.objects: list[int] = []
        self.groups: list[list[int]] = []

    def find(self) -> bool:
        """Find the objects and groups whose behaviors are user code; return whether there are any."""
        records = self._simulation.scenario.objects
        native = group_behaviors(records)
        own: dict[tuple[str, str], bool] = {}

        def is_own(record: ObjectRecord) -> bool:
            if record.behavior is None or record.kinematics is None:
                return False
            pair = _name(record.kinematics), _name(record.behavior)
            if pair not in own:
                own[pair] = _is_own(record, record.behavior, CUSTOM_BEHAVIORS)
            return own[pair]

        members: dict[int, list[int]] = {}
        for index, record in enumerate(records):
            if record.joined:
                members.setdefault(record.group, []).append(index)
        self.objects = [
            index
            for index, record in enumerate(records)
            if not (record.joined and record.group in native) and is_own(record)
        ]
        self.groups = [
            group
            for number, group in members.items()
            if number not in native
            and _is_own(records[group[0]], records[group[0]].group_behavior, CUSTOM_GROUP_BEHAVIORS)
        ]
        return bool(self.objects or self.groups)

    def prepare(self, worlds: Sequence[int], *, anew: bool = False) -> None:
        """Construct the behaviors that are classes, once per object or group.

        Args:
            worlds: Indices of the worlds.
            anew: Construct existing ones again.
        """
        for world in worlds:
            objects = self._simulation.views(world)
            for index in self.objects:
                view = objects[index]
                key = (world, view.id, "behavior")
                maker = CUSTOM_BEHAVIORS.maker(view.kinematics, _name(view.record.behavior))
                if maker is not None and (anew or key not in self._instances):
                    self._construct(key, maker, view.info, _keys_as_given(view.record.behavior))
            for group in self.groups:
                leader = objects[group[0]]
                key = (world, leader.group, "group")
                maker = CUSTOM_GROUP_BEHAVIORS.maker(leader.kinematics, _name(leader.record.group_behavior))
                if maker is not None and (anew or key not in self._instances):
                    chosen = [objects[index] for index in group]
                    self._construct(key, maker, chosen, _keys_as_given(leader.record.group_behavior))

    def forget(self, view: SimObject) -> None:
        """Delete the behavior that was constructed for an object."""
        self._instances.pop((view.world, view.id, "behavior"), None)

    def memory(self) -> Any:
        """The behaviors that are objects, which may remember something."""
        return self._instances

    def recall(self, memory: Any) -> None:
        """Continue from what :meth:`memory` returned."""
        self._instances = memory

    def _construct(self, key: tuple[int, int, str], maker: Any, given: Any, options: dict[str, Any]) -> None:
        made = construct(maker, given, options, "behavior class", self._simulation.report)
        if made is None:
            self._instances.pop(key, None)
        else:
            self._instances[key] = made

    def __call__(self, simulation: Simulation) -> None:
        """Set the commands of all objects with user behaviors; groups decide before single objects."""
        for world in range(simulation.copies):
            objects = simulation.views(world)
            for group in self.groups:
                self._decide_group(world, [objects[index] for index in group])
            for index in self.objects:
                view = objects[index]
                if simulation.given[view.row] or view.static or simulation.cannot_move(view.row):
                    continue
                name = _name(view.record.behavior)
                _impose(simulation, view, name, self.control(view))

    def control(self, view: SimObject) -> Any:
        """Return the control that user code chooses for an object.

        Raises:
            ScenarioError: The behavior is not registered.
        """
        options = view.record.behavior
        name = _name(options)
        act = self._instances.get((view.world, view.id, "behavior")) or CUSTOM_BEHAVIORS.function(view.kinematics, name)
        if act is None:
            raise _unknown(self._simulation, view, name)
        with _belief_of(view):
            return call(act, view, Surroundings(view).others, view.record.target_roles, _keys_as_given(options))

    def _decide_group(self, world: int, members: list[SimObject]) -> None:
        leader, simulation = members[0], self._simulation
        options = leader.record.group_behavior
        name = _name(options)
        act = self._instances.get((world, leader.group, "group"))
        act = act or CUSTOM_GROUP_BEHAVIORS.function(leader.kinematics, name)
        if act is None:
            simulation.report(
                f"group behavior {name!r} is not registered for {leader.kinematics!r}: its members follow their own"
            )
            return
        controls = act(members, **_keys_as_given(options))
        for view, control in zip(members, () if controls is None else controls, strict=False):
            if control is None or simulation.given[view.row] or view.static or simulation.cannot_move(view.row):
                continue
            _impose(simulation, view, name, control)


def construct(maker: Any, given: Any, keys: Mapping[str, Any], what: str, report: Callable[[str], None]) -> Any:
    """Make the behavior of a class of user code; what the class raises is reported, and None is returned."""
    try:
        return maker(given, **keys)
    except Exception as error:  # the object goes on without it, as in IR-SIM
        report(f"{what} {keys.get('name')!r} could not be constructed: {error!r}")
        return None


def call(act: Any, ego_object: Any, others: Iterable[Any], roles: str, keys: Mapping[str, Any]) -> Any:
    """Return the control that a behavior chooses for an object that sees the others with a role, or ``all``."""
    seen = [other for other in others if roles in ("all", other.role)]
    return act(ego_object=ego_object, external_objects=seen, **keys)


def _belief_of(view: SimObject) -> AbstractContextManager[None]:
    """The context in which user code sees what an object believes instead of the truth."""
    if view.record.perceives == "truth":
        return nullcontext()
    return core.Belief(view._simulation.world, view._simulation.state, view.row)


def _name(options: Any) -> str:
    return str(getattr(options, "name", ""))


def _keys_as_given(options: Any) -> dict[str, Any]:
    """Return the keys of the mapping as written in the file."""
    keys: dict[str, Any] = options.model_dump(exclude_unset=True)
    return keys


def _is_own(record: ObjectRecord, options: Any, table: CustomBehaviors) -> bool:
    """Return whether the options name a behavior of user code, or one that is not registered."""
    if options is None or record.kinematics is None:
        return False
    name = _name(options)
    return table.has(_name(record.kinematics), name) or BEHAVIORS.get(name) is None


def _impose(simulation: Simulation, view: SimObject, name: str, control: Any) -> None:
    simulation.impose(view.row, _checked(control, name, view))


def _unknown(simulation: Simulation, view: SimObject, name: str) -> ScenarioError:
    """Return the error that a behavior is not registered at the time it is needed."""
    known = [*BEHAVIORS.names(), *CUSTOM_BEHAVIORS.names(view.kinematics)]
    finding = Diagnostic(
        code="unknown-behavior",
        severity="error",
        path=(*view.record.path, "behavior", "name"),
        message=f"behavior {name!r} of {view.name!r} is not registered for {view.kinematics!r}",
        given=name,
        allowed=known,
        fix="register it before the first step: irsim run --import MODULE, or register_behavior in Python",
        file=simulation.scenario.source,
    )
    return ScenarioError([finding], simulation.scenario.text)


def _checked(control: object, name: str, view: SimObject) -> NDArray[np.float64]:
    """Return what a behavior returned as an array of finite control components.

    Raises:
        BehaviorError: It is not ``vel_dim`` finite numbers.
    """
    problem = f"behavior-failed: behavior {name!r} of {view.name!r} returned"
    if control is None:
        raise BehaviorError(f"{problem} None; return {view.vel_dim} numbers")
    try:
        values = np.asarray(control, dtype=np.float64).reshape(-1)
    except (TypeError, ValueError):
        raise BehaviorError(f"{problem} {control!r}; return {view.vel_dim} numbers") from None
    if values.size != view.vel_dim:
        raise BehaviorError(f"{problem} {values.size} numbers; {view.kinematics!r} takes {view.vel_dim}")
    if not np.isfinite(values).all():
        raise BehaviorError(f"{problem} {values.tolist()}, which is not finite")
    return values


def attach_python_behaviors(simulation: Simulation, *, anew: bool = False) -> None:
    """Let the Python behaviors that the scenario names decide in every step.

    Call it again after registrations or objects have changed.

    Args:
        simulation: The simulation.
        anew: Construct behaviors that are classes again.
    """
    known = [part for part in simulation.decisions if isinstance(part, PythonBehaviors)]
    part = known[0] if known else PythonBehaviors(simulation)
    if part.find() and not known:
        simulation.decisions.append(part)
        simulation.scene_drawn.append(lambda worlds: part.prepare(worlds, anew=True))
    part.prepare(range(simulation.copies), anew=anew)


def forget_behavior(simulation: Simulation, view: SimObject) -> None:
    """Delete the constructed behavior of an object, so that attaching user code constructs a new one."""
    for part in simulation.decisions:
        if isinstance(part, PythonBehaviors):
            part.forget(view)
