"""The folder that an agent works in: it reads, writes and lists files there and nowhere else, and may run the command
``irsim`` there, with limits of time and memory, offline."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from irsim_evals.grader.limited import LimitError, run_limited

__all__ = ["Folder", "FolderError", "run_command"]

_MAX_TEXT = 40_000
"""Characters of a file that one call of ``read`` returns."""
_MAX_FILE_BYTES = 1_000_000
"""Size of a file that may be written."""
_MAX_PICTURE_BYTES = 4_000_000
"""Size of a picture that may be read."""
_MAX_FILES = 150
"""Number of files that the folder may hold."""
_PICTURES = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
_COMMANDS = (
    "templates", "new", "validate", "diff", "run", "inspect", "benchmark", "suites", "policies", "render", "describe",
)  # fmt: skip
"""Commands that need neither a network nor code of the agent."""
_REFUSED = re.compile(
    r"--(?:import|bridge|cluster|show|export|install-completion|show-completion)\b"  # code, networks, windows
    r"|\.\.|(?:^|=|^-[a-z])[/~]"  # places outside the folder
    r"|\.py\b|^[\w.]+:\w"  # policies that are programs
)
_SECONDS = 60.0
"""Processor time of one command [s]."""
_MAX_OUTPUT = 16_000
"""Characters of the output that the agent gets."""


class FolderError(ValueError):
    """A path or a content that the folder does not accept; the text says what to write instead."""


class Folder:
    """Files of one attempt.

    Attributes:
        root: Where they lie.
        reference: First parts of paths → folders that can be read there and not written, such as the skills.
    """

    def __init__(self, root: Path, reference: Mapping[str, Path] | None = None) -> None:
        self.root = root.resolve()
        self.reference = dict(reference or {})

    def write(self, name: str, content: str) -> str:
        """Write a text file and say so; an existing one is replaced.

        Raises:
            FolderError: The path leads out of the folder or to something that is not written, or there is too much.
        """
        parts = _parts(name)
        if "/".join(parts).startswith(tuple(f"{mount}/" for mount in self.reference)):
            raise FolderError(f"{name} can be read only; write to another path")
        if any(part.startswith(".") for part in parts):
            raise FolderError(f"{name}: names that begin with a dot are not written; choose another name")
        path = self._below(parts, name)
        data = content.encode("utf-8", errors="replace")
        if len(data) > _MAX_FILE_BYTES:
            raise FolderError(f"{name} would have {len(data):,} bytes; write at most {_MAX_FILE_BYTES:,}")
        if path.is_dir():
            raise FolderError(f"{name} is a folder; give the name of a file")
        if not path.exists() and len(self.names()) >= _MAX_FILES:
            raise FolderError(f"there are {_MAX_FILES} files already; replace one of them")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        except OSError as error:
            raise FolderError(f"{name} cannot be written: {error.strerror}") from None
        return f"wrote {'/'.join(parts)} ({len(data):,} bytes)"

    def read(self, name: str, start: int = 0) -> str | tuple[str, bytes]:
        """A part of a text file, which begins at a character; or the media type and content of a picture.

        Raises:
            FolderError: There is no such file, or it is neither a text nor a small picture.
        """
        parts = _parts(name)
        path = self._find(parts, name)
        if path.is_dir():
            raise FolderError(f"{name} is a folder; list_files shows what is in it")
        if not path.is_file():
            raise FolderError(f"there is no file {name}; list_files shows which there are")
        kind = _PICTURES.get(path.suffix.lower())
        try:
            data = path.read_bytes()
        except OSError as error:
            raise FolderError(f"{name} cannot be read: {error.strerror}") from None
        if kind is not None:
            if len(data) > _MAX_PICTURE_BYTES:
                raise FolderError(f"{name} has {len(data):,} bytes, which is too large to look at")
            return kind, data
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError:
            raise FolderError(f"{name} is neither a text nor a picture") from None
        rest = text[max(start, 0) :]
        if len(rest) <= _MAX_TEXT:
            return rest
        return f"{rest[:_MAX_TEXT]}\n[cut; the file has {len(text):,} characters, go on with start={start + _MAX_TEXT}]"

    def names(self, below: str = ".") -> list[str]:
        """Paths of the files, sorted; files of a reference folder only if it is asked for.

        Raises:
            FolderError: There is no such folder.
        """
        parts = _parts(below)
        place = self._find(parts, below) if parts else self.root
        if not place.is_dir():
            raise FolderError(f"there is no folder {below}; list_files without an argument shows the whole")
        paths = []
        for path in sorted(place.rglob("*")):
            relative = path.relative_to(place)
            hidden = any(part.startswith(".") or part == "__pycache__" for part in relative.parts)
            if path.is_file() and not path.is_symlink() and not hidden:
                paths.append("/".join([*parts, *relative.parts]))
        return paths

    def _find(self, parts: list[str], name: str) -> Path:
        text = "/".join(parts)
        for mount, place in self.reference.items():
            if text == mount or text.startswith(f"{mount}/"):
                return self._below(parts[len(PurePosixPath(mount).parts) :], name, place.resolve())
        return self._below(parts, name)

    def _below(self, parts: list[str], name: str, root: Path | None = None) -> Path:
        root = root or self.root
        path = root.joinpath(*parts)
        try:
            inside = path.resolve().is_relative_to(root)
        except (OSError, ValueError, RuntimeError):
            inside = False
        if not inside:
            raise FolderError(f"{name} is outside the folder; give a path inside it, such as scenario.yaml")
        return path


def _parts(name: str) -> list[str]:
    """Parts of a path that a model gave."""
    if "\0" in name or len(name) > 300:
        raise FolderError("this is not the name of a file; give a short path such as scenario.yaml")
    path = PurePosixPath(name.strip().replace("\\", "/"))
    if path.is_absolute() or ".." in path.parts or (path.parts and path.parts[0].endswith(":")):
        raise FolderError(f"{name} is outside the folder; give a path inside it, such as scenario.yaml")
    return list(path.parts)


def run_command(folder: Path, line: str) -> str:
    """Run a line such as ``irsim validate scenario.yaml`` in a folder; returns what it prints.

    Raises:
        FolderError: The line is not allowed, or the command ended with an error; the text says why.
    """
    try:
        words = shlex.split(line)
    except ValueError as error:
        raise FolderError(f"{line!r} is not a command line: {error}") from None
    words = words[1:] if words[:1] == ["irsim"] else words
    if not words or (words[0] not in _COMMANDS and words != ["--help"]):
        raise FolderError(f"the commands are {', '.join(f'irsim {name}' for name in _COMMANDS)}, without pipes")
    for word in words:
        if _REFUSED.search(word):
            raise FolderError(f"{word} is not allowed here: only files of your folder, no programs and no network")
    try:
        code, text = run_limited(_run, (str(folder), words), _SECONDS, "command")
    except LimitError as error:
        raise FolderError(str(error)) from None
    text = text if len(text) <= _MAX_OUTPUT else f"{text[:_MAX_OUTPUT]}\n[cut]"
    if code:
        raise FolderError(f"{text.rstrip()}\n[exit code {code}]")
    return text or "[no output]"


def _run(folder: str, words: list[str]) -> tuple[int, str]:
    """Run a command in the limited process; exit code, and what it printed."""
    from irsim.cli.app import app

    os.chdir(folder)
    os.environ.update(COLUMNS="120", HOME=str(Path(folder).parent), MPLBACKEND="Agg")
    printed = io.StringIO()
    code: object = 0
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        try:
            app(words, prog_name="irsim")
        except SystemExit as end:
            code = end.code
    return (code if isinstance(code, int) else int(code is not None)), printed.getvalue()
