"""The comments of a YAML text, which its data do not have."""

from __future__ import annotations

import re
from collections import Counter

__all__ = ["comments", "keeps_comments"]

_QUOTED_OR_COMMENT = re.compile(
    r"""(?:(?<=[\s\[{,])|^)(?:"(?:\\.|[^"\\\n])*"|'(?:''|[^'\n])*')|(?P<comment>(?:(?<=\s)|^)\#.*)""", re.MULTILINE
)


def comments(text: str) -> list[str]:
    """Comments of a YAML text, in order, each from its ``#`` on; a ``#`` inside quotes is none."""
    found = (match["comment"] for match in _QUOTED_OR_COMMENT.finditer(text))
    return [comment.strip() for comment in found if comment is not None]


def keeps_comments(before: str, after: str) -> bool:
    """Whether every comment of a text is there in another, too."""
    return not Counter(comments(before)) - Counter(comments(after))
