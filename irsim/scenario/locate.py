"""Files: where a scenario and its images are looked for, and the rule that keeps names inside a folder."""

from __future__ import annotations

import difflib
import os
import re
import stat
import sys
import unicodedata
from collections.abc import Iterable
from pathlib import Path

from irsim.common.arguments import as_given
from irsim.diagnostics.errors import InputError, ScenarioNotFoundError

__all__ = ["BUNDLED", "default_name", "image_places", "locate", "near_files", "why_outside"]

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
        InputError: ``name`` is not a path.
    """
    if name is not None and not isinstance(name, (str, bytes, os.PathLike)):
        raise InputError(f"a scenario is named by its file, not by {as_given(name)}", "give the path of a YAML file")
    wanted = os.fsdecode(name) if name is not None else default_name()
    places = _places()
    candidates = [os.path.expanduser(wanted)] + [os.path.join(place, wanted) for place in places]
    for candidate in candidates:
        if os.path.isfile(candidate):
            return candidate
    for candidate in candidates:
        if os.path.exists(candidate):  # a directory or device: reading it reports what it is
            return candidate
    given, *others = _unique(os.path.dirname(os.path.abspath(candidate)) for candidate in candidates)
    searched = [given, *filter(_is_of_user, others)]
    raise _not_found(wanted, searched)


def _places() -> list[str]:
    script = os.path.dirname(os.path.abspath(sys.argv[0])) if sys.argv and sys.argv[0] else None
    return _unique(place for place in (sys.path[0] if sys.path else None, os.getcwd(), script) if place is not None)


def _is_of_user(folder: str) -> bool:
    """Whether a folder is one that a message names: neither hidden nor of a Python environment, as ``.venv/bin`` is."""
    path, here = Path(folder), Path.cwd()
    parts = path.relative_to(here).parts if path.is_relative_to(here) else path.parts
    above = [one for one in (path, *path.parents) if not here.is_relative_to(one)]
    return not any(part.startswith(".") for part in parts) and not any((one / "pyvenv.cfg").is_file() for one in above)


def _unique(items: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(items))


def _not_found(wanted: str, searched: list[str]) -> ScenarioNotFoundError:
    from irsim.bundled import templates

    template, near, advice = templates.meant(wanted), near_files(wanted, searched), []
    if template is not None:
        advice.append(
            f"'{template}' is a template: `irsim new {template}` writes {template}.yaml, which can then be used."
        )
    if near:
        advice.append("Did you mean " + " or ".join(f"'{path}'" for path in near) + "?")
    elif template is None:
        advice.append("`irsim templates` lists scenarios to start from, and `irsim new NAME` writes one.")
    return ScenarioNotFoundError(f"no scenario file '{wanted}'", searched, advice, near)


def near_files(wanted: str, places: Iterable[str]) -> list[str]:
    """YAML files in some folders with a similar name, nearest first.

    Args:
        wanted: Name of the file that there is not.
        places: The folders.
    """
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


_INVISIBLE = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Unicode categories: control characters, text-direction marks, lone surrogates, line and paragraph separators."""
_DRIVE = re.compile(r"[A-Za-z]:")
_WINDOWS_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)


def why_outside(name: str, root: Path, bases: Iterable[Path] = ()) -> str | None:
    """The reason why a file name is not allowed in a program confined to ``root``.

    A name is allowed if it is relative and leads downwards, no link on its way leads out of ``root``, and its target,
    if it exists, is an ordinary file or folder.

    Args:
        name: The name as written.
        root: The folder that the target must lie in.
        bases: Further folders, inside ``root``, that the name may be relative to.

    Returns:
        The problem, worded to follow the name: ``"leads upwards ('..')"``; None if the name is allowed.
    """
    if any(unicodedata.category(character) in _INVISIBLE for character in name):
        return "contains a control character"
    words = re.split(r"[/\\]", name)
    if name.startswith(("/", "\\")) or _DRIVE.match(name):
        return "is an absolute path"
    if name.startswith("~"):
        return "starts in a home folder"
    if ".." in words:
        return "leads upwards ('..')"
    if any(_WINDOWS_DEVICE.fullmatch(word.rstrip(" .")) for word in words):
        return "is the name of a device"
    try:
        limit = root.resolve()
        for base in (limit, *(limit / base for base in bases)):
            target = (base / name).resolve()
            if not target.is_relative_to(limit):
                return "is a link that leads out of the workspace"
            # since Python 3.13 resolve() leaves cyclic links as they are
            if any(part.is_symlink() for part in (target, *target.parents)):
                return "cannot be followed"
            if target.exists() and not _is_ordinary(target):
                return "is a device or pipe"
    except (OSError, RuntimeError, ValueError):  # cyclic links, a name that is too long, …
        return "cannot be followed"
    return None


def _is_ordinary(target: Path) -> bool:
    mode = target.stat().st_mode
    return stat.S_ISREG(mode) or stat.S_ISDIR(mode)


IMAGES = Path(__file__).parents[1] / "graphics" / "images"
"""Folder of the bundled images."""
BUNDLED = ("car_green.png", "car_blue.png", "car_red.png", "diff_robot0.png", "diff_robot1.png")
"""Names of the bundled images, which show a robot from above, facing right."""


def image_places(name: str, folder: str | Path | None) -> list[Path]:
    """Candidates for an image file: as given, beside the script, beside the scenario (``folder``), bundled."""
    return [place / name for place in (Path(), Path(sys.path[0] or "."), *([Path(folder)] if folder else []), IMAGES)]
