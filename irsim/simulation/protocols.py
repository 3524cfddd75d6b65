"""What a simulation asks of the drives and hooks that users write in Python; ``irsim.objects.extensions`` has them."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import Any, Protocol

from irsim.common.arrays import Floats

__all__ = ["ExternalDrives", "StepHooks", "WideControls"]


class WideControls(Protocol):
    """Controls of a drive that has more than the three that the core keeps.

    Attributes:
        command: (n,) wanted in the next step.
        control: (n,) executed in the last one.
        drive: (n,) what the drive does, before contacts interfere.
    """

    command: Floats
    control: Floats
    drive: Floats


class ExternalDrives(Protocol):
    """Drives written in Python, which move the rows that the core leaves alone.

    Attributes:
        objects: Places, within a world, of the objects that they move.
    """

    objects: list[int]

    def handler(self, row: int) -> Any:
        """The :class:`KinematicsHandler` of a row; None where the core moves it."""

    def wide(self, row: int) -> WideControls | None:
        """The controls of a row that has more than the core keeps."""

    def find(self) -> bool:
        """Look for the objects that they move; True if there are any."""

    def prepare(self, worlds: Sequence[int], *, anew: bool = False) -> None:
        """Construct the handlers of objects that have none, or of all."""

    def reset(self, worlds: Sequence[int]) -> None:
        """Set the controls back to those of the start."""

    def follow(self) -> None:
        """Turn the velocities that native behaviors want into controls."""

    def move(self) -> None:
        """Limit the controls that the core does not keep, and move."""

    def move_row(self, row: int) -> None:
        """Move one object by one period."""

    def control_alone(self, row: int, wanted: Floats) -> Floats:
        """(n,) controls for what a native behavior wants of a row."""

    def feeling(self) -> AbstractContextManager[None]:
        """While it is entered, the controls follow what contacts change of the velocities."""


class StepHooks(Protocol):
    """Methods of objects that users have overridden, called at their moments of a step.

    Attributes:
        stepping: Rows whose own ``step`` is being called by the environment.
        decided: The controls that were decided for them.
    """

    stepping: set[int]
    decided: dict[int, Floats]

    def add(self, view: Any) -> None:
        """Ask this object, too."""

    def decide(self) -> None:
        """Renew goals, call ``pre_process`` and let native behaviors decide."""

    def before_motion(self) -> None:
        """Keep what the core is about to change of objects with a step of their own."""

    def after_motion(self) -> None:
        """Call ``step``, ``mid_process`` and ``post_process`` where they are overridden."""
