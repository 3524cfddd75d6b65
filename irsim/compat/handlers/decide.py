"""Evaluates a built-in behavior in a world that contains only the given objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from pydantic import BaseModel

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.objects.base import SimObject
from irsim.objects.extensions.drives import control_from, handler_of
from irsim.simulation.build import build_world

__all__ = ["decide_among"]

_GROUP = -1
"""Number of a group that no scenario uses."""


def decide_among(
    deciding: Sequence[SimObject], others: Sequence[SimObject], options: BaseModel, *, grouped: bool = False
) -> list[Floats]:
    """Return the controls, (vel_dim, 1) each, that a behavior chooses in a world of only the given objects.

    Args:
        deciding: Objects of one simulation.
        others: Other objects that they see.
        options: Options of the behavior.
        grouped: Whether the deciding objects are one group.
    """
    simulation = deciding[0]._simulation
    own, common = (None, options) if grouped else (options, None)
    records = [
        replace(
            view.record,
            group=_GROUP,
            joined=grouped,
            wander=False,
            target_roles="all",
            behavior=own,
            group_behavior=common,
        )
        for view in deciding
    ]
    records += [replace(v.record, joined=False, behavior=None, group_behavior=None) for v in others]
    shown = [*deciding, *others]
    world = build_world(replace(simulation.scenario, objects=records, placements=[]))
    if simulation.copies == 1:
        state = core.State(world, simulation.state, [(view._simulation.state, view.row) for view in shown])
    else:
        state = core.State(world, simulation.state.seed[:1], False)
        for row, view in enumerate(shown):
            state.pose[row], state.control[row] = simulation.pose[view.row], simulation.control[view.row]
            state.extra[row, : view.state_dim - 3] = simulation.extra[view.row, : view.state_dim - 3]
            state.set_goals(row, simulation.state.goals(view.row), False)
            state.moved(row)
    controls = []
    for row, view in enumerate(deciding):
        core.decide_row(world, state, row)
        controls.append(_control(view, state.command[row].copy()))
    return controls


def _control(view: SimObject, command: Floats) -> Floats:
    handler = handler_of(view)
    if handler is None:
        return command[: view.vel_dim, None]
    return control_from(handler, np.array(view.state), command[:2, None])[:, None]
