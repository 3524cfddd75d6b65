"""YAML text → plain Python data in one pass over the parser's events, within limits; positions on demand.

Events come from libyaml where PyYAML was built with it, else from PyYAML's own parser. Nothing is ever constructed
from tags. Positions of nodes are recorded only when asked for: most files have nothing to report.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import yaml

from irsim.common.yaml.limits import YamlLimits
from irsim.common.yaml.nodes import NO_KEY, Anchored, Frame, Mark, Node, merge, scalar_mark, start_mark
from irsim.common.yaml.scalars import resolve, resolve_tagged
from irsim.diagnostics.diagnostic import Diagnostic, Path

__all__ = ["Composed", "compose"]

_MERGE = object()
_COLLECTION_TAGS = (None, "!", "tag:yaml.org,2002:map", "tag:yaml.org,2002:seq")


@dataclass(slots=True)
class Composed:
    """Result of reading a text: data (None after a fatal problem), problems, and positions if requested."""

    data: Any
    problems: list[Diagnostic]
    fatal: bool
    root: Node | None


class _Stop(Exception):
    """Raised after a problem that makes further reading pointless."""


def compose(text: str, limits: YamlLimits, *, positions: bool = False) -> Composed:
    """Read one YAML document.

    Args:
        text: The document.
        limits: Upper bounds; a larger text is refused.
        positions: Also record the position of every key and value.
    """
    composer = _Composer(text, limits, positions)
    try:
        composer.run()
    except _Stop:
        return Composed(None, composer.problems, True, composer.root)
    except yaml.YAMLError as error:
        composer.problems.append(syntax_problem(error, text, composer.path()))
        return Composed(None, composer.problems, True, composer.root)
    return Composed(composer.data, composer.problems, composer.fatal, composer.root)


_COLOR_COMMENT = re.compile(r"\s+(#(?:[0-9a-fA-F]{3,4}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8}))\s*$")


class _Composer:
    def __init__(self, text: str, limits: YamlLimits, positions: bool) -> None:
        self.text, self.limits, self.positions = text, limits, positions
        self.stack: list[Frame] = []
        self.anchors: dict[str, Anchored | None] = {}  # None: still being read
        self.problems: list[Diagnostic] = []
        self.data: Any = None
        self.root: Node | None = None
        self.fatal = False
        self.lines: list[str] = []
        self.events = 0
        self.expanded = self.aliases = 0

    def run(self) -> None:
        next_event = _parser(self.text).get_event
        scalar, sequence, mapping = yaml.ScalarEvent, yaml.SequenceStartEvent, yaml.MappingStartEvent
        ends = (yaml.SequenceEndEvent, yaml.MappingEndEvent)
        limit = self.limits.events
        documents = 0
        while True:
            event = next_event()
            kind = event.__class__
            self.events += 1
            if self.events > limit:
                self._stop("too-many-events", f"more than {limit:,} YAML values and brackets", event)
            if kind is scalar:
                self._scalar(event)
            elif kind is sequence or kind is mapping:
                self._open(event, kind is mapping)
            elif kind in ends:
                self._close(event)
            elif kind is yaml.AliasEvent:
                self._alias(event)
            elif kind is yaml.DocumentStartEvent:
                documents += 1
                if documents > 1:
                    self._stop(
                        "multiple-documents",
                        "a second YAML document starts here; a file is one document",
                        event,
                        fix="remove the line '---' and what follows, or put it into a file of its own",
                    )
            elif kind is yaml.StreamEndEvent or event is None:
                break
        if documents == 0:
            self._empty()

    def _empty(self) -> None:
        self.fatal = True
        self.problems.append(
            Diagnostic(
                "empty-document",
                "error",
                (),
                "the file has no content, only blank lines or comments",
                line=1,
                column=1,
                fix="start with 'world: {width: 10, height: 10}'",
            )
        )

    # values

    def _scalar(self, event: Any) -> None:
        text: str = event.value
        value: Any = text
        if event.implicit[0]:
            if text and text[0].isalpha() and len(text) > 5:
                pass  # most strings; no YAML 1.1 word is longer than "false"
            else:
                value, surprise = resolve(text)
                if surprise is not None:
                    self._surprise(surprise, text, value, event)
                elif not text:
                    self._look_for_color(event)
        elif event.tag is not None and event.tag != "!":
            try:
                value = resolve_tagged(event.tag, text)
            except KeyError:
                self._unsupported_tag(event)
            except ValueError as error:
                self._problem("unsupported-tag", str(error), event)
        anchor = event.anchor
        node = Node(scalar_mark(event)) if self.positions else None
        if anchor is not None:
            self.anchors[anchor] = Anchored(value, 1, 0, node)
        self._add(value, 1, 0, node, plain=bool(event.implicit[0]), event=event)

    def _open(self, event: Any, mapping: bool) -> None:
        if len(self.stack) >= self.limits.depth:
            self._stop("too-deep", f"nested more than {self.limits.depth} levels deep", event)
        if event.tag not in _COLLECTION_TAGS:
            self._unsupported_tag(event)
        anchor = event.anchor
        if anchor is not None:
            self.anchors[anchor] = None
        node = Node(start_mark(event)) if self.positions else None
        self.stack.append(Frame({} if mapping else [], mapping, anchor, node))

    def _close(self, event: Any) -> None:
        frame = self.stack.pop()
        if frame.node is not None:
            mark = frame.node.mark
            if event.end_mark.line + 1 == mark.line and event.end_mark.column > mark.column:
                frame.node.mark = Mark(mark.line, mark.column, event.end_mark.column + 1 - mark.column)
        if frame.merges:
            merge(frame)
        if frame.anchor is not None:
            self.anchors[frame.anchor] = Anchored(frame.value, frame.size, frame.height, frame.node)
        self._add(frame.value, frame.size, frame.height, frame.node)

    def _alias(self, event: Any) -> None:
        name = event.anchor
        if name not in self.anchors:
            self._stop("yaml-syntax", f"there is no anchor '&{name}' above the alias '*{name}'", event)
        anchor = self.anchors[name]
        if anchor is None:
            self._stop("recursive-alias", f"the alias '*{name}' is inside the value that it refers to", event)
        assert anchor is not None
        self.aliases += 1
        if self.aliases > self.limits.aliases:
            self._stop(
                "alias-expansion",
                f"more than {self.limits.aliases:,} aliases",
                event,
                fix="write the objects with 'number' and 'distribution' instead of repeating aliases",
            )
        self.expanded += anchor.size
        if self.expanded > self.limits.expansion:
            self._stop(
                "alias-expansion",
                f"aliases and merge keys expand to more than {self.limits.expansion:,} values",
                event,
                fix="write the objects with 'number' and 'distribution' instead of repeating aliases",
            )
        if len(self.stack) + anchor.height > self.limits.depth:
            self._stop("too-deep", f"nested more than {self.limits.depth} levels deep", event)
        self._add(anchor.value, anchor.size, anchor.height, anchor.node, event=event)

    def _add(
        self, value: Any, size: int, height: int, node: Node | None, *, plain: bool = False, event: Any = None
    ) -> None:
        """Add a finished value to the collection that is being read."""
        if not self.stack:
            self.data, self.root = value, node
            return
        frame = self.stack[-1]
        frame.size += size
        if height >= frame.height:
            frame.height = height + 1
        if not frame.mapping:
            if node is not None and frame.node is not None:
                frame.node.children[len(frame.value)] = node
            frame.value.append(value)
        elif frame.key is NO_KEY:
            self._key(frame, value, node, plain, event)
        elif frame.key is _MERGE:
            self._add_merge(frame, value, node)
            frame.key = NO_KEY
        else:
            frame.value[frame.key] = value
            if node is not None and frame.node is not None and frame.key_mark is not None:
                frame.node.keys[frame.key] = frame.key_mark
                frame.node.children[frame.key] = node
            frame.key = NO_KEY

    def _key(self, frame: Frame, key: Any, node: Node | None, plain: bool, event: Any) -> None:
        if plain and key == "<<":
            frame.key = _MERGE
            return
        if isinstance(key, (list, dict)):
            self._problem(
                "bad-key", "a key must be text, got a list or mapping", event, fix="quote it if it is meant as text"
            )
            key = str(key)[:40]
        elif len(frame.value) >= self.limits.keys:
            self._stop("too-many-events", f"more than {self.limits.keys:,} keys in one mapping", event)
        elif key in frame.value:
            self._problem(
                "duplicate-key",
                f"the key '{key}' is given a second time; the last value counts",
                event,
                key=key,
                given=key,
                fix="keep one of them",
                tolerated=True,
            )
        frame.key = key
        frame.key_mark = node.mark if node is not None else None

    def _add_merge(self, frame: Frame, value: Any, node: Node | None) -> None:
        sources = [(value, node)]
        if isinstance(value, list):
            children = node.children if node is not None else {}
            # the first of several merged mappings takes precedence, so it comes last
            sources = [(item, children.get(i)) for i, item in enumerate(value)][::-1]
        if not all(isinstance(item, dict) for item, _ in sources):
            self._problem("bad-key", "the value of the merge key '<<' must be a mapping or a list of mappings", None)
            return
        frame.merges = [*(frame.merges or []), *sources]

    # problems

    def path(self, key: Any = NO_KEY) -> Path:
        """Path of the value that is being read."""
        parts: list[str | int] = []
        for frame in self.stack:
            if not frame.mapping:
                parts.append(len(frame.value))
            elif frame.key is not NO_KEY and frame.key is not _MERGE:
                parts.append(str(frame.key))
        if key is not NO_KEY:
            parts.append(str(key))
        return tuple(parts)

    def _problem(
        self,
        code: str,
        message: str,
        event: Any,
        *,
        severity: Any = "error",
        key: Any = NO_KEY,
        tolerated: bool = False,
        given: Any = None,
        fix: str | None = None,
    ) -> None:
        mark = None if event is None else scalar_mark(event)
        self.fatal = self.fatal or (severity == "error" and not tolerated)
        if len(self.problems) >= self.limits.problems:
            return
        self.problems.append(
            Diagnostic(
                code,
                severity,
                self.path(key),
                message,
                line=mark.line if mark else None,
                column=mark.column if mark else None,
                length=mark.length if mark else 1,
                given=given,
                fix=fix,
                tolerated=tolerated,
            )
        )

    def _stop(self, code: str, message: str, event: Any, fix: str | None = None) -> None:
        self._problem(code, message, event, fix=fix)
        raise _Stop

    def _unsupported_tag(self, event: Any) -> None:
        shown = event.tag.replace("tag:yaml.org,2002:", "!!")
        self._problem(
            "unsupported-tag",
            f"the tag '{shown}' is not supported: a file is plain data",
            event,
            given=shown,
            fix="remove the tag",
        )

    def _look_for_color(self, event: Any) -> None:
        """Warn of an empty value before a comment that looks like a color."""
        frame = self.stack[-1] if self.stack else None
        if frame is None or (frame.mapping and frame.key is NO_KEY):
            return
        lines = self.lines = self.lines or self.text.splitlines()
        line = lines[event.end_mark.line] if event.end_mark.line < len(lines) else ""
        matches = _COLOR_COMMENT.match(line, event.end_mark.column)
        if matches is not None and (len(matches[1]) > len("#1234") or "color" in str(frame.key)):
            self._problem(
                "hash-comment",
                f"the value is empty, because '#' begins a comment: {matches[1]}",
                event,
                severity="warning",
                given=matches[1],
                fix=f"write it in quotes: '{matches[1]}'",
            )

    def _surprise(self, kind: str, text: str, value: Any, event: Any) -> None:
        what = "in base 60, like a time of day" if kind == "sexagesimal" else "as an octal number"
        self._problem(
            f"yaml-{kind}",
            f"YAML 1.1 reads {text} {what}: {value}",
            event,
            severity="warning",
            given=text,
            fix=f"write {value} for the number, or '{text}' in quotes for the text",
        )


def _parser(text: str) -> Any:
    """The event parser of libyaml, or PyYAML's own where PyYAML was built without libyaml."""
    if yaml.__with_libyaml__:
        from yaml._yaml import CParser

        return CParser(text)
    return yaml.SafeLoader(text)  # used for its events only; nothing is constructed


def syntax_problem(error: yaml.YAMLError, text: str, path: Path) -> Diagnostic:
    """The diagnostic for a parser's exception.

    Args:
        error: The exception.
        text: The text that was read.
        path: Path of the value that was being read.
    """
    line = column = 1
    message = " ".join(str(error).split())
    if isinstance(error, yaml.MarkedYAMLError):
        mark = error.problem_mark or error.context_mark
        if mark is not None:
            line, column = mark.line + 1, mark.column + 1
        begin = error.context_mark.line + 1 if error.context_mark is not None else line
        context = f"{error.context} from line {begin} on" if error.context and begin != line else error.context
        message = ", ".join(part for part in (context, error.problem) if part)
    elif isinstance(error, yaml.reader.ReaderError):
        position = error.position if isinstance(error.position, int) else 0
        before = text[:position]
        line, column = before.count("\n") + 1, position - before.rfind("\n")
        message = "a character that YAML does not allow"
    if "exceeded maximum nesting depth" in message:  # PyYAML has a limit of its own since version 6.0.4
        return Diagnostic("too-deep", "error", path, "nested too deeply", line=line, column=column)
    fix = None
    if "cannot start any token" in message and _character(text, line, column) == "\t":
        message, fix = "a tab is used for indentation", "indent with spaces"
    elif "cannot start any token" in message and _character(text, line, column) == "`":
        message, fix = "a Markdown fence is not part of the YAML", "leave out the lines with ```"
    return Diagnostic("yaml-syntax", "error", path, message, line=line, column=column, fix=fix)


def _character(text: str, line: int, column: int) -> str:
    lines = text.splitlines()
    return lines[line - 1][column - 1 : column] if 0 < line <= len(lines) else ""
