"""Reads a file, a text or a mapping into a :class:`Document`: data, problems, and the positions of all values."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from irsim.common.records import FileError, read_bytes
from irsim.common.yaml.compose import Composed, compose
from irsim.common.yaml.nodes import Mark, Node
from irsim.diagnostics.diagnostic import Diagnostic, Path
from irsim.scenario.limits import DEFAULT_LIMITS, Limits

__all__ = ["Document", "Mark", "load_data", "load_path", "load_text", "text_of"]

_CONTROL_BYTES = bytes(set(range(32)) - {9, 10, 12, 13, 27})
"""Bytes that no text file contains."""


@dataclass
class Document:
    """A scenario as written.

    Attributes:
        data: The scenario (inside the ``irsim:`` wrapper where there is one); None if it could not be read.
        problems: Findings made while reading it as YAML.
        fatal: Whether one of them makes the data unusable or wrong.
        text: The text; None for a scenario given as data.
        name: Name in messages.
        path: Path of the file; None without a file.
        prefix: Keys that lead to the scenario in the text: ``("irsim",)`` in a file shared with another simulator.
        limits: The limits under which it was read.
        maps: Files to read instead of the maps that the scenario names, by name: the copies kept in a recorded run.
    """

    data: Any
    problems: list[Diagnostic] = field(default_factory=list)
    fatal: bool = False
    text: str | None = None
    name: str | None = None
    path: str | None = None
    prefix: Path = ()
    limits: Limits = DEFAULT_LIMITS
    maps: Mapping[str, str] = field(default_factory=dict)
    _root: Node | None = field(default=None, repr=False)

    def mark(self, path: Path, *, key: bool = False) -> Mark | None:
        """Position of the value at ``path``, of its key if ``key``; of the innermost existing part if it is missing."""
        node = self.tree()
        if node is None:
            return None
        mark = node.mark
        for depth, part in enumerate(path, 1):
            raw = _raw_key(node, part)
            if raw is None:
                return mark
            of_key, node = node.keys.get(raw), node.children[raw]
            missing_below = depth < len(path) and _raw_key(node, path[depth]) is None
            mark = of_key if of_key is not None and (key or missing_below) else node.mark
        return mark

    def source_text(self, path: Path) -> str | None:
        """The characters of the scalar at ``path``, as written; None if it is not a scalar on a single line."""
        if self.text is None or (mark := self.mark(path)) is None:
            return None
        line = self.text.splitlines()[mark.line - 1]
        return line[mark.column - 1 : mark.column - 1 + mark.length]

    def tree(self) -> Node | None:
        """Positions of all values, from the root of the text; None without a text or if it is not valid YAML."""
        if self._root is None and self.text is not None:
            self._root = compose(self.text, self.limits, positions=True).root
        return self._root


def _raw_key(node: Node, part: str | int) -> Any:
    """The key of ``node`` that a path part names; paths hold every key that is not an index as text."""
    if part in node.children:
        return part
    return next((key for key in node.children if not isinstance(key, int) and str(key) == part), None)


def load_path(path: str | os.PathLike[str], limits: Limits = DEFAULT_LIMITS) -> Document:
    """Read a file. Everything wrong with it is listed in ``problems``; nothing raises an exception."""
    name = os.fspath(path)
    text = text_of(name, limits)
    if isinstance(text, Diagnostic):
        return Document(None, [text], True, name=name, path=name, limits=limits)
    return _document(compose(text, limits), text, name, name, limits)


def text_of(name: str, limits: Limits = DEFAULT_LIMITS) -> str | Diagnostic:
    """The text of a file, which is not read as YAML here; what prevents it from being read as text."""
    content, problem = _content(name, limits)
    if problem is not None:
        return problem
    assert content is not None
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        return _not_text(name, content, error)
    if content.translate(None, _CONTROL_BYTES) != content:
        return _not_text(name, content, None)
    return text


def load_text(
    text: str, name: str | None = None, *, path: str | None = None, limits: Limits = DEFAULT_LIMITS
) -> Document:
    """Read a scenario from YAML text."""
    if len(text) > limits.bytes:
        problem = _too_large(len(text), limits, name)
        return Document(None, [problem], True, name=name, path=path, limits=limits)
    try:
        text.encode()
    except UnicodeEncodeError as error:
        problem = _half_a_character(text, error.start, name)
        return Document(None, [problem], True, name=name, path=path, limits=limits)
    return _document(compose(text, limits), text, name, path, limits)


def _document(composed: Composed, text: str, name: str | None, path: str | None, limits: Limits) -> Document:
    return _unwrap(Document(composed.data, composed.problems, composed.fatal, text, name, path, (), limits))


def load_data(data: Any, name: str | None = None, limits: Limits = DEFAULT_LIMITS) -> Document:
    """Wrap a scenario that is data already, as :func:`irsim.make` accepts it; it has no text and no positions."""
    return _unwrap(Document(data, name=name, limits=limits))


def _unwrap(document: Document) -> Document:
    """The part under ``irsim:``, which is the scenario in files shared with another simulator, if there is one."""
    if isinstance(document.data, Mapping) and isinstance(document.data.get("irsim"), Mapping):
        document.data, document.prefix = document.data["irsim"], ("irsim",)
    return document


def _content(name: str, limits: Limits) -> tuple[bytes | None, Diagnostic | None]:
    try:
        return read_bytes(name, limits.bytes), None
    except FileError as error:
        if error.code == "file-too-large":
            return None, _too_large(error.size, limits, name)
        messages = {
            "file-not-found": f"there is no file '{name}'",
            "not-a-file": f"'{name}' {error.message.removeprefix('it ')}",
        }
        message = messages.get(error.code, f"'{name}' cannot be read: {error.message}")
        fix = "name a YAML file" if error.code == "not-a-file" else None
        return None, Diagnostic(error.code, "error", (), message, given=name, fix=fix, file=name)


def _too_large(size: int, limits: Limits, name: str | None) -> Diagnostic:
    return Diagnostic(
        "file-too-large",
        "error",
        (),
        f"a scenario may have at most {limits.bytes:,} bytes, got {size:,}",
        given=size,
        allowed=f"at most {limits.bytes:,} bytes",
        fix="write groups of objects with 'number' and 'distribution'",
        file=name,
    )


def _half_a_character(text: str, place: int, name: str | None) -> Diagnostic:
    return Diagnostic(
        "not-text",
        "error",
        (),
        f"character {place + 1} is half of a surrogate pair, which is not valid text",
        line=text.count("\n", 0, place) + 1,
        fix="remove it, or write the complete character",
        file=name,
    )


def _not_text(name: str, content: bytes, error: UnicodeDecodeError | None) -> Diagnostic:
    line = None
    message = f"'{name}' is not a text file"
    if error is not None and content.translate(None, _CONTROL_BYTES) == content:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"'{name}' is not UTF-8 text (byte {error.start})"
    return Diagnostic(
        "not-text", "error", (), message, line=line, given=name, fix="save the file as UTF-8 text", file=name
    )
