"""Protocols of drives and hooks written in Python, which a simulation calls, and of the recorder of an episode."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, Protocol

from irsim.common.arrays import Floats

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["EpisodeRecorder", "ExternalDrives", "PythonDecision", "PythonMeasurement", "StepHooks", "WideControls"]


PythonDecision = Callable[[Any], None]
"""Is called with the simulation between the native decisions and the motion, and fills ``command`` of the rows that it
decides for. Its method ``claim(simulation)``, if it has one, marks rows as ``given`` before the native decisions, which
then skip them."""

PythonMeasurement = Callable[[Any, "NDArray[np.bool_] | None"], None]
"""Is called with the simulation and a mask of worlds (None: all) after the native sensors, and updates the sensors that
it computes in these worlds."""


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

    def impose(self, control: Sequence[float] | Floats, limits: tuple[Floats, Floats], dt: float) -> bool:
        """Set the command, and return whether limits will cut it."""


class ExternalDrives(Protocol):
    """Drives written in Python, which move the rows that the core leaves alone.

    Attributes:
        objects: Places, within a world, of the objects that they move.
    """

    objects: list[int]

    def handler(self, row: int) -> Any:
        """The :class:`KinematicsHandler` of a row; None where the core moves it."""

    def wide(self, row: int) -> WideControls | None:
        """Return the controls of a row with more than three controls; None for other rows."""

    def find(self) -> bool:
        """Look for the objects that they move; True if there are any."""

    def prepare(self, worlds: Sequence[int], *, anew: bool = False) -> None:
        """Construct handlers for objects without one, or for all."""

    def reset(self, worlds: Sequence[int]) -> None:
        """Set the controls back to their initial values."""

    def follow(self) -> None:
        """Turn the velocities that native behaviors want into controls."""

    def move(self) -> None:
        """Limit the controls that the core does not keep, and move."""

    def move_row(self, row: int) -> None:
        """Move one object by one period."""

    def control_alone(self, row: int, wanted: Floats) -> Floats:
        """Return the control (n,) with which the drive of a row realizes the choice of a native behavior."""

    def control_for(self, row: int, velocity: Floats) -> Floats | None:
        """Return the control (n,) that follows a world-frame velocity (2,) [m/s]; None where the core moves the row."""

    def resolving_contacts(self) -> AbstractContextManager[None]:
        """Return a context in which velocity changes by contacts are applied to the controls of these drives, too."""


class StepHooks(Protocol):
    """Methods of objects that users have overridden, called at their moments of a step.

    Attributes:
        stepping: Rows whose own ``step`` is being called by the environment.
        decided: The controls that were decided for them.
    """

    stepping: set[int]
    decided: dict[int, Floats]

    def add(self, view: Any) -> None:
        """Call the overridden methods of this object, too."""

    def decide(self) -> None:
        """Renew goals, call ``pre_process`` and let native behaviors decide."""

    def before_motion(self) -> None:
        """Call ``gen_behavior_vel``, and save the state of objects that override ``step`` or ``mid_process``."""

    def after_motion(self) -> None:
        """Call ``step``, ``mid_process`` and ``post_process`` where they are overridden."""


class EpisodeRecorder(Protocol):
    """Advances a simulation and records its steps; :class:`irsim.runs.recorder.Recorder` is one."""

    def advance(self, steps: int, *, until_done: bool = False) -> int:
        """Advance the simulation and record what happens.

        Args:
            steps: Greatest number of steps.
            until_done: End as soon as every robot has arrived or stopped.

        Returns:
            Number of steps executed.
        """
        ...

    def write_if_due(self) -> None:
        """Write what has been recorded so far if enough of it, or enough time, has accumulated."""
        ...
