"""Robots and moving obstacles that have goals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from irsim.diagnostics.diagnostic import Path
from irsim.scenario.checks import Context
from irsim.scenario.resolve.body_size import SizedBody, SizedShape, has_fixed_shape
from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["Mover", "movers_of"]

_MAX_MOVERS = 2000
"""Number of movers that are checked."""


@dataclass(frozen=True)
class Mover(SizedBody):
    """A robot, or an obstacle with a behavior of its own, whose body has a filled part.

    Attributes:
        path: Where its goals are written in the scenario.
        several: Whether a list of goals is written there.
    """

    path: Path
    several: bool

    def goal_path(self, index: int) -> Path:
        """Where one of its goals is written."""
        return (*self.path, index) if self.several else self.path

    @property
    def radius(self) -> float:
        """Radius of the largest disc inside its body [m]; where the disc does not fit, the body does not either."""
        return self.shape.disc

    @property
    def is_disc(self) -> bool:
        """Whether the body is the disc."""
        return self.shape.around <= self.radius * (1 + 1e-9)

    @property
    def reach(self) -> float:
        """Greatest distance of the middle of the disc from a goal on arrival [m]."""
        x, y, _ = self.shape.inner_disc
        return self.record.goal_threshold + math.hypot(x, y)

    def centre(self, pose: Sequence[float]) -> tuple[float, float]:
        """Middle of the disc at a pose of the body [m]."""
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        x, y, _ = self.shape.inner_disc
        return pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y

    @property
    def behavior(self) -> str:
        """Name of its own or its group's behavior, "" without any."""
        return str(getattr(self.record.active_behavior, "name", ""))


def movers_of(context: Context) -> list[Mover]:
    """Movers whose body has a filled part and is the same in every scene."""
    movers: list[Mover] = []
    shapes: dict[int, SizedShape] = {}
    for record in context.entry_objects:
        if record.static or record.kinematics is None or not has_fixed_shape(record.shape):
            continue
        if record.role != "robot" and record.behavior is None:
            continue
        if record.behavior is None and record.group_behavior is None and not _has_goal(context, record):
            continue  # a program drives it to a goal that the scenario does not name
        shape = shapes.setdefault(id(record.shape), SizedShape(record.shape))
        if shape.disc <= 0 or len(movers) >= _MAX_MOVERS:
            continue
        path = _goal_path(context, record)
        movers.append(Mover(record, shape, path, context.has_goals(path)))
    return movers


def _has_goal(context: Context, record: ObjectRecord) -> bool:
    return any(context.is_given(record, key) for key in ("goal", "waypoints", "distribution"))


def _goal_path(context: Context, record: ObjectRecord) -> Path:
    for key in ("waypoints", "goal"):
        if context.is_given(record, key):
            return context.entry_path(record, key)
    return (*record.path, "distribution") if context.is_given(record, "distribution") else record.path
