"""The worlds of one process, which reads and writes its part of the shared arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

from numpy.typing import NDArray

from irsim.learning.step import Result
from irsim.learning.workers.memory import ArrayLayout
from irsim.learning.worlds import Worlds

__all__ = ["DRAWN", "RESULTS", "Part", "layout_of", "python_parts"]

RESULTS = tuple(field.name for field in fields(Result))
"""Arrays of a result."""
DRAWN = "drawn."
"""Beginning of the names of arrays with what was drawn."""
_SLOTS = ("actions", "seen", "last")
"""Arrays that have one entry for each learner of each world."""


def layout_of(worlds: Worlds, n: int, parts: int) -> list[ArrayLayout]:
    """The shared arrays of n worlds in some parts, of which one is given."""
    learners, slots = worlds.learners, n * worlds.learners
    choices = worlds.task.action.choices
    made = [
        ArrayLayout("actions", (slots, worlds.width if choices is None else len(choices)), "f8"),
        ArrayLayout("seen", (slots, worlds.eyes.size), "f4"),
        ArrayLayout("last", (slots, worlds.eyes.size), "f4"),
        ArrayLayout("reward", (n, learners), "f8"),
        ArrayLayout("terms", (len(worlds.task.reward), n, learners), "f8", axis=1),
        ArrayLayout("contacts_between_steps", (n, learners), "i4"),
        ArrayLayout("over", (n,), "?"),
        ArrayLayout("mask", (n,), "?"),
        ArrayLayout("seeds", (n,), "u8"),
        ArrayLayout("level", (n,), "i8"),
        ArrayLayout("episodes", (parts,), "i8"),
    ]
    flags = ("terminated", "truncated", "active", "arrived", "collided", "present")
    made += [ArrayLayout(name, (n, learners), "?") for name in flags]
    made += [
        ArrayLayout(DRAWN + name, (n, *values.shape[1:]), values.dtype.str) for name, values in worlds.drawn.items()
    ]
    return made


def python_parts(worlds: Worlds) -> list[int]:
    """Counts of Python plug-ins in the worlds; the parent compares them to detect code that a worker lacks."""
    simulation = worlds.simulation
    drives, hooks = int(simulation.drives is not None), int(simulation.hooks is not None)
    return [len(simulation.decisions), len(simulation.measurements), drives, hooks]


class Part:
    """The worlds of one process.

    Args:
        worlds: The worlds.
        number: Number of the part.
        first: Index of its first world among all worlds.
        layout: The shared arrays.
        arrays: The arrays, of all worlds.
    """

    def __init__(
        self,
        worlds: Worlds,
        number: int,
        first: int,
        layout: Sequence[ArrayLayout],
        arrays: Mapping[str, NDArray[Any]],
    ) -> None:
        self.worlds = worlds
        of_worlds = slice(first, first + worlds.n)
        of_slots = slice(first * worlds.learners, (first + worlds.n) * worlds.learners)
        self._own = {}
        for one in layout:
            rows = slice(number, number + 1) if one.name == "episodes" else of_worlds
            rows = of_slots if one.name in _SLOTS else rows
            self._own[one.name] = arrays[one.name][(slice(None),) * one.axis + (rows,)]
        self._drawn: dict[str, NDArray[Any]] | None = None
        self._tell_draws()

    def do(self, command: Sequence[Any]) -> None:
        """Carry out a command: its name, and its arguments."""
        name, *arguments = command
        getattr(self, f"_{name}")(*arguments)
        if self.worlds.drawn is not self._drawn:
            self._tell_draws()

    def _advance(self, given: bool, reset: Any) -> None:
        own = self._own
        numbers = own["actions"] if given else None
        result = self.worlds.advance(numbers, reset, out=own["seen"], last=own["last"]).result
        for name in RESULTS:
            own[name][...] = getattr(result, name)

    def _renew(self) -> None:
        self.worlds.renew(self._own["over"].copy(), self._own["seen"], self._own["last"])

    def _observe(self) -> None:
        self.worlds.observe(self._own["seen"])

    def _reset(self, seeded: bool) -> None:
        self.worlds.reset(self._own["mask"], seeds=self._own["seeds"].tolist() if seeded else None)

    def _set_level(self, level: int) -> None:
        self.worlds.set_level(level)

    def _tell_draws(self) -> None:
        """Write what was drawn for the present episodes."""
        worlds, own = self.worlds, self._own
        self._drawn = worlds.drawn
        own["present"][...], own["level"][...] = worlds.present, worlds.level
        for name, values in worlds.drawn.items():
            own[DRAWN + name][...] = values
        own["episodes"] += 1
