"""The agent skills of this package, and putting them where an agent's host looks for them."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from irsim.common import data_files as resources
from irsim.diagnostics.diagnostic import nearest
from irsim.diagnostics.errors import CodedError

__all__ = ["PLACES", "Installed", "PlaceError", "Skill", "SkillError", "find_skills", "install", "place_of"]

PLACES: Mapping[str, str] = {
    "claude": ".claude/skills",
    "agents": ".agents/skills",
    "gemini": ".gemini/skills",
    "cursor": ".cursor/skills",
    "codex": ".agents/skills",
}
"""Where each host looks, below a project or the home directory."""

_RECORD = ".irsim.json"
"""What was installed into a folder: the version, and the digest of each file as written."""

Action = Literal["installed", "updated", "unchanged", "kept"]


class SkillError(CodedError, ValueError):
    """The package has no such skill."""


class PlaceError(CodedError, OSError):
    """Skills cannot be put into a folder."""


@dataclass(frozen=True, slots=True)
class Skill:
    """One folder with a ``SKILL.md``.

    Attributes:
        name: Of the skill and its folder.
        description: What it does and when to use it.
        version: Of the package it came with.
        folder: Where it is.
    """

    name: str
    description: str
    version: str
    folder: Path

    def files(self) -> dict[str, bytes]:
        """Contents of its files by path below its folder, with ``/``."""
        paths = sorted(path for path in self.folder.rglob("*") if path.is_file())
        names = {path.relative_to(self.folder).as_posix(): path for path in paths}
        return {name: path.read_bytes() for name, path in names.items() if "__pycache__" not in name}


@dataclass(frozen=True, slots=True)
class Installed:
    """What became of one skill.

    Attributes:
        name: The skill.
        action: ``kept``: the folder holds changes of the user, or is a link, and was left alone.
        folder: Where it is.
        version: Version of the skill in this package.
        written: Files that were (or would be) written or removed.
        changed: Files that somebody changed since they were installed.
    """

    name: str
    action: Action
    folder: Path
    version: str
    written: list[str] = field(default_factory=list)
    changed: list[str] = field(default_factory=list)


def find_skills(names: Iterable[str] = ()) -> list[Skill]:
    """The skills of this package, by name.

    Args:
        names: Only these; default: all.

    Raises:
        SkillError: There is none of that name.
    """
    known = {path.parent.name: path for path in sorted(resources.skills_directory().glob("*/SKILL.md"))}
    wanted = list(dict.fromkeys(names)) or list(known)
    for name in wanted:
        if name not in known:
            near = nearest(name, list(known))
            fix = f"did you mean {near}?" if near else f"choose one of {', '.join(known)}"
            raise SkillError("unknown-skill", f"there is no skill {name!r}", fix)
    return [_read(known[name]) for name in wanted]


def place_of(target: str, *, user: bool = False, project: Path | None = None) -> Path:
    """The folder in which a host looks for skills.

    Args:
        target: One of :data:`PLACES`.
        user: In the home directory instead of a project.
        project: Root of the project; default: the current directory.
    """
    return (Path.home() if user else project or Path.cwd()) / PLACES[target]


def install(place: Path, skills: Iterable[Skill], *, force: bool = False, dry_run: bool = False) -> list[Installed]:
    """Put skills into a folder. Each is replaced as a whole or not at all.

    A file that was changed since it was installed is a reason to leave its skill alone. Files that were added are
    kept in any case.

    Args:
        place: Folder that holds, or will hold, one folder per skill.
        skills: Which.
        force: Overwrite changed files and replace links.
        dry_run: Only say what would be done.

    Raises:
        PlaceError: The folder cannot be there: a file or a link to nothing is in its place.
    """
    _check(place)
    return [_install(place / skill.name, skill, force=force, dry_run=dry_run) for skill in skills]


def _check(place: Path) -> None:
    """Whether the folder is there or can be made."""
    for path in (place, *place.parents):
        if not os.path.lexists(path):
            continue
        if path.is_dir():
            return
        if path.is_symlink():
            target = os.readlink(path)
            what = f"'{path}' is a link to '{target}', which is not a folder"
            raise PlaceError("file-access", what, f"make that folder, or remove the link: rm '{path}'")
        raise PlaceError("file-access", f"'{path}' is a file where a folder must be", "move it away")


def _read(page: Path) -> Skill:
    front = resources.read_yaml(page.read_text(encoding="utf-8").split("---\n", 2)[1])
    return Skill(front["name"], front["description"], str(front.get("metadata", {}).get("version", "")), page.parent)


def _install(folder: Path, skill: Skill, *, force: bool, dry_run: bool) -> Installed:
    new, old = skill.files(), _contents(folder)
    digests = _recorded(folder)
    written = sorted(
        [name for name, content in new.items() if old.get(name) != content]
        + [name for name in digests if name in old and name not in new]  # of an earlier version
    )
    if not written and folder.is_dir():
        return Installed(skill.name, "unchanged", folder, skill.version)
    changed = [name for name in written if name in old and digests.get(name) != _digest(old[name])]
    if folder.is_symlink():
        changed = changed or ["(a link)"]
    elif folder.exists() and not folder.is_dir():
        changed = ["(no folder)"]
    if changed and not force:
        return Installed(skill.name, "kept", folder, skill.version, changed=changed)
    action: Action = "updated" if os.path.lexists(folder) else "installed"
    if not dry_run:
        obsolete = [name for name in digests if name in old and name not in new]
        _replace(folder, {**new, _RECORD: _record(skill, new)}, obsolete)
    return Installed(skill.name, action, folder, skill.version, written, changed)


def _contents(folder: Path) -> dict[str, bytes]:
    if not folder.is_dir():
        return {}
    paths = (path for path in sorted(folder.rglob("*")) if path.is_file() and path != folder / _RECORD)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _record(skill: Skill, files: Mapping[str, bytes]) -> bytes:
    digests = {name: _digest(content) for name, content in files.items()}
    return (json.dumps({"skill": skill.name, "version": skill.version, "files": digests}, indent=1) + "\n").encode()


def _recorded(folder: Path) -> dict[str, str]:
    """Digests by file as they were written; nothing where there is no record, or none of ours."""
    try:
        found = json.loads((folder / _RECORD).read_text(encoding="utf-8"))["files"]
    except (OSError, ValueError, KeyError, TypeError):
        return {}
    return {str(name): str(digest) for name, digest in found.items()} if isinstance(found, dict) else {}


def _replace(folder: Path, files: Mapping[str, bytes], obsolete: Iterable[str]) -> None:
    """Write a folder beside its place, with what else was in it, and move it there; what was there goes last."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    there = os.path.lexists(folder)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}.") as scratch:
        fresh, before = Path(scratch, "new"), Path(scratch, "old")
        if folder.is_dir() and not folder.is_symlink():
            shutil.copytree(folder, fresh, symlinks=True)
        for name in obsolete:
            (fresh / name).unlink(missing_ok=True)
        for name, content in files.items():
            path = fresh / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.unlink(missing_ok=True)  # not through a link of somebody's
            path.write_bytes(content)
        if there:
            os.rename(folder, before)
        try:
            os.rename(fresh, folder)
        except BaseException:
            if there:
                os.rename(before, folder)
            raise
