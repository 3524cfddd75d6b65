"""Finds the agent skills of this package and installs them where an agent's host looks for them."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from irsim.common import data_files as resources
from irsim.common.hashing import digest
from irsim.common.records import ContentError, read_json
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import CodedError

__all__ = ["PLACES", "Installed", "PlaceError", "Skill", "SkillError", "find_skills", "install", "place_of"]

PLACES: Mapping[str, str] = {
    "claude": ".claude/skills",
    "agents": ".agents/skills",
    "gemini": ".gemini/skills",
    "cursor": ".cursor/skills",
    "codex": ".agents/skills",
}
"""Host -> folder in which it looks for skills, below a project or the home directory."""

_RECORD = ".irsim.json"
"""File that records what was installed into a folder: the version, and the digest of each file."""

Action = Literal["installed", "updated", "unchanged", "kept"]


class SkillError(CodedError, ValueError):
    """The name of a skill is unknown."""


class PlaceError(CodedError, OSError):
    """Skills cannot be put into a folder."""


@dataclass(frozen=True, slots=True)
class Skill:
    """One folder with a ``SKILL.md``.

    Attributes:
        name: Name of the skill and its folder.
        description: Purpose of the skill and when to use it.
        version: Version of the package that contains it.
        folder: Path of the folder.
    """

    name: str
    description: str
    version: str
    folder: Path

    def files(self) -> dict[str, bytes]:
        """Path below the folder, with ``/`` -> content of the file."""
        paths = sorted(path for path in self.folder.rglob("*") if path.is_file())
        names = {path.relative_to(self.folder).as_posix(): path for path in paths}
        return {name: path.read_bytes() for name, path in names.items() if "__pycache__" not in name}


@dataclass(frozen=True, slots=True)
class Installed:
    """Result of installing one skill.

    Attributes:
        name: Name of the skill.
        action: Action taken; ``kept`` means that the folder is a link or contains changes by the user, and was not
            touched.
        folder: Path of the folder.
        version: Version of the skill in this package.
        written: Files that were (or would be) written or removed.
        changed: Files that were changed after they had been installed.
    """

    name: str
    action: Action
    folder: Path
    version: str
    written: list[str] = field(default_factory=list)
    changed: list[str] = field(default_factory=list)


def find_skills(names: Iterable[str] = (), place: Path | None = None) -> list[Skill]:
    """The skills of this package, by name.

    Args:
        names: Names of the skills to return; all if empty.
        place: Folder with other skills, which take their place.

    Raises:
        SkillError: No skill has that name.
    """
    known = {path.parent.name: path for path in sorted((place or resources.skills_directory()).glob("*/SKILL.md"))}
    wanted = list(dict.fromkeys(names)) or list(known)
    for name in wanted:
        if name not in known:
            fix = suggestion(name, known, f"choose one of {', '.join(known)}")
            raise SkillError("unknown-skill", f"there is no skill {name!r}", fix, allowed=list(known))
    return [_read(known[name]) for name in wanted]


def place_of(target: str, *, user: bool = False, project: Path | None = None) -> Path:
    """The folder in which a host looks for skills.

    Args:
        target: One of :data:`PLACES`.
        user: Whether to use the home directory instead of a project.
        project: Root of the project; by default the current directory.
    """
    return (Path.home() if user else project or Path.cwd()) / PLACES[target]


def install(place: Path, skills: Iterable[Skill], *, force: bool = False, dry_run: bool = False) -> list[Installed]:
    """Install skills into a folder. Each skill is replaced as a whole or not at all.

    A skill with a file that was changed after its installation is not touched. Files that the user has added are always
    kept.

    Args:
        place: Folder that contains, or will contain, one folder per skill.
        skills: The skills to install.
        force: Overwrite changed files and replace links.
        dry_run: Only report what would be done.

    Raises:
        PlaceError: The folder cannot be created, because a file or a broken link is in its place.
    """
    _check_place(place)
    return [_install(place / skill.name, skill, force=force, dry_run=dry_run) for skill in skills]


def _check_place(place: Path) -> None:
    """Raise unless the folder exists or can be created."""
    for path in (place, *place.parents):
        if not os.path.lexists(path):
            continue
        if path.is_dir():
            return
        if path.is_symlink():
            target = os.readlink(path)
            what = f"'{path}' is a link to '{target}', which is not a folder"
            raise PlaceError("file-access", what, f"create that folder, or remove the link: rm '{path}'")
        raise PlaceError("file-access", f"'{path}' is a file where a folder must be", "move it away")


def _read(page: Path) -> Skill:
    front = resources.read_yaml(page.read_text(encoding="utf-8").split("---\n", 2)[1])
    return Skill(front["name"], front["description"], str(front.get("metadata", {}).get("version", "")), page.parent)


def _install(folder: Path, skill: Skill, *, force: bool, dry_run: bool) -> Installed:
    new, old = skill.files(), _contents(folder)
    digests = _read_record(folder)
    written = sorted(
        [name for name, content in new.items() if old.get(name) != content]
        + [name for name in digests if name in old and name not in new]  # files of an earlier version
    )
    if not written and folder.is_dir():
        return Installed(skill.name, "unchanged", folder, skill.version)
    changed = [name for name in written if name in old and digests.get(name) != digest(old[name])]
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


def _record(skill: Skill, files: Mapping[str, bytes]) -> bytes:
    digests = {name: digest(content) for name, content in files.items()}
    return (json.dumps({"skill": skill.name, "version": skill.version, "files": digests}, indent=1) + "\n").encode()


def _read_record(folder: Path) -> dict[str, str]:
    """File -> digest, as recorded at the installation; empty without a valid record."""
    try:
        digests = read_json(folder / _RECORD)["files"]
    except (ContentError, KeyError, TypeError):
        return {}
    return {str(name): str(digest) for name, digest in digests.items()} if isinstance(digests, dict) else {}


def _replace(folder: Path, files: Mapping[str, bytes], obsolete: Iterable[str]) -> None:
    """Replace a folder: write the new one beside it, with the user's own files, and swap the two."""
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
            path.unlink(missing_ok=True)  # so that a link is replaced, not followed
            path.write_bytes(content)
        if there:
            os.rename(folder, before)
        try:
            os.rename(fresh, folder)
        except BaseException:
            if there:
                os.rename(before, folder)
            raise
