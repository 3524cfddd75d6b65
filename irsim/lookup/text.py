"""Answers as plain text, and keys as Markdown tables."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from irsim.lookup.answer import Answer, Key

__all__ = ["as_brief_text", "as_text", "facts", "first_sentence", "key_list", "key_table", "plain_table"]


_MAX_BRIEF_KEYS = 8
"""Number of keys that a brief answer describes; further ones are only named."""
_MAX_BRIEF_LIST = 3500
"""Number of characters up to which a brief answer repeats a list of topics; of longer ones it has only the names."""
_MIN_BRIEF_TEXT = 200
"""Number of characters from which on the next sentence ends the text of a brief answer."""


def as_text(answer: Answer) -> str:
    """Return an answer as text, without its example: for some topics ``answer.example`` is a command."""
    lines = [answer.title]
    if answer.text:
        lines.append(answer.text)
    if answer.about is not None:
        lines.append(facts(answer.about))
    for heading, keys in answer.groups.items():
        if keys:
            lines += ["", f"{heading}:", *(_line(key) for key in keys)]
    if answer.see:
        lines += ["", f"see also: {', '.join(answer.see)}"]
    if answer.best is not None:
        lines += ["", as_brief_text(answer.best)]
    return "\n".join(lines)


def as_brief_text(answer: Answer) -> str:
    """Return the essence of an answer: first sentences, its own keys, and the example.

    Keys that a component has in common with its siblings, and those beyond the first ones, are only named. A list of
    topics is whole, or has only names. Of the first topic that a search finds there is only the text.
    """
    lines = [answer.title]
    if answer.text:
        lines.append(_brief(answer))
    if answer.about is not None:
        lines.append(facts(answer.about))
    most = _MAX_BRIEF_KEYS
    if answer.kind == "index":
        listed = sum(len(_line(key)) for keys in answer.groups.values() for key in keys)
        most = len(max(answer.groups.values(), key=len)) if listed <= _MAX_BRIEF_LIST else 0
    for heading, keys in answer.groups.items():
        shown = [] if "in common" in heading or heading == "keys of all" else keys[:most]
        lines += [_brief_line(key) for key in shown]
        if rest := [_with_default(key) for key in keys[len(shown) :]]:
            lines.append(f"- {'also' if shown else heading}: {', '.join(rest)}")
    if answer.best is not None:
        lines += [f"{answer.best.title}\n{_brief(answer.best)}"]
    if answer.example:
        lines.append(
            f"For example: {answer.example}" if "\n" not in answer.example else f"For example:\n{answer.example}"
        )
    return "\n".join(lines)


def _brief(answer: Answer) -> str:
    """Return the text of a guide or a code, or the first sentences of any other."""
    return answer.text if answer.kind in ("guide", "code") else first_sentence(answer.text, least=_MIN_BRIEF_TEXT)


def _brief_line(key: Key) -> str:
    parts = [part for part in (_with_default(key), first_sentence(key.text)) if part]
    return "- " + ": ".join(parts)


def _with_default(key: Key) -> str:
    """Return name, unit and default of a key: ``vmax [m/s] = 1.5``."""
    unit = "" if not key.unit else f" {key.unit}" if key.unit.startswith("[") else f" [{key.unit}]"
    return f"{key.name}{unit}{' (required)' if key.required else '' if key.default is None else f' = {key.default}'}"


def first_sentence(text: str, *, least: int = 0) -> str:
    """Return the first sentences of a text that together have at least ``least`` characters, by default one."""
    end = re.compile(r"(?<=[.])\s").search(text, least)
    return text if end is None else text[: end.start()]


def _line(key: Key) -> str:
    parts = [part for part in (facts(key), key.text) if part]
    return f"- {key.name}" + (f": {'. '.join(parts)}" if parts else "")


def facts(key: Key) -> str:
    """Return type, unit, range and default of a key in one line."""
    unit = "" if not key.unit else f" {key.unit}" if key.unit.startswith("[") else f" [{key.unit}]"
    if key.type in ("a name", "a value"):
        facts = [f"one of {key.allowed}"]
    else:
        facts = [key.type + unit if key.type else "", key.allowed or ""]
    if key.required:
        facts.append("required")
    if key.default is not None:
        facts.append(f"default {key.default}")
    if key.per_object:
        facts.append("or a list, one per object")
    return "; ".join(fact for fact in facts if fact)


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
