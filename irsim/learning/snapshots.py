"""Snapshots of the environments of learning libraries."""

from __future__ import annotations

from typing import Any

from irsim.learning.notebook import worlds_html
from irsim.simulation.snapshot import dump, load

__all__ = ["Snapshots"]

_KEPT = ("_fresh", "_over", "agents", "_np_random", "_np_random_seed")
"""Attributes of environments that change in a step or a reset, besides the attributes of their worlds."""


class Snapshots:
    """Methods of an environment that keep its present state and return to it.

    Environments can also be copied with ``copy.deepcopy`` and pickled, without their windows.
    """

    worlds: Any

    def _repr_html_(self) -> str:
        return worlds_html(self.worlds, type(self).__name__)

    def snapshot(self) -> bytes:
        """The present state, from which :meth:`restore` goes on bit for bit: planning and checkpoints need it.

        It can be restored as often as you like, here or in another environment of the same task and the same version
        of irsim. Restore only snapshots that you trust: they are pickles.

        Raises:
            InputError: Code in Python keeps something that pickle cannot store, or there are several workers.
        """
        own = {name: getattr(self, name) for name in _KEPT if name in vars(self)}
        return dump((own, self.worlds.snapshot()), self.worlds.simulation, type(self).__name__)

    def restore(self, data: bytes) -> None:
        """Return to the state of a snapshot.

        Raises:
            InputError: It is of another task, or of another number of worlds.
        """
        own, worlds = load(data, self.worlds.simulation, type(self).__name__)
        self.worlds.restore(worlds)
        vars(self).update(own)
