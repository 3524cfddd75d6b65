"""Adding objects to a running world, deleting them, and changing their records.

An object is always a row of a simulation. Before it is added to an environment, and after it is deleted from it, the
object has a simulation of its own. Moving its row from one simulation to another keeps its state, goals, history and
random draws.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from irsim.objects.base import SimObject
from irsim.objects.extensions.behaviors import attach_python_behaviors, forget_behavior
from irsim.objects.extensions.drives import attach_python_drives
from irsim.objects.sensors.sensors import attach_python_sensors
from irsim.simulation.simulation import Simulation

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = [
    "amend",
    "amend_all",
    "amend_world",
    "attach_python",
    "lone_simulation",
    "move_in",
    "move_out",
    "renumber",
    "replace_plot",
    "restore",
    "set_views",
]


def set_views(simulation: Simulation, shown: Sequence[Any]) -> None:
    """Attach objects to the rows of a simulation of one world, in this order."""
    for index, (view, record) in enumerate(zip(shown, simulation.scenario.objects, strict=True)):
        if view.record is not record:
            view._describe(record)
        view._attach(simulation, index)
    simulation.keep_views(shown)


def renumber(view: SimObject, number: int) -> None:
    """Change the id of an object in a simulation of its own, and its name if that was generated from the id."""
    record, simulation = view.record, view._simulation
    name = record.name if record.is_named else f"{record.role}_{number}"
    scenario = replace(simulation.scenario, objects=[replace(record, id=number, name=name)])
    vars(view).update(id=number, name=name)
    simulation.exchange(scenario, [(simulation, 0)])
    set_views(simulation, [view])


def lone_simulation(scenario: ResolvedScenario, record: ObjectRecord, seed: int) -> Simulation:
    """Return a simulation of one object in an otherwise empty world with the settings of ``scenario``."""
    world = scenario.world.model_copy(update={"obstacle_map": None, "fog_map": False, "boundary": "none", "zones": []})
    simulation = Simulation(
        replace(scenario, world=world, objects=[record], placements=[], grid=None), [seed], history=True
    )
    simulation.user = record.id + 1
    attach_python_drives(simulation)
    return simulation


def move_in(simulation: Simulation, newcomers: Sequence[SimObject]) -> None:
    """Move objects from simulations of their own into a simulation of one world; they become its last rows."""
    present = simulation.views()
    records = [_as_it_starts(view) for view in newcomers]
    _exchange(simulation, [*present, *newcomers], [*simulation.scenario.objects, *records])


def move_out(simulation: Simulation, leaving: Iterable[SimObject]) -> None:
    """Move objects from a simulation of one world into simulations of their own."""
    gone = set(leaving)
    staying = [view for view in simulation.views() if view not in gone]
    seed = simulation.key()[0]
    for view in gone:
        _set_apart(simulation, view, seed)
    _exchange(simulation, staying, _with_leaders(simulation.scenario.objects, [view.record for view in staying]))


def amend(view: SimObject, record: ObjectRecord) -> None:
    """Replace the record of an object by another one with the same id; all objects keep their states.

    Raises:
        AttributeError: The object belongs to a batch, whose worlds share their records.
    """
    simulation = view._simulation
    _check_single(simulation, view)
    if record == view.record:
        return
    if record.behavior is not view.record.behavior:
        forget_behavior(simulation, view)
    shown = simulation.views()
    _exchange(simulation, shown, [record if other is view else other.record for other in shown])


def replace_plot(view: SimObject, record: ObjectRecord) -> None:
    """Replace the record of an object by one that differs in ``plot`` only, which the engine does not read.

    Raises:
        AttributeError: The object belongs to a batch, whose worlds share their records.
    """
    simulation = view._simulation
    _check_single(simulation, view)
    records = [record if other is view.record else other for other in simulation.scenario.objects]
    simulation.scenario = replace(simulation.scenario, objects=records)
    view.record = record


def _check_single(simulation: Simulation, view: SimObject) -> None:
    if simulation.copies != 1:
        raise AttributeError(f"{view.name!r} is an object of a batch: set it in the scenario, or for all with `make`")


def amend_all(simulation: Simulation, records: Sequence[ObjectRecord]) -> None:
    """Replace the records of all objects of a world, in their order; the objects keep their states."""
    shown = simulation.views()
    for view, record in zip(shown, records, strict=True):
        if record.behavior is not view.record.behavior:
            forget_behavior(simulation, view)
            for shown_keys in ("behavior", "_behavior"):
                vars(view).pop(shown_keys, None)
    _exchange(simulation, shown, records)


def amend_world(simulation: Simulation, **changed: Any) -> None:
    """Change values in the section ``world`` of the scenario; all objects keep their states."""
    world = simulation.scenario.world.model_copy(update=changed)
    shown = simulation.views()
    origins = [(simulation, view.row) for view in shown]
    simulation.exchange(replace(simulation.scenario, world=world), origins)
    _settle(simulation, shown)


def restore(simulation: Simulation, scenario: ResolvedScenario, originals: Sequence[SimObject]) -> None:
    """Start the next scene with the objects of ``scenario``, attached to ``originals``.

    All other objects get simulations of their own.
    """
    seed = simulation.key()[0]
    for view in simulation.views():
        if view not in originals:
            _set_apart(simulation, view, seed)
    simulation.restore(scenario)
    _settle(simulation, originals, anew=True)


def _exchange(simulation: Simulation, shown: Sequence[SimObject], records: Sequence[ObjectRecord]) -> None:
    origins = [(view._simulation, view.row) for view in shown]
    simulation.exchange(replace(simulation.scenario, objects=list(records)), origins)
    _settle(simulation, shown)


def _settle(simulation: Simulation, shown: Sequence[SimObject], *, anew: bool = False) -> None:
    """Attach objects and user code to a simulation after its rows have changed."""
    set_views(simulation, shown)
    attach_python(simulation, anew=anew)


def _set_apart(simulation: Simulation, view: SimObject, seed: int) -> None:
    """Move an object into a simulation of its own; its row in the old one stays."""
    own = lone_simulation(simulation.scenario, view.record, seed)
    own.exchange(own.scenario, [(simulation, view.row)])
    set_views(own, [view])


def _as_it_starts(view: SimObject) -> ObjectRecord:
    """Return the record of an object with its present initial values, from which later scenes start."""
    state = view.init_state[:, 0].tolist()
    return replace(view.record, state=state, goals=[goal[:, 0].tolist() for goal in view.goals])


def _with_leaders(before: Sequence[ObjectRecord], after: Sequence[ObjectRecord]) -> list[ObjectRecord]:
    """Return the records that stay, such that a group keeps its behavior even if its first member has left."""
    leaders: dict[int, ObjectRecord] = {}
    for record in before:
        if record.joined:
            leaders.setdefault(record.group, record)
    seen: set[int] = set()
    kept: list[ObjectRecord] = []
    for record in after:
        if record.joined and record.group not in seen:
            seen.add(record.group)
            behavior = leaders[record.group].group_behavior
            if record.group_behavior is not behavior:
                record = replace(record, group_behavior=behavior)
        kept.append(record)
    return kept


def attach_python(simulation: Simulation, *, anew: bool = False) -> None:
    """Attach drives, behaviors and sensors of user code; call it again after the objects have changed.

    Args:
        simulation: The simulation.
        anew: Construct drives, and behaviors that are classes, again.
    """
    attach_python_drives(simulation, anew=anew)
    attach_python_behaviors(simulation, anew=anew)
    attach_python_sensors(simulation)
