"""Finds the file that a scenario name means, in the four places IR-SIM searches, or suggests similar names."""

from __future__ import annotations

import difflib
import os
import sys
from collections.abc import Iterable

from irsim.diagnostics.errors import ScenarioNotFoundError

__all__ = ["default_name", "locate"]

_MAX_SUGGESTIONS = 3
"""Similar file names that the message lists."""


def default_name() -> str:
    """The scenario of the running script: its base name up to the first dot, plus ``.yaml``."""
    return os.path.basename(sys.argv[0] or "").split(".")[0] + ".yaml"


def locate(name: str | os.PathLike[str] | None = None) -> str:
    """The path of a scenario file.

    Args:
        name: As the user wrote it; None for the file named like the running script.

    Returns:
        The first regular file among: the path as given, below ``sys.path[0]``, below the current directory, beside
        the running script.

    Raises:
        ScenarioNotFoundError: None of them exists; the message lists the places searched, files with similar
            names, and the template of that name.
    """
    wanted = os.fspath(name) if name is not None else default_name()
    places = _places()
    candidates = [os.path.expanduser(wanted)] + [os.path.join(place, wanted) for place in places]
    for candidate in candidates:
        if os.path.isfile(candidate):
            return candidate
    for candidate in candidates:
        if os.path.exists(candidate):  # a directory or device: reading it reports what it is
            return candidate
    searched = _unique(os.path.dirname(os.path.abspath(candidate)) for candidate in candidates)
    raise ScenarioNotFoundError(_message(wanted, searched))


def _places() -> list[str]:
    script = os.path.dirname(os.path.abspath(sys.argv[0])) if sys.argv and sys.argv[0] else None
    return _unique(place for place in (sys.path[0] if sys.path else None, os.getcwd(), script) if place is not None)


def _unique(items: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(items))


def _message(wanted: str, searched: list[str]) -> str:
    from irsim.bundled import templates

    lines = [f"no scenario file '{wanted}'. Searched:"]
    lines += [f"  {place}" for place in searched]
    template = templates.meant(wanted)
    if template is not None:
        lines.append(
            f"'{template}' is a template: `irsim new {template}` writes {template}.yaml, which can then be used."
        )
    near = _near(wanted, searched)
    if near:
        lines.append("Did you mean " + " or ".join(f"'{path}'" for path in near) + "?")
    return "\n".join(lines)


def _near(wanted: str, places: list[str]) -> list[str]:
    """Files in the searched places with a similar name, nearest first."""
    base = os.path.basename(wanted).lower()
    paths: dict[str, str] = {}
    for place in places:
        try:
            entries = [entry.name for entry in os.scandir(place) if entry.is_file()]
        except OSError:
            continue
        for entry in entries:
            if entry.lower().endswith((".yaml", ".yml")):
                paths.setdefault(entry, os.path.relpath(os.path.join(place, entry)))
    stem = base.rsplit(".", 1)[0]
    by_stem = {entry.lower().rsplit(".", 1)[0]: entry for entry in paths}
    return [paths[by_stem[match]] for match in difflib.get_close_matches(stem, by_stem, _MAX_SUGGESTIONS, 0.5)]
