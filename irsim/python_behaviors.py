"""Behaviors written in Python the 2.12 way: functions of an object and its surroundings that return its control."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim.diagnostics import Diagnostic
from irsim.errors import BehaviorError, ScenarioError
from irsim.registry import BEHAVIORS, CUSTOM_BEHAVIORS

if TYPE_CHECKING:
    from irsim.simulation import Simulation
    from irsim.views import ObjectView

__all__ = ["attach_python_behaviors"]


class _Decision:
    """Asks the registered function for the control of each object in ``indices``, in every world."""

    def __init__(self, indices: list[int]) -> None:
        self.indices = indices

    def __call__(self, simulation: Simulation) -> None:
        from irsim.views import views

        for world in range(simulation.copies):
            objects = views(simulation, world)
            for index in self.indices:
                view = objects[index]
                row = view.row
                if simulation.given[row] or view.static or simulation.stopped[row]:
                    continue
                record = view.record
                options = record.behavior
                assert options is not None
                name = str(getattr(options, "name", ""))
                function = CUSTOM_BEHAVIORS.find(view.kinematics, name)
                if function is None:
                    raise _unknown(simulation, view, name)
                roles = record.target_roles
                others = [o for o in objects if o is not view and roles in ("all", o.role)]
                control = function(ego_object=view, external_objects=others, **options.model_dump(exclude_unset=True))
                values = _checked(control, name, view)
                simulation.command[row, : values.size] = values
                simulation.given[row] = 1


def _unknown(simulation: Simulation, view: ObjectView, name: str) -> ScenarioError:
    """Nothing has registered the behavior by the time it is needed."""
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


def _checked(control: object, name: str, view: ObjectView) -> NDArray[np.float64]:
    """What a behavior returned, as finite control components."""
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


def attach_python_behaviors(simulation: Simulation) -> None:
    """Let the Python behaviors that the scenario names take part in every step."""
    from irsim.world.build import group_behaviors

    grouped = group_behaviors(simulation.scenario.objects)
    indices = [
        index
        for index, record in enumerate(simulation.scenario.objects)
        if record.behavior is not None
        and record.group not in grouped
        and record.kinematics is not None
        and BEHAVIORS.get(str(getattr(record.behavior, "name", ""))) is None
    ]
    if indices:
        simulation.decisions.append(_Decision(indices))
