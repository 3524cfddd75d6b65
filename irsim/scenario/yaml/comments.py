"""The comments of a YAML text, which its data do not have."""

from __future__ import annotations

import bisect
import re
from collections import Counter, defaultdict
from collections.abc import Iterator

from irsim.common.yaml.nodes import Node
from irsim.diagnostics.diagnostic import Path
from irsim.scenario.yaml.document import Document

__all__ = ["comments", "keeps_comments", "places_of_comments"]

_QUOTED_OR_COMMENT = re.compile(
    r"""(?:(?<=[\s\[{,])|^)(?:"(?:\\.|[^"\\\n])*"|'(?:''|[^'\n])*')|(?P<comment>(?:(?<=\s)|^)\#.*)""", re.MULTILINE
)


def comments(text: str) -> list[str]:
    """Comments of a YAML text, in order, each from its ``#`` on; a ``#`` inside quotes does not start one."""
    matched = (match["comment"] for match in _QUOTED_OR_COMMENT.finditer(text))
    return [comment.strip() for comment in matched if comment is not None]


def keeps_comments(before: str, after: str) -> bool:
    """Whether ``after`` still contains every comment of ``before``."""
    return not Counter(comments(before)) - Counter(comments(after))


def places_of_comments(document: Document) -> list[tuple[str, list[Path]]]:
    """The comments of a text, in order, each with the paths that it may be about.

    A comment behind a value is about everything on its line. A comment on a line of its own is about the next line with
    content or, if it is indented more than that line, about the last line above that is not indented more than the
    comment.

    Args:
        document: The document, with its text.

    Returns:
        Comments with paths; in a path, a robot or obstacle written without a list is element 0.
    """
    if document.text is None:
        return []
    there: dict[int, list[Path]] = defaultdict(list)
    for path, line in _nodes(document.tree(), ()):
        there[line].append(_list_path(path[len(document.prefix) :], document))
    occupied, lines = sorted(there), document.text.splitlines()
    placed: list[tuple[str, list[Path]]] = []
    line, read, known = 1, 0, dict[tuple[int, int], int]()
    for match in _QUOTED_OR_COMMENT.finditer(document.text):
        if match["comment"] is None:
            continue
        line, read = line + document.text.count("\n", read, match.start("comment")), match.start("comment")
        about = line
        if line not in there:
            spot = bisect.bisect(occupied, line), _indent(lines[line - 1])
            if spot not in known:
                known[spot] = _line_of(*spot, occupied, lines)
            about = known[spot]
        placed.append((match["comment"].strip(), there.get(about, [])))
    return placed


def _line_of(at: int, indent: int, occupied: list[int], lines: list[str]) -> int:
    """The line that a comment on a line of its own is about; ``at`` is the index of the next line with content."""
    if at < len(occupied) and _indent(lines[occupied[at] - 1]) >= indent:
        return occupied[at]
    return next((k for k in reversed(occupied[:at]) if _indent(lines[k - 1], " -") <= indent), 0)


def _nodes(node: Node | None, path: Path) -> Iterator[tuple[Path, int]]:
    """Every path, with the line on which its key or value starts."""
    if node is None:
        return
    for key, child in node.children.items():
        below = (*path, key if isinstance(key, int) else str(key))
        yield below, node.keys.get(key, child.mark).line
        yield from _nodes(child, below)


def _list_path(path: Path, document: Document) -> Path:
    single = path[:1] in (("robot",), ("obstacle",)) and isinstance(document.data.get(path[0]), dict)
    return (path[0], 0, *path[1:]) if single else path


def _indent(line: str, blank: str = " ") -> int:
    return len(line) - len(line.lstrip(blank))
