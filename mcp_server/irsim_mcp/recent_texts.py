"""Texts of scenarios that calls have given lately, each under a short id, so that a text is sent once."""

from __future__ import annotations

import hashlib
import re
from collections import OrderedDict

__all__ = ["RecentTexts"]

_MAX_TEXTS = 64
"""Number of texts that are kept."""
_MAX_CHARACTERS = 4 * 1024**2
"""Number of characters of all kept texts together."""
_ID = re.compile(r"text-[0-9a-f]{6}")


class RecentTexts:
    """Scenario texts of one server, the least recently used of which are forgotten first."""

    def __init__(self) -> None:
        self._texts: OrderedDict[str, str] = OrderedDict()

    def remember(self, text: str) -> str:
        """Keep a text and return its id, which depends on the text alone."""
        name = f"text-{hashlib.sha256(text.encode('utf-8', 'replace')).hexdigest()[:6]}"
        self._texts[name] = text
        self._texts.move_to_end(name)
        while len(self._texts) > 1 and (
            len(self._texts) > _MAX_TEXTS or sum(map(len, self._texts.values())) > _MAX_CHARACTERS
        ):
            self._texts.popitem(last=False)
        return name

    def find(self, name: str) -> str | None:
        """Return the text with an id; None if it was forgotten or never given."""
        text = self._texts.get(name)
        if text is not None:
            self._texts.move_to_end(name)
        return text

    @staticmethod
    def is_id(name: str) -> bool:
        """Whether a name has the form of an id."""
        return _ID.fullmatch(name) is not None
