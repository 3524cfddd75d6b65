"""Who learns: robots of a scenario that are alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import clean, listed
from irsim.diagnostics.diagnostic import suggestion
from irsim.learning.tasks.files import TaskError
from irsim.learning.tasks.task import Task
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["Team", "team_of"]

_MAX_CONTROLS = 3


@dataclass(frozen=True)
class Team:
    """The learners of a world.

    Attributes:
        indices: (A,) their indices among the objects of a world.
        names: Their names.
        drive: Name of their drive.
        action_width: Number of numbers of an action; 1 for the number of a choice.
    """

    indices: NDArray[np.int64]
    names: tuple[str, ...]
    drive: str
    action_width: int


def team_of(task: Task, scenario: ResolvedScenario) -> Team:
    """Find the learners of a task.

    Raises:
        TaskError: There is no learner, they differ in their drive, or the action does not fit it.
    """
    records = scenario.objects
    able = [i for i, one in enumerate(records) if one.role == "robot" and one.kinematics is not None and not one.static]
    chosen = able if task.learners is None else _named(task.learners, records, able)
    if not chosen:
        raise TaskError(
            "no robot of the scenario can move", "add a robot with a drive, such as kinematics: {name: diff}"
        )
    first = records[chosen[0]]
    for index in chosen:
        record = records[index]
        if record.kinematics != first.kinematics or record.vel_dim != first.vel_dim:
            what = f"the learners {first.name!r} and {record.name!r} have different drives"
            raise TaskError(what, "choose learners that share a drive, with the key learners")
    if first.vel_dim > _MAX_CONTROLS:
        raise TaskError(f"the drive of {first.name!r} has {first.vel_dim} controls", "use a drive with at most three")
    drive = str(getattr(first.kinematics, "name", ""))
    names = tuple(records[i].name for i in chosen)
    return Team(np.array(chosen, dtype=np.int64), names, drive, _action_width(task, first))


def _named(words: list[str], records: Sequence[ObjectRecord], able: list[int]) -> list[int]:
    chosen: list[int] = []
    for word in words:
        these = [i for i in able if records[i].name == word or word in records[i].tags]
        if not these:
            known = sorted({records[i].name for i in able})
            fix = suggestion(word, known, f"choose from {listed(known, 8)}")
            raise TaskError(f"no robot that can move has the name or the tag {clean(word)!r}", fix)
        chosen += [i for i in these if i not in chosen]
    return sorted(chosen)


def _action_width(task: Task, record: ObjectRecord) -> int:
    action = task.action
    controls = record.vel_dim if action.returns == "control" else 2
    for key, row in (
        ("low", action.low),
        ("high", action.high),
        ("choices", action.choices[0] if action.choices else None),
    ):
        if row is not None and len(row) != controls:
            whose = "the drive has" if action.returns == "control" else "a velocity has"
            raise TaskError(f"action.{key} has {len(row)} numbers, and {whose} {controls}", f"give {controls} numbers")
    if action.choices is None and action.returns == "control" and action.low is None:
        low, high = np.array(record.vel_min), np.array(record.vel_max)
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            what = f"actions lie between the limits of controls, but {record.name!r} has infinite limits"
            raise TaskError(what, "give the robot finite vel_min and vel_max, or the action low and high")
    return 1 if action.choices is not None else controls
