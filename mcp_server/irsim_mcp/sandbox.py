"""The workspace: the only folder from which scenarios are read; only recorded runs and jobs are written to it.

Everything below it is opened from a descriptor of the folder as it was at the start (:mod:`irsim.common.held`), so that
no link leads out, even if others change the folder meanwhile. Files that a call names are written atomically.
"""

from __future__ import annotations

import difflib
import errno
import functools
import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import Concatenate, ParamSpec, Protocol, TypeVar

from irsim.common.files import TEMPORARY
from irsim.common.held import AVAILABLE, Folder, hold
from irsim.common.text import clean
from irsim.runs.files import RunError, json_of, text_of
from irsim.runs.store import ID, META, SCENARIO_FILE, find_run, mark_cancelled, run_folders, runs_folder
from irsim.scenario.locate import why_outside
from irsim_mcp.answers import failure

__all__ = ["Workspace", "held", "set_aside"]

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")

_SUFFIXES = (".yaml", ".yml")
_MAX_LISTED_FILES = 2000
"""Number of files of each level that are searched for scenarios."""
_MAX_NAMED = 3
"""Number of files that a message suggests."""
_MAX_NAME_BYTES = 200
"""Length of the longest name of a file."""
_EXPORTS = "exports"
"""Folder of the workspace for exports of runs."""


class _Holder(Protocol):
    """Something of a workspace."""

    def hold(self) -> AbstractContextManager[None]:
        """Hold the folder of the workspace in the block."""


_Self = TypeVar("_Self", bound=_Holder)


def held(
    method: Callable[Concatenate[_Self, _Arguments], _Result],
) -> Callable[Concatenate[_Self, _Arguments], _Result]:
    """A method that works while the folder of the workspace is held."""

    @functools.wraps(method)
    def holding(self: _Self, /, *arguments: _Arguments.args, **options: _Arguments.kwargs) -> _Result:
        with self.hold():
            return method(self, *arguments, **options)

    return holding


class Workspace:
    """The folder of the workspace, with checks of the paths and ids that calls name.

    Args:
        root: The folder; links in its path are resolved once, here.
    """

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        self.folder = Folder(self.root) if AVAILABLE else None
        """The folder as it was when the server started, wherever its name leads now."""

    def hold(self) -> AbstractContextManager[None]:
        """Hold the folder in the block, so that no link below it leads out, whenever it appears."""
        return hold(self.folder)

    @held
    def scenario(self, name: str, argument: str = "scenario_path") -> str:
        """The path of a scenario file, relative to the workspace.

        Args:
            name: The path as the caller wrote it.
            argument: Name of the argument, for errors.

        Raises:
            ToolError: The path leads out of the workspace, or there is no such file.
        """
        wrong = why_outside(name, self.root)
        if wrong is not None:
            inside = self._relative(name)
            fix = f"put the file into the workspace {self.root} and name it relative to that, or pass scenario_yaml"
            if inside is not None:
                fix = f"{argument}={inside!r}"
            raise failure("path-outside-workspace", f"{clean(name)!r} {wrong}", where=argument, fix=fix)
        target = self.root / name
        if target.is_file():
            return target.relative_to(self.root).as_posix()
        if target.is_dir():
            what = f"{clean(name)!r} is a folder" if name else "it is empty"
            raise failure("not-a-file", what, where=argument, fix=self._advice(target, argument))
        what = f"there is no file {clean(name)!r} in the workspace {self.root}"
        raise failure("file-not-found", what, where=argument, fix=self._advice(target, argument))

    @held
    def new_file(self, name: str) -> str:
        """The path of a scenario file that may be written, relative to the workspace.

        Raises:
            ToolError: The path leads out of the workspace, through a link or into a hidden folder, or does not
                end as YAML files do.
        """
        wrong = why_outside(name, self.root)
        if wrong is not None:
            fix = f"name it relative to the workspace {self.root}, such as room.yaml"
            raise failure("path-outside-workspace", f"{clean(name)!r} {wrong}", where="path", fix=fix)
        path = PurePosixPath(name)
        if path.suffix not in _SUFFIXES or "\\" in name or ":" in name or len(path.name.encode()) > _MAX_NAME_BYTES:
            fix = "end it with .yaml, such as rooms/a.yaml"
            raise failure(
                "bad-argument", f"{clean(name)!r} is not a valid name of a scenario file", where="path", fix=fix
            )
        if any(part.startswith(".") for part in path.parts):
            fix = "choose a folder and a name that do not begin with a dot"
            raise failure("bad-argument", f"{clean(name)!r} is hidden", where="path", fix=fix)
        on_the_way = [self.root.joinpath(*path.parts[: count + 1]) for count in range(len(path.parts))]
        if any(part.is_symlink() for part in on_the_way):
            what = f"{clean(name)!r} is or goes through a link"
            raise failure("path-outside-workspace", what, where="path", fix="write to a plain file in plain folders")
        if on_the_way[-1].is_dir():
            raise failure("not-a-file", f"{clean(name)!r} is a folder", where="path", fix="name a file in it")
        return path.as_posix()

    @held
    def folder_for_exports(self) -> str:
        """The folder that exports of runs are written to, relative to the workspace; it is made if need be.

        Raises:
            ToolError: A link, or a file, has the name of the folder.
        """
        folder = self.root / _EXPORTS
        if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
            what = f"'{_EXPORTS}' of the workspace is not a folder"
            raise failure("not-a-file", what, where="to", fix="rename it, so that exports have a folder")
        folder.mkdir(exist_ok=True)
        return _EXPORTS

    @held
    def check_run(self, run_id: str) -> None:
        """Check that a run is recorded in the workspace.

        Raises:
            ToolError: There is no such run; the message names recent ones.
        """
        try:
            find_run(run_id, self.root)
        except RunError as error:
            raise failure(error.code, error.message, where="run_id", fix=error.fix) from None

    @held
    def runs(self) -> list[str]:
        """Ids of the recorded runs, the one started last first."""
        try:
            return [folder.name for folder in run_folders(runs_folder(self.root))]
        except RunError:
            return []

    def is_run(self, name: str) -> bool:
        """Whether a name is the id of a recorded run of the workspace."""
        return ID.fullmatch(name) is not None and name in self.runs()

    @held
    def scenario_of_run(self, run_id: str) -> tuple[str | None, str | None]:
        """The file that a run simulated, if it is still there, and otherwise its text; None for what is not known."""
        try:
            folder = find_run(run_id, self.root)
            meta, text = json_of(folder, META), text_of(folder, SCENARIO_FILE)
        except RunError:
            return None, None
        name = meta.get("scenario") if isinstance(meta, dict) else None
        there = isinstance(name, str) and why_outside(name, self.root) is None and (self.root / name).is_file()
        return (str(name), None) if there else (None, text)

    @held
    def stamp(self, name: str) -> tuple[int, int] | None:
        """Time of the last change [ns] and size [bytes] of a file; None if there is no such file."""
        if not self.has_file(name):
            return None
        about = (self.root / name).stat()
        return about.st_mtime_ns, about.st_size

    @held
    def has_file(self, name: str) -> bool:
        """Whether there is a file with a name."""
        return why_outside(name, self.root) is None and (self.root / name).is_file()

    @held
    def write(self, name: str, data: bytes, overwrite: bool) -> bool:
        """Write a file by renaming a temporary one, so that no reader ever sees half of it.

        Args:
            name: Checked path of the file, with ``/``; missing folders are created.
            data: Content of the file.
            overwrite: Whether an existing file may be replaced.

        Returns:
            Whether a file was replaced.

        Raises:
            ToolError: The file exists, a part of the path leads out or is not a folder, or the operating system
                refuses.
        """
        try:
            return _write(self.root / name, data, overwrite)
        except FileExistsError:
            what = f"{clean(name)!r} exists already"
            raise failure(
                "file-exists", what, where="path", fix="overwrite=true replaces it; or choose another name"
            ) from None
        except OSError as error:
            what = f"{clean(name)!r} cannot be written: {error.strerror or error}"
            fix = "use folders that are not links, and check permissions and free space"
            raise failure("file-access", what, where="path", fix=fix) from None

    @held
    def mark_cancelled(self, run_id: str) -> None:
        """Record that a run was stopped on purpose."""
        with suppress(RunError, OSError):
            mark_cancelled(find_run(run_id, self.root))

    def _relative(self, name: str) -> str | None:
        """An absolute path inside the workspace as a path relative to it; None for other paths."""
        try:
            path = Path(name).resolve()
            inside = Path(name).is_absolute() and path.is_file() and path.is_relative_to(self.root)
        except (OSError, RuntimeError, ValueError):
            return None
        return path.relative_to(self.root).as_posix() if inside else None

    def _advice(self, target: Path, argument: str) -> str:
        """A fix that suggests scenario files of the workspace, or the template that is meant."""
        from irsim.bundled import templates

        there = self.scenarios()
        text = "pass the text as scenario_yaml" if argument == "scenario_path" else "give its text"
        near = difflib.get_close_matches(target.relative_to(self.root).as_posix(), there, _MAX_NAMED, 0.5)
        template = templates.meant(str(target.relative_to(self.root)))
        if template is not None:
            other = f", or did you mean {' or '.join(map(repr, map(clean, near)))}?" if near else ""
            return f"{template!r} is a template: lookup topic={template!r} returns its YAML; {text}{other}"
        if near:
            return f"did you mean {' or '.join(map(repr, map(clean, near)))}?"
        some = ", ".join(repr(clean(name)) for name in there[:_MAX_NAMED])
        return f"the workspace has {some}" if some else f"write the file first, or {text}"

    @held
    def scenarios(self) -> list[str]:
        """YAML files of the workspace and of its immediate folders."""
        names = []
        for pattern in ("*", "*/*"):
            for count, path in enumerate(self.root.glob(pattern)):
                if count >= _MAX_LISTED_FILES:
                    break
                name = path.relative_to(self.root).as_posix()
                if path.suffix.lower() in _SUFFIXES and path.is_file() and why_outside(name, self.root) is None:
                    names.append(name)
        return sorted(names, key=lambda name: (name.count("/"), name))


def _write(target: Path, data: bytes, overwrite: bool) -> bool:
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, "a part of its path is not a folder") from None
    temporary = target.with_name(f"{TEMPORARY}{secrets.token_hex(6)}")
    file = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644)
    try:
        with os.fdopen(file, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        if not overwrite:
            _rename_to_new(temporary, target)
            return False
        there = os.path.lexists(target)
        temporary.replace(target)  # replaces a link, not its target
        return there
    finally:
        temporary.unlink(missing_ok=True)


def _rename_to_new(temporary: Path, target: Path) -> None:
    """Rename a file atomically to a name that does not exist yet."""
    try:
        os.link(temporary, target)
    except FileExistsError:
        raise
    except (OSError, NotImplementedError):  # a file system without hard links
        if os.path.lexists(target):
            raise FileExistsError from None
        temporary.replace(target)


@contextmanager
def set_aside(target: Path) -> Iterator[None]:
    """Set aside the folder of an earlier export of the same run, which comes back if no new one takes its place."""
    if not os.path.lexists(target):
        yield
        return
    if target.is_symlink() or not target.is_dir():
        what = f"'{target}' is in the way: it is not a folder of an earlier export"
        raise RunError("file-exists", what, "remove it, or give it another name", where="to")
    aside = target.with_name(f"{TEMPORARY}{os.urandom(4).hex()}")
    target.rename(aside)
    try:
        yield
    except BaseException:
        with suppress(OSError):  # another call has written one meanwhile
            aside.rename(target)
        if os.path.lexists(target):
            shutil.rmtree(aside, ignore_errors=True)
        raise
    shutil.rmtree(aside, ignore_errors=True)
