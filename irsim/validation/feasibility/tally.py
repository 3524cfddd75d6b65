"""Findings collected over several scenes, with the number of scenes in which each occurs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from irsim.diagnostics.diagnostic import Path
from irsim.scenario.messages.findings import Finding, hint, warning
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.validation.feasibility.movers import Mover

__all__ = ["Tally"]

_MIN_WARNING_SHARE = 0.25
"""Share of the scenes from which on a finding is a warning, not a hint."""


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
        scenes: Number of scenes that are examined.
        random: Whether the scenes differ.
        seed: Seed of the scene that is examined.
        entries: The findings so far.
    """

    scenes: int
    random: bool
    seed: int = 0
    entries: dict[tuple[str, Path], _Entry] = field(default_factory=dict)

    def add(
        self,
        code: str,
        path: Path,
        record: ObjectRecord,
        message: str,
        fix: str,
        *,
        serious: bool = True,
        entry: Path | None = None,
    ) -> None:
        """Add a finding about an object; the first one of an entry of the scenario is kept, further ones are counted.

        Args:
            code: Code of the finding.
            path: Where it is written in the scenario.
            record: The object.
            message: The problem.
            fix: The advice.
            serious: Whether it is a warning, not a hint; a serious finding replaces one that is not.
            entry: The entry of the scenario that it counts for; default: the object's.
        """
        key = code, record.path if entry is None else entry
        kept = self.entries.setdefault(key, _Entry(path, message, fix, serious, self.seed))
        if serious and not kept.serious:
            kept.path, kept.message, kept.fix, kept.serious, kept.seed = path, message, fix, True, self.seed
        kept.scenes.add(self.seed)
        kept.others.add(record.id)

    def add_goal(self, code: str, mover: Mover, index: int, message: str, fix: str, *, serious: bool = True) -> None:
        """Add a finding about one of the goals of an object."""
        self.add(code, mover.goal_path(index), mover.record, message, fix, serious=serious)

    def findings(self) -> Iterator[Finding]:
        """One finding for each code and entry of the scenario."""
        for (code, _), entry in self.entries.items():
            message, serious = entry.message, entry.serious
            if self.random:
                count = len(entry.scenes)
                message = f"in {count} of {self.scenes} seeds, for example seed {entry.seed}: {message}"
                serious = serious and count >= _MIN_WARNING_SHARE * self.scenes
            elif len(entry.others) > 1:
                message += f"; likewise {len(entry.others) - 1} more of this entry"
            yield (warning if serious else hint)(code, entry.path, message, fix=entry.fix)
