"""The command line that reproduces an episode or a picture."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["overlay_options", "region_options", "reproduce_command", "seed_to_repeat", "strip_options"]

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
        steps: Number of steps; None leaves it out.
        strict: Whether the scenario was read strictly.
        imports: Modules that were imported.
        extra: Further words.
    """
    words = ["irsim", verb, _NO_FILE if path is None else str(path)]
    if seed is not None:
        words += ["--seed", str(seed)]
    if steps is not None:
        words += ["--steps", str(steps)]
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
