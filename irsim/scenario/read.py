"""Reads a scenario: source → document → validated, checked and resolved scenario, with all findings."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from pydantic import ValidationError

from irsim.diagnostics.diagnostic import Diagnostic, Edit, Path, by_severity
from irsim.diagnostics.errors import NotSimulatedError, ScenarioError
from irsim.scenario.checks import KEY_CODES, Context, run_checks
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.messages.findings import Finding, error, key_path
from irsim.scenario.messages.translate import translate
from irsim.scenario.model.scenario import Scenario, WorldModel
from irsim.scenario.resolve.expand import resolve
from irsim.scenario.resolve.maps import LoadedMap, load_map
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import Document, load_data, load_path, load_text
from irsim.scenario.yaml.edits import apply_edits, removal_edit

__all__ = ["Reading", "or_raise", "read"]

FeasibilityChecks = Callable[[Context], Iterable[Finding]]
_STAND_INS = {"entry.kinematics.name": "diff", "entry.distribution.name": "random"}
"""Valid names that replace wrong ones, so that the later checks still see an object that moves and has a place."""
_MAX_ROUNDS = 6
"""Rounds of repairing and validating again; each round finds errors that earlier errors had hidden."""


@dataclass(frozen=True)
class Reading:
    """Result of reading a scenario.

    Attributes:
        scenario: The scenario, ready to build; None if an error makes it unusable.
        diagnostics: Everything found: errors, then warnings, then hints, each in the order of the file.
        document: The scenario as written.
    """

    scenario: ResolvedScenario | None
    diagnostics: list[Diagnostic] = field(default_factory=list)
    document: Document = field(default_factory=lambda: Document(None))

    @property
    def errors(self) -> list[Diagnostic]:
        """The findings that are errors."""
        return [item for item in self.diagnostics if item.severity == "error"]


def read(
    source: Document | str | os.PathLike[str] | Mapping[str, Any],
    *,
    strict: bool = False,
    limits: Limits = DEFAULT_LIMITS,
    name: str | None = None,
    feasibility: FeasibilityChecks | None = None,
) -> Reading:
    """Read, validate, check and resolve a scenario. The result holds all problems at once; none raises an exception.

    Args:
        source: A document, a path, YAML text (a string with a line break), or the data itself.
        strict: Report what IR-SIM 2.12 tolerates as errors; otherwise do what it does, and warn.
        limits: Upper bounds; a larger scenario is refused.
        name: Name of the text in messages.
        feasibility: Feasibility checks, which run only if no finding blocks the scenario.
    """
    document = _document(source, limits, name)
    findings = [Finding(problem) for problem in document.problems]
    if document.data is None and document.fatal:
        return Reading(None, _diagnostics(findings, document, strict), document)
    reader = _Reader(document, limits, findings, feasibility)
    resolved = reader.read()
    blocked = document.fatal or any(f.blocking or (strict and f.diagnostic.severity == "error") for f in findings)
    return Reading(None if blocked else resolved, _diagnostics(findings, document, strict, reader.renamed), document)


def _document(source: Any, limits: Limits, name: str | None) -> Document:
    if isinstance(source, Document):
        return source
    if isinstance(source, str) and "\n" in source:
        return load_text(source, name=name, limits=limits)
    if isinstance(source, (str, os.PathLike)):
        return load_path(source, limits)
    return load_data(source, name, limits)


class _Reader:
    """Validates the data, repairs a copy of it and validates again, so that one error does not hide the next."""

    def __init__(
        self, document: Document, limits: Limits, findings: list[Finding], feasibility: FeasibilityChecks | None = None
    ) -> None:
        self.document, self.limits, self.findings, self.feasibility = document, limits, findings, feasibility
        self.data = document.data
        self.touched: list[Path] = []
        self.renamed: dict[Path, Path] = {}
        self._map: tuple[Any, LoadedMap] | None = None

    def read(self) -> ResolvedScenario | None:
        """The scenario, its tolerated problems handled as in IR-SIM 2.12; meaningless if a finding is blocking."""
        if not isinstance(self.data, Mapping):
            self._add([_not_a_mapping(self.data)])
            return None
        if (other := _other_file(self.data)) is not None:
            self._add([other])
            return None
        too_many = _too_many_objects(self.data, self.limits)
        if too_many is not None:
            self._add([too_many])
            return None
        scenario = self._validate()
        if scenario is None:
            return None
        resolved = self._resolve(scenario)
        scenario = scenario.model_copy(update={"world": resolved.world})
        map_findings = self._map[1].findings if self._map is not None else []
        context = Context(scenario, resolved, self.data, self.document, map_findings)
        findings = run_checks(context)
        if self.feasibility is not None and not any(f.blocking for f in [*self.findings, *findings]):
            # Of two equal findings the first is kept, which was tried out.
            findings = [*self.feasibility(context), *findings]
        findings = [f for f in findings if not self._under_repair(f.diagnostic.path)]
        self._add(findings)
        edits = [f.carry_on for f in findings if f.carry_on is not None]
        if edits:
            self.data = apply_edits(self.data, edits)
            scenario = self._validate()
            return self._resolve(scenario) if scenario is not None else None
        return resolved

    def _validate(self) -> Scenario | None:
        for _ in range(_MAX_ROUNDS):
            try:
                return Scenario.model_validate(self.data)
            except ValidationError as failure:
                findings = translate(failure, self.data, self.document, self.limits.problems)
            self._add([f for f in findings if not self._under_repair(f.diagnostic.path)])
            if len(self.findings) > self.limits.problems:
                break
            edits = [self._repair(f) for f in findings]
            self.touched += [edit.path for edit in edits]
            self.renamed.update(
                ((*edit.path[:-1], str(edit.value)), edit.path) for edit in edits if edit.action == "rename"
            )
            self.data = apply_edits(self.data, edits)
            if (too_many := _too_many_objects(self.data, self.limits)) is not None:  # a repaired number counts too
                self._add([too_many])
                break
        return None

    def _repair(self, finding: Finding) -> Edit:
        """The edit that lets reading continue: 2.12's own reaction, else the suggested value, else a removal."""
        item = finding.diagnostic
        if finding.carry_on is not None:
            return finding.carry_on
        if item.edit is not None and item.edit.action in ("replace", "rename"):
            return item.edit
        if (stand_in := _STAND_INS.get(key_path(item.path))) is not None:
            return Edit("replace", item.path, stand_in)
        if item.code == "missing-key" or item.path[-1:] == ("name",):
            return removal_edit(item.path[:-1])
        return removal_edit(item.path)

    def _resolve(self, scenario: Scenario) -> ResolvedScenario:
        document = self.document
        stem = os.path.basename(document.path or document.name or "world").split(".")[0] or "world"
        data = dict(document.data) if isinstance(document.data, Mapping) else {}
        loaded = self._load_map(scenario.world)
        if loaded.world is not scenario.world:
            scenario = scenario.model_copy(update={"world": loaded.world})
        resolved = resolve(
            scenario, name=stem, document=data, source=document.path, text=document.text, grid=loaded.grid
        )
        resolved.map_files = loaded.files
        return resolved

    def _load_map(self, world: WorldModel) -> LoadedMap:
        """The map; it is loaded again only if its options or the extent of the world changed."""
        key = (world.obstacle_map, world.mdownsample, world.width, world.height, tuple(world.offset))
        if self._map is None or not _is_same_map(self._map[0], key):
            section = self.data.get("world") if isinstance(self.data, Mapping) else None
            written = section.get("obstacle_map") if isinstance(section, Mapping) else None
            self._map = key, load_map(world, written, self.document.path, self.limits, self.document.maps)
        return self._map[1]

    def _under_repair(self, path: Path) -> bool:
        return any(path[: len(other)] == other or other[: len(path)] == path for other in self.touched)

    def _add(self, findings: list[Finding]) -> None:
        known = {(f.diagnostic.code, f.diagnostic.path) for f in self.findings}
        for finding in findings:
            key = (finding.diagnostic.code, finding.diagnostic.path)
            if key not in known:
                known.add(key)
                self.findings.append(finding)


def _path_as_written(path: Path, renamed: Mapping[Path, Path]) -> Path:
    """The path before keys were renamed; the innermost renamed key is restored first."""
    for end in range(len(path), 0, -1):
        if (before := renamed.get(path[:end])) is not None:
            path = (*before, *path[end:])
    return path


def _is_same_map(a: tuple[Any, ...], b: tuple[Any, ...]) -> bool:
    """Whether options and numbers are equal; an array is equal only to itself."""
    return a[1:] == b[1:] and (a[0] is b[0] or (not hasattr(a[0], "__array__") and a[0] == b[0]))


def _not_a_mapping(data: Any) -> Finding:
    kind = "a list" if isinstance(data, (list, tuple)) else "text" if isinstance(data, str) else type(data).__name__
    return error(
        "not-a-scenario",
        (),
        f"a scenario must be a mapping, got {kind}",
        allowed="a mapping with the keys world, robot, obstacle, gui, bridges, custom",
        fix="start with 'world: {width: 10, height: 10}'",
    )


_OTHER_FILES = {
    "task": (
        "a task",
        "irsim validate FILE checks it, irsim train FILE trains and keeps its scenario as scenario.yaml in its folder",
    ),
    "suite": ("a suite", "irsim benchmark FILE runs it"),
}
"""First key -> kind of the file, and what it is for."""


def _other_file(data: Mapping[str, Any]) -> Finding | None:
    """The error if the file is of another kind, which its first key names; else None."""
    key = next(iter(data), None)
    if key not in _OTHER_FILES or any(section in data for section in ("world", "robot", "obstacle")):
        return None
    what, fix = _OTHER_FILES[key]
    return error("not-a-scenario", (), f"this is {what} file, and a scenario was expected", fix=fix)


def _too_many_objects(data: Mapping[str, Any], limits: Limits) -> Finding | None:
    """The error if the scenario has too many objects, found before any object is made; else None."""
    total = 0
    for role, what, limit in (
        ("robot", "robots", min(limits.robots, limits.objects)),
        ("obstacle", "objects", limits.objects),
    ):
        section = data.get(role)
        if section is None:
            continue
        for index, entry in enumerate(section if isinstance(section, (list, tuple)) else [section]):
            number = entry.get("number", 1) if isinstance(entry, Mapping) else 1
            if not isinstance(number, int) or number < 0:
                continue
            total += number
            if total > limit:
                path: Path = (role, index) if isinstance(section, (list, tuple)) else (role,)
                has_number = isinstance(entry, Mapping) and "number" in entry
                return error(
                    "too-many-objects",
                    (*path, "number") if has_number else path,
                    f"the limit is {limit:,} {what}, and up to this entry there are {total:,}",
                    given=number,
                    allowed=f"at most {limit:,} {what} in all",
                    fix=f"lower 'number', or raise the limit on {what}",
                )
    return None


def _diagnostics(
    findings: list[Finding], document: Document, strict: bool, renamed: Mapping[Path, Path] | None = None
) -> list[Diagnostic]:
    """The diagnostics of findings, with positions and in order; tolerated errors become warnings unless strict.

    Args:
        findings: The findings, with paths into the repaired data.
        document: The scenario as written.
        strict: As for :func:`read`.
        renamed: Path of each renamed key → its path as written.
    """
    shown, reported = [], set[tuple[Any, ...]]()
    shared = document.text is not None and "*" in document.text  # one mistake may be reached by several aliases
    for finding in findings:
        item = finding.diagnostic
        changes: dict[str, Any] = {"file": document.name}
        path = item.path
        if item.line is None:
            written = _path_as_written(path, renamed or {})
            mark = document.mark((*document.prefix, *written), key=item.code in KEY_CODES)
            if mark is not None and shared and item.severity == "error":
                once = (item.code, mark, path[-1:], repr(item.given))
                if once in reported:
                    continue
                reported.add(once)
            if mark is not None:
                changes.update(line=mark.line, column=mark.column, length=mark.length)
            changes["path"] = (*document.prefix, *path)
            if item.edit is not None and document.prefix:
                changes["edit"] = replace(item.edit, path=(*document.prefix, *item.edit.path))
        if item.tolerated and item.severity == "error" and not strict:
            changes["severity"] = "warning"
        shown.append(replace(item, **changes))
    ordered = by_severity(shown)
    limit = document.limits.problems
    if len(ordered) > limit:
        rest = len(ordered) - limit
        severity = ordered[limit].severity  # the highest severity among those left out
        last = Diagnostic("too-many-problems", severity, (), f"and {rest} more like these", file=document.name)
        ordered = [*ordered[:limit], last]
    return ordered


def or_raise(reading: Reading) -> tuple[ResolvedScenario, list[Diagnostic]]:
    """The scenario and the findings of a reading; raises if the scenario cannot be used."""
    if reading.scenario is None:
        errors = [item for item in reading.diagnostics if item.severity == "error"]
        kind = NotSimulatedError if all(e.code == "not-yet-simulated" for e in errors) else ScenarioError
        raise kind(reading.diagnostics, reading.document.text)
    return reading.scenario, reading.diagnostics
