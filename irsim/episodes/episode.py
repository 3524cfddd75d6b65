"""One episode: read its scenario, choose its seed and horizon, and advance its environment."""

from __future__ import annotations

import importlib
import itertools
import json
import math
import os
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.common.arguments import as_given, check_whole_number
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, Edit, format_path
from irsim.diagnostics.errors import ArgumentError, OverLimitError
from irsim.env import Env
from irsim.results.findings import Edit as EditRecord
from irsim.results.findings import Finding
from irsim.results.run import HorizonSource
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.locate import locate
from irsim.scenario.open import or_raise
from irsim.scenario.read import read
from irsim.scenario.resolve.randomness import random_parts
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import Document, load_path, load_text
from irsim.simulation.build import steps_until

if TYPE_CHECKING:
    from irsim.simulation.episode_recorder import EpisodeRecorder

__all__ = [
    "HORIZON_FACTOR",
    "MIN_HORIZON",
    "Progress",
    "advance",
    "as_finding",
    "default_time_limit",
    "horizon_of",
    "import_modules",
    "read_document",
    "read_scenario",
    "seed_of",
    "source_of",
]

Progress = Callable[[int, int], None]
"""Callback ``(steps_done, steps_total)``, called every few steps."""

MIN_HORIZON = 30.0
"""Shortest default time limit of an episode [s]."""
HORIZON_FACTOR = 4.0
"""The default time limit is this many times the time of the longest straight route at top speed."""
_CHUNK_STEPS = 50
"""Number of steps between two calls of the progress callback."""
_MAX_GIVEN_LENGTH = 200
"""Number of characters of the JSON of a wrong value that a finding keeps."""


def import_modules(names: Iterable[str]) -> None:
    """Import user modules (also from the current directory), so that they register their behaviors.

    Raises:
        ImportError: A module cannot be imported; the error has its name.
        ArgumentError: ``names`` is a string instead of a list.
    """
    if isinstance(names, str):
        raise ArgumentError(
            f"imports must be a list, got {as_given(names)}", f"give a list: imports=[{as_given(names)}]"
        )
    for name in names:
        if "" not in sys.path and str(Path.cwd()) not in sys.path:
            sys.path.insert(0, str(Path.cwd()))
        importlib.import_module(name.removesuffix(".py").replace("/", "."))


def read_scenario(
    path: str | Path | Document | None = None,
    *,
    text: str | None = None,
    strict: bool,
    limits: Limits | None = None,
    behavior: str | None = None,
) -> tuple[ResolvedScenario, list[Finding]]:
    """Read a scenario from a file or a text.

    Args:
        path: Path of the file, or a document.
        text: Text of the scenario, instead of ``path``.
        strict: Refuse what IR-SIM would ignore.
        limits: Limits of the loader.
        behavior: Replaces every robot's own behavior; see :func:`irsim.scenario.behavior_override.parse_behavior`.

    Returns:
        The scenario, ready to build, and the warnings and hints about it.

    Raises:
        ScenarioError: The scenario has errors.
        BenchmarkError: ``behavior`` is not a valid behavior.
        ValueError: Neither or both of ``path`` and ``text`` are given.
    """
    source = path if isinstance(path, Document) else source_of(path, text, limits)
    if behavior is not None:
        from irsim.scenario.behavior_override import (
            BenchmarkError,
            check_behavior_name,
            parse_behavior,
            read_with_behavior,
        )

        document = source if isinstance(source, Document) else load_path(source, limits or DEFAULT_LIMITS)
        try:
            check_behavior_name(behavior)
            scenario, diagnostics = read_with_behavior(document, parse_behavior(behavior), strict=strict)
        except BenchmarkError as error:
            error.where = "behavior"
            raise
        scenario.text = document.text  # a recorded run keeps the text of the user, not the one with the other behavior
        return scenario, [as_finding(d) for d in diagnostics]
    scenario, diagnostics = or_raise(read(source, strict=strict, limits=limits or DEFAULT_LIMITS))
    return scenario, [as_finding(d) for d in diagnostics]


def seed_of(scenario: ResolvedScenario, seed: int | None) -> int | None:
    """The given seed, else that of the scenario, else 0 if nothing is random; None if a seed must be drawn."""
    chosen = scenario.world.seed if seed is None else seed
    return 0 if chosen is None and not random_parts(scenario) else chosen


def default_time_limit(scenario: ResolvedScenario, env: Env) -> float:
    """Time limit [s] of a scenario without one: 4 times the longest straight route at top speed, at least 30 s.

    The latest start of a robot is added: its ``start_time`` or ``appear_time``, and the longest delay if starts are
    perturbed.
    """
    longest = 0.0
    for view in env.robot_list:
        points = [view.init_state[:2, 0], *(goal[:2, 0] for goal in view.goals)]
        way = sum(math.dist(a, b) for a, b in itertools.pairwise(points))
        if view.max_speed > 0:
            longest = max(longest, way / view.max_speed)
    starts = [record.moves_from + (record.spreads.delay if record.spreads else 0.0) for record in scenario.robots()]
    return max(MIN_HORIZON, HORIZON_FACTOR * longest) + max(starts, default=0.0)


def read_document(document: Document, *, strict: bool) -> tuple[ResolvedScenario, list[Finding]]:
    """Read a scenario from a document; see :func:`read_scenario`.

    Raises:
        ScenarioError: The scenario has errors.
    """
    scenario, diagnostics = or_raise(read(document, strict=strict, limits=document.limits))
    return scenario, [as_finding(diagnostic) for diagnostic in diagnostics]


def source_of(path: str | Path | None, text: str | None, limits: Limits | None) -> str | Document:
    """The path of a scenario file, found by its name, or the document of a text.

    Raises:
        ScenarioNotFoundError: There is no such file.
        ValueError: Neither or both of ``path`` and ``text`` are given.
        ArgumentError: ``path`` is not a path, or ``text`` is not a string.
    """
    if (path is None) == (text is None):
        raise ValueError("give either a path or a text")
    if path is not None:
        if not isinstance(path, (str, os.PathLike)):
            raise ArgumentError(
                f"path must be the path of a file, got {as_given(path)}",
                "give the path of a file, or its content as text",
            )
        return locate(path)
    given: Any = text
    if not isinstance(given, str):
        fix = "decode it: text.decode()" if isinstance(given, bytes) else "give the YAML text of a scenario"
        raise ArgumentError(f"text must be a string, got {as_given(given)}", fix)
    return load_text(given, limits=limits or DEFAULT_LIMITS)


def as_finding(diagnostic: Diagnostic) -> Finding:
    """Convert a diagnostic to a finding, as results have it."""
    allowed = diagnostic.allowed
    return Finding(
        code=diagnostic.code,
        severity=diagnostic.severity,
        path=format_path(diagnostic.path),
        line=diagnostic.line,
        column=diagnostic.column,
        length=diagnostic.length,
        message=diagnostic.message,
        given=_short(diagnostic.given),
        allowed=allowed if allowed is None or isinstance(allowed, str) else list(allowed),
        fix=diagnostic.fix,
        edit=_edit(diagnostic.edit),
        tolerated=diagnostic.tolerated,
    )


def _short(given: Any) -> Any:
    """A value as written, or the beginning of its JSON if that is long."""
    try:
        text = json.dumps(given, default=str)
    except (ValueError, RecursionError):  # the value contains itself
        return clean(type(given).__name__)
    return given if len(text) <= _MAX_GIVEN_LENGTH else clean(text, _MAX_GIVEN_LENGTH)


def _edit(edit: Edit | None) -> EditRecord | None:
    """The edit of a finding; None for an edit that could change what the scenario means."""
    if edit is None or not edit.safe:
        return None
    return EditRecord(action=edit.action, path=format_path(edit.path), value=edit.value)


def horizon_of(scenario: ResolvedScenario, env: Env, steps: int | None, limits: Limits) -> tuple[int, HorizonSource]:
    """Greatest number of steps of an episode, and what determines it.

    A horizon that is derived from the scenario is cut to the limits; one that was asked for must be within them.

    Raises:
        OverLimitError: ``steps`` exceeds the limits.
        ArgumentError: ``steps`` is not a whole number, or negative.
    """
    most, what = _most_steps(len(scenario.objects), limits)
    if steps is not None:
        steps = check_whole_number("steps", steps)
        if most is not None and steps > most:
            raise OverLimitError(f"{steps:,} steps are too many: at most {what}", f"ask for at most {most:,} steps")
        return steps, "argument"
    limit = scenario.world.time_limit
    seconds = default_time_limit(scenario, env) if limit is None else limit
    horizon = steps_until(seconds, env.step_time)
    if most is not None and horizon > most:
        return most, "limits"
    return horizon, "default" if limit is None else "scenario"


def _most_steps(objects: int, limits: Limits) -> tuple[int | None, str]:
    """Greatest number of steps that the limits allow in one run, and the reason in words."""
    bounds: list[tuple[int, str]] = []
    if limits.steps is not None:
        bounds.append((limits.steps, f"{limits.steps:,} are run at once"))
    if limits.work is not None:
        each = limits.work // max(1, objects)
        bounds.append((each, f"{limits.work:,} steps x objects are run at once, and there are {objects:,} objects"))
    return min(bounds, default=(None, ""))


def advance(
    env: Env, steps: int, progress: Progress | None, *, until_done: bool = True, recorder: EpisodeRecorder | None = None
) -> None:
    """Advance an environment, by default until every robot has arrived or stopped.

    Args:
        env: The environment.
        steps: Greatest number of steps.
        progress: Callback ``(steps_done, steps_total)``.
        until_done: End as soon as every robot has arrived or stopped.
        recorder: Records the steps.
    """
    done = 0
    while done < steps and not (until_done and env.done()):
        done += max(1, env.advance(min(_CHUNK_STEPS, steps - done), until_done=until_done, recorder=recorder))
        if progress is not None:
            progress(done, steps)
