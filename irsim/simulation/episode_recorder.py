"""What an environment needs of the recorder of an episode."""

from __future__ import annotations

from typing import Protocol

__all__ = ["EpisodeRecorder"]


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
