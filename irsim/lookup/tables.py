"""Keys as Markdown tables, for the references of the agent skill."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from irsim.lookup.answer import Key

__all__ = ["key_list", "key_table", "plain_table"]


def key_table(keys: Iterable[Key], gaps: Mapping[str, Iterable[str]] | None = None) -> str:
    """Return a table with one row per key: name, accepted values, default, meaning.

    Args:
        keys: The keys. A star marks those that accept one value per object.
        gaps: Key -> values that are not simulated, which its row lists.
    """
    rows = []
    for key in keys:
        name = f"`{key.name}`" + ("\\*" if key.per_object else "") + (" (required)" if key.required else "")
        missing = ", ".join(f"`{value}`" for value in (gaps or {}).get(key.name, ()))
        note = f" **Not simulated: {missing}.**" if missing else ""
        rows.append((name, _takes(key), f"`{key.default}`" if key.default is not None else "", key.text + note))
    return plain_table(("key", "takes", "default", "meaning"), rows)


def key_list(keys: Iterable[Key]) -> str:
    """Return one line per key: name, accepted values, default, meaning; this is shorter than a table."""
    return "\n".join(f"- `{key.name}` ({_takes(key)}; {key.default}): {key.text}" for key in keys)


def plain_table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a Markdown table."""
    lines = [_row(heads)]
    lines.append(_row("---" for _ in lines[0].split("|")[1:-1]))
    lines += [_row(row) for row in rows]
    return "\n".join(lines) + "\n"


def _row(cells: Iterable[str]) -> str:
    return "| " + " | ".join(" ".join(cell.split()).replace("|", "\\|") for cell in cells) + " |"


def _takes(key: Key) -> str:
    """Describe type, unit and range in a few words."""
    if key.type in ("a name", "a value"):
        return ", ".join(f"`{name}`" for name in (key.allowed or "").split(", "))
    if not key.type:  # a parameter of a template: the range names the unit
        return re.sub(r"^an? ", "", key.allowed or "")
    unit = key.unit or ""
    if unit and not unit.startswith("["):
        unit = f"[{unit}]"
    words = re.sub(r"^an? ", "", key.type) + (f" {unit}" if set(unit) - set("[1, ]") else "")
    return words + (f", {key.allowed}" if key.allowed else "")
