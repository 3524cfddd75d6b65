"""The interface that bridges to other programs implement.

``irsim/components/bridges/x.py`` has the options, derived from ``BridgeOptions``, and
``BRIDGES.register(X)(opened_by("x"))``; its ``driven`` says which robots the program may command.
``irsim/bridges/x/bridge.py`` has a subclass of :class:`Bridge` and ``make(options)``, and imports libraries when it
is opened; ``PARTS`` of ``irsim/bridges/doctor.py`` has its libraries and their tests on one machine for ``irsim
bridge doctor``. A run says that it is connected to ``peer`` in a ``mode``; ``renew`` gets each new scene.
``irsim/bridges/frames.py`` has the frames of other programs.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.diagnostics.errors import CodedError
from irsim.simulation.scene import SceneDescription

__all__ = ["Bridge", "BridgeError", "BridgeLostError", "Clock", "Mode"]

Mode: TypeAlias = Literal["sim", "dry-run", "real"]
"""Whether robots are simulated, or real ones that are not commanded, or real ones that are."""
Clock: TypeAlias = Literal["irsim", "external", "wall"]
"""Who decides when a step is: irsim as fast as it can, the other program, or the time on the wall."""


class BridgeError(CodedError, ValueError):
    """A bridge cannot be opened, or failed; :mod:`irsim.diagnostics.codes.tools` lists its codes."""


class BridgeLostError(BridgeError):
    """The program at the other end is gone or does not answer; the episode ends with this reason."""

    def __init__(self, message: str, fix: str = "start the other program again, then run the scenario again") -> None:
        super().__init__("bridge-lost", message, fix)


class Bridge:
    """One connection to another program; :func:`irsim.connect` calls the methods in this order.

    ``open``, then in each step ``pull`` (before the decisions), ``exchange`` (after decisions and motion, before
    contacts, collisions and sensors) and ``push`` (after the step); at the end, also after an exception, ``close``.
    A subclass overrides the methods that it needs.

    Attributes:
        name: Name of the bridge in messages.
        clock: Who decides when a step is.
        mode: Whether robots are simulated or real.
        agents: Names of the objects that the other program moves, known after ``open``; irsim does not move them.
    """

    name: str = "bridge"
    clock: Clock = "irsim"
    mode: Mode = "sim"
    agents: frozenset[str] = frozenset()

    @property
    def peer(self) -> str:
        """The program that it is connected to, in a few words, known after ``open``."""
        return self.name

    def open(self, scene: SceneDescription, start: WorldState) -> None:
        """Connect, and tell the other program the scene.

        Raises:
            BridgeError: The other program cannot be reached, or the scene does not fit it.
        """

    def renew(self, scene: SceneDescription, start: WorldState) -> None:
        """Take over another scene, which a reset has drawn, or in which a body is another one; ``push`` follows."""

    def pull(self) -> Feedback | None:
        """Goals, commands and poses that have come from outside since the last step; never NaN.

        A bridge whose clock is ``external`` waits here for the next tick, for a limited time.
        """
        return None

    def exchange(self, motion: Motion) -> Feedback | None:
        """Hand over what the robots want in this step; return where the agents of this bridge are at its end."""
        return None

    def push(self, state: WorldState) -> None:
        """Show the world after a step."""

    def notes(self) -> list[str]:
        """Remarks for the user at the end of a run, before ``close``; one sentence each."""
        return []

    def close(self) -> None:
        """Stop the robots and disconnect; a second call does nothing."""
