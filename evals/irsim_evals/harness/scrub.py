"""What a recording must not hold: keys, and paths of the machine; and names that differ from run to run."""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

__all__ = ["Names", "scrubbed"]

_SECRET_NAMES = re.compile(r"KEY|TOKEN|SECRET|PASSWORD|CREDENTIAL", re.IGNORECASE)
_SECRETS = re.compile(r"\b(?:sk-[A-Za-z0-9_-]{8,}|Bearer\s+[A-Za-z0-9._~+/=-]{8,}|gh[pousr]_[A-Za-z0-9]{20,})")
_MIN_SECRET = 8
"""Length from which on the value of a variable is taken for a secret."""
_RUN = re.compile(r"\b[a-z0-9_-]+-[0-9a-f]{6}\b")
_NAMED = re.compile(r"\$run\d+\b")


def scrubbed(value: Any, folders: Iterable[Path | str] = ()) -> Any:
    """A value in whose texts secrets and absolute paths are replaced.

    Args:
        value: A text, or lists and mappings of texts.
        folders: Folders of attempts, which become ``<folder>``.
    """
    replaced = _replacements(folders)

    def clean(item: Any) -> Any:
        if isinstance(item, str):
            for old, new in replaced:
                item = item.replace(old, new)
            return _SECRETS.sub("<secret>", item)
        if isinstance(item, dict):
            return {clean(key): clean(one) for key, one in item.items()}
        return [clean(one) for one in item] if isinstance(item, (list, tuple)) else item

    return clean(value)


def _replacements(folders: Iterable[Path | str]) -> list[tuple[str, str]]:
    """Texts and what stands for them, the longest first."""
    found = {str(path): "<folder>" for folder in folders for path in (Path(folder), Path(folder).resolve())}
    places = {"<packages>": Path(__file__).resolve().parents[2], "<python>": Path(sys.prefix), "<home>": Path.home()}
    for name, place in (*places.items(), ("<temporary>", Path(tempfile.gettempdir()))):
        for path in (place, place.resolve()):
            if len(path.parts) > 1:
                found.setdefault(str(path), name)
    for name, text in os.environ.items():
        if _SECRET_NAMES.search(name) and len(text) >= _MIN_SECRET and not text.startswith("/"):
            found[text] = "<secret>"
    return sorted(found.items(), key=lambda pair: -len(pair[0]))


class Names:
    """Numbers the ids of runs in the order in which they occur: the same work has the same text in every replay."""

    def __init__(self) -> None:
        self.ids: list[str] = []

    def numbered(self, value: Any) -> Any:
        """A value in which each id is ``$run1``, ``$run2`` …; ids that are new get the next number."""
        return _mapped(value, _RUN, lambda found: f"$run{self._number(found)}")

    def known(self, value: Any) -> Any:
        """The same, for what an agent writes: ids that no tool has named stay."""
        return _mapped(value, _RUN, lambda found: f"$run{self._number(found)}" if found in self.ids else found)

    def filled(self, value: Any) -> Any:
        """A value in which ids stand again where their numbers are."""
        ids = {f"$run{number}": name for number, name in enumerate(self.ids, 1)}
        return _mapped(value, _NAMED, lambda found: ids.get(found, found))

    def _number(self, found: str) -> int:
        if found not in self.ids:
            self.ids.append(found)
        return self.ids.index(found) + 1


def _mapped(value: Any, pattern: re.Pattern[str], change: Any) -> Any:
    if isinstance(value, str):
        return pattern.sub(lambda found: change(found[0]), value)
    if isinstance(value, dict):
        return {key: _mapped(one, pattern, change) for key, one in value.items()}
    return [_mapped(one, pattern, change) for one in value] if isinstance(value, list) else value
