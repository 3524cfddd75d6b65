"""Behaviors written in Python the 2.12 way: functions of an object and its surroundings that return its control."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim.registry import BEHAVIORS, CUSTOM_BEHAVIORS

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["attach_python_behaviors"]


class UnknownBehaviorError(ValueError):
    """A behavior that nothing has registered by the time it is needed."""


class _Decision:
    """Asks the registered function for the control of each object in ``ids``, in every world."""

    def __init__(self, ids: list[int]) -> None:
        self.ids = ids

    def __call__(self, simulation: Simulation) -> None:
        from irsim.views import views

        for world in range(simulation.copies):
            objects = views(simulation, world)
            for index in self.ids:
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
                    known = ", ".join(CUSTOM_BEHAVIORS.names(view.kinematics)) or "none"
                    raise UnknownBehaviorError(
                        f"behavior {name!r} of {view.name!r} is not registered for {view.kinematics!r} "
                        f"(built-in: {', '.join(BEHAVIORS.names())}; custom: {known})"
                    )
                roles = record.target_roles
                others = [o for o in objects if o.id != index and roles in ("all", o.role)]
                control = function(ego_object=view, external_objects=others, **options.model_dump(exclude_unset=True))
                values = np.asarray(control, dtype=np.float64).reshape(-1)
                if values.size != view.vel_dim:
                    raise ValueError(
                        f"behavior {name!r} returned {values.size} numbers, {view.name!r} takes {view.vel_dim}"
                    )
                simulation.command[row, : values.size] = values
                simulation.given[row] = 1


def attach_python_behaviors(simulation: Simulation) -> None:
    """Let the Python behaviors that the scenario names take part in every step."""
    ids = [
        record.id
        for record in simulation.scenario.objects
        if record.behavior is not None
        and record.kinematics is not None
        and BEHAVIORS.get(str(getattr(record.behavior, "name", ""))) is None
    ]
    if ids:
        simulation.decisions.append(_Decision(ids))
