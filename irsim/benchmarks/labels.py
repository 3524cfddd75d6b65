"""Labels of behaviors in tables: the MCP server writes them without NumPy."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.scenario.yaml.document import load_text

__all__ = ["labels_of"]

MAX_LABEL = 24
"""Characters of a behavior that is its own label; a longer one is numbered."""


def labels_of(behaviors: Sequence[str]) -> dict[str, str]:
    """Return a label for each behavior: a long one gets its name and its place in the list, as ``orca #2``."""
    return {
        text: text if len(text) <= MAX_LABEL else f"{_name(text)} #{place}"
        for place, text in enumerate(behaviors, start=1)
    }


def _name(text: str) -> str:
    """Return the name in a behavior that is known to be valid."""
    if not text.lstrip().startswith("{"):
        return text.strip()
    return str(load_text(text).data["name"])
