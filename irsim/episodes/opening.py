"""Before the first step: a seed with room for every object, the findings of this run, the command that repeats it."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TypeVar

from irsim.common.text import listed
from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.diagnostics.errors import PlacementError
from irsim.results.benchmark import CROWDED
from irsim.results.findings import Finding
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = [
    "MAX_TRIES",
    "UNOPENED",
    "crowded_message",
    "findings_under_policy",
    "first_with_room",
    "overlay_options",
    "region_options",
    "reproduce_command",
    "seed_to_repeat",
    "strip_options",
    "unopened_bridges",
    "unopened_findings",
]

T = TypeVar("T")
MAX_TRIES = 20
"""Number of seeds that are tried before a scenario counts as too crowded."""
UNOPENED = "bridges-not-opened"
"""Code of the warning about bridges that what simulates does not open."""
_MAX_NAMED = 10
"""Number of seeds that a message names."""


def first_with_room(make: Callable[[int], T], seeds: Iterable[int]) -> tuple[T, list[int]]:
    """Make something with the first seed that leaves room for every object.

    Args:
        make: Function of a seed.
        seeds: Seeds to try, at least one.

    Returns:
        The object that was made, and the seeds before it that leave no room.

    Raises:
        PlacementError: None of the seeds leaves room; the error of the first one is raised.
    """
    first: PlacementError | None = None
    crowded: list[int] = []
    for seed in seeds:
        try:
            return make(seed), crowded
        except PlacementError as error:
            first = first or error
            crowded.append(seed)
    assert first is not None
    raise first


def crowded_message(crowded: Sequence[int]) -> str | None:
    """Name the seeds that had no room; None if every seed had."""
    if not crowded:
        return None
    many = len(crowded) > 1
    return f"seed{'s' * many} {listed([str(seed) for seed in crowded], _MAX_NAMED)} had no room ({CROWDED})"


def findings_under_policy(findings: Sequence[Finding], scenario: ResolvedScenario) -> list[Finding]:
    """Leave out ``no-behavior`` of robots that can move, because the policy moves them.

    Args:
        findings: Findings about the scenario as written.
        scenario: The scenario.
    """
    driven = {format_path(record.path) for record in scenario.robots() if record.kinematics is not None}
    return [finding for finding in findings if not (finding.code == "no-behavior" and finding.path in driven)]


def unopened_bridges(scenario: ResolvedScenario, what: str) -> list[Diagnostic]:
    """A warning for a scenario with bridges; empty without bridges.

    Args:
        scenario: The scenario.
        what: The work that does not open them, such as ``a benchmark``.
    """
    names = [str(getattr(one, "name", "bridge")) for one in scenario.bridges]
    if not names:
        return []
    message = f"{what} simulates without the bridges of the scenario ({', '.join(dict.fromkeys(names))})"
    fix = "irsim run, or irsim.connect in Python, opens them"
    return [Diagnostic(UNOPENED, "warning", ("bridges",), message, fix=fix)]


def unopened_findings(scenario: ResolvedScenario, what: str) -> list[Finding]:
    """The warning of :func:`unopened_bridges`, as results have it."""
    return [Finding.of(item) for item in unopened_bridges(scenario, what)]


_NO_FILE = "scenario.yaml"
"""File name in the command of a scenario that is given as text."""


def reproduce_command(
    verb: str,
    path: str | Path | None,
    seed: int | None,
    steps: int | None,
    strict: bool,
    imports: Sequence[str] = (),
    extra: Sequence[str] = (),
) -> str:
    """Write the command line that reproduces an episode; for a scenario without a file it says how to name one.

    Args:
        verb: The command.
        path: The scenario file, None for a text.
        seed: The seed; None leaves it out.
        steps: The limit of steps, for ``render`` the step that is drawn; None leaves it out.
        strict: Whether the scenario was read strictly.
        imports: Modules that were imported.
        extra: Further words.
    """
    words = ["irsim", verb, _NO_FILE if path is None else str(path)]
    if seed is not None:
        words += ["--seed", str(seed)]
    if steps is not None:
        words += ["--step" if verb == "render" else "--steps", str(steps)]
    if strict:
        words.append("--strict")
    for name in imports:
        words += ["--import", name]
    text = shlex.join([*words, *extra])
    return text if path is not None else f"{text}  # the text, saved as {_NO_FILE}"


def seed_to_repeat(scenario: ResolvedScenario, seed: int, random: Sequence[str]) -> int | None:
    """The seed that a command needs to repeat a run; None if it decides nothing and is the default of the command.

    Args:
        scenario: The scenario.
        seed: The seed of the run.
        random: Names of the parts that the seed decides.
    """
    return seed if seed != (scenario.world.seed or 0) or random else None


def region_options(region: Sequence[float] | None) -> list[str]:
    """Return the option of ``irsim render`` for a part of the world."""
    return [] if region is None else ["--region", *(f"{float(value):g}" for value in region)]


def overlay_options(overlays: Sequence[str] | None) -> list[str]:
    """Return the option of ``irsim render`` for what a picture shows besides bodies."""
    return [] if overlays is None else ["--overlays", ",".join(overlays)]


def strip_options(moments: int | None) -> list[str]:
    """Return the option of ``irsim render`` for several moments in one picture."""
    return [] if moments is None else ["--strip", str(moments)]
