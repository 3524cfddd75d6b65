"""The input of every check."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from irsim.diagnostics.diagnostic import Path
from irsim.options.vectors import is_vector
from irsim.scenario.messages.findings import Finding
from irsim.scenario.model.lookup import at
from irsim.scenario.model.scenario import Entry, Scenario
from irsim.scenario.resolve.per_object import is_per_object, kind_of
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
from irsim.scenario.yaml.document import Document

__all__ = ["Context", "distinct"]


@dataclass(frozen=True)
class Context:
    """A valid scenario in all its forms.

    Attributes:
        scenario: The validated models.
        resolved: The resolved scenario, with one record per object.
        data: The data that were validated.
        document: The document as written.
        map_findings: Findings made while loading the map.
    """

    scenario: Scenario
    resolved: ResolvedScenario
    data: Mapping[str, Any]
    document: Document
    map_findings: Sequence[Finding] = ()

    def entries(self) -> Iterator[tuple[Path, Entry, list[ObjectRecord]]]:
        """Every entry with its path and its objects."""
        first = 0
        for role in ("robot", "obstacle"):
            for path, entry in self.scenario.entries(role):
                yield path, entry, self.resolved.objects[first : first + entry.number]
                first += entry.number

    @property
    def entry_objects(self) -> list[ObjectRecord]:
        """The objects made by entries, without the map and the walls round the world."""
        return [record for record in self.resolved.objects if record.path[0] != "world"]

    @cached_property
    def driven_groups(self) -> frozenset[int]:
        """Groups whose first member has a group behavior, which decides for all members."""
        leaders: dict[int, ObjectRecord] = {}
        for record in self.entry_objects:
            leaders.setdefault(record.group, record)
        return frozenset(group for group, leader in leaders.items() if leader.group_behavior is not None)

    @cached_property
    def bridged(self) -> frozenset[str]:
        """Names of the robots that programs at the other end of bridges may drive."""
        robots = [record.name for record in self.resolved.robots()]
        bridges: list[Any] = list(self.resolved.bridges)
        return frozenset(name for bridge in bridges for name in bridge.driven(robots))

    def why_undriven(self, record: ObjectRecord) -> str | None:
        """Why neither a behavior nor a policy moves an object, as a predicate; None if one may."""
        if record.kinematics is None:
            return "has no drive"
        if record.static:
            return "is static"
        return "replays a recording" if record.recorded and record.role == "obstacle" else None

    def entry(self, path: Path) -> Entry:
        """The entry at a path: ("robot", 0) or ("robot",)."""
        section: Any = getattr(self.scenario, str(path[0]))
        entry: Entry = section[path[1]] if len(path) > 1 else section
        return entry

    def entry_path(self, record: ObjectRecord, key: str) -> Path:
        """Path of an object's value of ``key``: the key itself or, if it holds a list, the object's element."""
        if record.path[0] == "world":
            return record.path
        value: Any = self.data
        for part in record.path:
            value = value[part]
        value = value.get(key)
        if is_per_object(value, kind_of(key)):
            return (*record.path, key, min(record.index, len(value) - 1))
        return (*record.path, key)

    def has_goals(self, path: Path) -> bool:
        """Whether a list of goals is written at a path, rather than a single goal."""
        written = at(self.data, path)
        return isinstance(written, (list, tuple)) and not is_vector(written)

    def goal_path(self, record: ObjectRecord, key: str, index: int) -> Path:
        """Path of one of the goals of an object, in a list or alone."""
        path = self.entry_path(record, key)
        return (*path, index) if self.has_goals(path) else path

    def is_given(self, record: ObjectRecord, key: str) -> bool:
        """Whether the entry of an object writes ``key`` (null does not count)."""
        value: Any = self.data
        for part in record.path:
            value = value[part]
        return value.get(key) is not None


def distinct(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Yield one finding per code and path: objects of one entry have the same problems."""
    seen: set[tuple[str, Path]] = set()
    for finding in findings:
        key = finding.diagnostic.code, finding.diagnostic.path
        if key not in seen:
            seen.add(key)
            yield finding
