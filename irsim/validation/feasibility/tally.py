"""What was found in how many of the scenes that were drawn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from irsim.diagnostics.diagnostic import Path
from irsim.scenario.messages.findings import Finding, hint, warning
from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["Tally"]

_OFTEN = 0.25
"""Share of the scenes from which it is a warning, not a hint."""


@dataclass
class _Entry:
    path: Path
    message: str
    fix: str
    serious: bool
    seed: int
    scenes: set[int] = field(default_factory=set)
    others: set[int] = field(default_factory=set)


@dataclass
class Tally:
    """Findings by code and entry of the scenario.

    Attributes:
        scenes: How many are looked at.
        random: Whether they differ.
    """

    scenes: int
    random: bool
    entries: dict[tuple[str, Path], _Entry] = field(default_factory=dict)

    def add(
        self, code: str, path: Path, record: ObjectRecord, message: str, fix: str, seed: int, *, serious: bool = True
    ) -> None:
        """Something about an object in the scene of a seed; the first one of an entry is told, others are counted."""
        entry = self.entries.setdefault((code, record.path), _Entry(path, message, fix, serious, seed))
        if serious and not entry.serious:
            entry.path, entry.message, entry.fix, entry.serious, entry.seed = path, message, fix, True, seed
        entry.scenes.add(seed)
        entry.others.add(record.id)

    def findings(self) -> Iterator[Finding]:
        """One for each code and entry."""
        for (code, _), entry in self.entries.items():
            message, serious = entry.message, entry.serious
            if self.random:
                count = len(entry.scenes)
                message = f"in {count} of {self.scenes} seeds, seed {entry.seed} for one: {message}"
                serious = serious and count >= _OFTEN * self.scenes
            elif len(entry.others) > 1:
                message += f"; likewise {len(entry.others) - 1} more of this entry"
            yield (warning if serious else hint)(code, entry.path, message, fix=entry.fix)
