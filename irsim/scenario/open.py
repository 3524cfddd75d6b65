"""Opens scenarios: returns one ready to build, or raises one exception that holds every problem."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from irsim.common.arguments import as_given
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import InputError
from irsim.scenario.behavior_override import check_behavior_name, parse_behavior, read_with_behavior
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.locate import locate
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import Document, load_path, load_text

__all__ = ["document_of", "import_modules", "open_scenario", "read_scenario"]


def open_scenario(
    name: str | os.PathLike[str] | None, *, strict: bool = False, limits: Limits | None = None
) -> tuple[ResolvedScenario, list[Diagnostic]]:
    """Find, read and check a scenario file.

    Args:
        name: As the user wrote it; None for the file named like the running script.
        strict: Treat what IR-SIM 2.12 ignores as an error.
        limits: Upper bounds; a larger scenario is refused.

    Returns:
        The scenario, and the warnings and hints about it.

    Raises:
        ScenarioNotFoundError: No file has that name.
        ScenarioError: The scenario cannot be used. NotSimulatedError if its only errors are features that this version
            does not simulate yet.
    """
    return or_raise(read(locate(name), strict=strict, limits=limits or DEFAULT_LIMITS))


def read_scenario(
    path: str | Path | Document | None = None,
    *,
    text: str | None = None,
    strict: bool,
    limits: Limits | None = None,
    behavior: str | None = None,
) -> tuple[ResolvedScenario, list[Diagnostic]]:
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
        InputError: ``behavior`` is not a valid behavior.
        ValueError: Neither or both of ``path`` and ``text`` are given.
    """
    document = path if isinstance(path, Document) else document_of(path, text, limits)
    if behavior is not None:
        try:
            check_behavior_name(behavior)
            scenario, diagnostics = read_with_behavior(document, parse_behavior(behavior), strict=strict)
        except InputError as error:
            error.where = "behavior"
            raise
        scenario.text = document.text  # a recorded run keeps the text of the user, not the one with the other behavior
        return scenario, diagnostics
    return or_raise(read(document, strict=strict, limits=limits or DEFAULT_LIMITS))


def document_of(path: str | Path | None, text: str | None, limits: Limits | None) -> Document:
    """The document of a scenario file, found by its name, or of a text.

    Raises:
        ScenarioNotFoundError: There is no such file.
        ValueError: Neither or both of ``path`` and ``text`` are given.
        InputError: ``path`` is not a path, or ``text`` is not a string.
    """
    if (path is None) == (text is None):
        raise ValueError("give either a path or a text")
    if path is not None:
        if not isinstance(path, (str, os.PathLike)):
            raise InputError(
                f"path must be the path of a file, got {as_given(path)}",
                "give the path of a file, or its content as text",
            )
        return load_path(locate(path), limits or DEFAULT_LIMITS)
    given: Any = text
    if not isinstance(given, str):
        fix = "decode it: text.decode()" if isinstance(given, bytes) else "give the YAML text of a scenario"
        raise InputError(f"text must be a string, got {as_given(given)}", fix)
    return load_text(given, limits=limits or DEFAULT_LIMITS)


def import_modules(names: Iterable[str]) -> None:
    """Import user modules (also from the current directory), so that they register their behaviors.

    Raises:
        ImportError: A module cannot be imported; the error has its name.
        InputError: ``names`` is a string instead of a list.
    """
    if isinstance(names, str):
        raise InputError(f"imports must be a list, got {as_given(names)}", f"give a list: imports=[{as_given(names)}]")
    for name in names:
        if "" not in sys.path and str(Path.cwd()) not in sys.path:
            sys.path.insert(0, str(Path.cwd()))
        importlib.import_module(name.removesuffix(".py").replace("/", "."))
